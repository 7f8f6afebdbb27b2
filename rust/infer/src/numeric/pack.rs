//! Several numbers side by side: the same arithmetic for several noise models at once.
//!
//! Loops count by hand: an iterator's next number is a call where a function has its own registers.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::elementary;
use core::ops::{Add, Div, Mul, Sub};

/// Numbers side by side.
pub(crate) const PACK: usize = 8;

/// One number for each of several noise models; loops over them become vector instructions.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Pack(pub [f64; PACK]);

impl Pack {
    #[inline(always)]
    pub fn all(value: f64) -> Self {
        Self([value; PACK])
    }

    #[inline(always)]
    pub fn map(mut self, with: impl Fn(f64) -> f64) -> Self {
        let mut lane = 0; // an iterator is a call for each lane where little is optimized
        while lane < PACK {
            self.0[lane] = with(self.0[lane]);
            lane += 1;
        }
        self
    }

    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.both(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Natural logarithm, within two units of the last place.
    #[inline(always)]
    pub fn ln(self) -> Self {
        if self.0.iter().all(|x| x.is_normal() && *x > 0.0) {
            self.map(elementary::ln)
        } else {
            self.map(f64::ln)
        }
    }

    /// Exponential, of no number beyond 700.
    #[inline(always)]
    pub fn exp(self) -> Self {
        self.map(elementary::exp)
    }

    #[inline(always)]
    fn both(mut self, other: Self, with: impl Fn(f64, f64) -> f64) -> Self {
        let mut lane = 0;
        while lane < PACK {
            self.0[lane] = with(self.0[lane], other.0[lane]);
            lane += 1;
        }
        self
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident $name:ident $sign:tt),*) => {$(
        impl $operator for Pack {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.both(other, |a, b| a $sign b)
            }
        }
    )*};
}

lane_by_lane!(Add add +, Sub sub -, Mul mul *, Div div /);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms_of_odd_numbers() {
        let odd = Pack([0.0, f64::INFINITY, f64::NAN, -1.0, 5e-324, 1.0, 2.0, 3.0]).ln();
        assert_eq!(odd.0[..2], [f64::NEG_INFINITY, f64::INFINITY]);
        assert!(odd.0[2].is_nan() && odd.0[3].is_nan());
        assert_eq!(odd.0[4..], [5e-324_f64, 1.0, 2.0, 3.0].map(f64::ln));
    }
}

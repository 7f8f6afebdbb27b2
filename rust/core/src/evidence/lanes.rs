//! Several numbers side by side: the same arithmetic for several noises at once.
//!
//! Loops count by hand: an iterator's next number is a call where a function has its own registers.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::elementary;
use core::ops::{Add, Div, Mul, Sub};

/// Numbers side by side.
pub(super) const LANES: usize = 8;

/// One number for each of several noises; loops over them become vector instructions.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Lane(pub [f64; LANES]);

impl Lane {
    #[inline(always)]
    pub fn all(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub fn map(mut self, with: impl Fn(f64) -> f64) -> Self {
        let mut lane = 0; // an iterator is a call for each lane where little is optimized
        while lane < LANES {
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
        while lane < LANES {
            self.0[lane] = with(self.0[lane], other.0[lane]);
            lane += 1;
        }
        self
    }
}

macro_rules! lane_by_lane {
    ($($operator:ident $name:ident $sign:tt),*) => {$(
        impl $operator for Lane {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.both(other, |a, b| a $sign b)
            }
        }
    )*};
}

lane_by_lane!(Add add +, Sub sub -, Mul mul *, Div div /);

/// `from - a b`, in four sums at once: one alone would wait for itself.
#[inline(always)]
pub(super) fn less(from: Lane, a: &[Lane], b: &[Lane]) -> Lane {
    let (whole, b) = (a.len() & !3, &b[..a.len()]);
    let (mut rest, mut at) = (from, whole);
    while at < a.len() {
        rest = rest - a[at] * b[at];
        at += 1;
    }
    if whole == 0 {
        return rest;
    }
    let mut sums = [Lane::all(0.0); 4];
    at = 0;
    while at < whole {
        sums[0] = sums[0] + a[at] * b[at];
        sums[1] = sums[1] + a[at + 1] * b[at + 1];
        sums[2] = sums[2] + a[at + 2] * b[at + 2];
        sums[3] = sums[3] + a[at + 3] * b[at + 3];
        at += 4;
    }
    rest - ((sums[0] + sums[1]) + (sums[2] + sums[3]))
}

/// Sum of squares, each times a weight.
#[inline(always)]
pub(super) fn squares(values: &[Lane], weights: &[Lane]) -> Lane {
    let (mut sum, mut at, weights) = (Lane::all(0.0), 0, &weights[..values.len()]);
    while at < values.len() {
        sum = sum + values[at] * values[at] * weights[at];
        at += 1;
    }
    sum
}

/// Matrices of `order`, of which the lower triangle is read, with something `added` to the diagonal,
/// factored from a row on, where those before are factored already: `L D L'` with ones on the diagonal
/// of `L`, where `D` stands.
///
/// No pivot is smaller than what was added to it; see [`super::cholesky::factor`].
#[inline(always)]
pub(super) fn factor(
    matrix: &[Lane],
    added: &[Lane],
    lower: &mut [Lane],
    inverse: &mut [Lane],
    from: usize,
) {
    let order = added.len();
    for i in from..order {
        let (before, own) = lower.split_at_mut(i * order);
        let line = &matrix[i * order..][..=i];
        for j in 0..i {
            own[j] = less(line[j], &own[..j], &before[j * order..][..j]);
        }
        let (mut pivot, mut at) = (line[i] + added[i], 0);
        while at < i {
            let scaled = own[at] * inverse[at];
            pivot = pivot - own[at] * scaled;
            own[at] = scaled;
            at += 1;
        }
        own[i] = pivot.max(added[i]);
        inverse[i] = Lane::all(1.0) / own[i];
    }
}

/// Solves `L x = b` in place, where `b` is zero before `first`; `L` has ones on its diagonal.
#[inline(always)]
pub(super) fn forward(lower: &[Lane], order: usize, b: &mut [Lane], first: usize) {
    for i in first + 1..order {
        b[i] = less(b[i], &lower[i * order + first..][..i - first], &b[first..i]);
    }
}

/// Solves `L' x = b` in place.
#[inline(always)]
pub(super) fn backward(lower: &[Lane], order: usize, b: &mut [Lane]) {
    for i in (0..order).rev() {
        let mut sum = b[i];
        for k in i + 1..order {
            sum = sum - lower[k * order + i] * b[k];
        }
        b[i] = sum;
    }
}

/// `(L D L')^-1`, both triangles, with memory for the inverse of `L`.
#[inline(always)]
pub(super) fn invert(
    lower: &[Lane],
    order: usize,
    inverse: &[Lane],
    unit: &mut [Lane],
    into: &mut [Lane],
) {
    for column in 0..order {
        let unit = &mut unit[column * order..][..order];
        unit[column..].fill(Lane::all(0.0));
        unit[column] = Lane::all(1.0);
        forward(lower, order, unit, column);
    }
    for i in 0..order {
        for j in 0..=i {
            let mut sum = Lane::all(0.0);
            for k in i..order {
                sum = sum + unit[i * order + k] * unit[j * order + k] * inverse[k];
            }
            into[i * order + j] = sum;
            into[j * order + i] = sum;
        }
    }
}

/// Makes a method run with the widest registers that this machine has.
macro_rules! on_widest {
    ($(#[$doc:meta])* $name:ident $wide:ident $wider:ident $inner:ident ($($given:ident: $type:ty),*) -> $made:ty) => {
        $(#[$doc])*
        pub fn $name(&mut self, $($given: $type),*) -> $made {
            match crate::simd::active() {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the instruction set is available.
                crate::simd::InstructionSet::Avx512 => unsafe { self.$wider($($given),*) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                crate::simd::InstructionSet::Avx2 => unsafe { self.$wide($($given),*) },
                _ => self.$inner($($given),*),
            }
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2")]
        unsafe fn $wide(&mut self, $($given: $type),*) -> $made {
            self.$inner($($given),*)
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2")]
        unsafe fn $wider(&mut self, $($given: $type),*) -> $made {
            self.$inner($($given),*)
        }
    };
}

pub(super) use on_widest;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::cholesky;

    #[test]
    fn logarithms_of_odd_numbers() {
        let odd = Lane([0.0, f64::INFINITY, f64::NAN, -1.0, 5e-324, 1.0, 2.0, 3.0]).ln();
        assert_eq!(odd.0[..2], [f64::NEG_INFINITY, f64::INFINITY]);
        assert!(odd.0[2].is_nan() && odd.0[3].is_nan());
        assert_eq!(odd.0[4..], [5e-324_f64, 1.0, 2.0, 3.0].map(f64::ln));
    }

    #[test]
    fn an_inverse_by_hand() {
        let matrix = [4.0, 0.0, 0.0, 2.0, 5.0, 0.0, 0.0, 1.0, 3.0].map(Lane::all);
        let (mut lower, mut pivots) = ([Lane::all(0.0); 9], [Lane::all(0.0); 3]);
        factor(&matrix, &[Lane::all(0.0); 3], &mut lower, &mut pivots, 0);
        let (mut unit, mut found) = ([Lane::all(0.0); 9], [Lane::all(0.0); 9]);
        invert(&lower, 3, &pivots, &mut unit, &mut found);
        let expected = [14.0, -6.0, 2.0, -6.0, 12.0, -4.0, 2.0, -4.0, 16.0].map(|x| x / 44.0);
        for (found, right) in found.iter().zip(expected) {
            assert!((found.0[3] - right).abs() < 1e-15);
        }
    }

    #[test]
    fn every_lane_as_by_itself() {
        let matrix = |lane: usize| [4.0 + lane as f64, 0.0, 0.0, 2.0, 5.0, 0.0, 0.0, 1.0, 3.0];
        let lanes: Vec<Lane> = (0..9)
            .map(|at| Lane(core::array::from_fn(|lane| matrix(lane)[at])))
            .collect();
        let (mut lower, mut pivots) = ([Lane::all(0.0); 9], [Lane::all(0.0); 3]);
        factor(&lanes, &[Lane::all(0.0); 3], &mut lower, &mut pivots, 0);
        let mut solved = [1.0, -2.0, 0.5].map(Lane::all);
        forward(&lower, 3, &mut solved, 0);
        for (number, pivot) in solved.iter_mut().zip(pivots) {
            *number = *number * pivot;
        }
        backward(&lower, 3, &mut solved);
        for lane in 0..LANES {
            let (mut own, mut b) = (matrix(lane), [1.0, -2.0, 0.5]);
            cholesky::factor(&mut own, 3, &[0.0; 3]);
            cholesky::forward(&own, 3, &mut b);
            cholesky::backward(&own, 3, &mut b);
            for (found, right) in solved.iter().zip(b) {
                assert!((found.0[lane] - right).abs() < 1e-15);
            }
        }
    }
}

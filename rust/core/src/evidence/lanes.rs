//! Several numbers side by side: the same arithmetic for several noises at once.

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
    pub fn map(self, with: impl Fn(f64) -> f64) -> Self {
        Self(core::array::from_fn(|lane| with(self.0[lane])))
    }

    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.both(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    fn both(self, other: Self, with: impl Fn(f64, f64) -> f64) -> Self {
        Self(core::array::from_fn(|lane| {
            with(self.0[lane], other.0[lane])
        }))
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

/// Lower triangle of matrices of `order`, row by row, factored in place from a row on, where those
/// before are factored already; see [`super::cholesky::factor`].
#[inline(always)]
pub(super) fn factor(matrix: &mut [Lane], order: usize, added: &[Lane], from: usize) {
    for i in from..order {
        for j in 0..=i {
            let mut sum = matrix[i * order + j];
            for k in 0..j {
                sum = sum - matrix[i * order + k] * matrix[j * order + k];
            }
            matrix[i * order + j] = if i == j {
                sum.max(added[i]).sqrt()
            } else {
                sum / matrix[j * order + j]
            };
        }
    }
}

/// Solves `L x = b` in place, where `b` is zero before `first`.
#[inline(always)]
pub(super) fn forward(lower: &[Lane], order: usize, b: &mut [Lane], first: usize) {
    for i in first..order {
        let mut sum = b[i];
        for k in first..i {
            sum = sum - lower[i * order + k] * b[k];
        }
        b[i] = sum / lower[i * order + i];
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
        b[i] = sum / lower[i * order + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::cholesky;

    #[test]
    fn every_lane_as_by_itself() {
        let matrix = |lane: usize| [4.0 + lane as f64, 0.0, 0.0, 2.0, 5.0, 0.0, 0.0, 1.0, 3.0];
        let mut lanes: Vec<Lane> = (0..9)
            .map(|at| Lane(core::array::from_fn(|lane| matrix(lane)[at])))
            .collect();
        factor(&mut lanes, 3, &[Lane::all(0.0); 3], 0);
        let mut solved = [1.0, -2.0, 0.5].map(Lane::all);
        forward(&lanes, 3, &mut solved, 0);
        backward(&lanes, 3, &mut solved);
        for lane in 0..LANES {
            let (mut own, mut b) = (matrix(lane), [1.0, -2.0, 0.5]);
            cholesky::factor(&mut own, 3, &[0.0; 3]);
            cholesky::forward(&own, 3, &mut b);
            cholesky::backward(&own, 3, &mut b);
            assert_eq!(solved.map(|x| x.0[lane]), b);
        }
    }
}

//! The number type that every formula is written in.
//!
//! A formula generic over [`Scalar`] simulates with `f64`/`f32`, runs batches in SIMD lanes and
//! gives exact derivatives with [`Dual`](crate::dual::Dual). The trait has no comparison
//! operators, so a formula cannot branch on a value: it stays differentiable and vectorizes.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, possibly carrying derivatives, possibly several at once.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// A constant of the formula, rounded once to the width of `Self`; its derivatives are zero.
    fn constant(value: f64) -> Self;

    /// `self * factor + term` with one rounding: the same bits on every instruction set.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Exponential function, branch-free.
    fn exp(self) -> Self;

    /// Absolute value.
    fn abs(self) -> Self;

    /// `chosen` where `condition >= 0`, else `other` (also where `condition` is NaN).
    fn select(condition: Self, chosen: Self, other: Self) -> Self;

    /// The smaller of two numbers.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(other - self, self, other)
    }

    /// The larger of two numbers.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(self - other, self, other)
    }
}

/// A [`Scalar`] of one row or several, of which it can be known that none needs what is left out.
pub trait Rows: Scalar {
    /// Whether every row is `>= 0`. Only for leaving out what would not change any row: a row's
    /// result must not depend on its neighbors.
    fn all_non_negative(self) -> bool;
}

/// `coefficients[0] + coefficients[1] x + coefficients[2] x^2 + ...` by Horner's rule.
#[inline(always)]
pub fn polynomial<S: Scalar, const N: usize>(x: S, coefficients: [f64; N]) -> S {
    let mut sum = S::constant(coefficients[N - 1]);
    for &coefficient in coefficients[..N - 1].iter().rev() {
        sum = sum.mul_add(x, S::constant(coefficient));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomial_is_horner() {
        assert_eq!(polynomial(2.0, [1.0, 10.0, 100.0]), 421.0);
        assert_eq!(polynomial(7.0_f32, [3.0]), 3.0);
    }

    #[test]
    fn select_takes_the_other_side_for_nan() {
        assert_eq!(f64::select(f64::NAN, 1.0, 2.0), 2.0);
        assert_eq!(f64::select(0.0, 1.0, 2.0), 1.0);
        assert_eq!(Scalar::min(1.0, 2.0), 1.0);
        assert_eq!(Scalar::max(1.0, 2.0), 2.0);
    }
}

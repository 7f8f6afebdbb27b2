//! Dual numbers: a value with its exact derivatives to `N` variables (forward mode).

use crate::scalar::{Rows, Scalar};
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its partial derivatives, of one row or of several.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize, S = f64> {
    /// The value.
    pub value: S,
    /// Partial derivatives to the `N` seeded variables.
    pub derivatives: [S; N],
}

impl<const N: usize, S: Scalar> Dual<N, S> {
    /// The variable number `index`: its derivative to itself is one.
    #[inline(always)]
    #[must_use]
    pub fn variable(value: S, index: usize) -> Self {
        let mut dual = Self::fixed(value);
        dual.derivatives[index] = S::constant(1.0);
        dual
    }

    /// A value that depends on none of the variables.
    #[inline(always)]
    #[must_use]
    pub fn fixed(value: S) -> Self {
        Self {
            value,
            derivatives: [S::constant(0.0); N],
        }
    }

    /// A function of `self` with value `value` and derivative `slope`.
    #[inline(always)]
    fn chain(self, value: S, slope: S) -> Self {
        let mut derivatives = self.derivatives;
        for d in &mut derivatives {
            *d = *d * slope;
        }
        Self { value, derivatives }
    }

    /// A function of two duals with value `value` and partial derivatives `a`, `b`.
    #[inline(always)]
    fn chain2(self, other: Self, value: S, a: S, b: S) -> Self {
        let mut derivatives = self.derivatives;
        for (i, d) in derivatives.iter_mut().enumerate() {
            *d = self.derivatives[i].mul_add(a, other.derivatives[i] * b);
        }
        Self { value, derivatives }
    }
}

impl<const N: usize, S: Scalar> Add for Dual<N, S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let one = S::constant(1.0);
        self.chain2(other, self.value + other.value, one, one)
    }
}

impl<const N: usize, S: Scalar> Sub for Dual<N, S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let one = S::constant(1.0);
        self.chain2(other, self.value - other.value, one, -one)
    }
}

impl<const N: usize, S: Scalar> Mul for Dual<N, S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.chain2(other, self.value * other.value, other.value, self.value)
    }
}

impl<const N: usize, S: Scalar> Div for Dual<N, S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let inverse = S::constant(1.0) / other.value;
        self.chain2(other, quotient, inverse, -quotient * inverse)
    }
}

impl<const N: usize, S: Scalar> Neg for Dual<N, S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value, S::constant(-1.0))
    }
}

impl<const N: usize, S: Scalar> Scalar for Dual<N, S> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::fixed(S::constant(value))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let mut derivatives = self.derivatives;
        for (i, d) in derivatives.iter_mut().enumerate() {
            let product =
                self.derivatives[i].mul_add(factor.value, factor.derivatives[i] * self.value);
            *d = product + term.derivatives[i];
        }
        Self {
            value: self.value.mul_add(factor.value, term.value),
            derivatives,
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, S::constant(0.5) / root)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let one = S::constant(1.0);
        self.chain(self.value.abs(), S::select(self.value, one, -one))
    }
    #[inline(always)]
    fn select(condition: Self, chosen: Self, other: Self) -> Self {
        let mut derivatives = chosen.derivatives;
        for (i, d) in derivatives.iter_mut().enumerate() {
            *d = S::select(condition.value, chosen.derivatives[i], other.derivatives[i]);
        }
        Self {
            value: S::select(condition.value, chosen.value, other.value),
            derivatives,
        }
    }
}

impl<const N: usize, S: Rows> Rows for Dual<N, S> {
    #[inline(always)]
    fn all_non_negative(self) -> bool {
        self.value.all_non_negative()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn product_rule_and_chain_rule() {
        let x = Dual::<2>::variable(3.0, 0);
        let y = Dual::<2>::variable(2.0, 1);
        let f = (x * y + Dual::constant(3.0)).sqrt(); // sqrt(xy + 3) = 3
        assert_eq!(f.value, 3.0);
        assert_eq!(f.derivatives, [2.0 / 6.0, 3.0 / 6.0]);
    }

    #[test]
    fn fused_operations_agree_with_plain_ones() {
        let x = Dual::<1>::variable(1.7, 0);
        let fused = x.mul_add(x, Dual::constant(2.0));
        let plain = x * x + Dual::constant(2.0);
        assert_eq!(fused.derivatives, plain.derivatives);
        assert!((fused.value - plain.value).abs() < 1e-15);
    }
}

//! Dual numbers: a value with its exact derivatives to `N` variables (forward mode).

use crate::scalar::Scalar;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A value and its partial derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// Partial derivatives to the `N` seeded variables.
    pub derivatives: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The variable number `index`: its derivative to itself is one.
    #[must_use]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut derivatives = [0.0; N];
        derivatives[index] = 1.0;
        Self { value, derivatives }
    }

    /// A function of `self` with value `value` and derivative `slope`.
    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self {
            value,
            derivatives: self.derivatives.map(|d| d * slope),
        }
    }

    /// A function of two duals with value `value` and partial derivatives `a`, `b`.
    #[inline(always)]
    fn chain2(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        let mut derivatives = [0.0; N];
        for (i, d) in derivatives.iter_mut().enumerate() {
            *d = self.derivatives[i].mul_add(a, other.derivatives[i] * b);
        }
        Self { value, derivatives }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.chain2(other, self.value + other.value, 1.0, 1.0)
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.chain2(other, self.value - other.value, 1.0, -1.0)
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.chain2(other, self.value * other.value, other.value, self.value)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.chain2(other, quotient, 1.0 / other.value, -quotient / other.value)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self {
            value,
            derivatives: [0.0; N],
        }
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let mut derivatives = [0.0; N];
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
        self.chain(root, 0.5 / root)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = Scalar::exp(self.value);
        self.chain(value, value)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.chain(self.value.abs(), self.value.signum())
    }
    #[inline(always)]
    fn select(condition: Self, chosen: Self, other: Self) -> Self {
        if condition.value >= 0.0 {
            chosen
        } else {
            other
        }
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

//! Several vectors in flight at once.
#![allow(unsafe_code)]

use super::Vector;
use crate::scalar::Scalar;
use core::array::from_fn;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// `N` independent vectors, each operation done on all: it hides the latency of the units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes<V, const N: usize>([V; N]);

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<V: Scalar, const N: usize> $trait for Lanes<V, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(from_fn(|i| self.0[i].$method(other.0[i])))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<V: Scalar, const N: usize> Neg for Lanes<V, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(from_fn(|i| -self.0[i]))
    }
}

impl<V: Scalar, const N: usize> Scalar for Lanes<V, N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([V::constant(value); N])
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(from_fn(|i| self.0[i].mul_add(factor.0[i], term.0[i])))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(from_fn(|i| self.0[i].sqrt()))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Self(from_fn(|i| self.0[i].exp()))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(from_fn(|i| self.0[i].abs()))
    }
    #[inline(always)]
    fn select(condition: Self, chosen: Self, other: Self) -> Self {
        Self(from_fn(|i| {
            V::select(condition.0[i], chosen.0[i], other.0[i])
        }))
    }
}

impl<V: Vector, const N: usize> Vector for Lanes<V, N> {
    type Element = V::Element;
    const WIDTH: usize = N * V::WIDTH;

    #[inline(always)]
    unsafe fn load(source: *const V::Element) -> Self {
        // SAFETY: the caller guarantees N * V::WIDTH readable elements.
        Self(from_fn(|i| unsafe { V::load(source.add(i * V::WIDTH)) }))
    }

    #[inline(always)]
    unsafe fn store(self, target: *mut V::Element) {
        for (i, vector) in self.0.into_iter().enumerate() {
            // SAFETY: the caller guarantees N * V::WIDTH writable elements.
            unsafe { vector.store(target.add(i * V::WIDTH)) };
        }
    }
}

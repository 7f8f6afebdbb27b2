//! Several vectors in flight at once.
//!
//! Plain loops, no closures: a closure does not inherit the instruction set of the function that it
//! is written in, and would be called where an instruction should stand.
#![allow(unsafe_code)]

use super::Vector;
use crate::scalar::{Rows, Scalar};
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
                let mut result = self;
                for i in 0..N {
                    result.0[i] = self.0[i].$method(other.0[i]);
                }
                result
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
        let mut result = self;
        for i in 0..N {
            result.0[i] = -self.0[i];
        }
        result
    }
}

impl<V: Scalar, const N: usize> Scalar for Lanes<V, N> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([V::constant(value); N])
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        let mut result = self;
        for i in 0..N {
            result.0[i] = self.0[i].mul_add(factor.0[i], term.0[i]);
        }
        result
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let mut result = self;
        for i in 0..N {
            result.0[i] = self.0[i].sqrt();
        }
        result
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let mut result = self;
        for i in 0..N {
            result.0[i] = self.0[i].exp();
        }
        result
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let mut result = self;
        for i in 0..N {
            result.0[i] = self.0[i].abs();
        }
        result
    }
    #[inline(always)]
    fn select(condition: Self, chosen: Self, other: Self) -> Self {
        let mut result = condition;
        for i in 0..N {
            result.0[i] = V::select(condition.0[i], chosen.0[i], other.0[i]);
        }
        result
    }
}

impl<V: Rows, const N: usize> Rows for Lanes<V, N> {
    #[inline(always)]
    fn all_non_negative(self) -> bool {
        let mut all = true;
        for vector in self.0 {
            all &= vector.all_non_negative();
        }
        all
    }
}

impl<V: Vector, const N: usize> Vector for Lanes<V, N> {
    type Element = V::Element;
    const WIDTH: usize = N * V::WIDTH;

    #[inline(always)]
    unsafe fn load(source: *const V::Element) -> Self {
        let mut result = Self([V::constant(0.0); N]);
        for i in 0..N {
            // SAFETY: the caller guarantees N * V::WIDTH readable elements.
            result.0[i] = unsafe { V::load(source.add(i * V::WIDTH)) };
        }
        result
    }

    #[inline(always)]
    unsafe fn store(self, target: *mut V::Element) {
        for i in 0..N {
            // SAFETY: the caller guarantees N * V::WIDTH writable elements.
            unsafe { self.0[i].store(target.add(i * V::WIDTH)) };
        }
    }
}

//! A plain number: a [`Scalar`] of one row, and a vector of width one.

use super::{Vector, exp32, exp64};
use crate::scalar::{Rows, Scalar};

macro_rules! scalar_for_float {
    ($float:ty, $exp:path) => {
        impl Scalar for $float {
            #[inline(always)]
            #[allow(clippy::cast_possible_truncation)] // the narrower width is the point
            fn constant(value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                <$float>::mul_add(self, factor, term)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$float>::sqrt(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            #[inline(always)]
            fn select(condition: Self, chosen: Self, other: Self) -> Self {
                if condition >= 0.0 { chosen } else { other }
            }
        }
    };
}

impl Rows for f64 {
    #[inline(always)]
    fn all_non_negative(self) -> bool {
        self >= 0.0
    }
}

impl Rows for f32 {
    #[inline(always)]
    fn all_non_negative(self) -> bool {
        self >= 0.0
    }
}

scalar_for_float!(f64, exp64);
scalar_for_float!(f32, exp32);

macro_rules! vector_of_one {
    ($float:ty) => {
        impl Vector for $float {
            type Element = $float;
            const WIDTH: usize = 1;
            #[inline(always)]
            unsafe fn load(source: *const $float) -> Self {
                // SAFETY: the caller guarantees one readable element.
                unsafe { *source }
            }
            #[inline(always)]
            unsafe fn store(self, target: *mut $float) {
                // SAFETY: the caller guarantees one writable element.
                unsafe { *target = self }
            }
        }
    };
}

vector_of_one!(f64);
vector_of_one!(f32);

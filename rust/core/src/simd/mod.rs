//! SIMD: numbers several at a time, on whatever the processor of this machine offers.
//!
//! A [`Vector`] is a [`Scalar`] that holds several numbers. A wheel is built for the baseline of
//! its architecture; the wider registers are chosen at run time, once. Every formula uses explicit
//! [`Scalar::mul_add`] and nothing reassociates, so each instruction set gives the same bits.
//!
//! Measured before choosing (full compensation, f64, in cache, one core of a Xeon with AVX-512):
//! explicit registers three at a time take 2.8 ns a row, loops left to the compiler's vectorizer
//! 4.1 ns; with AVX2 4.5 against 7.8. A chain of dependent operations leaves the units idle unless
//! several independent rows are in flight, and a model of several effects does not vectorize by
//! itself at all.
#![allow(unsafe_code)]

mod exponential;
mod instruction_set;
mod interleave;
mod lanes;
mod one;
mod widest;
#[cfg(target_arch = "x86_64")]
pub(crate) mod x86;

pub(crate) use exponential::{exp32, exp64};
pub use instruction_set::{InstructionSet, active, force};
pub use interleave::{Eight, interleave};
pub(crate) use lanes::Lanes;
pub use widest::{OnVectors, on_vectors};

use crate::scalar::{Rows, Scalar};

/// What the exponential needs beyond [`Scalar`]: single and double precision alike.
pub(crate) trait Float: Scalar {
    /// `self`, but not below `low` and not above `high`; NaN stays NaN.
    fn within(self, low: f64, high: f64) -> Self;

    /// `2^n` from `self = n + bias + 1.5 * 2^(mantissa bits)`, whose lowest bits hold `n + bias`.
    fn power_of_two(self) -> Self;
}

/// A [`Scalar`] of `WIDTH` numbers side by side in memory.
pub trait Vector: Rows {
    /// The number type in memory.
    type Element: Copy;

    /// How many numbers.
    const WIDTH: usize;

    /// Reads `WIDTH` numbers, not necessarily aligned.
    ///
    /// # Safety
    /// `source` is valid for reading `WIDTH` elements.
    unsafe fn load(source: *const Self::Element) -> Self;

    /// Writes `WIDTH` numbers, not necessarily aligned.
    ///
    /// # Safety
    /// `target` is valid for writing `WIDTH` elements.
    unsafe fn store(self, target: *mut Self::Element);
}

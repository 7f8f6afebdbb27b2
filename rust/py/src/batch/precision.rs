//! The two precisions of a kernel, for code that is written once.
#![allow(unsafe_code)]

use echocal_core::batch::{Column, Kernel};
use numpy::Element;

/// A precision that kernels run in.
pub trait Precision: Element + Copy {
    /// A number in this precision.
    fn rounded(value: f64) -> Self;

    /// # Safety
    /// As for [`Kernel::run_f64`].
    unsafe fn run(
        kernel: &dyn Kernel,
        inputs: &[Column],
        output: Column,
        rows: usize,
        threads: usize,
    );
}

impl Precision for f64 {
    fn rounded(value: f64) -> Self {
        value
    }
    unsafe fn run(
        kernel: &dyn Kernel,
        inputs: &[Column],
        output: Column,
        rows: usize,
        threads: usize,
    ) {
        // SAFETY: the caller's.
        unsafe { kernel.run_f64(inputs, output, rows, threads) }
    }
}

impl Precision for f32 {
    fn rounded(value: f64) -> Self {
        value as Self
    }
    unsafe fn run(
        kernel: &dyn Kernel,
        inputs: &[Column],
        output: Column,
        rows: usize,
        threads: usize,
    ) {
        // SAFETY: the caller's.
        unsafe { kernel.run_f32(inputs, output, rows, threads) }
    }
}

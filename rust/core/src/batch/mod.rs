//! Formulas over whole columns: blocks of rows through SIMD registers, on several threads.
//!
//! A [`Formula`] is written once, generic over [`Rows`]; [`kernel`] makes it run over strided
//! memory in either precision. Nothing is allocated per row and no input is copied unless its
//! rows are not side by side; a constant is one number, whatever the number of rows.
//!
//! A thread goes through its rows in order. It reads a vector or a block of every input before it
//! writes the same rows of the output, and never reads them again.
#![allow(unsafe_code)]

mod block;
mod formulas;
mod models;
mod overlap;
mod sensitivity;
pub(crate) mod staged;
#[cfg(test)]
mod tests;
mod threads;

pub use formulas::{Output, absorption, echo, speed_of_sound};
pub use models::{ModelOutput, jacobian, of_model};
pub use overlap::is_row_by_row;
pub use sensitivity::{ExpansionPoint, Numbers, Sensitivities, SensitivityBlock};
pub use staged::{BLOCK, Line};
pub use threads::{available as available_threads, limit as limit_threads};

use crate::scalar::Rows;

/// A function of `K` numbers, in any [`Rows`].
pub trait Formula<const K: usize>: Send + Sync + 'static {
    /// Which inputs it reads: the others are not fetched from memory.
    const READS: [bool; K] = [true; K];

    /// Rows below which one more thread does not pay.
    const ROWS_OF_A_THREAD: usize = threads::OF_A_FORMULA;

    /// The function.
    fn evaluate<S: Rows>(&self, inputs: [S; K]) -> S;
}

/// Where a batch finds, or puts, one number per row.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// The first row.
    pub start: *mut u8,
    /// Bytes from one row to the next; 0 for a constant.
    pub stride: isize,
}

impl Column {
    /// The same value in every row.
    pub(crate) fn constant(value: &f64) -> Self {
        Self {
            start: core::ptr::from_ref(value).cast_mut().cast(),
            stride: 0,
        }
    }

    /// Numbers side by side.
    pub(crate) fn of(values: &[f64]) -> Self {
        Self {
            start: values.as_ptr().cast_mut().cast(),
            stride: size_of::<f64>().cast_signed(),
        }
    }

    /// The column from this row on.
    #[inline(always)]
    fn skip(self, rows: usize) -> Self {
        let start = self.start.wrapping_offset(self.stride * rows.cast_signed());
        Self { start, ..self }
    }

    /// Reads rows from the first one on.
    ///
    /// # Safety
    /// The column has as many rows of type `T`.
    unsafe fn get<T: Copy + Into<f64>>(self, values: &mut [f64]) {
        for (row, value) in values.iter_mut().enumerate() {
            // SAFETY: the caller's.
            *value = unsafe { *self.skip(row).start.cast::<T>() }.into();
        }
    }

    /// Writes to rows from the first one on.
    ///
    /// # Safety
    /// The column has as many rows of type `T`, and may be written to.
    #[inline(always)]
    unsafe fn put<T>(self, values: &[f64], rounded: impl Fn(f64) -> T) {
        if self.stride == size_of::<T>().cast_signed() {
            // the compiler sees that they lie side by side, and writes several at a time
            let start: *mut T = self.start.cast();
            for (row, &value) in values.iter().enumerate() {
                // SAFETY: the caller's.
                unsafe { *start.add(row) = rounded(value) };
            }
            return;
        }
        for (row, &value) in values.iter().enumerate() {
            // SAFETY: the caller's.
            unsafe { *self.skip(row).start.cast() = rounded(value) };
        }
    }
}

/// What the rows of columns are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Precision {
    Double,
    Single,
}

impl Precision {
    /// Reads rows of a column.
    ///
    /// # Safety
    /// The column has as many rows of this precision.
    unsafe fn get(self, column: Column, values: &mut [f64]) {
        // SAFETY: the caller's.
        unsafe {
            match self {
                Self::Double => column.get::<f64>(values),
                Self::Single => column.get::<f32>(values),
            }
        }
    }

    /// Writes to rows of a column.
    ///
    /// # Safety
    /// The column has as many rows of this precision, and may be written to.
    unsafe fn put(self, column: Column, values: &[f64]) {
        // SAFETY: the caller's.
        unsafe {
            match self {
                Self::Double => column.put(values, |value| value),
                Self::Single => column.put(values, |value| value as f32),
            }
        }
    }
}

/// A formula that runs over columns, whatever its number of inputs.
pub trait Kernel: Send + Sync {
    /// Number of inputs.
    fn arity(&self) -> usize;

    /// The value for one row: the same bits as in a batch.
    ///
    /// # Panics
    /// Where the number of inputs is not [`Kernel::arity`].
    fn evaluate(&self, inputs: &[f64]) -> f64;

    /// The values for all rows in double precision, on at most so many threads.
    ///
    /// # Safety
    /// There are [`Kernel::arity`] inputs. Every column is valid and aligned for `rows` elements at
    /// its stride, the output for writing. The output may share memory with an input in two cases:
    ///
    /// - row by row, see [`is_row_by_row`];
    /// - on one thread, if writing a row leaves all later rows of the input as they are. So it is where
    ///   the input lies at or ahead of the output in the order of rows.
    unsafe fn run_f64(&self, inputs: &[Column], output: Column, rows: usize, threads: usize);

    /// The values for all rows in single precision.
    ///
    /// # Safety
    /// As for [`Kernel::run_f64`].
    unsafe fn run_f32(&self, inputs: &[Column], output: Column, rows: usize, threads: usize);
}

/// Makes a formula run over columns.
pub fn kernel<F: Formula<K>, const K: usize>(formula: F) -> Box<dyn Kernel> {
    Box::new(Compiled(formula))
}

struct Compiled<F, const K: usize>(F);

impl<F: Formula<K>, const K: usize> Kernel for Compiled<F, K> {
    fn arity(&self) -> usize {
        K
    }

    fn evaluate(&self, inputs: &[f64]) -> f64 {
        block::evaluate(&self.0, core::array::from_fn(|index| inputs[index]))
    }

    unsafe fn run_f64(&self, inputs: &[Column], output: Column, rows: usize, threads: usize) {
        let inputs = core::array::from_fn(|index| inputs[index]);
        let span = |first, count| {
            let inputs = inputs.map(|column: Column| column.skip(first));
            // SAFETY: rows `first` to `first + count` of columns that the caller guarantees.
            unsafe { block::run_f64(&self.0, inputs, output.skip(first), count) }
        };
        threads::split(rows, threads, F::ROWS_OF_A_THREAD, &span);
    }

    unsafe fn run_f32(&self, inputs: &[Column], output: Column, rows: usize, threads: usize) {
        let inputs = core::array::from_fn(|index| inputs[index]);
        let span = |first, count| {
            let inputs = inputs.map(|column: Column| column.skip(first));
            // SAFETY: rows `first` to `first + count` of columns that the caller guarantees.
            unsafe { block::run_f32(&self.0, inputs, output.skip(first), count) }
        };
        threads::split(rows, threads, F::ROWS_OF_A_THREAD, &span);
    }
}

// SAFETY: a column is an address and a stride; who runs a kernel answers for what lies there.
unsafe impl Send for Column {}
// SAFETY: as above.
unsafe impl Sync for Column {}

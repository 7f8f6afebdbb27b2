//! The short way for the commonest inputs: contiguous arrays of one shape and precision, and numbers.
//!
//! A ufunc with five inputs takes NumPy several microseconds to set up. Here nothing is to be
//! broadcast, converted or buffered, so the kernel runs on the memory as it is. Whatever does not
//! fit goes the ufunc's way, with the same bits.
#![allow(unsafe_code)]

use echocal_core::batch::{Column, Kernel, is_row_by_row};
use numpy::npyffi::NPY_ARRAY_WRITEABLE;
use numpy::prelude::*;
use numpy::{IxDyn, PyArray, PyArrayDescr, PyUntypedArray, dtype};
use pyo3::prelude::*;

use super::arguments::Input;
use super::precision::Precision;
use super::ufunc::MOST_INPUTS;

/// Rows from which the GIL is worth releasing, as in NumPy.
const MANY: usize = 500;

/// The result, where the inputs fit.
pub fn direct<'py>(
    py: Python<'py>,
    kernel: &dyn Kernel,
    inputs: &[Input<'_, 'py>],
    out: Option<&Bound<'py, PyAny>>,
    threads: usize,
) -> Option<Bound<'py, PyAny>> {
    let arrays = inputs.iter().filter_map(|input| input.given);
    let first = arrays
        .clone()
        .find_map(|given| given.cast_exact::<PyUntypedArray>().ok())?;
    if first.ndim() == 0 {
        return None; // a number after all: the ufunc makes it one
    }
    let kind = first.dtype();
    if kind.is_equiv_to(&dtype::<f64>(py)) {
        run::<f64>(py, kernel, inputs, first, &kind, out, threads)
    } else if kind.is_equiv_to(&dtype::<f32>(py)) {
        run::<f32>(py, kernel, inputs, first, &kind, out, threads)
    } else {
        None
    }
}

fn run<'py, T: Precision>(
    py: Python<'py>,
    kernel: &dyn Kernel,
    inputs: &[Input<'_, 'py>],
    first: &Bound<'py, PyUntypedArray>,
    kind: &Bound<'py, PyArrayDescr>,
    out: Option<&Bound<'py, PyAny>>,
    threads: usize,
) -> Option<Bound<'py, PyAny>> {
    let fits = |value: &Bound<'py, PyAny>| {
        let array = value.cast_exact::<PyUntypedArray>().ok()?.clone();
        let plain = array.is_c_contiguous() && is_aligned(&array) && array.shape() == first.shape();
        (plain && array.dtype().is_equiv_to(kind)).then_some(array)
    };
    let mut numbers = [T::rounded(0.0); MOST_INPUTS];
    let mut columns = [constant(&numbers[0]); MOST_INPUTS];
    for ((input, number), column) in inputs.iter().zip(&mut numbers).zip(&mut columns) {
        *column = match input.number() {
            Some(value) => {
                *number = T::rounded(value);
                constant(number)
            }
            None => side_by_side::<T>(&fits(input.given?)?),
        };
    }
    let columns = &columns[..inputs.len()];
    let rows = first.len();
    let result = match out {
        // SAFETY: every row is written below, before anybody sees the array.
        None => unsafe { PyArray::<T, IxDyn>::new(py, first.shape(), false) }.into_any(),
        Some(out) => out.clone(),
    };
    let array = fits(&result)?;
    let output = side_by_side::<T>(&array);
    let mut each = columns.iter();
    if !is_writeable(&array) || !each.all(|column| is_row_by_row::<T>(*column, output, rows)) {
        return None;
    }
    // SAFETY: the arrays are aligned, contiguous, of this precision and of `rows` elements; the
    // references above keep them alive; the output meets the inputs row by row, if at all.
    let compute = || unsafe { T::run(kernel, columns, output, rows, threads) };
    if rows < MANY {
        compute()
    } else {
        py.detach(compute)
    }
    Some(result)
}

fn constant<T>(number: &T) -> Column {
    let start = core::ptr::from_ref(number).cast_mut().cast();
    Column { start, stride: 0 }
}

fn side_by_side<T>(array: &Bound<'_, PyUntypedArray>) -> Column {
    // SAFETY: the pointer leads to a living array.
    let start = unsafe { (*array.as_array_ptr()).fields.data.cast() };
    Column {
        start,
        stride: size_of::<T>().cast_signed(),
    }
}

fn is_aligned(array: &Bound<'_, PyUntypedArray>) -> bool {
    // SAFETY: the pointer leads to a living array.
    unsafe { (*array.as_array_ptr()).fields.flags & numpy::npyffi::NPY_ARRAY_ALIGNED != 0 }
}

fn is_writeable(array: &Bound<'_, PyUntypedArray>) -> bool {
    // SAFETY: the pointer leads to a living array.
    unsafe { (*array.as_array_ptr()).fields.flags & NPY_ARRAY_WRITEABLE != 0 }
}

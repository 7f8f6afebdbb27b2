//! What comes from Python is checked here before the core trusts it: lengths, positions, labels, order.
//!
//! The core indexes memory with these; nothing that Python gives may make it panic, or cut a column.

use std::ops::Deref;

use numpy::ndarray::Dimension;
use numpy::prelude::*;
use numpy::{Element, Ix1, PyArray, PyReadonlyArray};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::prelude::*;

/// The length that columns have in common.
pub fn same_length(columns: &[(&str, usize)]) -> PyResult<usize> {
    let Some(&(first, rows)) = columns.first() else {
        return Err(PyValueError::new_err("there are no columns"));
    };
    match columns.iter().find(|&&(_, length)| length != rows) {
        None => Ok(rows),
        Some((other, length)) => Err(PyValueError::new_err(format!(
            "columns differ in length: {first} has {rows} rows, {other} has {length}"
        ))),
    }
}

/// The same of columns that must have a row.
pub fn same_length_not_empty(columns: &[(&str, usize)]) -> PyResult<usize> {
    match same_length(columns)? {
        0 => Err(PyValueError::new_err(format!("{} is empty", columns[0].0))),
        rows => Ok(rows),
    }
}

/// Refuses a position that is not among so many.
pub fn within(
    what: &str,
    positions: impl IntoIterator<Item = usize>,
    count: usize,
) -> PyResult<()> {
    match positions.into_iter().find(|&position| position >= count) {
        None => Ok(()),
        Some(position) => Err(PyIndexError::new_err(format!(
            "there is no {what} {position}: there are {count}, counted from 0"
        ))),
    }
}

/// Refuses more of something than there may be.
pub fn at_most(what: &str, count: usize, most: usize) -> PyResult<()> {
    if count <= most {
        return Ok(());
    }
    let message = format!("{count} {what}; at most {most}");
    Err(PyValueError::new_err(message))
}

/// Refuses positions that go back.
pub fn ascending(what: &str, positions: &[usize]) -> PyResult<()> {
    match positions.windows(2).find(|pair| pair[0] > pair[1]) {
        None => Ok(()),
        Some(pair) => Err(PyValueError::new_err(format!(
            "{what} must ascend, but {} follows {}",
            pair[1], pair[0]
        ))),
    }
}

/// Labels of rows as positions, and how many there are, counted from 0.
///
/// Each label up to the last costs memory, so rows have no more of them than there are rows.
pub fn labels<L>(what: &str, given: &[L]) -> PyResult<(Vec<usize>, usize)>
where
    L: Copy + std::fmt::Display,
    usize: TryFrom<L>,
{
    let rows = given.len();
    let position = |&label: &L| {
        let position = usize::try_from(label).ok();
        position.filter(|&at| at < rows).ok_or_else(|| {
            let last = rows - 1; // there is this one
            let message =
                format!("{what} has label {label}; labels of {rows} rows are 0 to {last}");
            PyValueError::new_err(message)
        })
    };
    let labels = given.iter().map(position).collect::<PyResult<Vec<_>>>()?;
    let count = labels.iter().max().map_or(0, |&last| last + 1);
    Ok((labels, count))
}

/// An array of one dtype and so many dimensions, whose numbers lie side by side in C order: as it was
/// given, or a copy where it was strided, not aligned, or in another order.
pub struct Array<'py, T: Element, D: Dimension>(PyReadonlyArray<'py, T, D>);

/// One of one dimension.
pub type Column<'py, T> = Array<'py, T, Ix1>;

impl<'py, T: Element, D: Dimension> Array<'py, T, D> {
    /// The length of each dimension.
    pub fn shape(&self) -> &[usize] {
        self.0.shape()
    }

    /// Of what Python holds now; a position in memory from before may no longer be true.
    pub fn of(given: &Bound<'py, PyAny>) -> PyResult<Self> {
        let py = given.py();
        let readable = |array: &Bound<'py, PyAny>| {
            let array = array.cast::<PyArray<T, D>>().map_err(|_| {
                let (kind, axes) = (T::get_dtype(py), D::NDIM.unwrap_or_default());
                let message = format!("expected a NumPy array of {kind} of {axes} dimensions");
                PyTypeError::new_err(message)
            })?;
            let readable = array.try_readonly();
            readable.map_err(|error| PyValueError::new_err(error.to_string()))
        };
        let own = readable(given)?;
        if own.is_c_contiguous() && own.as_slice().is_ok() {
            return Ok(Self(own));
        }
        let copy = given.call_method1("copy", ("C",))?;
        Ok(Self(readable(&copy)?))
    }
}

impl<'py, T: Element, D: Dimension> FromPyObject<'_, 'py> for Array<'py, T, D> {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Self::of(&given)
    }
}

impl<T: Element, D: Dimension> Deref for Array<'_, T, D> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        let numbers = self.0.as_slice();
        numbers.expect("an array is contiguous and aligned, or was copied, when it is taken")
    }
}

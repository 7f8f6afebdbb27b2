//! Basis functions of unexplained terms, and the rows that stand for a long column, over arrays.

use echocal_infer::columns;
use numpy::prelude::*;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::border::{Column, at_most};
use crate::columns::MOST_FUNCTIONS;

/// Legendre polynomials of a column between two values, one line per scale, from the first degree on.
#[pyfunction]
pub fn legendre_values<'py>(
    py: Python<'py>,
    values: Column<'py, f64>,
    low: f64,
    high: f64,
    scales: Vec<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    at_most("degrees", scales.len(), MOST_FUNCTIONS)?;
    let values = &*values;
    let found = py.detach(|| columns::legendre_values(values, (low, high), &scales));
    PyArray1::from_vec(py, found).reshape([scales.len(), values.len()])
}

/// Sine and cosine of multiples of a column's phase in a period, two lines per scale, from the first
/// multiple on.
#[pyfunction]
pub fn wave_values<'py>(
    py: Python<'py>,
    values: Column<'py, f64>,
    period: f64,
    scales: Vec<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    at_most("multiples of a wave", scales.len(), MOST_FUNCTIONS)?;
    let values = &*values;
    let found = py.detach(|| columns::wave_values(values, period, &scales));
    PyArray1::from_vec(py, found).reshape([2 * scales.len(), values.len()])
}

/// Numbers of a column; of very many, those of evenly spread runs.
#[pyfunction]
pub fn spread<'py>(py: Python<'py>, values: Column<'py, f64>) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_vec(py, columns::spread(&values).collect())
}

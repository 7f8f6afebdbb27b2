//! Likelihoods of noises, over arrays.

use echocal_infer::noise::{CycleSlips, NoiseDensity};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::border::{Column, labels, same_length_not_empty};

/// Log likelihood, level of each row, scale, probability of each group by cell.
type Fitted<'py> = (
    f64,
    Bound<'py, PyArray1<f64>>,
    f64,
    Bound<'py, PyArray2<f64>>,
);

/// Log density of Student's t, or of the normal distribution, at each of some numbers of scale one.
#[pyfunction]
pub fn log_density<'py>(
    py: Python<'py>,
    values: Column<'py, f64>,
    freedom: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let found = NoiseDensity::of(freedom).log_densities(&values);
    Ok(PyArray1::from_vec(py, found))
}

/// Fits groups that are whole steps apart, from some levels and a scale on; see the core.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // as Python sees it
pub fn slips<'py>(
    py: Python<'py>,
    left: Column<'py, f64>,
    step: Column<'py, f64>,
    cells: Column<'py, i64>,
    stretches: Column<'py, i64>,
    orders: Vec<f64>,
    freedom: f64,
    spread: f64,
    level: Vec<f64>,
    scale: f64,
) -> PyResult<Fitted<'py>> {
    let (left, step) = (&*left, &*step);
    let (cells, _) = labels("cells", &cells)?;
    let (segments, _) = labels("stretches", &stretches)?;
    same_length_not_empty(&[
        ("left", left.len()),
        ("step", step.len()),
        ("cells", cells.len()),
        ("stretches", segments.len()),
        ("level", level.len()),
    ])?;
    if orders.is_empty() {
        return Err(PyValueError::new_err("there are no orders"));
    }
    let slips = CycleSlips {
        left,
        step,
        cells: &cells,
        segments: &segments,
        orders: &orders,
        freedom,
        spread,
    };
    let found = py.detach(|| slips.fit(level, scale));
    let groups = orders.len();
    let shape = [found.weights.len() / groups, groups];
    Ok((
        found.log,
        PyArray1::from_vec(py, found.level),
        found.scale,
        PyArray1::from_vec(py, found.weights).reshape(shape)?,
    ))
}

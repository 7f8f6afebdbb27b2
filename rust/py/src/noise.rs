//! Likelihoods of noises, over arrays.

use echocal_infer::noise::{CycleSlips, NoiseDensity};
use numpy::prelude::*;
use numpy::{Ix2, PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::border::{Array, Column, labels, same_length_not_empty};
use crate::infer_checks::not_negative;

/// A mixture of groups of rows that are whole steps apart.
#[pyclass(name = "SlipFit", module = "echocal._core", frozen, get_all)]
pub struct CoreSlipFit {
    /// Log likelihood.
    log: f64,
    /// Level of each row.
    level: Py<PyArray1<f64>>,
    /// Scale of the scatter within a group.
    scale: f64,
    /// Probability of each group, by cell.
    weights: Py<PyArray2<f64>>,
}

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

/// Scale of greatest likelihood of each line of some numbers, no smaller than the `least`, and the log
/// density there, under each number of degrees of freedom.
#[pyfunction]
#[allow(clippy::type_complexity)] // as Python sees it
pub fn fitted_densities<'py>(
    py: Python<'py>,
    values: Array<'py, f64, Ix2>,
    freedoms: Vec<f64>,
    least: f64,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
    let &[lines, length] = values.shape() else {
        unreachable!("a two-dimensional array has two lengths")
    };
    same_length_not_empty(&[("values", length)])?;
    not_negative("least", least)?;
    let values = &*values;
    let found: Vec<_> = py.detach(|| {
        let of = |&freedom: &f64| {
            let mut density = NoiseDensity::of(freedom);
            let each = values.chunks_exact(length);
            each.map(move |line| density.fitted(line, least))
        };
        freedoms.iter().flat_map(of).collect()
    });
    let shape = [freedoms.len(), lines];
    let (scales, logs) = found.into_iter().unzip();
    Ok((
        PyArray1::from_vec(py, scales).reshape(shape)?,
        PyArray1::from_vec(py, logs).reshape(shape)?,
    ))
}

/// Fits groups that are whole steps apart, from some levels and a scale on; see the core.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // as Python sees it
pub fn slips<'py>(
    py: Python<'py>,
    left: Column<'py, f64>,
    step: Column<'py, f64>,
    cells: Column<'py, i64>,
    segments: Column<'py, i64>,
    orders: Vec<f64>,
    freedom: f64,
    spread: f64,
    level: Vec<f64>,
    scale: f64,
) -> PyResult<CoreSlipFit> {
    let (left, step) = (&*left, &*step);
    let (cells, _) = labels("cells", &cells)?;
    let (segments, _) = labels("segments", &segments)?;
    same_length_not_empty(&[
        ("left", left.len()),
        ("step", step.len()),
        ("cells", cells.len()),
        ("segments", segments.len()),
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
    Ok(CoreSlipFit {
        log: found.log,
        level: PyArray1::from_vec(py, found.level).unbind(),
        scale: found.scale,
        weights: PyArray1::from_vec(py, found.weights)
            .reshape(shape)?
            .unbind(),
    })
}

//! Likelihoods of noises, over arrays.

use echocal_core::evidence::{Kernel, Slips};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

type Column<'py> = PyReadonlyArray1<'py, f64>;
type Labels<'py> = PyReadonlyArray1<'py, i64>;

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
    values: Column<'py>,
    freedom: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let found = Kernel::of(freedom).log_densities(values.as_slice()?);
    Ok(PyArray1::from_vec(py, found))
}

/// Fits groups that are whole steps apart, from some levels and a scale on; see the core.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // as Python sees it
pub fn slips<'py>(
    py: Python<'py>,
    left: Column<'py>,
    step: Column<'py>,
    cells: Labels<'py>,
    stretches: Labels<'py>,
    orders: Vec<f64>,
    freedom: f64,
    spread: f64,
    level: Vec<f64>,
    scale: f64,
) -> PyResult<Fitted<'py>> {
    let (left, step) = (left.as_slice()?, step.as_slice()?);
    let (cells, stretches) = (labels(&cells)?, labels(&stretches)?);
    let lengths = [step.len(), cells.len(), stretches.len(), level.len()];
    if lengths != [left.len(); 4] || left.is_empty() || orders.is_empty() {
        return Err(PyValueError::new_err(
            "columns differ in length or are empty",
        ));
    }
    let slips = Slips {
        left,
        step,
        cells: &cells,
        stretches: &stretches,
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

fn labels(given: &Labels<'_>) -> PyResult<Vec<usize>> {
    let each = given.as_slice()?.iter();
    let labels = each.map(|&label| usize::try_from(label));
    labels
        .collect::<Result<_, _>>()
        .map_err(|_| PyValueError::new_err("a label is negative"))
}

//! Evidence, over arrays.

use echocal_core::batch::available_threads;
use echocal_core::evidence::{self, Layout, Outcome, Prior, Stack, Variant, Weighed};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Which rows belong together, checked.
pub fn layout<'a>(
    starts: &'a PyReadonlyArray1<'_, bool>,
    blocks: &'a PyReadonlyArray1<'_, u32>,
    cells: &'a PyReadonlyArray1<'_, u32>,
    distance: &'a PyReadonlyArray1<'_, f64>,
    rows: usize,
) -> PyResult<Layout<'a>> {
    if [starts.len(), blocks.len(), cells.len(), distance.len()] != [rows; 4] {
        return Err(PyValueError::new_err("columns and labels differ in length"));
    }
    let (blocks, cells) = (blocks.as_slice()?, cells.as_slice()?);
    let count = |labels: &[u32]| labels.iter().max().map_or(0, |&last| last as usize + 1);
    Ok(Layout {
        starts: starts.as_slice()?,
        blocks,
        cells,
        distance: distance.as_slice()?,
        block_count: count(blocks),
        cell_count: count(cells),
    })
}

/// A form of a cause: cause (none for a shape), fixed columns, free columns, their bounds, weight.
type Form = (Option<usize>, Vec<usize>, Vec<usize>, Vec<(f64, f64)>, f64);

/// Log evidence, mean, covariance, probability of each noise, variance.
type Result<'py> = (
    f64,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<f64>>,
    f64,
);

fn stack<'a>(
    products: &'a PyReadonlyArray3<'_, f64>,
    log_weight: &'a PyReadonlyArray1<'_, f64>,
    degrees: f64,
    finest: f64,
) -> PyResult<Stack<'a>> {
    let &[noises, width, other] = products.shape() else {
        unreachable!("a three-dimensional array has three lengths")
    };
    if width != other || noises != log_weight.len() || noises == 0 || width == 0 {
        return Err(PyValueError::new_err(
            "products and weights differ in shape",
        ));
    }
    Ok(Stack {
        products: products.as_slice()?,
        log_weight: log_weight.as_slice()?,
        width,
        degrees,
        finest,
    })
}

fn variants(forms: Vec<Form>, width: usize) -> PyResult<Vec<Variant>> {
    let variant = |(cause, offsets, free, bounds, weight): Form| {
        if free.len() != bounds.len() || offsets.iter().chain(&free).any(|&column| column >= width)
        {
            return Err(PyValueError::new_err(
                "a form has columns that are not there",
            ));
        }
        Ok(Variant {
            cause: cause.unwrap_or(usize::MAX),
            is_shape: cause.is_none(),
            offsets,
            free,
            bounds,
            weight,
        })
    };
    forms.into_iter().map(variant).collect()
}

fn result<'py>(py: Python<'py>, weighed: Weighed) -> PyResult<Result<'py>> {
    let order = weighed.mean.len();
    Ok((
        weighed.log_evidence,
        PyArray1::from_vec(py, weighed.mean),
        PyArray1::from_vec(py, weighed.covariance).reshape([order, order])?,
        PyArray1::from_vec(py, weighed.noise),
        weighed.variance,
    ))
}

/// Variance that the columns between the first and the last leave of the last, see the core.
#[pyfunction]
pub fn left_over(
    products: PyReadonlyArray2<'_, f64>,
    degrees: f64,
    variance: f64,
    finest: f64,
) -> PyResult<f64> {
    let &[width, other] = products.shape() else {
        unreachable!("a two-dimensional array has two lengths")
    };
    if width != other || width < 2 {
        return Err(PyValueError::new_err("products are no square"));
    }
    let products = products.as_slice()?;
    Ok(evidence::left_over(
        products, width, degrees, variance, finest,
    ))
}

/// Weighs hypotheses, each by itself.
#[pyfunction]
pub fn weigh<'py>(
    py: Python<'py>,
    products: PyReadonlyArray3<'py, f64>,
    log_weight: PyReadonlyArray1<'py, f64>,
    degrees: f64,
    finest: f64,
    hypotheses: Vec<Vec<Form>>,
    one_width: bool,
) -> PyResult<Vec<Result<'py>>> {
    let stack = stack(&products, &log_weight, degrees, finest)?;
    let each = hypotheses.into_iter();
    let hypotheses: PyResult<Vec<_>> = each.map(|forms| variants(forms, stack.width)).collect();
    let (hypotheses, threads) = (hypotheses?, available_threads());
    let weighed = py.detach(|| evidence::weigh(&stack, &hypotheses, one_width, threads));
    weighed.into_iter().map(|one| result(py, one)).collect()
}

/// Weighs every hypothesis that competes: forms, prior and result of each; the noises carried
/// along, and the number of linear systems solved.
#[pyfunction]
#[allow(clippy::type_complexity, clippy::too_many_arguments)] // as Python sees them
pub fn posterior<'py>(
    py: Python<'py>,
    products: PyReadonlyArray3<'py, f64>,
    log_weight: PyReadonlyArray1<'py, f64>,
    degrees: f64,
    finest: f64,
    forms: Vec<Form>,
    causes: [f64; 4],
    shape: f64,
    hopeless: f64,
) -> PyResult<(Vec<(Vec<usize>, f64, Result<'py>)>, Vec<bool>, usize)> {
    let stack = stack(&products, &log_weight, degrees, finest)?;
    let variants = variants(forms, stack.width)?;
    let prior = Prior {
        causes,
        shape,
        hopeless,
    };
    let threads = available_threads();
    let (outcomes, noises, systems) =
        py.detach(|| evidence::posterior(&stack, &variants, &prior, threads));
    let outcome = |o: Outcome| Ok((o.variants, o.prior, result(py, o.weighed)?));
    let outcomes: PyResult<Vec<_>> = outcomes.into_iter().map(outcome).collect();
    Ok((outcomes?, noises, systems))
}

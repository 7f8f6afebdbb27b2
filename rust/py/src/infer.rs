//! Log evidence and posterior of hypotheses, over arrays.

use echocal_core::batch::available_threads;
use echocal_infer::gram::RowLayout;
use echocal_infer::search::{self, Outcome, Prior};
use echocal_infer::solve::{self, HypothesisFit, Variant, WhitenedStack};
use numpy::prelude::*;
use numpy::{Ix2, Ix3, PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::collections::HashMap;

use crate::border::{Array, Column, same_length, within};

/// Block and group of each cell.
type Places = Vec<(usize, usize)>;

/// Which rows of a table belong together, checked; `places` has block and group of each cell.
///
/// They come back with groups counted from 0, in the order in which they appear: of some rows of a
/// table, groups may keep the labels that they have in all of it.
pub fn layout<'a>(
    starts: &'a [bool],
    blocks: &'a [u32],
    cells: &'a [u32],
    distance: &'a [f64],
    rows: usize,
    places: &[(usize, usize)],
    block_count: usize,
) -> PyResult<(RowLayout<'a>, Places)> {
    same_length(&[
        ("the table", rows),
        ("starts", starts.len()),
        ("blocks", blocks.len()),
        ("cells", cells.len()),
        ("distance", distance.len()),
    ])?;
    let of = |label: &u32| *label as usize;
    within("block", blocks.iter().map(of), block_count)?;
    within("cell", cells.iter().map(of), places.len())?;
    within("block", places.iter().map(|place| place.0), block_count)?;
    let elsewhere = |row: &usize| places[cells[*row] as usize].0 != blocks[*row] as usize;
    if let Some(row) = (0..rows).find(elsewhere) {
        let (block, cell) = (blocks[row], cells[row]);
        let message =
            format!("row {row} is of block {block} and of cell {cell}, which lies in another");
        return Err(PyValueError::new_err(message));
    }
    let layout = RowLayout {
        starts,
        blocks,
        cells,
        distance,
        block_count,
        cell_count: places.len(),
    };
    let mut counted = HashMap::new();
    let counted = |&(block, group): &(usize, usize)| {
        let next = counted.len();
        (block, *counted.entry(group).or_insert(next))
    };
    Ok((layout, places.iter().map(counted).collect()))
}

/// A form of a cause: cause (none for an unexplained term), fixed columns, free columns, their bounds, weight.
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
    products: &'a Array<'_, f64, Ix3>,
    log_weight: &'a [f64],
    degrees: f64,
    finest: f64,
) -> PyResult<WhitenedStack<'a>> {
    let &[noises, width, other] = products.shape() else {
        unreachable!("a three-dimensional array has three lengths")
    };
    if width != other || noises == 0 || width == 0 {
        return Err(PyValueError::new_err(
            "products are no square matrices, one for each noise",
        ));
    }
    same_length(&[("products", noises), ("log_weight", log_weight.len())])?;
    Ok(WhitenedStack {
        products,
        log_weight,
        width,
        degrees,
        variance_floor: finest,
    })
}

fn variants(forms: Vec<Form>, width: usize) -> PyResult<Vec<Variant>> {
    let variant = |(cause, offsets, free, bounds, weight): Form| {
        same_length(&[("free", free.len()), ("bounds", bounds.len())])?;
        within("column", offsets.iter().chain(&free).copied(), width)?;
        Ok(Variant {
            cause: cause.unwrap_or(usize::MAX),
            is_unexplained: cause.is_none(),
            offsets,
            free,
            bounds,
            weight,
        })
    };
    forms.into_iter().map(variant).collect()
}

fn result<'py>(py: Python<'py>, fit: HypothesisFit) -> PyResult<Result<'py>> {
    let order = fit.mean.len();
    Ok((
        fit.log_evidence,
        PyArray1::from_vec(py, fit.mean),
        PyArray1::from_vec(py, fit.covariance).reshape([order, order])?,
        PyArray1::from_vec(py, fit.noise),
        fit.variance,
    ))
}

/// Variance that the columns between the first and the last leave of the last, see the crate echocal-infer.
#[pyfunction]
pub fn left_over(
    products: Array<'_, f64, Ix2>,
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
    Ok(solve::residual_variance(
        &products, width, degrees, variance, finest,
    ))
}

/// Forms of one hypothesis whose widths can be combined: each has three, and every combination costs.
const MOST_MIXED: usize = 12;

/// The log evidence of hypotheses, each by itself.
#[pyfunction]
pub fn weigh<'py>(
    py: Python<'py>,
    products: Array<'py, f64, Ix3>,
    log_weight: Column<'py, f64>,
    degrees: f64,
    finest: f64,
    hypotheses: Vec<Vec<Form>>,
    one_width: bool,
) -> PyResult<Vec<Result<'py>>> {
    let stack = stack(&products, &log_weight, degrees, finest)?;
    let each = hypotheses.into_iter();
    let hypotheses: PyResult<Vec<_>> = each.map(|forms| variants(forms, stack.width)).collect();
    let (hypotheses, threads) = (hypotheses?, available_threads());
    let most = hypotheses.iter().map(Vec::len).max().unwrap_or(0);
    if most > MOST_MIXED && !one_width {
        let message = format!(
            "a hypothesis has {most} forms, which would be 3^{most} combinations of widths; above \
             {MOST_MIXED} forms, ask for one width"
        );
        return Err(PyValueError::new_err(message));
    }
    let fits = py.detach(|| solve::log_evidence(&stack, &hypotheses, one_width, threads));
    fits.into_iter().map(|one| result(py, one)).collect()
}

/// The posterior over hypotheses: forms, prior and result of each; the noises taken into account, and
/// the number of linear systems solved.
#[pyfunction]
#[allow(clippy::type_complexity, clippy::too_many_arguments)] // as Python sees them
pub fn posterior<'py>(
    py: Python<'py>,
    products: Array<'py, f64, Ix3>,
    log_weight: Column<'py, f64>,
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
        unexplained: shape,
        pruning_log_odds: hopeless,
    };
    let threads = available_threads();
    let found = py.detach(|| search::posterior(&stack, &variants, &prior, threads));
    let outcome = |o: Outcome| Ok((o.variants, o.prior, result(py, o.fit)?));
    let outcomes: PyResult<Vec<_>> = found.outcomes.into_iter().map(outcome).collect();
    Ok((outcomes?, found.noises, found.systems))
}

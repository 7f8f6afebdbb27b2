//! Log evidence and posterior of hypotheses, over arrays.

use echocal_core::batch::available_threads;
use echocal_infer::search;
use echocal_infer::solve::{self, Variant, WhitenedStack};
use numpy::Ix3;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::border::{Array, Column, same_length, same_length_not_empty};
use crate::infer_checks::{not_negative, positive};
use crate::infer_classes::{
    CoreForm, CoreHypothesisFit, CorePosterior, CorePrior, CoreSearchOptions, variants,
};

/// Number and width of square matrices, one for each noise.
fn matrices(products: &Array<'_, f64, Ix3>) -> PyResult<(usize, usize)> {
    let &[noises, width, other] = products.shape() else {
        unreachable!("a three-dimensional array has three lengths")
    };
    if width != other || noises == 0 || width == 0 {
        let message = format!(
            "products must be square matrices, one for each noise, but are {noises} of {width} by {other}"
        );
        return Err(PyValueError::new_err(message));
    }
    Ok((noises, width))
}

fn stack<'a>(
    products: &'a Array<'_, f64, Ix3>,
    log_weight: &'a [f64],
    degrees: f64,
    variance_floor: f64,
) -> PyResult<WhitenedStack<'a>> {
    let (noises, width) = matrices(products)?;
    same_length(&[("products", noises), ("log_weight", log_weight.len())])?;
    positive("degrees", degrees)?;
    not_negative("variance_floor", variance_floor)?;
    Ok(WhitenedStack {
        products,
        log_weight,
        width,
        degrees,
        variance_floor,
    })
}

/// Forms of one hypothesis whose widths can be combined: each has three, and every combination costs.
const MOST_MIXED: usize = 12;

/// Hypotheses as Python gives them: the forms of each.
type Hypotheses<'py> = Vec<Vec<PyRef<'py, CoreForm>>>;

/// Hypotheses whose widths can be combined, checked against the number of columns.
fn fittable(
    hypotheses: &Hypotheses<'_>,
    width: usize,
    one_width: bool,
) -> PyResult<Vec<Vec<Variant>>> {
    let each = hypotheses.iter();
    let found: Vec<_> = each
        .map(|forms| variants(forms, width))
        .collect::<PyResult<_>>()?;
    let most = found.iter().map(Vec::len).max().unwrap_or(0);
    if most > MOST_MIXED && !one_width {
        let message = format!(
            "a hypothesis has {most} forms, which would be 3^{most} combinations of widths; above \
             {MOST_MIXED} forms, ask for one width"
        );
        return Err(PyValueError::new_err(message));
    }
    Ok(found)
}

/// Fits hypotheses, each by itself; with `one_width` with the widest prior alone.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // as Python sees it
pub fn fit_hypotheses<'py>(
    py: Python<'py>,
    products: Array<'py, f64, Ix3>,
    log_weight: Column<'py, f64>,
    degrees: f64,
    variance_floor: f64,
    hypotheses: Hypotheses<'py>,
    one_width: bool,
) -> PyResult<Vec<CoreHypothesisFit>> {
    let stack = stack(&products, &log_weight, degrees, variance_floor)?;
    let hypotheses = fittable(&hypotheses, stack.width, one_width)?;
    let threads = available_threads();
    let fits = py.detach(|| solve::log_evidence(&stack, &hypotheses, one_width, threads));
    fits.into_iter()
        .map(|one| CoreHypothesisFit::of(py, one))
        .collect()
}

/// The posterior over the hypotheses that some forms make.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // as Python sees it
pub fn posterior<'py>(
    py: Python<'py>,
    products: Array<'py, f64, Ix3>,
    log_weight: Column<'py, f64>,
    degrees: f64,
    variance_floor: f64,
    forms: Vec<PyRef<'py, CoreForm>>,
    prior: &CorePrior,
    options: &CoreSearchOptions,
) -> PyResult<CorePosterior> {
    let stack = stack(&products, &log_weight, degrees, variance_floor)?;
    let variants = variants(&forms, stack.width)?;
    let (prior, options, threads) = (prior.prior(), options.options(), available_threads());
    let found = py.detach(|| search::posterior(&stack, &variants, &prior, &options, threads));
    CorePosterior::of(py, found)
}

/// Position of the form that stands for the same causes, of forms of so many log odds, most probable
/// first, and coefficients.
#[pyfunction]
pub fn preferred_form(
    log_odds: Vec<f64>,
    coefficients: Vec<usize>,
    form_preference: f64,
) -> PyResult<usize> {
    same_length_not_empty(&[
        ("log_odds", log_odds.len()),
        ("coefficients", coefficients.len()),
    ])?;
    let forms: Vec<_> = log_odds.into_iter().zip(coefficients).collect();
    Ok(search::preferred_form(&forms, form_preference))
}

//! Log evidence, posterior and ranking of hypotheses, over arrays.

use echocal_core::batch::available_threads;
use echocal_infer::search::{self, RankedHypothesis};
use echocal_infer::solve::{self, AveragedOut, Signal, Variant, WhitenedStack};
use numpy::prelude::*;
use numpy::{Ix2, Ix3, PyArray1, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::border::{Array, Column, same_length, same_length_not_empty, within};
use crate::infer_checks::{not_negative, positive};
use crate::infer_classes::{
    CoreForm, CoreHypothesisFit, CorePosterior, CorePrior, CoreRanking, CoreSearchOptions, variants,
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

/// Number of columns of some products, checked with what a ridge needs.
fn ridge(
    products: &Array<'_, f64, Ix2>,
    degrees: f64,
    variance_floor: f64,
    ridge_width: f64,
) -> PyResult<usize> {
    let &[width, other] = products.shape() else {
        unreachable!("a two-dimensional array has two lengths")
    };
    if width != other || width < 2 {
        let message =
            format!("products must be a square of two columns or more, but are {width} by {other}");
        return Err(PyValueError::new_err(message));
    }
    positive("degrees", degrees)?;
    not_negative("variance_floor", variance_floor)?;
    positive("ridge_width", ridge_width)?;
    Ok(width)
}

/// Variance that the columns between the first and the last leave of the last, see the crate echocal-infer.
#[pyfunction]
pub fn residual_variance(
    products: Array<'_, f64, Ix2>,
    degrees: f64,
    variance: f64,
    variance_floor: f64,
    ridge_width: f64,
) -> PyResult<f64> {
    let width = ridge(&products, degrees, variance_floor, ridge_width)?;
    Ok(solve::residual_variance(
        &products,
        width,
        degrees,
        variance,
        variance_floor,
        ridge_width,
    ))
}

/// Coefficients of the columns between the first and the last, all at once.
#[pyfunction]
pub fn ridge_coefficients<'py>(
    py: Python<'py>,
    products: Array<'py, f64, Ix2>,
    degrees: f64,
    variance_floor: f64,
    ridge_width: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let width = ridge(&products, degrees, variance_floor, ridge_width)?;
    let found = solve::ridge_coefficients(&products, width, degrees, variance_floor, ridge_width);
    Ok(PyArray1::from_vec(py, found))
}

/// Mean square that all columns together leave of the last one, under each noise.
#[pyfunction]
pub fn mean_squares_left<'py>(
    py: Python<'py>,
    products: Array<'py, f64, Ix3>,
    degrees: f64,
    variance_floor: f64,
    ridge_width: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (_, width) = matrices(&products)?;
    if width < 2 {
        return Err(PyValueError::new_err(
            "products have fewer than two columns",
        ));
    }
    positive("degrees", degrees)?;
    not_negative("variance_floor", variance_floor)?;
    positive("ridge_width", ridge_width)?;
    let products = &*products;
    let found = py
        .detach(|| solve::mean_squares_left(products, width, degrees, variance_floor, ridge_width));
    Ok(PyArray1::from_vec(py, found))
}

/// Products without some columns whose sizes have standard deviation 1, and what that adds to the log
/// evidence. `place`, `variance`: the matrix, and the variance of the innovations, of each of the results;
/// an infinite variance takes nothing out.
#[pyfunction]
#[allow(clippy::type_complexity)] // as Python sees it
pub fn averaged_out<'py>(
    py: Python<'py>,
    products: Array<'py, f64, Ix3>,
    columns: Vec<usize>,
    kept: Vec<usize>,
    place: Vec<usize>,
    variance: Column<'py, f64>,
) -> PyResult<(Bound<'py, PyArray3<f64>>, Bound<'py, PyArray1<f64>>)> {
    let (noises, width) = matrices(&products)?;
    within("column", columns.iter().chain(&kept).copied(), width)?;
    within("matrix", place.iter().copied(), noises)?;
    same_length_not_empty(&[("place", place.len()), ("variance", variance.len())])?;
    same_length_not_empty(&[("kept", kept.len())])?;
    for &variance in &*variance {
        not_negative("a variance", variance)?;
    }
    let wanted: Vec<_> = place.into_iter().zip(variance.iter().copied()).collect();
    let out = AveragedOut {
        columns: &columns,
        kept: &kept,
    };
    let (products, threads) = (&*products, available_threads());
    let (found, log) = py.detach(|| out.of(products, width, &wanted, threads));
    let shape = [wanted.len(), kept.len(), kept.len()];
    let found = PyArray1::from_vec(py, found).reshape(shape)?;
    Ok((found, PyArray1::from_vec(py, log)))
}

/// Log odds that remain against the imitation of a signal by each form, and the size that each needs.
#[pyfunction]
#[allow(clippy::type_complexity)] // as Python sees it
pub fn imitations<'py>(
    py: Python<'py>,
    products: Array<'py, f64, Ix2>,
    signal: Column<'py, f64>,
    beside: Column<'py, f64>,
    forms: Vec<PyRef<'py, CoreForm>>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
    let &[width, other] = products.shape() else {
        unreachable!("a two-dimensional array has two lengths")
    };
    same_length_not_empty(&[
        ("products", width),
        ("a line of products", other),
        ("signal", signal.len()),
        ("beside", beside.len()),
    ])?;
    let forms = variants(&forms, width)?;
    let given = Signal {
        products: &products,
        signal: &signal,
        beside: &beside,
    };
    let found = given.imitations(&forms);
    let left = found.iter().map(|one| one.left).collect();
    let size = found.iter().map(|one| one.size).collect();
    Ok((PyArray1::from_vec(py, left), PyArray1::from_vec(py, size)))
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

/// Probabilities of hypotheses, most probable first, and of their sets of causes; `competing`: number
/// of causes that compete; `covariances`: of the coefficients of each hypothesis.
#[pyfunction]
pub fn rank<'py>(
    py: Python<'py>,
    hypotheses: Hypotheses<'py>,
    log_posterior: Column<'py, f64>,
    covariances: Vec<Array<'py, f64, Ix2>>,
    competing: usize,
    prior: &CorePrior,
) -> PyResult<CoreRanking> {
    same_length_not_empty(&[
        ("hypotheses", hypotheses.len()),
        ("log_posterior", log_posterior.len()),
        ("covariances", covariances.len()),
    ])?;
    if !log_posterior.iter().any(|log| log.is_finite()) {
        return Err(PyValueError::new_err(
            "no hypothesis has a finite log posterior",
        ));
    }
    let each = hypotheses
        .iter()
        .zip(&covariances)
        .zip(log_posterior.iter());
    let mut ranked = Vec::with_capacity(hypotheses.len());
    for (place, ((forms, covariance), &log_posterior)) in each.enumerate() {
        if log_posterior.is_nan() || log_posterior == f64::INFINITY {
            let message = format!("hypothesis {place} has a log posterior of {log_posterior}");
            return Err(PyValueError::new_err(message));
        }
        let variants = variants(forms, usize::MAX)?;
        let free: usize = variants.iter().map(|form| form.free.len()).sum();
        if covariance.shape() != [free, free] {
            let shape = covariance.shape();
            let message = format!(
                "hypothesis {place} has {free} free columns, but its covariance is {} by {}",
                shape[0], shape[1]
            );
            return Err(PyValueError::new_err(message));
        }
        let variances = covariance.iter().step_by(free + 1).copied().collect();
        let known = variants.iter().filter(|form| !form.is_unexplained).count();
        if known > competing {
            let message = format!("hypothesis {place} has {known} causes, but {competing} compete");
            return Err(PyValueError::new_err(message));
        }
        ranked.push(RankedHypothesis {
            variants,
            log_posterior,
            variances,
        });
    }
    Ok(CoreRanking::of(
        py,
        search::rank(&ranked, competing, &prior.prior()),
    ))
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

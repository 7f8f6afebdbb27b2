//! What the inference is given and what it finds, as classes that cannot be changed.

use echocal_infer::search::{Outcome, Posterior, Prior, SearchOptions};
use echocal_infer::solve::{HypothesisFit, Variant};
use numpy::prelude::*;
use numpy::{Element, PyArray, PyArray1, PyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::border::{same_length, within};
use crate::infer_checks::{not_negative, positive, probability};

/// One linear form of a cause: columns that enter as they are, columns with a coefficient, or both.
#[pyclass(name = "Form", module = "echocal._core", frozen)]
pub struct CoreForm {
    pub variant: Variant,
}

#[pymethods]
impl CoreForm {
    /// `cause`: which cause it is a form of; None for an unexplained term. `bounds`: of each free
    /// column's coefficient, in prior standard deviations. `weight`: among the forms of its cause.
    #[new]
    fn new(
        cause: Option<usize>,
        offsets: Vec<usize>,
        free: Vec<usize>,
        bounds: Vec<(f64, f64)>,
        weight: f64,
    ) -> PyResult<Self> {
        same_length(&[("free", free.len()), ("bounds", bounds.len())])?;
        if let Some((low, high)) = bounds
            .iter()
            .find(|(low, high)| low.is_nan() || high.is_nan() || low > high)
        {
            let message = format!(
                "a coefficient must have a lower bound and an upper one, but has {low} and {high}"
            );
            return Err(PyValueError::new_err(message));
        }
        probability("the weight of a form", weight)?;
        if cause == Some(usize::MAX) {
            let message = format!("there are fewer than {} causes", usize::MAX);
            return Err(PyValueError::new_err(message));
        }
        Ok(Self {
            variant: Variant {
                cause: cause.unwrap_or(usize::MAX),
                is_unexplained: cause.is_none(),
                offsets,
                free,
                bounds,
                weight,
            },
        })
    }

    /// Which cause it is a form of; None for an unexplained term.
    #[getter]
    fn cause(&self) -> Option<usize> {
        (!self.variant.is_unexplained).then_some(self.variant.cause)
    }

    /// Columns with coefficient one.
    #[getter]
    fn offsets(&self) -> Vec<usize> {
        self.variant.offsets.clone()
    }

    /// Columns whose coefficient is to be found.
    #[getter]
    fn free(&self) -> Vec<usize> {
        self.variant.free.clone()
    }

    /// Bounds of each coefficient, in prior standard deviations.
    #[getter]
    fn bounds(&self) -> Vec<(f64, f64)> {
        self.variant.bounds.clone()
    }

    /// Probability among the forms of its cause.
    #[getter]
    fn weight(&self) -> f64 {
        self.variant.weight
    }
}

/// The variants of some forms, each of whose columns there is.
pub fn variants(forms: &[PyRef<'_, CoreForm>], width: usize) -> PyResult<Vec<Variant>> {
    let variant = |form: &PyRef<'_, CoreForm>| {
        let own = &form.variant;
        within(
            "column",
            own.offsets.iter().chain(&own.free).copied(),
            width,
        )?;
        Ok(own.clone())
    };
    forms.iter().map(variant).collect()
}

/// Probabilities before the data.
#[pyclass(name = "Prior", module = "echocal._core", frozen, get_all)]
pub struct CorePrior {
    /// Of no, one, two and three causes.
    causes: [f64; 4],
    /// Of an unexplained term, independently of the causes.
    unexplained: f64,
}

#[pymethods]
impl CorePrior {
    #[new]
    fn new(causes: [f64; 4], unexplained: f64) -> PyResult<Self> {
        for p in causes {
            probability("the prior of a number of causes", p)?;
        }
        positive("the prior of two causes", causes[2])?; // that of three is a multiple of it
        probability("the prior of an unexplained term", unexplained)?;
        Ok(Self {
            causes,
            unexplained,
        })
    }

    /// Of no cause and no unexplained term, where some terms compete or none.
    fn no_cause(&self, terms: bool) -> f64 {
        self.prior().no_cause(terms)
    }
}

impl CorePrior {
    pub fn prior(&self) -> Prior {
        Prior {
            causes: self.causes,
            unexplained: self.unexplained,
        }
    }
}

/// What a search leaves out.
#[pyclass(name = "SearchOptions", module = "echocal._core", frozen, get_all)]
pub struct CoreSearchOptions {
    /// Log odds against the most probable hypothesis beyond which one is pruned.
    pruning_log_odds: f64,
    /// Log odds between forms of the same causes below which the one with more coefficients is taken.
    form_preference: f64,
    /// Probability that the least probable hypotheses may share and still be left out.
    unlisted: f64,
}

#[pymethods]
impl CoreSearchOptions {
    #[new]
    fn new(pruning_log_odds: f64, form_preference: f64, unlisted: f64) -> PyResult<Self> {
        not_negative("pruning_log_odds", pruning_log_odds)?;
        not_negative("form_preference", form_preference)?;
        probability("unlisted", unlisted)?;
        Ok(Self {
            pruning_log_odds,
            form_preference,
            unlisted,
        })
    }
}

impl CoreSearchOptions {
    pub fn options(&self) -> SearchOptions {
        SearchOptions {
            pruning_log_odds: self.pruning_log_odds,
            form_preference: self.form_preference,
            unlisted: self.unlisted,
        }
    }
}

/// An array that nobody can write to.
fn frozen<T: Element, D: numpy::ndarray::Dimension>(
    array: &Bound<'_, PyArray<T, D>>,
) -> Py<PyArray<T, D>> {
    array.readwrite().make_nonwriteable();
    array.clone().unbind()
}

/// A hypothesis after the data.
#[pyclass(name = "HypothesisFit", module = "echocal._core", frozen, get_all)]
pub struct CoreHypothesisFit {
    /// Without the hypothesis's prior, with an arbitrary constant common to all.
    log_evidence: f64,
    /// Coefficients of the free columns, in prior standard deviations.
    mean: Py<PyArray1<f64>>,
    /// Their covariance.
    covariance: Py<PyArray2<f64>>,
    /// Probability of each noise under this hypothesis.
    noise: Py<PyArray1<f64>>,
    /// Variance of the innovations.
    variance: f64,
}

impl CoreHypothesisFit {
    pub fn of(py: Python<'_>, fit: HypothesisFit) -> PyResult<Self> {
        let order = fit.mean.len();
        let covariance = PyArray1::from_vec(py, fit.covariance).reshape([order, order])?;
        Ok(Self {
            log_evidence: fit.log_evidence,
            mean: frozen(&PyArray1::from_vec(py, fit.mean)),
            covariance: frozen(&covariance),
            noise: frozen(&PyArray1::from_vec(py, fit.noise)),
            variance: fit.variance,
        })
    }
}

/// A hypothesis with its place in the posterior.
#[pyclass(name = "Outcome", module = "echocal._core", frozen, get_all)]
pub struct CoreOutcome {
    /// Positions of its forms.
    forms: Vec<usize>,
    /// Probability before the data.
    prior: f64,
    /// After the data.
    fit: Py<CoreHypothesisFit>,
}

/// What a search found.
#[pyclass(name = "Posterior", module = "echocal._core", frozen, get_all)]
pub struct CorePosterior {
    /// The hypotheses that are not pruned, most probable first.
    outcomes: Vec<Py<CoreOutcome>>,
    /// Whether each noise was taken into account.
    noises: Vec<bool>,
    /// Number of linear systems solved.
    systems: usize,
}

impl CorePosterior {
    pub fn of(py: Python<'_>, found: Posterior) -> PyResult<Self> {
        let outcome = |one: Outcome| {
            let fit = Py::new(py, CoreHypothesisFit::of(py, one.fit)?)?;
            Py::new(
                py,
                CoreOutcome {
                    forms: one.variants,
                    prior: one.prior,
                    fit,
                },
            )
        };
        Ok(Self {
            outcomes: found
                .outcomes
                .into_iter()
                .map(outcome)
                .collect::<PyResult<_>>()?,
            noises: found.noises,
            systems: found.systems,
        })
    }
}

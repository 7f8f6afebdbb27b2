//! What one pass over a table leaves, and its whitening.

use echocal_core::batch::available_threads;
use echocal_infer::noise::{
    Autoregression, Convection, MovingAverage, NoiseCorrelation, NoiseModel, Path, TableSums, White,
};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::border::{Column, same_length, within};
use crate::infer_checks::{coefficient, not_negative, positive, required};

/// Correlated noise with one set of parameters, and a random error that the rows of a station share.
#[pyclass(name = "NoiseModel", module = "echocal._core", frozen, get_all)]
pub struct CoreNoiseModel {
    /// Position of its correlation among the sums.
    correlation: usize,
    /// Autoregressive coefficient; 0 of a convection.
    rho: f64,
    /// Variance of the error that all rows of a station share, over that of the innovations.
    station_ratio: f64,
    /// Innovation variance over the variance of the process: the weight of a series' first row.
    first_weight: f64,
    /// Log of its probability before the data.
    log_prior: f64,
}

#[pymethods]
impl CoreNoiseModel {
    #[new]
    fn new(
        correlation: usize,
        rho: f64,
        station_ratio: f64,
        first_weight: f64,
        log_prior: f64,
    ) -> PyResult<Self> {
        coefficient("rho", rho)?;
        not_negative("station_ratio", station_ratio)?;
        positive("first_weight", first_weight)?;
        required(log_prior < f64::INFINITY, "log_prior", "finite", log_prior)?;
        Ok(Self {
            correlation,
            rho,
            station_ratio,
            first_weight,
            log_prior,
        })
    }
}

/// A moving-average coefficient; or of a convection autoregression, growth, and whether the air is alike along
/// the whole path; None is white.
#[derive(FromPyObject)]
pub enum GivenCorrelation {
    Convection((f64, f64, bool)),
    MovingAverage(f64),
}

/// The correlation that Python gives, checked.
pub fn correlation(given: Option<GivenCorrelation>) -> PyResult<NoiseCorrelation> {
    Ok(match given {
        None => NoiseCorrelation::White(White),
        Some(GivenCorrelation::Convection((rho, growth, whole))) => {
            coefficient("the autoregression of a convection", rho)?;
            not_negative("the growth of a convection", growth)?;
            let path = if whole { Path::Whole } else { Path::Cells };
            NoiseCorrelation::Convection(Convection { rho, growth, path })
        }
        Some(GivenCorrelation::MovingAverage(theta)) => {
            coefficient("a moving average", theta)?;
            NoiseCorrelation::MovingAverage(MovingAverage { coefficient: theta })
        }
    })
}

/// Refuses distances that convection cannot grow with.
pub fn distances(of: &[NoiseCorrelation], distance: &[f64]) -> PyResult<()> {
    let convection = |one: &NoiseCorrelation| matches!(one, NoiseCorrelation::Convection(_));
    if !of.iter().any(convection) {
        return Ok(());
    }
    let wrong = |metres: &f64| !(metres.is_finite() && *metres >= 0.0);
    match distance.iter().position(wrong) {
        None => Ok(()),
        Some(row) => {
            let what = format!("the distance of row {row} in convection");
            required(false, &what, "finite and 0 or more", distance[row])
        }
    }
}

/// A series whitened for a correlation, and the sum of the log variances of its rows.
#[pyfunction]
pub fn whitened<'py>(
    py: Python<'py>,
    correlation: Option<GivenCorrelation>,
    rho: f64,
    first_weight: f64,
    values: Column<'py, f64>,
    starts: Column<'py, bool>,
    distance: Column<'py, f64>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, f64)> {
    let (values, starts, distance) = (&*values, &*starts, &*distance);
    same_length(&[
        ("values", values.len()),
        ("starts", starts.len()),
        ("distance", distance.len()),
    ])?;
    let model = self::correlation(correlation)?;
    distances(&[model], distance)?;
    coefficient("rho", rho)?;
    positive("first_weight", first_weight)?;
    let own = Autoregression { rho, first_weight };
    let (white, log) = py.detach(|| model.whitened(own, values, starts, distance));
    Ok((PyArray1::from_vec(py, white), log))
}

/// Lag-0 and lag-1 products of columns, block by block; what is made from them shares them.
#[pyclass(name = "Sums", module = "echocal._core", frozen)]
pub struct CoreSums {
    pub(crate) sums: TableSums,
}

impl CoreSums {
    /// Noises and blocks as Python gives them, checked.
    fn given(
        &self,
        noises: &[PyRef<'_, CoreNoiseModel>],
        used: &[bool],
    ) -> PyResult<Vec<NoiseModel>> {
        let correlations = noises.iter().map(|noise| noise.correlation);
        within("correlation", correlations, self.sums.products.len())?;
        same_length(&[("used", used.len()), ("series", self.sums.series.len())])?;
        let noise = |noise: &PyRef<'_, CoreNoiseModel>| NoiseModel {
            correlation: noise.correlation,
            rho: noise.rho,
            station_ratio: noise.station_ratio,
            first_weight: noise.first_weight,
            log_prior: noise.log_prior,
        };
        Ok(noises.iter().map(noise).collect())
    }
}

#[pymethods]
impl CoreSums {
    /// Whitened products and log weight of each noise, over the blocks in use.
    #[allow(clippy::type_complexity)] // as Python sees it
    fn whiten<'py>(
        &self,
        py: Python<'py>,
        noises: Vec<PyRef<'py, CoreNoiseModel>>,
        used: Vec<bool>,
    ) -> PyResult<(Bound<'py, PyArray3<f64>>, Bound<'py, PyArray1<f64>>)> {
        let noises = self.given(&noises, &used)?;
        let (threads, width) = (available_threads(), self.sums.width());
        let (products, weights) = py.detach(|| {
            let all: Vec<usize> = (0..width).collect();
            self.sums.whiten(&noises, &used, &all, threads)
        });
        let shape = [noises.len(), width, width];
        let products = PyArray1::from_vec(py, products).reshape(shape)?;
        Ok((products, PyArray1::from_vec(py, weights)))
    }

    /// Number of columns.
    #[getter]
    fn width(&self) -> usize {
        self.sums.width()
    }

    /// These sums and those of one more pass over the same rows and columns.
    fn joined(&self, more: &Self) -> PyResult<Self> {
        let (own, others) = (&self.sums, &more.sums);
        same_length(&[
            ("the columns of these sums", own.width()),
            ("those of the others", others.width()),
        ])?;
        let same = own.flat_level == others.flat_level;
        if !same || own.series != others.series || own.cells != others.cells {
            let message = "the sums are of other rows: blocks, cells or levels differ";
            return Err(PyValueError::new_err(message));
        }
        let sums = own.joined(others);
        Ok(Self { sums })
    }

    /// The same with zero in place of columns that are not finite, and whether each is.
    fn without_infinite(&self) -> (Self, Vec<bool>) {
        let sums = self.sums.without_infinite();
        let finite = sums.finite_columns();
        (Self { sums }, finite)
    }
}

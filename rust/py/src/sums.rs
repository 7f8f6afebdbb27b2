//! What one pass over a table leaves, and its whitening.

use echocal_core::batch::available_threads;
use echocal_infer::noise::{
    Autoregression, Convection, MovingAverage, NoiseCorrelation, NoiseModel, TableSums, White,
};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::border::{Column, ascending, same_length, within};

/// Correlation (by position), autoregression, variance ratio of stations, weight of first rows, log prior.
type Given = (usize, f64, f64, f64, f64);

/// A moving-average coefficient, or autoregression and growth of a convection; None is white.
#[derive(FromPyObject)]
pub enum Remembered {
    Convection((f64, f64)),
    Fading(f64),
}

pub fn correlation(remembered: Option<Remembered>) -> NoiseCorrelation {
    match remembered {
        None => NoiseCorrelation::White(White),
        Some(Remembered::Convection((rho, growth))) => {
            NoiseCorrelation::Convection(Convection { rho, growth })
        }
        Some(Remembered::Fading(coefficient)) => {
            NoiseCorrelation::MovingAverage(MovingAverage { coefficient })
        }
    }
}

/// A series whitened for a correlation, and the sum of the log variances of its rows.
#[pyfunction]
pub fn whitened<'py>(
    py: Python<'py>,
    remembered: Option<Remembered>,
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
    let model = correlation(remembered);
    let own = Autoregression { rho, first_weight };
    let (white, log) = py.detach(|| model.whitened(own, values, starts, distance));
    Ok((PyArray1::from_vec(py, white), log))
}

/// Lag-0 and lag-1 products of columns, block by block.
#[pyclass(name = "Sums", module = "echocal._core")]
pub struct CoreSums {
    pub(crate) sums: TableSums,
}

/// Matrices of some columns as matrices of all, zero elsewhere.
fn placed(some: &[f64], chosen: &[usize], width: usize) -> Vec<f64> {
    let (own, area) = (chosen.len(), width * width);
    let mut all = vec![0.0; some.len() / (own * own).max(1) * area];
    for (from, to) in some
        .chunks_exact((own * own).max(1))
        .zip(all.chunks_exact_mut(area))
    {
        for (i, line) in chosen.iter().zip(from.chunks_exact(own)) {
            for (j, value) in chosen.iter().zip(line) {
                to[i * width + j] = *value;
            }
        }
    }
    all
}

#[pymethods]
impl CoreSums {
    /// Whitened products and log weight of each noise, over the blocks in use; of some columns
    /// alone, in ascending order and the first among them, the others are zero.
    #[allow(clippy::type_complexity)] // as Python sees it
    #[pyo3(signature = (noises, used, chosen=None))]
    fn whiten<'py>(
        &self,
        py: Python<'py>,
        noises: Vec<Given>,
        used: Vec<bool>,
        chosen: Option<Vec<usize>>,
    ) -> PyResult<(Bound<'py, PyArray3<f64>>, Bound<'py, PyArray1<f64>>)> {
        let memories = noises.iter().map(|noise| noise.0);
        within("memory", memories, self.sums.products.len())?;
        same_length(&[("used", used.len()), ("series", self.sums.series.len())])?;
        let noise = |(correlation, rho, station_ratio, first_weight, log_prior)| NoiseModel {
            correlation,
            rho,
            station_ratio,
            first_weight,
            log_prior,
        };
        let noises: Vec<NoiseModel> = noises.into_iter().map(noise).collect();
        let (threads, width) = (available_threads(), self.sums.width);
        if let Some(chosen) = &chosen {
            within("column", chosen.iter().copied(), width)?;
            ascending("columns", chosen)?;
            if chosen.first() != Some(&0) || chosen.windows(2).any(|pair| pair[0] == pair[1]) {
                let message = "columns must have the first among them, and none twice";
                return Err(PyValueError::new_err(message));
            }
        }
        let (products, weights) = py.detach(|| {
            let all: Vec<usize> = (0..width).collect();
            let columns = chosen.as_deref().unwrap_or(&all);
            let (some, weights) = self.sums.whiten(&noises, &used, columns, threads);
            if columns.len() == width {
                return (some, weights);
            }
            (placed(&some, columns, width), weights)
        });
        let shape = [noises.len(), width, width];
        let products = PyArray1::from_vec(py, products).reshape(shape)?;
        Ok((products, PyArray1::from_vec(py, weights)))
    }

    /// Number of columns.
    #[getter]
    fn width(&self) -> usize {
        self.sums.width
    }

    /// Adds the sums of one more pass over the same rows and columns, which are then its own.
    fn join(&mut self, more: &mut Self) -> PyResult<()> {
        let (own, others) = (&self.sums, &more.sums);
        let same = own.width == others.width && own.flat_level == others.flat_level;
        if !same || own.series != others.series || own.cells != others.cells {
            return Err(PyValueError::new_err("sums of other rows or columns"));
        }
        self.sums.join(core::mem::take(&mut more.sums.products));
        Ok(())
    }

    /// Makes columns zero that are not finite; tells which are.
    fn clear_infinite(&mut self) -> PyResult<Vec<bool>> {
        if self.sums.products.is_empty() {
            let message = "there are no sums: none were asked for, or others have them now";
            return Err(PyValueError::new_err(message));
        }
        Ok(self.sums.clear_infinite())
    }
}

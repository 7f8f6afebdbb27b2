//! What one pass over a table leaves, and its whitening.

use echocal_core::batch::available_threads;
use echocal_core::evidence::{Convection, Memory, Noise, Sums};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray3, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Memory (by position), autoregression, variance ratio of stands, weight of first rows, log prior.
type Given = (usize, f64, f64, f64, f64);

/// A moving-average coefficient, or autoregression and growth of a convection; None is white.
#[derive(FromPyObject)]
pub enum Remembered {
    Convection((f64, f64)),
    Fading(f64),
}

pub fn memory(remembered: Option<Remembered>) -> Memory {
    match remembered {
        None => Memory::White,
        Some(Remembered::Convection((rho, growth))) => {
            Memory::Convection(Convection { rho, growth })
        }
        Some(Remembered::Fading(factor)) => Memory::Fading(factor),
    }
}

/// A series whitened for a memory, and the sum of the log variances of its rows.
#[pyfunction]
pub fn whitened<'py>(
    py: Python<'py>,
    remembered: Option<Remembered>,
    rho: f64,
    first_weight: f64,
    values: PyReadonlyArray1<'py, f64>,
    starts: PyReadonlyArray1<'py, bool>,
    distance: PyReadonlyArray1<'py, f64>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, f64)> {
    let (values, starts, distance) = (values.as_slice()?, starts.as_slice()?, distance.as_slice()?);
    if [starts.len(), distance.len()] != [values.len(); 2] {
        return Err(PyValueError::new_err("columns differ in length"));
    }
    let memory = memory(remembered);
    let (white, log) = py.detach(|| memory.whitened(rho, first_weight, values, starts, distance));
    Ok((PyArray1::from_vec(py, white), log))
}

/// Lag-0 and lag-1 products of columns, block by block.
#[pyclass(name = "Sums", module = "echocal._core")]
pub struct CoreSums {
    pub(crate) sums: Sums,
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
    /// alone, the first among them, the others are zero.
    #[allow(clippy::type_complexity)] // as Python sees it
    #[pyo3(signature = (noises, used, chosen=None))]
    fn whiten<'py>(
        &self,
        py: Python<'py>,
        noises: Vec<Given>,
        used: Vec<bool>,
        chosen: Option<Vec<usize>>,
    ) -> PyResult<(Bound<'py, PyArray3<f64>>, Bound<'py, PyArray1<f64>>)> {
        let memories = self.sums.products.len();
        if used.len() != self.sums.series.len() || noises.iter().any(|noise| noise.0 >= memories) {
            return Err(PyValueError::new_err("no such block or memory"));
        }
        let noise = |(memory, rho, stand_ratio, first_weight, log_prior)| Noise {
            memory,
            rho,
            stand_ratio,
            first_weight,
            log_prior,
        };
        let noises: Vec<Noise> = noises.into_iter().map(noise).collect();
        let (threads, width) = (available_threads(), self.sums.width);
        if chosen.iter().flatten().any(|&column| column >= width) {
            return Err(PyValueError::new_err("no such column"));
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
        if more.sums.width != self.sums.width || more.sums.series != self.sums.series {
            return Err(PyValueError::new_err("sums of other rows or columns"));
        }
        self.sums.join(core::mem::take(&mut more.sums.products));
        Ok(())
    }

    /// Makes columns zero that are not finite; tells which are.
    fn clear_infinite(&mut self) -> Vec<bool> {
        self.sums.clear_infinite()
    }
}

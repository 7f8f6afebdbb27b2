//! What one pass over a table leaves, and its whitening.

use echocal_core::batch::available_threads;
use echocal_core::evidence::{Noise, Sums};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Memory (by position), autoregression, variance ratio of stands, weight of first rows, log prior.
type Given = (usize, f64, f64, f64, f64);

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

    /// Makes columns zero that are not finite; tells which are.
    fn clear_infinite(&mut self) -> Vec<bool> {
        self.sums.clear_infinite()
    }

    /// Squares of the last column, of those before, and their products, over rows that follow
    /// another.
    fn steps(&self) -> [f64; 3] {
        self.sums.steps()
    }
}

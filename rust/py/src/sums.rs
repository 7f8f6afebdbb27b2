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

#[pymethods]
impl CoreSums {
    /// Whitened products and log weight of each noise, over the blocks in use.
    #[allow(clippy::type_complexity)] // as Python sees it
    fn whiten<'py>(
        &self,
        py: Python<'py>,
        noises: Vec<Given>,
        used: Vec<bool>,
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
        let threads = available_threads();
        let (products, weights) = py.detach(|| self.sums.whiten(&noises, &used, threads));
        let shape = [noises.len(), self.sums.width, self.sums.width];
        let products = PyArray1::from_vec(py, products).reshape(shape)?;
        Ok((products, PyArray1::from_vec(py, weights)))
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

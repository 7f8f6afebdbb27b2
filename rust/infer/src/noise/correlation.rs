//! What every model of correlated noise must offer.

use crate::gram::{LagProducts, RowLayout, Source};
use core::fmt::Debug;

/// The autoregressive part beside a model whose one pass serves every coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Autoregression {
    /// Autoregressive coefficient.
    pub rho: f64,
    /// Variance of the innovations over that of the process: the weight of a series' first row.
    pub first_weight: f64,
}

/// How the noise of a row is tied to that of the rows before it in its series.
///
/// One file for each model, and one line in `registry!` of [`crate::noise`]; the tests there try
/// every model of the registry.
pub trait Correlation: Copy + Debug + PartialEq {
    /// The sums of products of the filtered columns for each of some models, in one pass over the
    /// rows, on at most so many threads. The sums do not depend on the number of threads.
    ///
    /// # Panics
    /// If the columns and the layout differ in length.
    #[must_use]
    fn gather(
        source: &dyn Source,
        layout: &RowLayout<'_>,
        models: &[Self],
        threads: usize,
    ) -> Vec<LagProducts>;

    /// A series of values whitened, with the sum of the log variances that its rows had beside the
    /// innovations'.
    ///
    /// # Panics
    /// If the slices differ in length.
    #[must_use]
    fn whitened(
        self,
        autoregression: Autoregression,
        values: &[f64],
        starts: &[bool],
        distance: &[f64],
    ) -> (Vec<f64>, f64);

    /// Models to be tested, each with an autoregressive coefficient.
    #[cfg(test)]
    fn examples() -> Vec<(Self, f64)>;

    /// Covariance of two rows of one series, some rows apart, at two distances \[m\]: in units of what
    /// [`Correlation::whitened`] gives variance one.
    #[cfg(test)]
    fn covariance(self, rho: f64, lag: usize, distances: [f64; 2]) -> f64;
}

//! White noise: rows are independent.

use super::autocorrelation::MovingAverage;
use super::correlation::{Autoregression, Correlation};
use crate::gram::{LagProducts, RowLayout, Source};

/// White noise: the covariance is 1 at lag 0, else 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct White;

impl Correlation for White {
    /// The sums of rows each of which begins a series.
    fn gather(
        source: &dyn Source,
        layout: &RowLayout<'_>,
        models: &[Self],
        threads: usize,
    ) -> Vec<LagProducts> {
        let starts = vec![true; layout.starts.len()];
        let apart = RowLayout {
            starts: &starts,
            ..*layout
        };
        let plain = [MovingAverage { coefficient: 0.0 }];
        let found = MovingAverage::gather(source, &apart, &plain, threads).pop();
        found.map_or_else(Vec::new, |sums| vec![sums; models.len()])
    }

    fn whitened(
        self,
        _autoregression: Autoregression,
        values: &[f64],
        _starts: &[bool],
        _distance: &[f64],
    ) -> (Vec<f64>, f64) {
        (values.to_vec(), 0.0)
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, f64)> {
        vec![(Self, 0.0)]
    }

    #[cfg(test)]
    fn covariance(self, _rho: f64, lag: usize, _distances: [f64; 2]) -> f64 {
        f64::from(u8::from(lag == 0))
    }
}

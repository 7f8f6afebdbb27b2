//! An error that all rows of a group share: the unknown level of a segment, or the error of a station.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use crate::gram::{GROUP, add_products};

/// What is known about the error that the rows of a group share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SharedError {
    /// Nothing: the level of a segment, with a flat prior.
    UnknownLevel,
    /// A normal error of this variance over that of the innovations: that of a station.
    Random(f64),
}

impl SharedError {
    /// Part of a group's products that the integral over its error takes off, over the square `own`
    /// of the group's first column, and what the integral adds to the log evidence.
    fn integrated(self, own: f64) -> (f64, f64) {
        match self {
            Self::UnknownLevel => (1.0 / own, -0.5 * own.ln()),
            Self::Random(ratio) => (ratio / (1.0 + ratio * own), -0.5 * (ratio * own).ln_1p()),
        }
    }
}

/// Integrates the error of each group out of whitened products; returns what that adds to the log
/// evidence.
///
/// The error acts as a multiple of the first column over the rows of its group. `groups` has the
/// products of the first column with each column, group by group; `into` the products of all columns.
pub(super) fn take_off(
    error: SharedError,
    groups: &[f64],
    into: &mut [f64],
    shrunken: &mut Vec<f64>,
    taken: &mut Vec<f64>,
) -> f64 {
    let (width, mut weight) = (into.len().isqrt(), 0.0);
    let padded = width.next_multiple_of(GROUP);
    shrunken.clear();
    for line in groups.chunks_exact(width.max(1)) {
        let (shrink, log) = error.integrated(line[0]);
        weight += log;
        if shrink != 0.0 {
            let root = shrink.sqrt();
            shrunken.extend(line.iter().map(|value| root * value));
            shrunken.resize(shrunken.len() + padded - width, 0.0);
        }
    }
    if !shrunken.is_empty() {
        taken.clear();
        taken.resize(padded * padded, 0.0);
        add_products(shrunken, padded, taken);
        for i in 0..width {
            for j in i..width {
                into[i * width + j] -= taken[i * padded + j];
                into[j * width + i] = into[i * width + j];
            }
        }
    }
    weight
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two groups of two and three rows: the first column is one everywhere, the second is `X`.
    const X: [f64; 5] = [0.3, -0.7, 1.1, 0.4, 2.0];

    fn sums() -> ([f64; 4], [f64; 4]) {
        let part = |rows: &[f64]| [rows.len() as f64, rows.iter().sum::<f64>()];
        let square: f64 = X.iter().map(|x| x * x).sum();
        let sum: f64 = X.iter().sum();
        let groups = [part(&X[..2]), part(&X[2..])].concat();
        (
            [5.0, sum, sum, square],
            [groups[0], groups[1], groups[2], groups[3]],
        )
    }

    #[test]
    fn a_station_error_is_the_inverse_of_its_covariance() {
        // of a group of n rows, (1 + r 1 1')^-1 = 1 - r / (1 + n r) 1 1', and det = 1 + n r
        let ratio = 0.7;
        let (mut into, groups) = sums();
        let error = SharedError::Random(ratio);
        let log = take_off(error, &groups, &mut into, &mut Vec::new(), &mut Vec::new());
        let (mut expected, mut determinant) = (0.0, 1.0);
        for rows in [&X[..2], &X[2..]] {
            let n = rows.len() as f64;
            let sum: f64 = rows.iter().sum();
            let squares: f64 = rows.iter().map(|x| x * x).sum();
            expected += squares - ratio / (1.0 + n * ratio) * sum * sum;
            determinant *= 1.0 + n * ratio;
        }
        assert!((into[3] - expected).abs() < 1e-14);
        assert!((log + 0.5 * f64::ln(determinant)).abs() < 1e-14);
    }

    #[test]
    fn an_unknown_level_takes_off_the_mean_of_each_segment() {
        let (mut into, groups) = sums();
        let error = SharedError::UnknownLevel;
        let log = take_off(error, &groups, &mut into, &mut Vec::new(), &mut Vec::new());
        let mut expected = 0.0;
        for rows in [&X[..2], &X[2..]] {
            let mean = rows.iter().sum::<f64>() / rows.len() as f64;
            expected += rows.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
        }
        assert!((into[3] - expected).abs() < 1e-14);
        assert!(into[0].abs() < 1e-14);
        assert!((log + 0.5 * 6.0_f64.ln()).abs() < 1e-14);
    }
}

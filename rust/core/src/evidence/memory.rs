//! What a pass over the rows remembers.

#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::convection::Convection;
use super::products::{Layout, Products};
use super::source::Source;

/// How the noise of a row is tied to that of the rows before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Memory {
    /// White noise: a row owes nothing to another.
    White,
    /// A moving-average coefficient, beside any autoregression.
    Fading(f64),
    /// Warm cells in the path of the echo.
    Convection(Convection),
}

impl Memory {
    /// The sums for each memory, in at most one pass for either kind.
    ///
    /// # Panics
    /// If the columns and the layout differ in length.
    #[must_use]
    pub fn gather(
        source: &dyn Source,
        layout: &Layout<'_>,
        memories: &[Self],
        threads: usize,
    ) -> Vec<Products> {
        let (mut fading, mut convections) = (Vec::new(), Vec::new());
        for &memory in memories {
            match memory {
                Self::White => {}
                Self::Fading(factor) => fading.push(factor),
                Self::Convection(convection) => convections.push(convection),
            }
        }
        let mut faded = Vec::new();
        if !fading.is_empty() {
            faded = Products::gather(source, layout, &fading, threads);
        }
        let mut drifted = Vec::new();
        if !convections.is_empty() {
            drifted = Convection::gather(source, layout, &convections, threads);
        }
        let (mut faded, mut drifted) = (faded.into_iter(), drifted.into_iter());
        let next = |memory: &Self| match memory {
            Self::White => plain(source, layout, threads),
            Self::Fading(_) => faded.next(),
            Self::Convection(_) => drifted.next(),
        };
        memories.iter().filter_map(next).collect()
    }

    /// A series of values whitened, with the sum of the log variances that its rows had beside the
    /// innovations'.
    ///
    /// `rho` is the autoregressive coefficient beside a fading memory, `first_weight` the weight of
    /// a row that begins a series.
    ///
    /// # Panics
    /// If the slices differ in length.
    #[must_use]
    pub fn whitened(
        self,
        rho: f64,
        first_weight: f64,
        values: &[f64],
        starts: &[bool],
        distance: &[f64],
    ) -> (Vec<f64>, f64) {
        let memory = match self {
            Self::Convection(convection) => return convection.whitened(values, starts, distance),
            Self::Fading(memory) => memory,
            Self::White => return (values.to_vec(), 0.0),
        };
        assert!(values.len() == starts.len());
        let (mut kept, mut series) = (0.0, 0);
        let white = values.iter().zip(starts).map(|(&value, &begins)| {
            let before = kept;
            kept = value;
            if begins {
                series += 1;
                return first_weight.sqrt() * value;
            }
            kept += memory * before;
            kept - rho * before
        });
        let white = white.collect();
        (white, -f64::from(series) * first_weight.ln())
    }
}

/// The sums of rows each of which begins a series.
fn plain(source: &dyn Source, layout: &Layout<'_>, threads: usize) -> Option<Products> {
    let starts = vec![true; layout.starts.len()];
    let apart = Layout {
        starts: &starts,
        ..*layout
    };
    Products::gather(source, &apart, &[0.0], threads).pop()
}

#[cfg(test)]
mod tests {
    use super::*;

    const VALUES: [f64; 6] = [1.0, -2.0, 4.0, 0.5, 3.0, -1.0];
    const STARTS: [bool; 6] = [true, false, false, true, false, false];
    const DISTANCE: [f64; 6] = [0.5, 3.0, 1.0, 2.0, 2.0, 0.2];

    /// Cholesky's factor of the covariance, the slow and obvious way: white rows and log determinant.
    fn slowly(covariance: impl Fn(usize, usize) -> f64) -> (Vec<f64>, f64) {
        let (mut factor, mut white, mut log) = ([[0.0; 6]; 6], Vec::new(), 0.0);
        for i in 0..6 {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let left = covariance(i, j) - known;
                factor[i][j] = if i == j {
                    left.sqrt()
                } else {
                    left / factor[j][j]
                };
            }
            let known: f64 = (0..i).map(|k| factor[i][k] * white[k]).sum();
            white.push((VALUES[i] - known) / factor[i][i]);
            log += 2.0 * factor[i][i].ln();
        }
        (white, log)
    }

    fn check(
        memory: Memory,
        rho: f64,
        first_weight: f64,
        covariance: impl Fn(usize, usize) -> f64,
    ) {
        let (found, log) = memory.whitened(rho, first_weight, &VALUES, &STARTS, &DISTANCE);
        let apart = |i: usize, j: usize| i / 3 != j / 3; // two series
        let (white, slow) = slowly(|i, j| if apart(i, j) { 0.0 } else { covariance(i, j) });
        for (found, white) in found.iter().zip(white) {
            assert!((found - white).abs() < 1e-12, "{found} {white}");
        }
        assert!((log - slow).abs() < 1e-12, "{log} {slow}");
    }

    #[test]
    fn a_convection_is_its_covariance() {
        let (rho, growth): (f64, f64) = (0.8, 0.7);
        let memory = Memory::Convection(Convection { rho, growth });
        check(memory, 0.0, 1.0, |i, j| {
            let both = (DISTANCE[i] * DISTANCE[j]).sqrt() * rho.powi((i - j) as i32);
            growth * both + f64::from(u8::from(i == j))
        });
    }

    #[test]
    fn an_autoregression_is_its_covariance() {
        let rho: f64 = 0.6;
        check(Memory::Fading(0.0), rho, 1.0 - rho * rho, |i, j| {
            rho.powi((i - j) as i32) / (1.0 - rho * rho)
        });
    }
}

//! Columns with sizes of their own in every hypothesis, averaged out of the products of all columns.
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use crate::numeric::cholesky::factor;
use crate::numeric::on_widest;
use crate::parallel::fill_each;

/// Part of a sum of squares; columns that the rest explains to rounding leave no less.
const SINGULAR: f64 = 1e-12;

/// Columns whose sizes are normal with standard deviation 1, and the columns that are kept.
#[derive(Clone, Copy, Debug)]
pub struct AveragedOut<'a> {
    /// Columns that are averaged out.
    pub columns: &'a [usize],
    /// Columns of the result. Those that are averaged out explain nothing there: their products are zero.
    pub kept: &'a [usize],
}

impl AveragedOut<'_> {
    /// Products without the columns, and what that adds to the log evidence: docs/method/noises.md, Eq. 41.
    ///
    /// `products` are matrices of `width`, one after the other. Each of `wanted` is a place among them and
    /// the variance of the innovations; an infinite variance takes nothing out.
    ///
    /// # Panics
    /// If a place or a column is not there.
    #[must_use]
    pub fn of(
        &self,
        products: &[f64],
        width: usize,
        wanted: &[(usize, f64)],
        threads: usize,
    ) -> (Vec<f64>, Vec<f64>) {
        let mut into = vec![0.0; wanted.len() * self.kept.len() * self.kept.len()];
        let log = fill_each(wanted, &mut into, threads, || {
            let mut memory = Memory::default();
            move |&(place, variance): &(usize, f64), into: &mut [f64]| {
                let own = &products[place * width * width..][..width * width];
                memory.fill(own, width, variance, self, into)
            }
        });
        (into, log)
    }
}

/// Products of the columns that are averaged out, with each other and with those that are kept.
#[derive(Default)]
struct Memory {
    among: Vec<f64>,
    along: Vec<f64>,
}

impl Memory {
    on_widest! {
        /// Fills in one matrix.
        fill fill_avx2 fill_avx512 filled (products: &[f64], width: usize, variance: f64, of: &AveragedOut<'_>, into: &mut [f64]) -> f64
    }

    #[inline(always)]
    fn filled(
        &mut self,
        products: &[f64],
        width: usize,
        variance: f64,
        of: &AveragedOut<'_>,
        into: &mut [f64],
    ) -> f64 {
        let (own, kept, order) = (of.columns, of.kept, of.columns.len());
        let trace: f64 = own.iter().map(|&i| products[i * width + i]).sum();
        let variance = match variance.max(SINGULAR * trace) {
            positive if positive > 0.0 => positive,
            _ => 1.0, // the columns are zero
        };
        let Self { among, along } = self;
        among.clear();
        along.clear();
        for (at, &column) in own.iter().enumerate() {
            let line = &products[column * width..][..width];
            among.extend(own.iter().map(|&other| line[other] / variance));
            among[at * order + at] += 1.0;
            along.extend(kept.iter().map(|&other| line[other] / variance.sqrt()));
        }
        factor(among, order, &vec![1.0; order]);
        for i in 0..order {
            let (before, rest) = along.split_at_mut(i * kept.len());
            let line = &mut rest[..kept.len()];
            for (j, other) in before.chunks_exact(kept.len()).enumerate() {
                less(line, among[i * order + j], other);
            }
            let pivot = among[i * order + i];
            line.iter_mut().for_each(|number| *number /= pivot);
        }
        for (at, &column) in kept.iter().enumerate() {
            let line = &mut into[at * kept.len()..][..kept.len()];
            if own.contains(&column) {
                line.fill(0.0);
                continue;
            }
            let given = &products[column * width..][..width];
            for (number, &other) in line.iter_mut().zip(kept) {
                *number = given[other];
            }
            for other in along.chunks_exact(kept.len()) {
                less(line, other[at], other);
            }
            for (number, other) in line.iter_mut().zip(kept) {
                if own.contains(other) {
                    *number = 0.0;
                }
            }
        }
        -(0..order).map(|i| among[i * order + i].ln()).sum::<f64>()
    }
}

/// Takes a multiple of other numbers from some.
#[inline(always)]
fn less(from: &mut [f64], factor: f64, numbers: &[f64]) {
    for (number, other) in from.iter_mut().zip(numbers) {
        *number -= factor * other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_column_by_hand() {
        // the first column has a square of 3: with a variance of 2 it takes 1 * 4 / 5 from the rest
        let products = [3.0, 1.0, 4.0, 1.0, 2.0, 0.5, 4.0, 0.5, 9.0];
        let out = AveragedOut {
            columns: &[0],
            kept: &[0, 1, 2],
        };
        let (found, log) = out.of(&products, 3, &[(0, 2.0), (0, f64::INFINITY)], 1);
        let right = [
            0.0,
            0.0,
            0.0,
            0.0,
            2.0 - 0.2,
            0.5 - 0.8,
            0.0,
            0.5 - 0.8,
            9.0 - 3.2,
        ];
        for (found, right) in found.iter().zip(right) {
            assert!((found - right).abs() < 1e-15, "{found} {right}");
        }
        assert!((log[0] + 0.5 * 2.5_f64.ln()).abs() < 1e-15);
        assert_eq!(found[9..], [0.0, 0.0, 0.0, 0.0, 2.0, 0.5, 0.0, 0.5, 9.0]);
        assert_eq!(log[1], 0.0);
    }
}

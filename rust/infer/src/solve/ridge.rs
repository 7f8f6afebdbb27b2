//! What all columns together leave unexplained.
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use crate::numeric::cholesky::{backward, dot, factor, forward};
use crate::numeric::on_widest;

/// Rounds of the fixed point: the variance sets the ridge, and the ridge the variance. The ridge is
/// small beside the squares of columns that matter, so that each round changes far less than the last.
const ROUNDS: usize = 3;
/// Part of a sum of squares that arithmetic leaves behind: a few thousand roundings of 1.1e-16.
const ROUNDING: f64 = 1e-12;

/// Variance that the columns between the first and the last of some products leave of the last.
///
/// A ridge of some prior standard deviations; what is left is divided by the rows less the effective
/// number of coefficients. It is the square of `R_f` in docs/method.md, Eq. 31.
///
/// # Panics
/// If the products are not a square of at least two columns.
#[must_use]
pub fn residual_variance(
    products: &[f64],
    width: usize,
    degrees: f64,
    variance: f64,
    variance_floor: f64,
    ridge_width: f64,
) -> f64 {
    let mut ridge = Ridge::of(products, width);
    (0..ROUNDS).fold(variance, |variance, _| {
        let added = variance.max(variance_floor) / (ridge_width * ridge_width);
        ridge.round(degrees, added)
    })
}

/// Coefficients of the columns between the first and the last of some products, all at once.
///
/// A ridge of some prior standard deviations, beside the mean square of the last column.
///
/// # Panics
/// If the products are not a square of at least two columns.
#[must_use]
pub fn ridge_coefficients(
    products: &[f64],
    width: usize,
    degrees: f64,
    variance_floor: f64,
    ridge_width: f64,
) -> Vec<f64> {
    let mut ridge = Ridge::of(products, width);
    let variance = (ridge.square / degrees).max(variance_floor);
    ridge.round(degrees, variance / (ridge_width * ridge_width));
    ridge.solved
}

/// Mean square that the columns between the first and the last leave of the last, for each of some
/// matrices of products.
///
/// A ridge of some prior standard deviations, beside the mean square of the last column.
///
/// # Panics
/// If there are fewer than two columns.
#[must_use]
pub fn mean_squares_left(
    products: &[f64],
    width: usize,
    degrees: f64,
    variance_floor: f64,
    ridge_width: f64,
) -> Vec<f64> {
    let mut ridge = Ridge::default();
    let left = |own: &[f64]| {
        ridge.take(own, width);
        let order = ridge.along.len();
        let size: f64 = (0..order).map(|i| ridge.among[i * order + i]).sum();
        let variance = (ridge.square / degrees).max(variance_floor);
        let left = ridge.leave((variance / (ridge_width * ridge_width)).max(ROUNDING * size));
        (left / degrees).max(variance_floor)
    };
    products.chunks_exact(width * width).map(left).collect()
}

/// Products of columns with each other and with what they explain, and memory.
#[derive(Default)]
struct Ridge {
    among: Vec<f64>,
    along: Vec<f64>,
    square: f64,
    lower: Vec<f64>,
    solved: Vec<f64>,
}

impl Ridge {
    fn of(products: &[f64], width: usize) -> Self {
        let mut ridge = Self::default();
        ridge.take(products, width);
        ridge
    }

    fn take(&mut self, products: &[f64], width: usize) {
        assert!(width >= 2 && products.len() == width * width);
        let order = width - 2;
        self.among.clear();
        self.along.clear();
        for line in products[width..].chunks_exact(width).take(order) {
            self.among.extend_from_slice(&line[1..=order]);
            self.along.push(line[order + 1]);
        }
        self.square = products[width * width - 1];
    }

    on_widest! {
        /// Variance that a ridge leaves; finds the coefficients.
        round round_avx2 round_avx512 rounded (degrees: f64, ridge: f64) -> f64
    }

    on_widest! {
        /// Sum of squares that a ridge leaves; finds the coefficients.
        leave leave_avx2 leave_avx512 left (ridge: f64) -> f64
    }

    #[inline(always)]
    fn rounded(&mut self, degrees: f64, ridge: f64) -> f64 {
        let (left, order) = (self.left(ridge), self.along.len());
        let used = order as f64 - ridge * inverse_trace(&self.lower, order);
        left.max(ROUNDING * self.square) / (degrees - used).max(1.0)
    }

    #[inline(always)]
    fn left(&mut self, ridge: f64) -> f64 {
        let (order, lower, solved) = (self.along.len(), &mut self.lower, &mut self.solved);
        lower.clone_from(&self.among);
        for i in 0..order {
            lower[i * order + i] += ridge;
        }
        factor(lower, order, &vec![ridge; order]);
        solved.clone_from(&self.along);
        forward(lower, order, solved);
        let explained = squares(solved);
        backward(lower, order, solved);
        self.square - explained - ridge * squares(solved)
    }
}

#[inline(always)]
fn squares(values: &[f64]) -> f64 {
    dot(values, values)
}

/// Trace of the inverse of `L L'`: the squares of the inverse of `L`.
#[inline(always)]
fn inverse_trace(lower: &[f64], order: usize) -> f64 {
    let mut sum = 0.0;
    let mut column = vec![0.0; order];
    for first in 0..order {
        column[first] = 1.0 / lower[first * order + first];
        for i in first + 1..order {
            let line = &lower[i * order + first..i * order + i];
            column[i] = -dot(line, &column[first..i]) / lower[i * order + i];
        }
        sum += squares(&column[first..]);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_column_by_hand() {
        // one column of square 4 along 2 with a square of 10: ridge 1 leaves 10 - 4 / 5 - 4 / 25
        let products = [1.0, 0.0, 0.0, 0.0, 4.0, 2.0, 0.0, 2.0, 10.0];
        let first: f64 = (10.0 - 0.8 - 0.16) / (8.0 - 0.8);
        let found = residual_variance(&products, 3, 8.0, 9.0, 1e-18, 3.0);
        let ridge = |variance: f64| {
            let ridge: f64 = variance / 9.0;
            let left = 10.0 - 4.0 / (4.0 + ridge) - ridge * (2.0 / (4.0 + ridge)).powi(2);
            left / (8.0 - 4.0 / (4.0 + ridge))
        };
        assert!((ridge(9.0) - first).abs() < 1e-15);
        assert!((found - ridge(ridge(first))).abs() < 1e-15);
        let mean = mean_squares_left(&products, 3, 8.0, 1e-18, 3.0)[0];
        let added = 10.0 / 8.0 / 9.0;
        let left = 10.0 - 4.0 / (4.0 + added) - added * (2.0_f64 / (4.0 + added)).powi(2);
        assert!((mean - left / 8.0).abs() < 1e-15);
        let found = ridge_coefficients(&products, 3, 8.0, 1e-18, 3.0);
        assert!((found[0] - 2.0 / (4.0 + 10.0 / 8.0 / 9.0)).abs() < 1e-15);
    }
}

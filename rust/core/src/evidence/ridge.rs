//! What all columns together leave unexplained.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::cholesky::{backward, dot, factor, forward};

/// Rounds of the fixed point: the variance sets the ridge, and the ridge the variance.
const ROUNDS: usize = 3;
/// Part of a sum of squares that arithmetic leaves behind.
const ROUNDING: f64 = 1e-12;

/// Variance that the columns between the first and the last of some products leave of the last.
///
/// A ridge in units of the priors, three prior standard deviations wide; what is left is divided by
/// the rows less the effective number of coefficients.
///
/// # Panics
/// If the products are not a square of at least two columns.
#[must_use]
pub fn left_over(products: &[f64], width: usize, degrees: f64, variance: f64, finest: f64) -> f64 {
    assert!(width >= 2 && products.len() == width * width);
    let order = width - 2;
    let line = |row: usize| &products[(1 + row) * width + 1..][..order + 1];
    let along: Vec<f64> = (0..order).map(|row| line(row)[order]).collect();
    let square = line(order)[order];
    let mut variance = variance;
    for _ in 0..ROUNDS {
        let ridge = variance.max(finest) / 9.0;
        let mut lower: Vec<f64> = (0..order)
            .flat_map(|row| &line(row)[..order])
            .copied()
            .collect();
        for i in 0..order {
            lower[i * order + i] += ridge;
        }
        factor(&mut lower, order, &vec![ridge; order]);
        let mut solved = along.clone();
        forward(&lower, order, &mut solved);
        let explained = squares(&solved);
        backward(&lower, order, &mut solved);
        let left = square - explained - ridge * squares(&solved);
        let used = order as f64 - ridge * inverse_trace(&lower, order);
        variance = left.max(ROUNDING * square) / (degrees - used).max(1.0);
    }
    variance
}

fn squares(values: &[f64]) -> f64 {
    dot(values, values)
}

/// Trace of the inverse of `L L'`: the squares of the inverse of `L`.
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
        let found = left_over(&products, 3, 8.0, 9.0, 1e-18);
        let ridge = |variance: f64| {
            let ridge: f64 = variance / 9.0;
            let left = 10.0 - 4.0 / (4.0 + ridge) - ridge * (2.0 / (4.0 + ridge)).powi(2);
            left / (8.0 - 4.0 / (4.0 + ridge))
        };
        assert!((ridge(9.0) - first).abs() < 1e-15);
        assert!((found - ridge(ridge(first))).abs() < 1e-15);
    }
}

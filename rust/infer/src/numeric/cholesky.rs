//! Small symmetric positive definite systems.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

/// Lower triangle of a matrix of `order`, row by row, factored in place: `L` with `L L' = A`.
///
/// `added` was added to the diagonal of a matrix without negative eigenvalues, so no pivot squared
/// can be smaller; rounding would make it so where columns are nearly the same.
pub(crate) fn factor(matrix: &mut [f64], order: usize, added: f64) {
    for i in 0..order {
        for j in 0..=i {
            let (row, other) = (&matrix[i * order..][..j], &matrix[j * order..][..j]);
            let left = matrix[i * order + j] - dot(row, other);
            matrix[i * order + j] = if i == j {
                left.max(added).sqrt()
            } else {
                left / matrix[j * order + j]
            };
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves `L x = b` in place.
pub(crate) fn forward(lower: &[f64], order: usize, b: &mut [f64]) {
    for i in 0..order {
        b[i] = (b[i] - dot(&lower[i * order..][..i], &b[..i])) / lower[i * order + i];
    }
}

/// Solves `L' x = b` in place.
pub(crate) fn backward(lower: &[f64], order: usize, b: &mut [f64]) {
    for i in (0..order).rev() {
        let line = &lower[i * order..][..=i];
        let found = b[i] / line[i];
        b[i] = found;
        for (number, factor) in b[..i].iter_mut().zip(line) {
            *number -= factor * found;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_by_hand() {
        let mut matrix = [4.0, 0.0, 0.0, 2.0, 5.0, 0.0, 0.0, 1.0, 3.0]; // the upper triangle is not read
        factor(&mut matrix, 3, 0.0);
        let expected = [14.0, -6.0, 2.0, -6.0, 12.0, -4.0, 2.0, -4.0, 16.0].map(|x| x / 44.0);
        for (column, right) in expected.chunks_exact(3).enumerate() {
            let mut found = [0.0; 3];
            found[column] = 1.0;
            forward(&matrix, 3, &mut found);
            backward(&matrix, 3, &mut found);
            for (found, right) in found.iter().zip(right) {
                assert!((found - right).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn a_factor_of_any_order_times_itself_is_the_matrix() {
        for order in 1..12 {
            let number = |i: usize, j: usize| ((i * 5 + j * 3) as f64 * 0.37).sin();
            let product = |i, j| (0..40).map(|k| number(i, k) * number(j, k)).sum::<f64>();
            let matrix: Vec<f64> = (0..order * order)
                .map(|at| product(at / order, at % order) + f64::from(at % (order + 1) == 0))
                .collect();
            let mut lower = matrix.clone();
            factor(&mut lower, order, 0.0);
            for i in 0..order {
                for j in 0..=i {
                    let found = dot(&lower[i * order..][..=j], &lower[j * order..][..=j]);
                    assert!((found - matrix[i * order + j]).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_direction_without_information_stays_finite() {
        let mut matrix = [1.0, 0.0, 1.0, 1.0]; // 1e-20 added, and lost
        factor(&mut matrix, 2, 1e-20);
        assert_eq!(matrix[3], 1e-10);
    }
}

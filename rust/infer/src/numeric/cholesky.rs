//! Small symmetric positive definite systems.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

/// Lower triangle of a matrix of `order`, row by row, factored in place, column by column: `L` with `L L' = A`.
///
/// `added` was added to the diagonal of a matrix without negative eigenvalues, so no pivot squared
/// can be smaller; rounding would make it so where columns are nearly the same.
#[inline(always)]
pub(crate) fn factor(matrix: &mut [f64], order: usize, added: &[f64]) {
    let mut column = vec![0.0; order];
    for j in 0..order {
        let pivot = matrix[j * order + j].max(added[j]).sqrt();
        matrix[j * order + j] = pivot;
        for i in j + 1..order {
            column[i] = matrix[i * order + j] / pivot;
            let line = &mut matrix[i * order + j..=i * order + i];
            line[0] = column[i];
            let factor = column[i];
            for (number, other) in line[1..].iter_mut().zip(&column[j + 1..=i]) {
                *number -= factor * other;
            }
        }
    }
}

/// Sum of products, in eight sums at once: one alone would wait for itself.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let both = a.remainder().iter().zip(b.remainder());
    let rest: f64 = both.map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum += a * b;
        }
    }
    rest + sums.iter().sum::<f64>()
}

/// Solves `L x = b` in place.
#[inline(always)]
pub(crate) fn forward(lower: &[f64], order: usize, b: &mut [f64]) {
    for i in 0..order {
        b[i] = (b[i] - dot(&lower[i * order..][..i], &b[..i])) / lower[i * order + i];
    }
}

/// Solves `L' x = b` in place.
#[inline(always)]
pub(crate) fn backward(lower: &[f64], order: usize, b: &mut [f64]) {
    for i in (0..order).rev() {
        let mut sum = b[i];
        for k in i + 1..order {
            sum -= lower[k * order + i] * b[k];
        }
        b[i] = sum / lower[i * order + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_by_hand() {
        let mut matrix = [4.0, 0.0, 0.0, 2.0, 5.0, 0.0, 0.0, 1.0, 3.0]; // the upper triangle is not read
        factor(&mut matrix, 3, &[0.0; 3]);
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
    fn a_direction_without_information_stays_finite() {
        let mut matrix = [1.0, 0.0, 1.0, 1.0]; // 1e-20 added, and lost
        factor(&mut matrix, 2, &[1e-20; 2]);
        assert_eq!(matrix[3], 1e-10);
    }
}

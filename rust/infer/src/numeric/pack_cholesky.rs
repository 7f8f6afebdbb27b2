//! Small symmetric positive definite systems, for several noise models side by side.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::pack::Pack;

/// `from - a b`, in four sums at once: one alone would wait for itself.
#[inline(always)]
pub(crate) fn less(from: Pack, a: &[Pack], b: &[Pack]) -> Pack {
    let (whole, b) = (a.len() & !3, &b[..a.len()]);
    let (mut rest, mut at) = (from, whole);
    while at < a.len() {
        rest = rest - a[at] * b[at];
        at += 1;
    }
    if whole == 0 {
        return rest;
    }
    let mut sums = [Pack::all(0.0); 4];
    at = 0;
    while at < whole {
        sums[0] = sums[0] + a[at] * b[at];
        sums[1] = sums[1] + a[at + 1] * b[at + 1];
        sums[2] = sums[2] + a[at + 2] * b[at + 2];
        sums[3] = sums[3] + a[at + 3] * b[at + 3];
        at += 4;
    }
    rest - ((sums[0] + sums[1]) + (sums[2] + sums[3]))
}

/// Sum of squares, each times a weight.
#[inline(always)]
pub(crate) fn squares(values: &[Pack], weights: &[Pack]) -> Pack {
    let (mut sum, mut at, weights) = (Pack::all(0.0), 0, &weights[..values.len()]);
    while at < values.len() {
        sum = sum + values[at] * values[at] * weights[at];
        at += 1;
    }
    sum
}

/// Matrices of `order`, of which the lower triangle is read, with something `added` to the diagonal,
/// factored from a row on, where those before are factored already: `L D L'` with ones on the diagonal
/// of `L`, where `D` is stored.
///
/// What was added was added to a matrix without negative eigenvalues, so no pivot is smaller; rounding
/// would make it so where columns are nearly the same.
#[inline(always)]
pub(crate) fn factor(
    matrix: &[Pack],
    added: &[Pack],
    lower: &mut [Pack],
    inverse: &mut [Pack],
    from: usize,
) {
    let order = added.len();
    for i in from..order {
        let (before, own) = lower.split_at_mut(i * order);
        let line = &matrix[i * order..][..=i];
        for j in 0..i {
            own[j] = less(line[j], &own[..j], &before[j * order..][..j]);
        }
        let (mut pivot, mut at) = (line[i] + added[i], 0);
        while at < i {
            let scaled = own[at] * inverse[at];
            pivot = pivot - own[at] * scaled;
            own[at] = scaled;
            at += 1;
        }
        own[i] = pivot.max(added[i]);
        inverse[i] = Pack::all(1.0) / own[i];
    }
}

/// Solves `L x = b` in place, where `b` is zero before `first`; `L` has ones on its diagonal.
#[inline(always)]
pub(crate) fn forward(lower: &[Pack], order: usize, b: &mut [Pack], first: usize) {
    for i in first + 1..order {
        b[i] = less(b[i], &lower[i * order + first..][..i - first], &b[first..i]);
    }
}

/// Solves `L' x = b` in place.
#[inline(always)]
pub(crate) fn backward(lower: &[Pack], order: usize, b: &mut [Pack]) {
    for i in (0..order).rev() {
        let mut sum = b[i];
        for k in i + 1..order {
            sum = sum - lower[k * order + i] * b[k];
        }
        b[i] = sum;
    }
}

/// `(L D L')^-1`, both triangles, with memory for the inverse of `L`.
#[inline(always)]
pub(crate) fn invert(
    lower: &[Pack],
    order: usize,
    inverse: &[Pack],
    unit: &mut [Pack],
    into: &mut [Pack],
) {
    for column in 0..order {
        let unit = &mut unit[column * order..][..order];
        unit[column..].fill(Pack::all(0.0));
        unit[column] = Pack::all(1.0);
        forward(lower, order, unit, column);
    }
    for i in 0..order {
        for j in 0..=i {
            let mut sum = Pack::all(0.0);
            for k in i..order {
                sum = sum + unit[i * order + k] * unit[j * order + k] * inverse[k];
            }
            into[i * order + j] = sum;
            into[j * order + i] = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::pack::PACK;

    #[test]
    fn an_inverse_by_hand() {
        let matrix = [4.0, 0.0, 0.0, 2.0, 5.0, 0.0, 0.0, 1.0, 3.0].map(Pack::all);
        let (mut lower, mut pivots) = ([Pack::all(0.0); 9], [Pack::all(0.0); 3]);
        factor(&matrix, &[Pack::all(0.0); 3], &mut lower, &mut pivots, 0);
        let (mut unit, mut found) = ([Pack::all(0.0); 9], [Pack::all(0.0); 9]);
        invert(&lower, 3, &pivots, &mut unit, &mut found);
        let expected = [14.0, -6.0, 2.0, -6.0, 12.0, -4.0, 2.0, -4.0, 16.0].map(|x| x / 44.0);
        for (found, right) in found.iter().zip(expected) {
            assert!((found.0[3] - right).abs() < 1e-15);
        }
    }

    #[test]
    fn every_lane_as_by_itself() {
        let matrix = |lane: usize| [4.0 + lane as f64, 0.0, 0.0, 2.0, 5.0, 0.0, 0.0, 1.0, 3.0];
        let lanes: Vec<Pack> = (0..9)
            .map(|at| Pack(core::array::from_fn(|lane| matrix(lane)[at])))
            .collect();
        let (mut lower, mut pivots) = ([Pack::all(0.0); 9], [Pack::all(0.0); 3]);
        factor(&lanes, &[Pack::all(0.0); 3], &mut lower, &mut pivots, 0);
        let mut solved = [1.0, -2.0, 0.5].map(Pack::all);
        forward(&lower, 3, &mut solved, 0);
        for (number, pivot) in solved.iter_mut().zip(pivots) {
            *number = *number * pivot;
        }
        backward(&lower, 3, &mut solved);
        for lane in 0..PACK {
            let [four, ..] = matrix(lane);
            let whole = [[four, 2.0, 0.0], [2.0, 5.0, 1.0], [0.0, 1.0, 3.0]];
            for (line, right) in whole.iter().zip([1.0, -2.0, 0.5]) {
                let found: f64 = line.iter().zip(&solved).map(|(a, x)| a * x.0[lane]).sum();
                assert!((found - right).abs() < 1e-14);
            }
        }
    }
}

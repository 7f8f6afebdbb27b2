//! Sums of products as matrices and lines.

/// `sums += more`.
pub(crate) fn add(sums: &mut [f64], more: &[f64]) {
    for (sum, &value) in sums.iter_mut().zip(more) {
        *sum += value;
    }
}

/// Lines without the padding.
pub(crate) fn narrow(sums: &[f64], width: usize, columns: usize) -> Vec<f64> {
    let lines = sums.chunks_exact(width.max(1));
    lines.flat_map(|line| &line[..columns]).copied().collect()
}

/// Both triangles of several matrices, without the padding.
pub(crate) fn triangles(sums: &[f64], width: usize, columns: usize) -> Vec<f64> {
    let mut result = vec![0.0; sums.len() / (width * width).max(1) * columns * columns];
    let matrices = result.chunks_exact_mut((columns * columns).max(1));
    for (whole, upper) in matrices.zip(sums.chunks_exact((width * width).max(1))) {
        mirrored(upper, width, columns, whole);
    }
    result
}

/// Both triangles of a matrix, without the padding.
pub(crate) fn mirrored(upper: &[f64], width: usize, columns: usize, whole: &mut [f64]) {
    for i in 0..columns {
        let line = &upper[i * width + i..i * width + columns];
        whole[i * columns + i..(i + 1) * columns].copy_from_slice(line);
        for (j, &value) in (i..).zip(line) {
            whole[j * columns + i] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn upper_triangles_become_whole_matrices() {
        let upper = [1.0, 2.0, 9.0, 0.0, 3.0, 9.0, 0.0, 0.0, 9.0]; // the third column is padding
        assert_eq!(triangles(&upper, 3, 2), [1.0, 2.0, 2.0, 3.0]);
        assert_eq!(narrow(&upper[..6], 3, 2), [1.0, 2.0, 0.0, 3.0]);
        let mut sums = vec![1.0, 2.0];
        add(&mut sums, &[10.0, 20.0]);
        assert_eq!(sums, [11.0, 22.0]);
    }
}

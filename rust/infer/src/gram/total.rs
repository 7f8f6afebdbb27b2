//! Products of every pair of columns over all rows.

use super::matrices::{add, triangles};
use super::panels::Panels;
use super::source::Source;
use super::tiles::{GROUP, add_chosen};
use crate::parallel::in_spans;
use echocal_core::batch::{BLOCK, Line};

/// The Gram matrix `X' X`: products of every pair of columns, summed over all rows; row-major.
#[must_use]
pub fn gram(source: &dyn Source, threads: usize) -> Vec<f64> {
    let columns = source.width();
    let width = columns.next_multiple_of(GROUP);
    let chosen: Vec<u32> = (1..).take(BLOCK).collect();
    let worker = || {
        let (mut reader, mut panels) = (source.reader(), Panels::new(width));
        let mut lines = vec![Line::of(0.0); columns];
        let chosen = &chosen;
        move |first: usize, end: usize| {
            let mut sums = vec![0.0; width * width];
            for block in (first..end).step_by(BLOCK) {
                let count = BLOCK.min(end - block);
                reader.read(block, count, &mut lines);
                panels.fill(&lines, count);
                panels.leave_out_zeros(count);
                add_chosen(panels.rows(), &chosen[..count], width, &mut sums);
            }
            sums
        }
    };
    let mut whole = vec![0.0; width * width];
    for sums in in_spans(source.rows(), threads, worker) {
        add(&mut whole, &sums);
    }
    triangles(&whole, width, columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gram::Stored;

    #[test]
    fn the_sums_are_those_of_every_row_whatever_the_threads() {
        let rows = 9001; // more than two spans, and no whole number of blocks
        let column = |seed: usize| -> Vec<f64> {
            (0..rows)
                .map(|row| ((row * seed) as f64 * 0.754_877).fract() - 0.5)
                .collect()
        };
        let columns: Vec<Vec<f64>> = [1, 3, 7].map(column).into();
        let stored = Stored(columns.iter().map(Vec::as_slice).collect());
        let found = gram(&stored, 1);
        assert_eq!(found, gram(&stored, 2));
        for i in 0..3 {
            for j in 0..3 {
                let both = columns[i].iter().zip(&columns[j]);
                let expected: f64 = both.map(|(x, y)| x * y).sum();
                assert!((found[3 * i + j] - expected).abs() < 1e-10, "{i} {j}");
            }
        }
    }
}

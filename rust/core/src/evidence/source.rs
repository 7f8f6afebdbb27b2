//! Columns as a pass over the rows sees them.

use crate::batch::staged::{BLOCK, Line};

/// Columns that exist a block of rows at a time.
pub trait Source: Sync {
    /// Number of columns.
    fn width(&self) -> usize;

    /// Number of rows.
    fn rows(&self) -> usize;

    /// A reader for one thread.
    fn reader(&self) -> Box<dyn Reader + '_>;
}

/// Fills lines with columns.
pub trait Reader {
    /// Rows `first..first + count` of every column; `count` is at most the length of a line.
    fn read(&mut self, first: usize, count: usize, into: &mut [Line]);
}

/// Columns in memory.
pub struct Stored<'a>(pub &'a [&'a [f64]]);

impl Source for Stored<'_> {
    fn width(&self) -> usize {
        self.0.len()
    }

    fn rows(&self) -> usize {
        self.0.first().map_or(0, |column| column.len())
    }

    fn reader(&self) -> Box<dyn Reader + '_> {
        Box::new(StoredReader(self.0))
    }
}

struct StoredReader<'a>(&'a [&'a [f64]]);

impl Reader for StoredReader<'_> {
    fn read(&mut self, first: usize, count: usize, into: &mut [Line]) {
        for (line, column) in into.iter_mut().zip(self.0) {
            line.0[..count].copy_from_slice(&column[first..first + count]);
        }
    }
}

/// Rows of some columns side by side, `width` numbers a row, the last ones zero.
pub(super) fn side_by_side(lines: &[Line], count: usize, width: usize, rows: &mut Vec<f64>) {
    static NONE: Line = Line([0.0; BLOCK]);
    rows.resize(count * width, 0.0);
    for first in (0..width).step_by(super::gram::GROUP) {
        let group: [&Line; super::gram::GROUP] =
            core::array::from_fn(|k| lines.get(first + k).unwrap_or(&NONE));
        for (row, numbers) in rows.chunks_exact_mut(width).enumerate() {
            for (number, line) in numbers[first..].iter_mut().zip(group) {
                *number = line.0[row];
            }
        }
    }
}

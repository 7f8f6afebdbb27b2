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

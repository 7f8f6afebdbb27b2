//! Columns as a pass over the rows sees them.

use crate::batch::staged::Line;

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

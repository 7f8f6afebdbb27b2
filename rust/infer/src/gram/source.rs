//! Columns as a pass over the rows sees them.

use echocal_core::batch::Line;

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

/// Columns that are there, side by side.
#[derive(Clone, Debug)]
pub struct Stored<'a>(pub Vec<&'a [f64]>);

impl Source for Stored<'_> {
    fn width(&self) -> usize {
        self.0.len()
    }

    fn rows(&self) -> usize {
        self.0.first().map_or(0, |column| column.len())
    }

    fn reader(&self) -> Box<dyn Reader + '_> {
        Box::new(Lines(&self.0))
    }
}

struct Lines<'a>(&'a [&'a [f64]]);

impl Reader for Lines<'_> {
    fn read(&mut self, first: usize, count: usize, into: &mut [Line]) {
        for (line, column) in into.iter_mut().zip(self.0) {
            line.0[..count].copy_from_slice(&column[first..first + count]);
        }
    }
}

//! A recorded quantity of a table: one number, or one for each row.

use crate::batch::Column;
use core::ops::Range;

/// Rows of a table: borrowed columns, or one number for all rows.
#[derive(Clone, Copy, Debug)]
pub enum Numbers<'a> {
    /// One number per row.
    Each(&'a [f64]),
    /// The same number in every row.
    All(&'a f64),
}

impl Numbers<'_> {
    pub(super) fn column(&self) -> Column {
        match *self {
            Self::Each(values) => Column::of(values),
            Self::All(value) => Column::constant(value),
        }
    }

    /// Whether there is a number for each of so many rows.
    pub(super) fn has(&self, rows: usize) -> bool {
        match *self {
            Self::Each(values) => values.len() == rows,
            Self::All(_) => true,
        }
    }

    /// Least and largest number of some rows, whichever are numbers.
    #[must_use]
    pub fn range(&self, rows: Range<usize>) -> (f64, f64) {
        let each = match *self {
            Self::Each(values) => &values[rows],
            Self::All(value) => core::slice::from_ref(value),
        };
        let all = (f64::INFINITY, f64::NEG_INFINITY);
        each.iter()
            .fold(all, |(low, high), &x| (low.min(x), high.max(x)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_pass_over_what_is_no_number() {
        let values = [3.0, f64::NAN, -1.0, 7.0];
        assert_eq!(Numbers::Each(&values).range(0..3), (-1.0, 3.0));
        assert_eq!(Numbers::All(&values[3]).range(0..3), (7.0, 7.0));
        assert!(Numbers::Each(&values).has(4) && !Numbers::Each(&values).has(3));
    }
}

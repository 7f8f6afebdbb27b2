//! Blocks of rows of a batch's columns.

use super::tracks::{Line, LineRef, Reading};
use crate::batch::{Column, Precision};
use crate::conditions::Quantity;

/// Columns of a batch, of which blocks are read where they lie if they can be.
pub(crate) struct BlockReader {
    precision: Precision,
    columns: [Column; 1 + Quantity::COUNT],
    buffers: Box<[Line; 1 + Quantity::COUNT]>,
    filled: [bool; 1 + Quantity::COUNT],
}

impl BlockReader {
    /// Columns: the quantity that a model is applied to, then every recorded one.
    pub(crate) fn new(
        precision: Precision,
        first: Column,
        recorded: [Column; Quantity::COUNT],
    ) -> Self {
        let column = |k: usize| if k == 0 { first } else { recorded[k - 1] };
        Self {
            precision,
            columns: core::array::from_fn(column),
            buffers: Box::new([Line::of(0.0); 1 + Quantity::COUNT]),
            filled: [false; 1 + Quantity::COUNT],
        }
    }

    /// Some rows, with no derivative yet; the first column stands for the distance.
    ///
    /// # Safety
    /// The columns have `first + count` rows of the precision, `count` from 1 to [`BLOCK`](super::BLOCK); nobody
    /// writes to these rows while the result is in use.
    pub(crate) unsafe fn block(&mut self, first: usize, count: usize) -> Reading<'_> {
        const WIDEST: usize = 16;
        let padded = count.next_multiple_of(WIDEST);
        let double = self.precision == Precision::Double;
        let in_place = |column: Column| {
            double && column.stride == size_of::<f64>().cast_signed() && padded == count
        };
        for k in 0..self.columns.len() {
            if !in_place(self.columns[k]) {
                // SAFETY: the caller's.
                unsafe { self.fill(k, first, count, padded) };
            }
        }
        let place = |k: usize| {
            let column: Column = self.columns[k];
            if in_place(column) {
                // SAFETY: the caller guarantees `count` rows, which are all that is read.
                unsafe { LineRef::new(column.skip(first).start.cast()) }
            } else {
                LineRef::fixed(&self.buffers[k])
            }
        };
        let recorded = core::array::from_fn(|q| place(1 + q));
        Reading::new(place(0), recorded, padded)
    }

    /// Copies rows of a column side by side; the last one fills up to `padded`.
    ///
    /// # Safety
    /// As for [`Self::block`].
    unsafe fn fill(&mut self, k: usize, first: usize, count: usize, padded: usize) {
        let (column, line) = (self.columns[k], &mut self.buffers[k].0);
        let rows = column.skip(first);
        if column.stride == 0 {
            if !self.filled[k] {
                // SAFETY: the caller guarantees a number.
                unsafe { self.precision.get(rows, &mut line[..1]) };
                let number = line[0];
                line.fill(number);
                self.filled[k] = true;
            }
            return;
        }
        // SAFETY: the caller guarantees the rows.
        unsafe { self.precision.get(rows, &mut line[..count]) };
        let last = line[count - 1];
        line[count..padded].fill(last);
    }
}

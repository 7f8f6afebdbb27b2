//! Blocks of rows of a batch's columns.

use super::tracks::{Line, LineRef, Reading};
use crate::batch::{Column, Precision};
use crate::conditions::Quantity;

/// How many columns: the quantity that a model is applied to, then every recorded one.
const COLUMNS: usize = 1 + Quantity::COUNT;

/// Columns of a batch, of which blocks are read where they lie if they can be.
pub(crate) struct BlockReader {
    precision: Precision,
    columns: [Column; COLUMNS],
    buffers: Box<[Line; COLUMNS]>,
    /// The columns whose rows differ; most quantities are one number, and read once.
    varying: Vec<usize>,
    begun: bool,
}

impl BlockReader {
    /// Columns: the quantity that a model is applied to, then every recorded one.
    pub(crate) fn new(
        precision: Precision,
        first: Column,
        recorded: [Column; Quantity::COUNT],
    ) -> Self {
        let column = |k: usize| if k == 0 { first } else { recorded[k - 1] };
        let columns: [Column; COLUMNS] = core::array::from_fn(column);
        Self {
            precision,
            columns,
            buffers: Box::new([Line::of(0.0); COLUMNS]),
            varying: (0..COLUMNS).filter(|&k| columns[k].stride != 0).collect(),
            begun: false,
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
        let direct = self.precision == Precision::Double && padded == count;
        let in_place = |column: Column| direct && column.stride == size_of::<f64>().cast_signed();
        if !self.begun {
            // SAFETY: the caller's.
            unsafe { self.fill_constants() };
            self.begun = true;
        }
        for &k in &self.varying {
            let column = self.columns[k];
            if !in_place(column) {
                let line = &mut self.buffers[k].0;
                // SAFETY: the caller guarantees the rows.
                unsafe { self.precision.get(column.skip(first), &mut line[..count]) };
                // the last one fills up the vectors
                let last = line[count - 1];
                line[count..padded].fill(last);
            }
        }
        let mut places: [LineRef<'_>; COLUMNS] =
            core::array::from_fn(|k| LineRef::fixed(&self.buffers[k]));
        for &k in &self.varying {
            let column = self.columns[k];
            if in_place(column) {
                // SAFETY: the caller guarantees `count` rows, which are all that is read.
                places[k] = unsafe { LineRef::new(column.skip(first).start.cast()) };
            }
        }
        let recorded = core::array::from_fn(|q| places[1 + q]);
        Reading::new(places[0], recorded, padded)
    }

    /// Fills the lines of the columns that are one number.
    ///
    /// # Safety
    /// Each column has a number of the precision.
    unsafe fn fill_constants(&mut self) {
        for (column, line) in self.columns.iter().zip(self.buffers.iter_mut()) {
            if column.stride == 0 {
                // SAFETY: the caller's.
                unsafe { self.precision.get(*column, &mut line.0[..1]) };
                let number = line.0[0];
                line.0.fill(number);
            }
        }
    }
}

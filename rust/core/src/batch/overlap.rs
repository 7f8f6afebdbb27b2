//! Outputs that lie where an input has other rows: threads would overwrite what others have not read.

use super::Column;

/// Whether writing a row of the output leaves every other row of the input as it is: in place, apart,
/// or between the rows of the input. The rows may then be shared out among threads.
///
/// Columns of different strides whose extents meet count as not so, even if no two rows meet.
#[must_use]
pub fn is_row_by_row<T>(input: Column, output: Column, rows: usize) -> bool {
    let (size, step) = (size_of::<T>(), output.stride.unsigned_abs());
    let (own, written) = (extent(input, rows, size), extent(output, rows, size));
    if rows == 0 || own.1 <= written.0 || written.1 <= own.0 {
        return true;
    }
    if input.stride != output.stride || step < size {
        return false;
    }
    let behind = input.start.addr().wrapping_sub(output.start.addr());
    let between = behind.cast_signed().rem_euclid(output.stride.abs());
    behind == 0 || (size..=step - size).contains(&between.cast_unsigned())
}

/// The addresses of the first byte of a column and of the one after its last.
fn extent(column: Column, rows: usize, size: usize) -> (usize, usize) {
    let first = column.start.addr();
    let last = column.skip(rows.saturating_sub(1)).start.addr();
    (first.min(last), first.max(last) + size)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same, given first row and stride \[elements\] of input and output.
    fn row_by_row(rows: usize, input: (usize, isize), output: (usize, isize)) -> bool {
        let mut memory = [0.0_f64; 64];
        let start = memory.as_mut_ptr();
        let column = |(first, stride): (usize, isize)| Column {
            start: start.wrapping_add(first).cast(),
            stride: 8 * stride,
        };
        is_row_by_row::<f64>(column(input), column(output), rows)
    }

    #[test]
    fn in_place_apart_or_between() {
        assert!(row_by_row(20, (0, 1), (0, 1)));
        assert!(row_by_row(20, (0, 3), (0, 3)));
        assert!(row_by_row(20, (19, -1), (19, -1)));
        assert!(row_by_row(20, (0, 1), (20, 1)));
        assert!(row_by_row(20, (0, 2), (1, 2))); // two columns of one table
        assert!(row_by_row(20, (40, -2), (41, -2)));
        assert!(row_by_row(0, (0, 1), (0, 1)));
    }

    #[test]
    fn other_rows() {
        assert!(!row_by_row(20, (1, 1), (0, 1))); // ahead
        assert!(!row_by_row(20, (0, 1), (1, 1))); // behind
        assert!(!row_by_row(20, (19, -1), (0, 1))); // the other way round
        assert!(!row_by_row(20, (0, 2), (0, 1)));
        assert!(!row_by_row(20, (0, 2), (2, 2)));
        assert!(!row_by_row(20, (5, 0), (0, 1))); // a constant among what is written
    }
}

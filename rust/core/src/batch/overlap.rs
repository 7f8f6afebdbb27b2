//! Inputs whose rows lie where the output has other rows.
//!
//! NumPy copies most of them before it calls a loop, but not inputs that run ahead of the output: a
//! loop that goes row by row in order has read such a row before it overwrites it. Threads begin in
//! the middle, where the output of one meets the input of the next. So these inputs are copied here.
#![allow(unsafe_code)]

use super::Column;
use std::collections::TryReserveError;

/// Copies every input that the output overlaps other than row by row; `inputs` lead to the copies,
/// which must live until they were read.
///
/// An output in place, or one that lies between the rows of an input, costs no copy.
///
/// # Errors
/// If there is no memory for a copy; `inputs` may then lead to copies that are gone.
///
/// # Safety
/// Every input is valid and aligned for `rows` elements at its stride.
pub unsafe fn copy_overlapping<T: Copy>(
    inputs: &mut [Column],
    output: Column,
    rows: usize,
) -> Result<Vec<Vec<T>>, TryReserveError> {
    let mut copies = Vec::new();
    for input in inputs {
        if is_row_by_row::<T>(*input, output, rows) {
            continue;
        }
        let constant = input.stride == 0;
        let count = if constant { 1 } else { rows };
        let mut copy = Vec::new();
        copy.try_reserve_exact(count)?;
        // SAFETY: the caller guarantees the rows.
        copy.extend((0..count).map(|row| unsafe { *input.skip(row).start.cast::<T>() }));
        let stride = if constant { 0 } else { size_of::<T>() };
        *input = Column {
            start: copy.as_mut_ptr().cast(),
            stride: stride.cast_signed(),
        };
        copies.push(copy);
    }
    Ok(copies)
}

/// Whether writing a row of the output leaves every other row of the input as it is.
fn is_row_by_row<T>(input: Column, output: Column, rows: usize) -> bool {
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

    /// Whether a copy is made of an input, given first row and stride [elements] of input and output.
    fn copies(rows: usize, input: (usize, isize), output: (usize, isize)) -> bool {
        let mut memory: Vec<f64> = (0..64).map(f64::from).collect();
        let start = memory.as_mut_ptr();
        let column = |(first, stride): (usize, isize)| Column {
            start: start.wrapping_add(first).cast(),
            stride: 8 * stride,
        };
        let mut inputs = [column(input)];
        // SAFETY: the rows lie within the memory.
        let made = unsafe { copy_overlapping::<f64>(&mut inputs, column(output), rows) };
        let made = made.unwrap_or_default();
        for row in 0..rows {
            let expected = input.0.cast_signed() + input.1 * row.cast_signed();
            // SAFETY: the input, or its copy, has the rows.
            let found: f64 = unsafe { *inputs[0].skip(row).start.cast() };
            assert_eq!(found, expected as f64);
        }
        !made.is_empty()
    }

    #[test]
    fn in_place_or_apart_costs_nothing() {
        assert!(!copies(20, (0, 1), (0, 1)));
        assert!(!copies(20, (0, 3), (0, 3)));
        assert!(!copies(20, (19, -1), (19, -1)));
        assert!(!copies(20, (0, 1), (20, 1)));
        assert!(!copies(20, (0, 2), (1, 2))); // two columns of one table
        assert!(!copies(20, (40, -2), (41, -2)));
        assert!(!copies(0, (0, 1), (0, 1)));
    }

    #[test]
    fn other_rows_are_copied() {
        assert!(copies(20, (1, 1), (0, 1))); // ahead
        assert!(copies(20, (0, 1), (1, 1))); // behind
        assert!(copies(20, (19, -1), (0, 1))); // the other way round
        assert!(copies(20, (0, 2), (0, 1)));
        assert!(copies(20, (0, 2), (2, 2)));
        assert!(copies(20, (5, 0), (0, 1))); // a constant among what is written
    }
}

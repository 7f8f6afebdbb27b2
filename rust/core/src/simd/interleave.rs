//! Columns brought side by side, row by row.

#[cfg(target_arch = "x86_64")]
use super::x86::{F64x4, transposed};
#[cfg(target_arch = "x86_64")]
use super::{InstructionSet, Vector, active};
#[cfg(target_arch = "x86_64")]
use crate::scalar::Scalar;

/// Numbers of one row, side by side in a line of the cache of their own.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Eight(pub [f64; 8]);

/// Copies the first rows of eight columns: row `i` of all of them becomes `into[i]`.
///
/// # Panics
/// If a column has fewer rows than are filled.
pub fn interleave(columns: [&[f64]; 8], into: &mut [Eight]) {
    assert!(columns.iter().all(|column| column.len() >= into.len()));
    #[cfg(target_arch = "x86_64")]
    if active() != InstructionSet::Baseline {
        // SAFETY: the instruction set is available, or a wider one; the lengths were checked.
        return unsafe { in_squares(columns, into) };
    }
    plainly(columns, into, 0);
}

/// Rows from one on, number by number.
#[inline(always)]
fn plainly(columns: [&[f64]; 8], into: &mut [Eight], from: usize) {
    for (row, numbers) in into.iter_mut().enumerate().skip(from) {
        numbers.0 = columns.map(|column| column[row]);
    }
}

/// Four rows of four columns at a time.
///
/// # Safety
/// The processor has AVX2 and FMA, and every column has the rows.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn in_squares(columns: [&[f64]; 8], into: &mut [Eight]) {
    const SIDE: usize = F64x4::WIDTH;
    let whole = into.len() / SIDE * SIDE;
    for first in (0..8).step_by(SIDE) {
        for row in (0..whole).step_by(SIDE) {
            let mut square = [F64x4::constant(0.0); SIDE];
            // SAFETY: four rows from this one on are there, in every column and in the result.
            unsafe {
                for (line, column) in square.iter_mut().zip(&columns[first..]) {
                    *line = F64x4::load(column.as_ptr().add(row));
                }
                for (line, numbers) in transposed(square).iter().zip(&mut into[row..]) {
                    line.store(numbers.0.as_mut_ptr().add(first));
                }
            }
        }
    }
    plainly(columns, into, whole);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_has_its_columns() {
        let columns: [[f64; 11]; 8] =
            core::array::from_fn(|column| core::array::from_fn(|row| (20 * column + row) as f64));
        for count in [0, 3, 4, 9, 11] {
            let mut found = vec![Eight([f64::NAN; 8]); count];
            interleave(columns.each_ref().map(|column| &column[..]), &mut found);
            for (row, numbers) in found.iter().enumerate() {
                let expected = columns.map(|column| column[row]);
                assert_eq!(numbers.0, expected, "row {row} of {count}");
            }
        }
    }
}

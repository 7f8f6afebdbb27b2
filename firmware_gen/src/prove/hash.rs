//! The hash over the outputs of rows that are straight lines: every output is computed, several rows side by side,
//! because the steps of one hash wait for each other.

use super::claim::{SEED, fold};
use super::straight::Straight;
use crate::types::Range;

/// Rows side by side. Set by hand.
pub(super) const ROWS: usize = 16;

/// The hash of each row's outputs, in the order of the echo codes.
pub(super) fn hashes(rows: &[Straight; ROWS], codes: Range) -> [u32; ROWS] {
    let count = codes.maximum - codes.minimum + 1;
    let narrow = |row: &Straight| row.fits_word(codes);
    let bits = rows[0].bits();
    if rows.iter().all(narrow) && rows.iter().all(|row| row.bits() == bits) {
        let mut lines = rows.map(|row| row.start_at(codes.minimum) as u32);
        let slopes = rows.map(|row| row.slope() as u32);
        let after = rows.map(|row| row.after() as u32);
        let mut hashes = [SEED; ROWS];
        for _ in 0..count {
            for row in 0..ROWS {
                let output = (lines[row] >> bits).wrapping_add(after[row]);
                hashes[row] = fold(hashes[row], output);
                lines[row] = lines[row].wrapping_add(slopes[row]);
            }
        }
        return hashes;
    }
    let mut hashes = [SEED; ROWS];
    for echo in codes.minimum..=codes.maximum {
        for (hash, row) in hashes.iter_mut().zip(rows) {
            *hash = fold(*hash, row.output(echo) as u32);
        }
    }
    hashes
}

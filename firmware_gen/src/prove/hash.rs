//! The hash over the outputs of rows that are straight lines. Every output is computed and hashed. Several rows go side by
//! side, because the steps of one hash wait for each other.

use super::claim::{SEED, fold};
use super::straight::Straight;
use crate::types::Range;
use echocal_core::simd::{OnVectors, Vector, on_vectors};

/// Rows side by side: four vectors of 256 bits. Set by hand.
pub(super) const ROWS: usize = 32;

/// The hash of each row's outputs, in the order of the echo codes.
pub(super) fn hashes(rows: &[Straight; ROWS], codes: Range) -> [u32; ROWS] {
    let bits = rows[0].bits();
    let narrow = |row: &Straight| row.bits() == bits && row.fits_word(codes);
    if rows.iter().all(narrow) {
        return on_vectors(Words {
            lines: rows.map(|row| row.start_at(codes.minimum) as u32),
            slopes: rows.map(|row| row.slope() as u32),
            after: rows.map(|row| row.after() as u32),
            bits,
            count: codes.maximum - codes.minimum + 1,
        });
    }
    let mut hashes = [SEED; ROWS];
    for echo in codes.minimum..=codes.maximum {
        for (hash, row) in hashes.iter_mut().zip(rows) {
            *hash = fold(*hash, row.output(echo) as u32);
        }
    }
    hashes
}

/// Lines of 32 bits, which the compiler puts into the vectors of the machine.
struct Words {
    lines: [u32; ROWS],
    slopes: [u32; ROWS],
    after: [u32; ROWS],
    bits: u32,
    count: i64,
}

impl OnVectors for Words {
    type Output = [u32; ROWS];

    #[inline(always)]
    fn run<V: Vector<Element = f64>>(mut self) -> Self::Output {
        let mut hashes = [SEED; ROWS];
        for _ in 0..self.count {
            for (row, hash) in hashes.iter_mut().enumerate() {
                let output = (self.lines[row] >> self.bits).wrapping_add(self.after[row]);
                *hash = fold(*hash, output);
                self.lines[row] = self.lines[row].wrapping_add(self.slopes[row]);
            }
        }
        hashes
    }
}

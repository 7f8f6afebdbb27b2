//! Single-precision columns through a formula that is compiled for double precision only.

use super::block::{self, BLOCK};
use super::{Column, Formula};

/// Evaluates a formula over single-precision rows.
///
/// # Safety
/// As for [`super::Kernel::run_f32`].
pub(super) unsafe fn run<F: Formula<K>, const K: usize>(
    formula: &F,
    inputs: [Column; K],
    output: Column,
    rows: usize,
) {
    let mut buffers = [[0.0_f64; BLOCK]; K];
    let mut result = [0.0_f64; BLOCK];
    for first in (0..rows).step_by(BLOCK) {
        let count = BLOCK.min(rows - first);
        for (input, buffer) in inputs.iter().zip(&mut buffers) {
            for (row, wide) in buffer[..count].iter_mut().enumerate() {
                // SAFETY: the caller guarantees `rows` rows of single precision.
                *wide = f64::from(unsafe { *input.skip(first + row).start.cast::<f32>() });
            }
        }
        let columns = buffers.each_mut().map(wide);
        // SAFETY: `count` rows of the buffers are valid, and they do not overlap.
        unsafe { block::run_rows(formula, columns, wide(&mut result), count) };
        for (row, &value) in result[..count].iter().enumerate() {
            // SAFETY: the caller guarantees `rows` writable rows of single precision.
            unsafe { *output.skip(first + row).start.cast() = value as f32 };
        }
    }
}

fn wide(buffer: &mut [f64; BLOCK]) -> Column {
    Column {
        start: buffer.as_mut_ptr().cast(),
        stride: size_of::<f64>().cast_signed(),
    }
}

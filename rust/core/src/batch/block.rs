//! One thread's rows, block by block, with the instruction set of this machine.
#![allow(unsafe_code)]

use super::{Column, Formula};
#[cfg(target_arch = "x86_64")]
use crate::simd::x86::{F32x8, F32x16, F64x4, F64x8};
use crate::simd::{InstructionSet, Lanes, Vector, active};
use core::array::from_fn;
use core::mem::MaybeUninit;

/// Rows at once: a multiple of every vector width, and all columns' blocks stay in the first cache.
pub(super) const BLOCK: usize = 384;

/// Vectors in flight: three hide the latency of a division and a chain of polynomials.
///
/// Measured in cache (Zen 4, `distance` by Cramer's law, double precision): one, two, three vectors take 3.1, 2.25
/// and 1.75 ns a row with AVX2, 1.5 with AVX-512 whatever their number. There the units that multiply are
/// busy without a break; with AVX2 three vectors spill some registers, which costs less than waiting.
const IN_FLIGHT: usize = 3;

macro_rules! run {
    ($(#[$doc:meta])* $run:ident, $avx2:ident, $avx512:ident: $float:ident, $wide:ident, $wider:ident) => {
        $(#[$doc])*
        ///
        /// # Safety
        /// As for [`super::Kernel::run_f64`].
        pub(super) unsafe fn $run<F: Formula<K>, const K: usize>(
            formula: &F,
            inputs: [Column; K],
            output: Column,
            rows: usize,
        ) {
            match active() {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the instruction set is available; the rest the caller guarantees.
                InstructionSet::Avx512 => unsafe { $avx512(formula, inputs, output, rows) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                InstructionSet::Avx2 => unsafe { $avx2(formula, inputs, output, rows) },
                // SAFETY: the caller guarantees the columns.
                _ => unsafe { blocks::<$float, F, K>(formula, inputs, output, rows) },
            }
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,fma")]
        unsafe fn $avx2<F: Formula<K>, const K: usize>(
            formula: &F,
            inputs: [Column; K],
            output: Column,
            rows: usize,
        ) {
            // SAFETY: the caller guarantees the columns.
            unsafe { blocks::<Lanes<$wide, IN_FLIGHT>, F, K>(formula, inputs, output, rows) }
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
        unsafe fn $avx512<F: Formula<K>, const K: usize>(
            formula: &F,
            inputs: [Column; K],
            output: Column,
            rows: usize,
        ) {
            // SAFETY: the caller guarantees the columns.
            unsafe { blocks::<Lanes<$wider, IN_FLIGHT>, F, K>(formula, inputs, output, rows) }
        }
    };
}

run!(
    /// Evaluates a formula over rows in double precision.
    run_f64, run_f64_avx2, run_f64_avx512: f64, F64x4, F64x8
);
run!(
    /// Evaluates a formula over rows in single precision.
    run_f32, run_f32_avx2, run_f32_avx512: f32, F32x8, F32x16
);

/// Evaluates a formula for one row.
pub(super) fn evaluate<F: Formula<K>, const K: usize>(formula: &F, inputs: [f64; K]) -> f64 {
    match active() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the instruction set is available, or a wider one that includes it.
        InstructionSet::Avx2 | InstructionSet::Avx512 => unsafe { evaluate_fma(formula, inputs) },
        _ => formula.evaluate(inputs),
    }
}

/// Fused operations are one instruction each here, elsewhere a call.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn evaluate_fma<F: Formula<K>, const K: usize>(formula: &F, inputs: [f64; K]) -> f64 {
    formula.evaluate(inputs)
}

type Buffer<T> = [MaybeUninit<T>; BLOCK];

/// The rows in blocks; whatever is not side by side in memory passes through a buffer.
#[inline(always)]
unsafe fn blocks<V: Vector, F: Formula<K>, const K: usize>(
    formula: &F,
    inputs: [Column; K],
    output: Column,
    rows: usize,
) {
    const { assert!(BLOCK.is_multiple_of(V::WIDTH)) };
    // no buffer needed: all whole vectors at once
    let direct = side_by_side::<V::Element>(output)
        && (0..K).all(|k| !F::READS[k] || side_by_side::<V::Element>(inputs[k]));
    let mut buffers: [Buffer<V::Element>; K] = [const { [MaybeUninit::uninit(); BLOCK] }; K];
    let mut result: Buffer<V::Element> = [MaybeUninit::uninit(); BLOCK];
    let mut first = 0;
    while first < rows {
        let left = rows - first;
        let vectors = if direct { left / V::WIDTH } else { 0 };
        let count = match vectors {
            0 => BLOCK.min(left),
            _ => vectors * V::WIDTH,
        };
        let padded = count.next_multiple_of(V::WIDTH);
        let whole = padded == count;
        let sources: [*const V::Element; K] = from_fn(|k| {
            let column = inputs[k].skip(first);
            if !F::READS[k] || whole && side_by_side::<V::Element>(column) {
                column.start.cast()
            } else {
                if column.stride != 0 || first == 0 {
                    // SAFETY: the caller guarantees `count` rows; `padded` fit the buffer.
                    unsafe { gather(column, &mut buffers[k], count, padded) };
                }
                buffers[k].as_ptr().cast()
            }
        });
        let column = output.skip(first);
        let direct = whole && side_by_side::<V::Element>(column);
        let target = if direct {
            column.start.cast()
        } else {
            result.as_mut_ptr().cast()
        };
        // SAFETY: `padded` elements of each source that is read, and of the target, are valid.
        unsafe { block::<V, F, K>(formula, sources, target, padded) };
        if !direct {
            // SAFETY: the block wrote the buffer; the caller guarantees `count` rows.
            unsafe { scatter(&result, column, count) };
        }
        first += count;
    }
}

/// Rows that are side by side, from the first pointers on.
#[inline(always)]
unsafe fn block<V: Vector, F: Formula<K>, const K: usize>(
    formula: &F,
    sources: [*const V::Element; K],
    target: *mut V::Element,
    rows: usize,
) {
    for row in (0..rows).step_by(V::WIDTH) {
        let mut inputs = [V::constant(0.0); K];
        for k in 0..K {
            if F::READS[k] {
                // SAFETY: the caller guarantees `rows` readable elements, a multiple of the width.
                inputs[k] = unsafe { V::load(sources[k].add(row)) };
            }
        }
        let value = formula.evaluate(inputs);
        // SAFETY: the caller guarantees `rows` writable elements.
        unsafe { value.store(target.add(row)) };
    }
}

fn side_by_side<T>(column: Column) -> bool {
    column.stride == size_of::<T>().cast_signed()
}

/// Copies rows side by side; the last one fills up to `padded`.
#[inline(always)]
unsafe fn gather<T: Copy>(column: Column, buffer: &mut Buffer<T>, count: usize, padded: usize) {
    for (row, place) in buffer[..count].iter_mut().enumerate() {
        // SAFETY: the caller guarantees `count` rows.
        *place = MaybeUninit::new(unsafe { *column.skip(row).start.cast() });
    }
    let last = buffer[count - 1];
    buffer[count..padded].fill(last);
}

/// Copies rows from side by side to where they belong.
#[inline(always)]
unsafe fn scatter<T: Copy>(buffer: &Buffer<T>, column: Column, count: usize) {
    for (row, value) in buffer[..count].iter().enumerate() {
        // SAFETY: the caller guarantees `count` rows, and that the buffer holds as many values.
        unsafe { *column.skip(row).start.cast() = value.assume_init() };
    }
}

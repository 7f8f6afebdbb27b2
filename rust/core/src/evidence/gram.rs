//! Sums of products of rows, several columns at a time.
#![allow(unsafe_code)]
#![allow(clippy::needless_range_loop)] // plain loops over constant sizes stay in registers

#[cfg(target_arch = "x86_64")]
use crate::simd::x86::{F64x4, F64x8};
use crate::simd::{InstructionSet, Vector, active};

/// Columns are padded to whole groups of so many.
pub(super) const GROUP: usize = 8;

/// `sums += rows' rows`, of rows of `width` numbers side by side, `width` in whole groups.
///
/// Only what is right of the diagonal's groups is summed.
pub(super) fn add_products(rows: &[f64], width: usize, sums: &mut [f64]) {
    assert!(width.is_multiple_of(GROUP) && rows.len().is_multiple_of(width.max(1)));
    assert_eq!(sums.len(), width * width);
    match active() {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the instruction set is available, and the lengths were checked.
        InstructionSet::Avx512 => unsafe { with_avx512(rows, width, sums) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        InstructionSet::Avx2 => unsafe { with_avx2(rows, width, sums) },
        // SAFETY: as above.
        _ => unsafe { all::<f64, 4>(rows, width, sums) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
unsafe fn with_avx512(rows: &[f64], width: usize, sums: &mut [f64]) {
    // SAFETY: the caller's.
    unsafe { all::<F64x8, 8>(rows, width, sums) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn with_avx2(rows: &[f64], width: usize, sums: &mut [f64]) {
    // SAFETY: the caller's.
    unsafe { all::<F64x4, 4>(rows, width, sums) }
}

/// Tiles of `HEIGHT` lines by three vectors: their sums stay in registers.
#[inline(always)]
unsafe fn all<V: Vector<Element = f64>, const HEIGHT: usize>(
    rows: &[f64],
    width: usize,
    sums: &mut [f64],
) {
    for line in (0..width).step_by(HEIGHT) {
        let mut column = line / GROUP * GROUP;
        // SAFETY: a tile ends within the width, a multiple of the group and so of both sizes.
        unsafe {
            while column + 3 * V::WIDTH <= width {
                tile::<V, HEIGHT, 3>(rows, width, sums, line, column);
                column += 3 * V::WIDTH;
            }
            while column < width {
                tile::<V, HEIGHT, 1>(rows, width, sums, line, column);
                column += V::WIDTH;
            }
        }
    }
}

#[inline(always)]
unsafe fn tile<V: Vector<Element = f64>, const HEIGHT: usize, const VECTORS: usize>(
    rows: &[f64],
    width: usize,
    sums: &mut [f64],
    line: usize,
    column: usize,
) {
    let mut own = [[V::constant(0.0); VECTORS]; HEIGHT];
    let target = sums.as_mut_ptr();
    // SAFETY: the caller guarantees that the tile lies within the width.
    unsafe {
        for i in 0..HEIGHT {
            for j in 0..VECTORS {
                own[i][j] = V::load(target.add((line + i) * width + column + j * V::WIDTH));
            }
        }
        for row in 0..rows.len() / width {
            let row = rows.as_ptr().add(row * width);
            let mut right = [V::constant(0.0); VECTORS];
            for j in 0..VECTORS {
                right[j] = V::load(row.add(column + j * V::WIDTH));
            }
            for i in 0..HEIGHT {
                let left = V::constant(*row.add(line + i));
                for j in 0..VECTORS {
                    own[i][j] = added(left, right[j], own[i][j]);
                }
            }
        }
        for i in 0..HEIGHT {
            for j in 0..VECTORS {
                own[i][j].store(target.add((line + i) * width + column + j * V::WIDTH));
            }
        }
    }
}

/// `left right + sum`; fused where that is an instruction.
#[inline(always)]
fn added<V: Vector>(left: V, right: V, sum: V) -> V {
    if V::WIDTH == 1 {
        left * right + sum
    } else {
        left.mul_add(right, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_every_pair_of_columns() {
        for width in [8, 16, 40, 64] {
            let number = |at: usize| (at as f64 * 0.754_877).fract() - 0.5;
            let rows: Vec<f64> = (0..7 * width).map(number).collect();
            let mut sums = vec![1.0; width * width];
            add_products(&rows, width, &mut sums);
            for i in 0..width {
                for j in i..width {
                    let each = rows.chunks_exact(width).map(|row| row[i] * row[j]);
                    let expected = 1.0 + each.sum::<f64>();
                    assert!((sums[i * width + j] - expected).abs() < 1e-14, "{i} {j}");
                }
            }
        }
    }
}

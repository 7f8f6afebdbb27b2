//! Sums of products of rows, several columns at a time.
#![allow(unsafe_code)]
#![allow(clippy::needless_range_loop)] // plain loops over constant sizes stay in registers

use echocal_core::simd::{OnVectors, Vector, on_vectors};

/// Columns that lie side by side: a line of the cache. Others are padded to whole groups of so many.
pub(crate) const GROUP: usize = 8;

/// Rows of columns, of which [`GROUP`] lie side by side: a panel.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub numbers: &'a [f64],
    /// Numbers from one row to the next.
    pub row: usize,
    /// Numbers from one panel to the next.
    pub panel: usize,
    /// Panels that are not zero, in order.
    pub panels: &'a [usize],
}

impl Rows<'_> {
    /// Where some columns of the first row are.
    #[inline(always)]
    pub(crate) fn column(&self, column: usize) -> *const f64 {
        let offset = column / GROUP * self.panel + column % GROUP;
        self.numbers.as_ptr().wrapping_add(offset)
    }
}

/// `sums += rows' rows`, of rows of `width` numbers side by side, `width` in whole groups.
///
/// Only what is right of the diagonal's groups is summed.
pub(crate) fn add_products(rows: &[f64], width: usize, sums: &mut [f64]) {
    assert!(rows.len().is_multiple_of(width.max(1)));
    let chosen: Vec<u32> = (0..).take(rows.len() / width.max(1)).collect();
    let panels: Vec<usize> = (0..width / GROUP).collect();
    let rows = Rows {
        numbers: rows,
        row: width,
        panel: GROUP,
        panels: &panels,
    };
    add_chosen(rows, &chosen, width, sums);
}

/// The same of some rows; where `sums` has one line, those of the first column alone.
pub(crate) fn add_chosen(rows: Rows<'_>, chosen: &[u32], width: usize, sums: &mut [f64]) {
    let (Some(&row), Some(&panel)) = (chosen.iter().max(), rows.panels.iter().max()) else {
        return;
    };
    let end = row as usize * rows.row + panel * rows.panel + GROUP;
    assert!((1 + panel) * GROUP <= width && end <= rows.numbers.len());
    assert!(sums.len() == width * width || sums.len() == width);
    on_vectors(AddChosen {
        rows,
        chosen,
        width,
        sums,
    });
}

/// The arguments of [`add_chosen`], checked.
struct AddChosen<'a> {
    rows: Rows<'a>,
    chosen: &'a [u32],
    width: usize,
    sums: &'a mut [f64],
}

impl OnVectors for AddChosen<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vector<Element = f64>>(self) {
        let Self {
            rows,
            chosen,
            width,
            sums,
        } = self;
        // SAFETY: the lengths were checked.
        unsafe {
            if V::WIDTH == GROUP {
                all::<V, 8>(rows, chosen, width, sums); // 24 of 32 registers hold sums
            } else {
                all::<V, 4>(rows, chosen, width, sums); // 12 of 16
            }
        }
    }
}

/// Tiles of `HEIGHT` lines by three vectors: their sums stay in registers.
#[inline(always)]
unsafe fn all<V: Vector<Element = f64>, const HEIGHT: usize>(
    rows: Rows<'_>,
    chosen: &[u32],
    width: usize,
    sums: &mut [f64],
) {
    let mut columns = Vec::with_capacity(width / V::WIDTH);
    for &panel in rows.panels {
        columns.extend((panel * GROUP..(1 + panel) * GROUP).step_by(V::WIDTH));
    }
    // SAFETY: a tile lies within panels, whose width is a multiple of both sizes.
    unsafe {
        if sums.len() == width {
            return line::<V, 1>(rows, chosen, width, sums, 0, &columns);
        }
        for (k, panel) in rows.panels.iter().enumerate() {
            let beside = &columns[k * (GROUP / V::WIDTH)..]; // from the diagonal to the right
            for first in (panel * GROUP..(1 + panel) * GROUP).step_by(HEIGHT) {
                line::<V, HEIGHT>(rows, chosen, width, sums, first, beside);
            }
        }
    }
}

/// Tiles of some lines beside each other.
#[inline(always)]
unsafe fn line<V: Vector<Element = f64>, const HEIGHT: usize>(
    rows: Rows<'_>,
    chosen: &[u32],
    width: usize,
    sums: &mut [f64],
    first: usize,
    columns: &[usize],
) {
    let (threes, rest) = columns.as_chunks::<3>();
    // SAFETY: the caller's.
    unsafe {
        for &three in threes {
            tile::<V, HEIGHT, 3>(rows, chosen, width, sums, first, three);
        }
        for &column in rest {
            tile::<V, HEIGHT, 1>(rows, chosen, width, sums, first, [column]);
        }
    }
}

#[inline(always)]
unsafe fn tile<V: Vector<Element = f64>, const HEIGHT: usize, const VECTORS: usize>(
    rows: Rows<'_>,
    chosen: &[u32],
    width: usize,
    sums: &mut [f64],
    line: usize,
    columns: [usize; VECTORS],
) {
    let mut own = [[V::constant(0.0); VECTORS]; HEIGHT];
    let target = sums.as_mut_ptr();
    let above = rows.column(line);
    let mut beside = [above; VECTORS];
    for j in 0..VECTORS {
        beside[j] = rows.column(columns[j]);
    }
    // SAFETY: the caller guarantees that the tile lies within the width, and has the rows.
    unsafe {
        for i in 0..HEIGHT {
            for j in 0..VECTORS {
                own[i][j] = V::load(target.add((line + i) * width + columns[j]));
            }
        }
        for &row in chosen {
            let at = row as usize * rows.row;
            let mut right = [V::constant(0.0); VECTORS];
            for j in 0..VECTORS {
                right[j] = V::load(beside[j].add(at));
            }
            for i in 0..HEIGHT {
                let left = V::constant(*above.add(at + i));
                for j in 0..VECTORS {
                    own[i][j] = added(left, right[j], own[i][j]);
                }
            }
        }
        for i in 0..HEIGHT {
            for j in 0..VECTORS {
                own[i][j].store(target.add((line + i) * width + columns[j]));
            }
        }
    }
}

/// `left right + sum`; fused on vectors, not on single numbers.
///
/// On a processor without fused multiply-add each fused operation is a call of some 3 ns, and a sum
/// of products is nothing else. So the sums differ between such a processor and another by rounding
/// (a few parts in 10^16 of the largest term), where everything in the physics has the same bits.
#[inline(always)]
pub(crate) fn added<V: Vector>(left: V, right: V, sum: V) -> V {
    if V::WIDTH == 1 {
        left * right + sum
    } else {
        left.mul_add(right, sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(at: usize) -> f64 {
        (at as f64 * 0.754_877).fract() - 0.5
    }

    #[test]
    fn products_of_every_pair_of_columns() {
        for width in [8, 16, 40, 64] {
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

    #[test]
    fn one_line_is_that_of_the_first_column() {
        let (width, count) = (40, 5);
        let numbers: Vec<f64> = (0..width * count).map(number).collect();
        let rows = Rows {
            numbers: &numbers,
            row: GROUP,
            panel: GROUP * count,
            panels: &[0, 1, 2, 3, 4],
        };
        let (mut whole, mut line) = (vec![0.0; width * width], vec![0.0; width]);
        add_chosen(rows, &[0, 2, 3], width, &mut whole);
        add_chosen(rows, &[0, 2, 3], width, &mut line);
        assert_eq!(whole[..width], line);
        let squares = [0, 2, 3].map(|row| number(row * GROUP) * number(row * GROUP));
        assert!((line[0] - squares.iter().sum::<f64>()).abs() < 1e-15);
    }
}

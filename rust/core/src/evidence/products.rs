//! Lag-0 and lag-1 products of columns, plain and with an exponential memory.
//!
//! Residuals of a logged sensor are rarely independent. White noise on top of a first-order
//! autoregression (Box, Jenkins & Reinsel 2008, section A4.3: an ARMA(1,1)) is whitened by
//! `e_t = x_t - rho x_(t-1) + memory e_(t-1)`. With `z_t = x_t + memory z_(t-1)` this is
//! `e_t = z_t - rho z_(t-1)`, so the lag-0 and lag-1 products of `z` give the products of `e` for
//! every `rho`; memory 0 is the plain autoregression. The pass keeps them per block of rows (for
//! hold-out) and, for the first column alone, per cell (for the unknown level of a stretch or the
//! error of a stand, which is a multiple of that column).

#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

/// How rows belong together.
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    /// Whether a row begins a new series: nothing is remembered across.
    pub starts: &'a [bool],
    /// The block of each row.
    pub blocks: &'a [u32],
    /// The cell of each row; a cell lies within one block.
    pub cells: &'a [u32],
    /// Number of blocks.
    pub block_count: usize,
    /// Number of cells.
    pub cell_count: usize,
}

/// Sums of products of `width` columns for one memory.
///
/// `present` sums `z_t z_t'` over rows that follow another row of their series, `previous` sums
/// `z_(t-1) z_(t-1)'`, `lagged` sums `z_t z_(t-1)'` over the same rows, `first` sums `z_t z_t'`
/// over rows that begin a series. Block sums are `width * width` each and symmetric except
/// `lagged`; cell sums are the row of the first column, where `lagged` holds the symmetric part
/// doubled.
#[derive(Clone, Debug, PartialEq)]
pub struct Products {
    /// Products per block: present, previous, lagged, first.
    pub blocks: [Vec<f64>; 4],
    /// Products of the first column per cell: present, previous, lagged (both ways), first.
    pub cells: [Vec<f64>; 4],
}

impl Products {
    /// One pass over `columns` (each as long as the table), remembering with factor `memory`.
    ///
    /// # Panics
    /// If the columns and the layout differ in length.
    #[must_use]
    pub fn gather(columns: &[&[f64]], layout: &Layout<'_>, memory: f64) -> Self {
        let width = columns.len();
        let rows = layout.starts.len();
        assert!(columns.iter().all(|column| column.len() == rows));
        let mut sums = Self {
            blocks: core::array::from_fn(|_| vec![0.0; layout.block_count * width * width]),
            cells: core::array::from_fn(|_| vec![0.0; layout.cell_count * width]),
        };
        let mut now = vec![0.0; width];
        let mut before = vec![0.0; width];
        let place = |row: usize| (layout.blocks[row] as usize, layout.cells[row] as usize);
        for row in 0..rows {
            core::mem::swap(&mut now, &mut before);
            let begins = layout.starts[row];
            let kept = if begins { 0.0 } else { memory };
            for ((z, &old), column) in now.iter_mut().zip(&before).zip(columns) {
                *z = kept * old + column[row];
            }
            let at = place(row);
            if begins {
                sums.add(3, at, 1.0, &now);
            } else {
                sums.add(0, at, 1.0, &now);
                sums.add_lagged(at, &now, &before);
                if place(row - 1) != at {
                    sums.add(1, at, 1.0, &before);
                }
            }
            let goes_on = row + 1 < rows && !layout.starts[row + 1] && place(row + 1) == at;
            if !goes_on {
                sums.add(1, at, -1.0, &now);
            }
        }
        sums.complete_previous();
        sums
    }

    /// Adds `sign z z'` to the sums of a kind.
    fn add(&mut self, kind: usize, (block, cell): (usize, usize), sign: f64, z: &[f64]) {
        let width = z.len();
        let area = block * width * width..(block + 1) * width * width;
        add_outer(&mut self.blocks[kind][area], sign, z, z);
        let line = cell * width..(cell + 1) * width;
        add_scaled(&mut self.cells[kind][line], sign * z[0], z);
    }

    fn add_lagged(&mut self, (block, cell): (usize, usize), now: &[f64], before: &[f64]) {
        let width = now.len();
        let area = block * width * width..(block + 1) * width * width;
        add_outer(&mut self.blocks[2][area], 1.0, now, before);
        let line = cell * width..(cell + 1) * width;
        add_scaled(&mut self.cells[2][line.clone()], now[0], before);
        add_scaled(&mut self.cells[2][line], before[0], now);
    }

    /// Every row precedes another but the last ones, which `previous` holds so far, negative.
    fn complete_previous(&mut self) {
        for sums in [&mut self.blocks, &mut self.cells] {
            let [present, previous, _, first] = sums;
            for ((sum, &p), &f) in previous.iter_mut().zip(&*present).zip(&*first) {
                *sum += p + f;
            }
        }
    }
}

/// `matrix += sign left right'`, row-major.
#[inline(always)]
fn add_outer(matrix: &mut [f64], sign: f64, left: &[f64], right: &[f64]) {
    for (line, &factor) in matrix.chunks_exact_mut(right.len()).zip(left) {
        add_scaled(line, sign * factor, right);
    }
}

/// `line += factor * values`.
#[inline(always)]
fn add_scaled(line: &mut [f64], factor: f64, values: &[f64]) {
    for (sum, &value) in line.iter_mut().zip(values) {
        *sum += factor * value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: [f64; 5] = [1.0; 5];
    const X: [f64; 5] = [1.0, -2.0, 4.0, 0.5, 3.0];

    fn layout<'a>(starts: &'a [bool], zeros: &'a [u32]) -> Layout<'a> {
        Layout {
            starts,
            blocks: zeros,
            cells: zeros,
            block_count: 1,
            cell_count: 1,
        }
    }

    /// Products of the whitened series, the slow and obvious way.
    fn whitened(starts: &[bool], rho: f64, memory: f64) -> f64 {
        let mut sum = 0.0;
        let mut e = [0.0; 5];
        for t in 0..5 {
            if starts[t] {
                e[t] = X[t];
            } else {
                e[t] = X[t] - rho * X[t - 1] + memory * e[t - 1];
                sum += e[t] * e[t];
            }
        }
        sum
    }

    #[test]
    fn lagged_products_give_the_whitened_series() {
        let starts = [true, false, false, false, false];
        let zeros = [0; 5];
        for (rho, memory) in [(0.3, 0.0), (0.9, 0.5)] {
            let p = Products::gather(&[&ONE, &X], &layout(&starts, &zeros), memory);
            let [present, previous, lagged, _] = &p.blocks;
            let sum = present[3] + rho * rho * previous[3] - 2.0 * rho * lagged[3];
            assert!((sum - whitened(&starts, rho, memory)).abs() < 1e-12);
        }
    }

    #[test]
    fn nothing_is_remembered_across_series() {
        let starts = [true, false, true, false, false];
        let zeros = [0; 5];
        let p = Products::gather(&[&ONE, &X], &layout(&starts, &zeros), 0.0);
        assert_eq!(p.blocks[3][3], 1.0 + 16.0);
        assert_eq!(p.blocks[2][3], -2.0 + 2.0 + 1.5);
        assert_eq!(p.cells[2], vec![6.0, -1.0 + 4.5 + 3.5]);
    }

    #[test]
    fn blocks_and_cells_add_up_to_the_whole() {
        let starts = [true, false, false, true, false];
        let parts = Layout {
            blocks: &[0, 0, 1, 1, 0],
            cells: &[0, 0, 1, 2, 3],
            block_count: 2,
            cell_count: 4,
            ..layout(&starts, &[])
        };
        let whole = Products::gather(&[&ONE, &X], &layout(&starts, &[0; 5]), 0.5);
        let parts = Products::gather(&[&ONE, &X], &parts, 0.5);
        for kind in 0..4 {
            for i in 0..4 {
                let sum = parts.blocks[kind][i] + parts.blocks[kind][4 + i];
                assert!((sum - whole.blocks[kind][i]).abs() < 1e-12, "kind {kind}");
            }
            for i in 0..2 {
                let sum: f64 = (0..4).map(|cell| parts.cells[kind][2 * cell + i]).sum();
                assert!((sum - whole.cells[kind][i]).abs() < 1e-12, "kind {kind}");
            }
        }
    }
}

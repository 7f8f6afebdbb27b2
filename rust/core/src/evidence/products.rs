//! Lag-0 and lag-1 products of columns, plain and with an exponential memory.
//!
//! Residuals of a logged sensor are rarely independent. White noise on top of a first-order
//! autoregression (Box, Jenkins & Reinsel 2008, section A4.3: an ARMA(1,1)) is whitened by
//! `e_t = x_t - rho x_(t-1) + memory e_(t-1)`. With `z_t = x_t + memory z_(t-1)` this is
//! `e_t = z_t - rho z_(t-1)`, so the lag-0 and lag-1 products of `z` give the products of `e` for
//! every `rho`; memory 0 is the plain autoregression. The pass keeps them per block of rows (for
//! hold-out) and, for the first column alone, per cell (for the unknown level of a stretch or the
//! error of a stand, which is a multiple of that column).
//!
//! Only symmetric products are summed, which halves the work: with `P` and `Q` the products of
//! `z_t` and of `z_(t-1)` and `X` those of `x_t`, the lag-1 products and their transpose add up to
//! `(P - X) / memory + memory Q`, and for memory 0 to `P + Q - D`, with `D` the products of
//! `x_t - x_(t-1)`.

#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::gram::GROUP;
use super::source::Source;
use super::spans::{Class, KINDS, Kinds, Parts, Plan, gathered};

/// How rows belong together.
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    /// Whether a row begins a new series: nothing is remembered across.
    pub starts: &'a [bool],
    /// The block of each row.
    pub blocks: &'a [u32],
    /// The cell of each row; a cell lies within one block.
    pub cells: &'a [u32],
    /// The distance of each row \[m\].
    pub distance: &'a [f64],
    /// Number of blocks.
    pub block_count: usize,
    /// Number of cells.
    pub cell_count: usize,
}

/// Sums of products of `width` columns for one memory.
///
/// `present` sums `z_t z_t'` over rows that follow another row of their series, `previous` sums
/// `z_(t-1) z_(t-1)'`, `lagged` sums the symmetric part of `z_t z_(t-1)'` over the same rows,
/// `first` sums `z_t z_t'` over rows that begin a series. Block sums are `width * width` each and
/// symmetric; cell sums are the row of the first column, where `lagged` is doubled. Sums over rows of
/// which there are none are empty.
#[derive(Clone, Debug, PartialEq)]
pub struct Products {
    /// Products per block: present, previous, lagged, first.
    pub blocks: [Vec<f64>; 4],
    /// Products of the first column per cell: present, previous, lagged (both ways), first.
    pub cells: [Vec<f64>; 4],
    /// Sum of the log variances that rows were whitened with, per block.
    pub log_variance: Vec<f64>,
}

impl Products {
    /// One pass over the rows of a source, on at most so many threads, remembering with each factor
    /// in `memories`. The sums do not depend on the number of threads.
    ///
    /// # Panics
    /// If the columns and the layout differ in length.
    #[must_use]
    pub fn gather(
        source: &dyn Source,
        layout: &Layout<'_>,
        memories: &[f64],
        threads: usize,
    ) -> Vec<Self> {
        let rows = layout.starts.len();
        assert!(source.rows() == rows);
        assert!(layout.blocks.len() == rows && layout.cells.len() == rows);
        let remembered: Vec<f64> = memories.iter().copied().filter(|&m| m != 0.0).collect();
        let plan = Plan {
            source,
            layout,
            memories: &remembered,
            width: source.width().next_multiple_of(GROUP),
        };
        let parts = gathered(&plan, threads);
        let of = |&memory: &f64| {
            let kind = remembered.iter().position(|&m| m == memory);
            Self::of(&plan, &parts, kind, memory)
        };
        memories.iter().map(of).collect()
    }

    /// The sums for one memory from those of the classes of rows.
    fn of(plan: &Plan<'_>, parts: &Parts, remembered: Option<usize>, memory: f64) -> Self {
        let (width, columns) = (plan.width, plan.source.width());
        let (blocks, cells) = (plan.layout.block_count, plan.layout.cell_count);
        let mut blocks = added(&parts.blocks, blocks, width * width, remembered, memory);
        blocks[2].iter_mut().for_each(|lagged| *lagged *= 0.5);
        let cells = added(&parts.cells, cells, width, remembered, memory);
        Self {
            blocks: blocks.map(|sums| triangles(&sums, width, columns)),
            cells: cells.map(|sums| narrow(&sums, width, columns)),
            log_variance: vec![0.0; plan.layout.block_count],
        }
    }
}

/// Sums of so many blocks or cells, `length` numbers each: present, previous, lagged both ways,
/// first.
fn added(
    classes: &Kinds,
    count: usize,
    length: usize,
    remembered: Option<usize>,
    memory: f64,
) -> [Vec<f64>; 4] {
    let none = |wanted: bool| vec![0.0; if wanted { count * length } else { 0 }];
    let follow = |class: &Class| !class.begins || class.next.is_some();
    let [mut present, mut previous, mut other] = [(); 3].map(|()| none(classes.keys().any(follow)));
    let mut first = none(classes.keys().any(|class| class.begins));
    let kind = remembered.map_or(0, |k| KINDS + k);
    // beside a memory the plain products, without one those of the differences
    let beside = if remembered.is_some() { 0 } else { 1 };
    let place = |at: u32| at as usize * length..(at as usize + 1) * length;
    for (class, sums) in classes {
        let own = if class.begins { &sums[0] } else { &sums[kind] };
        if let Some(next) = class.next {
            add(&mut previous[place(next)], own);
        }
        if class.begins {
            add(&mut first[place(class.own)], own);
        } else {
            add(&mut present[place(class.own)], own);
            add(&mut other[place(class.own)], &sums[beside]);
        }
    }
    for ((x, p), q) in other.iter_mut().zip(&present).zip(&previous) {
        *x = both_ways(*p, *q, *x, memory);
    }
    [present, previous, other, first]
}

/// Lag-1 products and their transpose, see the module.
fn both_ways(present: f64, previous: f64, other: f64, memory: f64) -> f64 {
    if memory == 0.0 {
        present + previous - other
    } else {
        (present - other) / memory + memory * previous
    }
}

/// `sums += more`.
fn add(sums: &mut [f64], more: &[f64]) {
    for (sum, &value) in sums.iter_mut().zip(more) {
        *sum += value;
    }
}

/// Lines without the padding.
pub(super) fn narrow(sums: &[f64], width: usize, columns: usize) -> Vec<f64> {
    let lines = sums.chunks_exact(width.max(1));
    lines.flat_map(|line| &line[..columns]).copied().collect()
}

/// Both triangles, without the padding.
pub(super) fn triangles(sums: &[f64], width: usize, columns: usize) -> Vec<f64> {
    let mut result = vec![0.0; sums.len() / (width * width).max(1) * columns * columns];
    let matrices = result.chunks_exact_mut((columns * columns).max(1));
    for (whole, upper) in matrices.zip(sums.chunks_exact((width * width).max(1))) {
        for i in 0..columns {
            let line = &upper[i * width + i..i * width + columns];
            whole[i * columns + i..(i + 1) * columns].copy_from_slice(line);
            for (j, &value) in (i..).zip(line) {
                whole[j * columns + i] = value;
            }
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::staged::Line;
    use crate::evidence::source::Reader;

    /// Columns in memory.
    struct Stored<'a>(&'a [&'a [f64]]);

    impl Source for Stored<'_> {
        fn width(&self) -> usize {
            self.0.len()
        }
        fn rows(&self) -> usize {
            self.0[0].len()
        }
        fn reader(&self) -> Box<dyn Reader + '_> {
            Box::new(Stored(self.0))
        }
    }

    impl Reader for Stored<'_> {
        fn read(&mut self, first: usize, count: usize, into: &mut [Line]) {
            for (line, column) in into.iter_mut().zip(self.0) {
                line.0[..count].copy_from_slice(&column[first..first + count]);
            }
        }
    }

    const ONE: [f64; 5] = [1.0; 5];
    const X: [f64; 5] = [1.0, -2.0, 4.0, 0.5, 3.0];

    fn layout<'a>(starts: &'a [bool], zeros: &'a [u32]) -> Layout<'a> {
        Layout {
            starts,
            blocks: zeros,
            cells: zeros,
            distance: &ONE,
            block_count: 1,
            cell_count: 1,
        }
    }

    fn gather(layout: &Layout<'_>, memory: f64) -> Products {
        let mut all = Products::gather(&Stored(&[&ONE, &X]), layout, &[0.0, 0.5], 1);
        all.swap_remove(usize::from(memory != 0.0))
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
            let p = gather(&layout(&starts, &zeros), memory);
            let [present, previous, lagged, _] = &p.blocks;
            let sum = present[3] + rho * rho * previous[3] - 2.0 * rho * lagged[3];
            assert!((sum - whitened(&starts, rho, memory)).abs() < 1e-12);
        }
    }

    #[test]
    fn nothing_is_remembered_across_series() {
        let starts = [true, false, true, false, false];
        let zeros = [0; 5];
        let p = gather(&layout(&starts, &zeros), 0.0);
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
        let whole = gather(&layout(&starts, &[0; 5]), 0.5);
        let parts = gather(&parts, 0.5);
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

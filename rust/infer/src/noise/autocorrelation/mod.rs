//! White noise on top of a first-order autoregression, an ARMA(1,1): docs/method.md, Eq. 3, and docs/method/noises.md, Eq. 10.
//!
//! Residuals of a logged sensor are rarely independent. White noise on top of a first-order
//! autoregression (Box, Jenkins & Reinsel 2008, section A4.3: an ARMA(1,1)) is whitened by
//! `e_t = x_t - rho x_(t-1) + m e_(t-1)`, with `m` the moving-average coefficient. With
//! `z_t = x_t + m z_(t-1)` this is `e_t = z_t - rho z_(t-1)`, so the lag-0 and lag-1 products of `z`
//! give the products of `e` for every `rho`; `m = 0` is the plain autoregression. The pass keeps them
//! per block of rows (for cross-validation) and, for the first column alone, per cell (for the unknown
//! level of a segment or the error of a station, which is a multiple of that column).
//!
//! The first row of a series has no innovation before it: `z` begins with the value itself. That is
//! exact for `m = 0`. For `m > 0` it is an approximation that the next rows forget as powers of `m`.
//!
//! Only symmetric products are summed, which halves the work: with `P` and `Q` the products of
//! `z_t` and of `z_(t-1)` and `X` those of `x_t`, the lag-1 products and their transpose add up to
//! `(P - X) / m + m Q`, and for `m = 0` to `P + Q - D`, with `D` the products of
//! `x_t - x_(t-1)`.

#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

mod span;

use super::correlation::{Autoregression, Correlation};
use crate::gram::{Class, ClassSums, Edge, GROUP, LagProducts, RowLayout, Source, add, mirrored};
use span::{KINDS, Parts, Plan, gathered};

/// The moving-average part of an ARMA(1,1); one pass serves every autoregressive coefficient.
///
/// Covariance of lag k in units of the innovations: rho^(k-1) (rho - m) (1 - rho m) / (1 - rho^2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingAverage {
    /// Moving-average coefficient `m`, 0 for a plain autoregression.
    pub coefficient: f64,
}

impl Correlation for MovingAverage {
    /// One pass over the rows for all coefficients.
    fn gather(
        source: &dyn Source,
        layout: &RowLayout<'_>,
        models: &[Self],
        threads: usize,
    ) -> Vec<LagProducts> {
        let rows = layout.starts.len();
        assert!(source.rows() == rows);
        assert!(layout.blocks.len() == rows && layout.cells.len() == rows);
        let all = models.iter().map(|model| model.coefficient);
        let coefficients: Vec<f64> = all.clone().filter(|&m| m != 0.0).collect();
        let plan = Plan {
            source,
            layout,
            edges: &edges(layout),
            coefficients: &coefficients,
            width: source.width().next_multiple_of(GROUP),
        };
        let parts = gathered(&plan, threads);
        let of = |coefficient: f64| {
            let place = coefficients.iter().position(|&m| m == coefficient);
            products(&plan, &parts, place, coefficient)
        };
        all.map(of).collect()
    }

    /// `e_t = z_t - rho z_(t-1)`: docs/method.md, Eq. 3. The first row of a series has the variance of
    /// the process; for `m > 0` it and the rows after it are approximate.
    fn whitened(
        self,
        autoregression: Autoregression,
        values: &[f64],
        starts: &[bool],
        _distance: &[f64],
    ) -> (Vec<f64>, f64) {
        assert!(values.len() == starts.len());
        let Autoregression { rho, first_weight } = autoregression;
        let (mut kept, mut series) = (0.0, 0);
        let white = values.iter().zip(starts).map(|(&value, &begins)| {
            let before = kept;
            kept = value;
            if begins {
                series += 1;
                return first_weight.sqrt() * value;
            }
            kept += self.coefficient * before;
            kept - rho * before
        });
        let white = white.collect();
        (white, -f64::from(series) * first_weight.ln())
    }

    #[cfg(test)]
    fn examples() -> Vec<(Self, f64)> {
        [(0.0, 0.6), (0.0, -0.3), (0.5, 0.9), (0.3, 0.5)]
            .map(|(coefficient, rho)| (Self { coefficient }, rho))
            .into()
    }

    #[cfg(test)]
    fn covariance(self, rho: f64, lag: usize, _distances: [f64; 2]) -> f64 {
        let m = self.coefficient;
        if lag == 0 {
            return (1.0 + m * m - 2.0 * rho * m) / (1.0 - rho * rho);
        }
        rho.powi(lag as i32 - 1) * (rho - m) * (1.0 - rho * m) / (1.0 - rho * rho)
    }
}

/// The sums for one coefficient from those of the classes of rows.
fn products(plan: &Plan<'_>, parts: &Parts, place: Option<usize>, coefficient: f64) -> LagProducts {
    let (width, columns) = (plan.width, plan.source.width());
    let (blocks, cells) = (plan.layout.block_count, plan.layout.cell_count);
    let placed = |classes, count| Placed::of(classes, count, place, coefficient);
    let half = |upper: &mut [f64], into: &mut [f64]| mirrored(upper, width, columns, into);
    let line = |sums: &mut [f64], into: &mut [f64]| into.copy_from_slice(&sums[..columns]);
    let mut blocks = placed(&parts.blocks, blocks).sums(width * width, columns * columns, half);
    blocks[2].iter_mut().for_each(|lagged| *lagged *= 0.5);
    LagProducts {
        blocks,
        cells: placed(&parts.cells, cells).sums(width, columns, line),
        log_variance: vec![0.0; plan.layout.block_count],
        edges: of_edges(plan, parts, place),
    }
}

/// First rows of blocks that follow a row of another block in their series; the first of all follows none.
fn edges(layout: &RowLayout<'_>) -> Vec<usize> {
    let mut seen = vec![false; layout.block_count];
    let first = |&row: &usize| !core::mem::replace(&mut seen[layout.blocks[row] as usize], true);
    let firsts = (0..layout.starts.len()).filter(first);
    firsts
        .filter(|&row| row > 0 && !layout.starts[row])
        .collect()
}

/// These rows for one coefficient.
fn of_edges(plan: &Plan<'_>, parts: &Parts, place: Option<usize>) -> Vec<Edge> {
    let columns = plan.source.width();
    let narrow = |row: &Vec<f64>| row[..columns].to_vec();
    let of = |(&row, kinds): (&usize, &Vec<[Vec<f64>; 2]>)| {
        let [own, previous] = &kinds[place.map_or(0, |k| 1 + k)];
        Edge {
            block: plan.layout.blocks[row] as usize,
            before: plan.layout.blocks[row - 1] as usize,
            cell: plan.layout.cells[row] as usize,
            plain: narrow(&kinds[0][0]),
            own: narrow(own),
            previous: narrow(previous),
        }
    };
    parts.edges.iter().map(of).collect()
}

/// Sums of the classes of rows that count in a block or a cell: those of its own rows, and of the rows before
/// these.
type OfPlace<'a> = [Vec<(Class, &'a [Vec<f64>])>; 2];

/// Classes of rows by the block or the cell that they count in.
struct Placed<'a> {
    places: Vec<OfPlace<'a>>,
    /// Kind of the products.
    kind: usize,
    /// Kind of the products beside them, from which the lag-1 products follow.
    beside: usize,
    coefficient: f64,
}

impl<'a> Placed<'a> {
    fn of(
        classes: &'a ClassSums,
        count: usize,
        filter: Option<usize>,
        coefficient: f64,
    ) -> Self {
        let mut places = vec![[const { Vec::new() }; 2]; count];
        for (&class, sums) in classes {
            places[class.own as usize][0].push((class, &sums[..]));
            if let Some(next) = class.next {
                places[next as usize][1].push((class, &sums[..]));
            }
        }
        Self {
            places,
            kind: filter.map_or(0, |k| KINDS + k),
            // beside a coefficient the plain products, without one those of the differences
            beside: if filter.is_some() { 0 } else { 1 },
            coefficient,
        }
    }

    /// Sums of all places, `length` numbers each: present, previous, lagged both ways, first. Each is kept as
    /// `kept` numbers. One place is summed at a time, in memory that stays in the cache.
    fn sums(
        &self,
        length: usize,
        kept: usize,
        keep: impl Fn(&mut [f64], &mut [f64]),
    ) -> [Vec<f64>; 4] {
        let all = self.places.iter().flatten().flatten();
        let (mut begins, mut follow) = (false, false);
        for (class, _) in all {
            begins |= class.begins;
            follow |= !class.begins || class.next.is_some();
        }
        let mut own = [(); 4].map(|()| vec![0.0; length]);
        let wanted = [follow, follow, follow, begins];
        let mut found = wanted.map(|wanted| vec![0.0; if wanted { self.places.len() * kept } else { 0 }]);
        for place in 0..self.places.len() {
            self.add(place, &mut own);
            for (sums, into) in own.iter_mut().zip(&mut found) {
                if let Some(into) = into.get_mut(place * kept..(place + 1) * kept) {
                    keep(sums, into);
                }
            }
        }
        found
    }

    /// The sums of one place.
    fn add(&self, place: usize, [present, previous, other, first]: &mut [Vec<f64>; 4]) {
        for sums in [&mut *present, previous, other, first] {
            sums.fill(0.0);
        }
        let kind = |class: &Class| if class.begins { 0 } else { self.kind };
        let [own, before] = &self.places[place];
        for (class, sums) in before {
            add(previous, &sums[kind(class)]);
        }
        for (class, sums) in own {
            if class.begins {
                add(first, &sums[0]);
            } else {
                add(present, &sums[self.kind]);
                add(other, &sums[self.beside]);
            }
        }
        for ((x, p), q) in other.iter_mut().zip(&*present).zip(&*previous) {
            *x = both_ways(*p, *q, *x, self.coefficient);
        }
    }
}

/// Lag-1 products and their transpose; see the module.
fn both_ways(present: f64, previous: f64, other: f64, coefficient: f64) -> f64 {
    if coefficient == 0.0 {
        present + previous - other
    } else {
        (present - other) / coefficient + coefficient * previous
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::FromParts;
    use crate::gram::Stored;
    use crate::noise::{NoiseModel, TableSums};

    const ONE: [f64; 5] = [1.0; 5];
    const X: [f64; 5] = [1.0, -2.0, 4.0, 0.5, 3.0];

    fn layout<'a>(starts: &'a [bool], zeros: &'a [u32]) -> RowLayout<'a> {
        RowLayout {
            starts,
            blocks: zeros,
            cells: zeros,
            distance: &ONE,
            block_count: 1,
            cell_count: 1,
        }
    }

    fn gather(layout: &RowLayout<'_>, coefficient: f64) -> LagProducts {
        let both = [0.0, 0.5].map(|coefficient| MovingAverage { coefficient });
        let stored = Stored(vec![&ONE, &X]);
        let mut all = MovingAverage::gather(&stored, layout, &both, 1);
        all.swap_remove(usize::from(coefficient != 0.0))
    }

    /// Products of the whitened series, the slow and obvious way.
    fn whitened(starts: &[bool], rho: f64, m: f64) -> f64 {
        let mut sum = 0.0;
        let mut e = [0.0; 5];
        for t in 0..5 {
            if starts[t] {
                e[t] = X[t];
            } else {
                e[t] = X[t] - rho * X[t - 1] + m * e[t - 1];
                sum += e[t] * e[t];
            }
        }
        sum
    }

    #[test]
    fn lagged_products_give_the_whitened_series() {
        let starts = [true, false, false, false, false];
        let zeros = [0; 5];
        for (rho, m) in [(0.3, 0.0), (0.9, 0.5)] {
            let p = gather(&layout(&starts, &zeros), m);
            let [present, previous, lagged, _] = &p.blocks;
            let sum = present[3] + rho * rho * previous[3] - 2.0 * rho * lagged[3];
            assert!((sum - whitened(&starts, rho, m)).abs() < 1e-12);
        }
    }

    #[test]
    fn nothing_is_carried_across_series() {
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
        let parts = RowLayout {
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

    fn sums(layout: &RowLayout<'_>, source: Stored<'_>, coefficient: f64) -> TableSums {
        let model = [MovingAverage { coefficient }];
        TableSums {
            products: vec![MovingAverage::gather(&source, layout, &model, 1).remove(0).into()],
            columns: FromParts::same(2).into(),
            cells: (0..layout.cell_count).map(|cell| (cell, cell)).collect(),
            series: vec![1.0, 0.0][..layout.block_count].to_vec(),
            flat_level: false,
            finite: vec![true; 2],
        }
    }

    #[test]
    fn a_block_without_the_one_before_begins_a_series() {
        let starts = [true, false, false, false, false];
        let both = RowLayout {
            blocks: &[0, 0, 1, 1, 1],
            cells: &[0, 0, 1, 1, 1],
            block_count: 2,
            cell_count: 2,
            ..layout(&starts, &[])
        };
        let noise = NoiseModel {
            correlation: 0,
            rho: 0.9,
            station_ratio: 0.3,
            first_weight: 0.2,
            log_prior: 0.0,
        };
        let whole = sums(&both, Stored(vec![&ONE, &X]), 0.0);
        let alone = sums(&layout(&starts[..3], &[0; 3]), Stored(vec![&ONE[2..], &X[2..]]), 0.0);
        let (found, weight) = whole.whiten(&[noise], &[false, true], &[0, 1], 1);
        let (expected, own) = alone.whiten(&[noise], &[true], &[0, 1], 1);
        for (found, expected) in found.iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert!((weight[0] - own[0]).abs() < 1e-12);
        let (used, _) = whole.whiten(&[noise], &[true, true], &[0, 1], 1);
        let [present, previous, lagged, first] = &whole.products[0].blocks;
        let sum = |kind: &[f64]| kind[3] + kind[7];
        let square = sum(present) + 0.81 * sum(previous) - 1.8 * sum(lagged) + 0.2 * sum(first);
        assert!(used[3] < square); // the errors of stations are taken off, and no series begins beside
    }
}

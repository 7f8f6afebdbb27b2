//! Products of whitened columns, for many noises at once.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::shared_error::{SharedError, take_off};
use crate::columns::FromParts;
use crate::gram::{Edge, LagProducts, add};
use crate::parallel::fill_each;
use std::sync::Arc;

/// Correlated noise with one set of parameters, and a random error that the rows of a station share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseModel {
    /// Position of its correlation among the sums.
    pub correlation: usize,
    /// Autoregressive coefficient; of a convection, whose sums are of white rows, 0.
    pub rho: f64,
    /// Variance of the error that all rows of a station share, over that of the innovations.
    pub station_ratio: f64,
    /// Innovation variance over the variance of the process: the weight of a series' first row.
    pub first_weight: f64,
    /// Log of its probability before the data.
    pub log_prior: f64,
}

/// What passes over a table leave. It is not changed; what is made from it shares its sums.
#[derive(Clone, Debug)]
pub struct TableSums {
    /// Sums of the parts of the columns, for each correlation.
    pub products: Vec<Arc<LagProducts>>,
    /// How the columns are made of these parts; the first column is the first part.
    pub columns: Arc<FromParts>,
    /// Block and group (segment, or station) of each cell; groups count from 0, none without a cell.
    pub cells: Vec<(usize, usize)>,
    /// Series that begin in each block.
    pub series: Vec<f64>,
    /// Whether groups have an unknown level (nothing known about it) or a random error.
    pub flat_level: bool,
    /// Whether each part is finite, once that is known.
    pub finite: Vec<bool>,
}

/// Sums of the parts over some blocks for one correlation: present, previous, lagged, first.
struct Merged {
    all: [Vec<f64>; 4],
    groups: [Vec<f64>; 4],
    log_variance: f64,
    /// Series that begin only because the block before is not in use.
    further_series: f64,
}

/// What one thread works with.
#[derive(Default)]
struct Memory {
    parts: Vec<f64>,
    groups: Vec<f64>,
    shrunken: Vec<f64>,
    taken: Vec<f64>,
}

impl TableSums {
    /// Number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.columns.columns()
    }

    /// Whitened products (docs/method.md, Eq. 9) of some columns, the first among them, under each noise, one matrix after
    /// the other, with what the noise adds to the log evidence of every hypothesis, over the blocks
    /// in use.
    #[must_use]
    pub fn whiten(
        &self,
        noises: &[NoiseModel],
        used: &[bool],
        chosen: &[usize],
        threads: usize,
    ) -> (Vec<f64>, Vec<f64>) {
        let lines = self.lines(used);
        let series: f64 = (self.series.iter().zip(used))
            .filter_map(|(&series, &used)| used.then_some(series))
            .sum();
        let merged: Vec<Option<Merged>> = (0..self.products.len())
            .map(|correlation| {
                let wanted = noises.iter().any(|noise| noise.correlation == correlation);
                wanted.then(|| self.merged(correlation, used, &lines))
            })
            .collect();
        let mut products = vec![0.0; noises.len() * chosen.len() * chosen.len()];
        let weights = fill_each(noises, &mut products, threads, || {
            let mut memory = Memory::default();
            let merged = &merged;
            move |noise: &NoiseModel, into: &mut [f64]| {
                merged[noise.correlation].as_ref().map_or(0.0, |sums| {
                    let weight = self.whitened(noise, sums, series, &mut memory);
                    self.columns.products(&mut memory.parts, chosen, into);
                    weight
                })
            }
        });
        (products, weights)
    }

    /// Which line of group sums each cell adds to; none where its block is not in use.
    fn lines(&self, used: &[bool]) -> (Vec<Option<usize>>, usize) {
        let mut place = vec![None; self.cells.len()]; // as many groups there are at most
        let mut count = 0;
        let line = |&(block, group): &(usize, usize)| {
            used[block].then(|| {
                *place[group].get_or_insert_with(|| {
                    count += 1;
                    count - 1
                })
            })
        };
        let lines = self.cells.iter().map(line).collect();
        (lines, count)
    }

    fn merged(
        &self,
        correlation: usize,
        used: &[bool],
        lines: &(Vec<Option<usize>>, usize),
    ) -> Merged {
        let width = self.columns.parts();
        let own = &self.products[correlation];
        let mut all = [(); 4].map(|()| vec![0.0; width * width]);
        for (sums, blocks) in all.iter_mut().zip(&own.blocks) {
            let each = blocks.chunks_exact((width * width).max(1)).zip(used);
            for (block, _) in each.filter(|&(_, &used)| used) {
                add(sums, block);
            }
        }
        let mut groups = [(); 4].map(|()| vec![0.0; lines.1 * width]);
        for (sums, cells) in groups.iter_mut().zip(&own.cells) {
            for (cell, line) in cells.chunks_exact(width.max(1)).zip(&lines.0) {
                if let Some(line) = line {
                    add(&mut sums[line * width..][..width], cell);
                }
            }
        }
        let cut = |edge: &&Edge| used[edge.block] && !used[edge.before];
        let mut further_series = 0.0;
        for edge in own.edges.iter().filter(cut) {
            edge.begin(&mut all, 0, width, 0.5);
            if let Some(line) = lines.0[edge.cell] {
                edge.begin(&mut groups, line * width, 1, 1.0);
            }
            further_series += 1.0;
        }
        let each = own.log_variance.iter().zip(used);
        let log_variance = each.filter(|&(_, &used)| used).map(|(log, _)| log).sum();
        Merged {
            all,
            groups,
            log_variance,
            further_series,
        }
    }

    /// Whitens the products of the parts, docs/method.md, Eq. 9, and docs/method/noises.md, Eq. 10; returns
    /// the weight of the noise: its prior, and `-1/2 ln det V` of docs/method.md, Eq. 13.
    fn whitened(&self, noise: &NoiseModel, sums: &Merged, series: f64, memory: &mut Memory) -> f64 {
        let (rho, first_weight) = (noise.rho, noise.first_weight);
        let Memory {
            parts,
            groups,
            shrunken,
            taken,
        } = memory;
        parts.resize(sums.all[0].len(), 0.0);
        groups.resize(sums.groups[0].len(), 0.0);
        combine(&sums.all, [1.0, rho * rho, -2.0 * rho, first_weight], parts);
        combine(&sums.groups, [1.0, rho * rho, -rho, first_weight], groups);
        let error = if self.flat_level {
            SharedError::UnknownLevel
        } else {
            SharedError::Random(noise.station_ratio)
        };
        let of_groups = take_off(error, groups, parts, shrunken, taken);
        let series = series + sums.further_series;
        noise.log_prior + 0.5 * series * first_weight.ln() - 0.5 * sums.log_variance + of_groups
    }

    /// The same with zero in place of columns that are not finite; `finite` says which they are.
    ///
    /// # Panics
    /// If there are no sums.
    #[must_use]
    pub fn without_infinite(&self) -> Self {
        let width = self.columns.parts();
        let area = width * width;
        let squares = |kind: &Vec<f64>, column: usize| -> f64 {
            kind.chunks_exact(area)
                .map(|block| block[column * width + column])
                .sum()
        };
        let finite: Vec<bool> = (0..width)
            .map(|column| {
                let [present, .., first] = &self.products[0].blocks;
                (squares(present, column) + squares(first, column)).is_finite()
            })
            .collect();
        let columns = self.columns.finite(finite.clone());
        Self {
            products: cleared(&self.products, &finite),
            columns: Arc::new(self.columns.without(&columns)),
            finite,
            ..self.clone()
        }
    }

    /// Whether each column is finite, once that is known.
    #[must_use]
    pub fn finite_columns(&self) -> Vec<bool> {
        self.columns.finite(self.finite.clone())
    }

    /// These sums and those of one more pass over the same rows and columns; the parts that are zero
    /// here become zero there.
    #[must_use]
    pub fn joined(&self, more: &Self) -> Self {
        let further = cleared(&more.products, &self.finite);
        Self {
            products: self.products.iter().cloned().chain(further).collect(),
            ..self.clone()
        }
    }
}

/// The same sums, with zero for columns that are not finite.
fn cleared(sums: &[Arc<LagProducts>], finite: &[bool]) -> Vec<Arc<LagProducts>> {
    let mut sums = sums.to_vec();
    if finite.contains(&false) {
        for own in &mut sums {
            clear(Arc::make_mut(own), finite);
        }
    }
    sums
}

/// Makes columns zero that are not finite.
fn clear(own: &mut LagProducts, finite: &[bool]) {
    let width = finite.len();
    let each = |kind: &mut Vec<f64>, lost: &dyn Fn(usize) -> bool| {
        for (at, sum) in kind.iter_mut().enumerate() {
            if lost(at) {
                *sum = 0.0;
            }
        }
    };
    for kind in &mut own.blocks {
        each(kind, &|at| {
            !(finite[at % width] && finite[at / width % width])
        });
    }
    for kind in &mut own.cells {
        each(kind, &|at| !finite[at % width]);
    }
    for edge in &mut own.edges {
        for kind in [&mut edge.plain, &mut edge.own, &mut edge.previous] {
            each(kind, &|at| !finite[at]);
        }
    }
}

fn combine(sums: &[Vec<f64>; 4], factors: [f64; 4], into: &mut [f64]) {
    let [present, previous, lagged, first] = sums;
    let rows = present.iter().zip(previous).zip(lagged).zip(first);
    for (sum, (((a, b), c), d)) in into.iter_mut().zip(rows) {
        *sum = factors[0] * a + factors[1] * b + factors[2] * c + factors[3] * d;
    }
}

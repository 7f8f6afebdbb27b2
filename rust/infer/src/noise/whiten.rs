//! Products of whitened columns, for many noises at once.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::shared_error::{SharedError, take_off};
use crate::gram::LagProducts;
use crate::parallel::fill_each;

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

/// What one pass over a table leaves.
#[derive(Clone, Debug)]
pub struct TableSums {
    /// Sums for each correlation.
    pub products: Vec<LagProducts>,
    /// Number of columns.
    pub width: usize,
    /// Block and group (segment, or station) of each cell; groups count from 0, none without a cell.
    pub cells: Vec<(usize, usize)>,
    /// Series that begin in each block.
    pub series: Vec<f64>,
    /// Whether groups have an unknown level (nothing known about it) or a random error.
    pub flat_level: bool,
    /// Whether each column is finite, once that is known.
    pub finite: Vec<bool>,
}

/// Sums over some blocks for one correlation: present, previous, lagged, first.
struct Merged {
    all: [Vec<f64>; 4],
    groups: [Vec<f64>; 4],
    log_variance: f64,
}

impl TableSums {
    /// Whitened products of some columns, the first among them, under each noise, one matrix after
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
                wanted.then(|| self.merged(correlation, used, &lines, chosen))
            })
            .collect();
        let mut products = vec![0.0; noises.len() * chosen.len() * chosen.len()];
        let weights = fill_each(noises, &mut products, threads, || {
            let (mut shrunken, mut taken) = (Vec::new(), Vec::new());
            let merged = &merged;
            move |noise: &NoiseModel, into: &mut [f64]| {
                merged[noise.correlation].as_ref().map_or(0.0, |sums| {
                    self.whitened(noise, sums, series, into, [&mut shrunken, &mut taken])
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
        chosen: &[usize],
    ) -> Merged {
        let (width, kept) = (self.width, chosen.len());
        let own = &self.products[correlation];
        let mut all = [(); 4].map(|()| vec![0.0; kept * kept]);
        for (sums, blocks) in all.iter_mut().zip(&own.blocks) {
            let each = blocks.chunks_exact((width * width).max(1)).zip(used);
            for (block, _) in each.filter(|&(_, &used)| used) {
                for (sums, &row) in sums.chunks_exact_mut(kept.max(1)).zip(chosen) {
                    add(sums, &block[row * width..][..width], chosen);
                }
            }
        }
        let mut groups = [(); 4].map(|()| vec![0.0; lines.1 * kept]);
        for (sums, cells) in groups.iter_mut().zip(&own.cells) {
            for (cell, line) in cells.chunks_exact(width.max(1)).zip(&lines.0) {
                if let Some(line) = line {
                    add(&mut sums[line * kept..][..kept], cell, chosen);
                }
            }
        }
        let each = own.log_variance.iter().zip(used);
        let log_variance = each.filter(|&(_, &used)| used).map(|(log, _)| log).sum();
        Merged {
            all,
            groups,
            log_variance,
        }
    }

    /// Fills one matrix, with memory for sums over groups; returns the weight of the noise.
    fn whitened(
        &self,
        noise: &NoiseModel,
        sums: &Merged,
        series: f64,
        into: &mut [f64],
        [shrunken, taken]: [&mut Vec<f64>; 2],
    ) -> f64 {
        let (rho, first_weight) = (noise.rho, noise.first_weight);
        combine(&sums.all, [1.0, rho * rho, -2.0 * rho, first_weight], into);
        let mut groups = vec![0.0; sums.groups[0].len()];
        combine(
            &sums.groups,
            [1.0, rho * rho, -rho, first_weight],
            &mut groups,
        );
        let mut weight =
            noise.log_prior + 0.5 * series * first_weight.ln() - 0.5 * sums.log_variance;
        let error = if self.flat_level {
            SharedError::UnknownLevel
        } else {
            SharedError::Random(noise.station_ratio)
        };
        weight += take_off(error, &groups, into, shrunken, taken);
        weight
    }

    /// Whether each column is finite; those that are not become zero.
    pub fn clear_infinite(&mut self) -> Vec<bool> {
        let width = self.width;
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
        self.products.iter_mut().for_each(|own| clear(own, &finite));
        self.finite.clone_from(&finite);
        finite
    }

    /// Adds the sums of one more pass over the same rows and columns.
    pub fn join(&mut self, more: Vec<LagProducts>) {
        for mut own in more {
            clear(&mut own, &self.finite);
            self.products.push(own);
        }
    }
}

/// Makes columns zero that are not finite.
fn clear(own: &mut LagProducts, finite: &[bool]) {
    if finite.iter().all(|&finite| finite) {
        return;
    }
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
}

fn combine(sums: &[Vec<f64>; 4], factors: [f64; 4], into: &mut [f64]) {
    let [present, previous, lagged, first] = sums;
    let rows = present.iter().zip(previous).zip(lagged).zip(first);
    for (sum, (((a, b), c), d)) in into.iter_mut().zip(rows) {
        *sum = factors[0] * a + factors[1] * b + factors[2] * c + factors[3] * d;
    }
}

/// `sums += more`, of some columns.
fn add(sums: &mut [f64], more: &[f64], chosen: &[usize]) {
    if chosen.len() == more.len() {
        for (sum, &value) in sums.iter_mut().zip(more) {
            *sum += value;
        }
    } else {
        for (sum, &column) in sums.iter_mut().zip(chosen) {
            *sum += more[column];
        }
    }
}

//! Products of whitened columns, for many noises at once.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::gram::{GROUP, add_products};
use super::products::Products;
use super::threaded::each_of;

/// White noise on a first-order autoregression, with a random error per stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Position of its moving-average coefficient among the memories of the sums.
    pub memory: usize,
    /// Autoregressive coefficient.
    pub rho: f64,
    /// Variance of the error that all rows of a stand share, over that of the innovations.
    pub stand_ratio: f64,
    /// Innovation variance over the variance of the process: the weight of a series' first row.
    pub first_weight: f64,
    /// Log of its probability before the data.
    pub log_prior: f64,
}

/// What one pass over a table leaves.
#[derive(Clone, Debug)]
pub struct Sums {
    /// Sums for each memory.
    pub products: Vec<Products>,
    /// Number of columns.
    pub width: usize,
    /// Block and group (stretch, or stand) of each cell.
    pub cells: Vec<(usize, usize)>,
    /// Series that begin in each block.
    pub series: Vec<f64>,
    /// Whether groups have an unknown level (nothing known about it) or a random error.
    pub flat_level: bool,
}

/// Sums over some blocks for one memory: present, previous, lagged, first.
struct Merged {
    all: [Vec<f64>; 4],
    groups: [Vec<f64>; 4],
}

impl Sums {
    /// Whitened products under each noise, one matrix after the other, with what the noise adds to
    /// the log evidence of every hypothesis, over the blocks in use.
    #[must_use]
    pub fn whiten(&self, noises: &[Noise], used: &[bool], threads: usize) -> (Vec<f64>, Vec<f64>) {
        let lines = self.lines(used);
        let series: f64 = (self.series.iter().zip(used))
            .filter_map(|(&series, &used)| used.then_some(series))
            .sum();
        let merged: Vec<Option<Merged>> = (0..self.products.len())
            .map(|memory| {
                let wanted = noises.iter().any(|noise| noise.memory == memory);
                wanted.then(|| self.merged(memory, used, &lines))
            })
            .collect();
        let whitened = each_of(noises, threads, || {
            |noise: &Noise| {
                let sums = merged[noise.memory].as_ref();
                sums.map(|sums| self.whitened(noise, sums, series))
            }
        });
        let mut products = Vec::with_capacity(noises.len() * self.width * self.width);
        let mut weights = Vec::with_capacity(noises.len());
        for (matrix, weight) in whitened.into_iter().flatten() {
            products.extend(matrix);
            weights.push(weight);
        }
        (products, weights)
    }

    /// The sums of some columns alone, in this order.
    #[must_use]
    pub fn narrow(&self, chosen: &[usize]) -> Self {
        let width = self.width;
        let block = |values: &[f64]| -> Vec<f64> {
            let line = |&i: &usize| chosen.iter().map(move |&j| values[i * width + j]);
            chosen.iter().flat_map(line).collect()
        };
        let own = |sums: &Products| Products {
            blocks: sums.blocks.each_ref().map(|kind| {
                let blocks = kind.chunks_exact((width * width).max(1));
                blocks.flat_map(block).collect()
            }),
            cells: sums.cells.each_ref().map(|kind| {
                let cells = kind.chunks_exact(width.max(1));
                let some = |cell: &[f64]| -> Vec<f64> { chosen.iter().map(|&j| cell[j]).collect() };
                cells.flat_map(some).collect()
            }),
        };
        Self {
            products: self.products.iter().map(own).collect(),
            width: chosen.len(),
            cells: self.cells.clone(),
            series: self.series.clone(),
            flat_level: self.flat_level,
        }
    }

    /// Which line of group sums each cell adds to; none where its block is not in use.
    fn lines(&self, used: &[bool]) -> (Vec<Option<usize>>, usize) {
        let most = self
            .cells
            .iter()
            .map(|&(_, group)| group + 1)
            .max()
            .unwrap_or(0);
        let mut place = vec![None; most];
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

    fn merged(&self, memory: usize, used: &[bool], lines: &(Vec<Option<usize>>, usize)) -> Merged {
        let (area, width) = (self.width * self.width, self.width);
        let own = &self.products[memory];
        let mut all = [(); 4].map(|()| vec![0.0; area]);
        for (sums, blocks) in all.iter_mut().zip(&own.blocks) {
            for (block, _) in used.iter().enumerate().filter(|&(_, &used)| used) {
                add(sums, &blocks[block * area..(block + 1) * area]);
            }
        }
        let mut groups = [(); 4].map(|()| vec![0.0; lines.1 * width]);
        for (sums, cells) in groups.iter_mut().zip(&own.cells) {
            for (cell, line) in lines.0.iter().enumerate() {
                let Some(line) = line else { continue };
                let sum = &mut sums[line * width..(line + 1) * width];
                add(sum, &cells[cell * width..(cell + 1) * width]);
            }
        }
        Merged { all, groups }
    }

    fn whitened(&self, noise: &Noise, sums: &Merged, series: f64) -> (Vec<f64>, f64) {
        let Noise {
            rho,
            first_weight,
            stand_ratio,
            log_prior,
            ..
        } = *noise;
        let width = self.width;
        let mut total = combined(&sums.all, [1.0, rho * rho, -2.0 * rho, first_weight]);
        let groups = combined(&sums.groups, [1.0, rho * rho, -rho, first_weight]);
        let mut weight = log_prior + 0.5 * series * first_weight.ln();
        let padded = width.next_multiple_of(GROUP);
        let mut shrunken = Vec::new();
        for line in groups.chunks_exact(width.max(1)) {
            let own = line[0];
            let shrink = if self.flat_level {
                weight -= 0.5 * own.ln();
                1.0 / own
            } else {
                weight -= 0.5 * (stand_ratio * own).ln_1p();
                stand_ratio / (1.0 + stand_ratio * own)
            };
            if shrink != 0.0 {
                let root = shrink.sqrt();
                shrunken.extend(line.iter().map(|value| root * value));
                shrunken.resize(shrunken.len() + padded - width, 0.0);
            }
        }
        if !shrunken.is_empty() {
            let mut taken = vec![0.0; padded * padded];
            add_products(&shrunken, padded, &mut taken);
            for i in 0..width {
                for j in 0..width {
                    total[i * width + j] -= taken[i.min(j) * padded + i.max(j)];
                }
            }
        }
        (total, weight)
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
        if finite.iter().all(|&finite| finite) {
            return finite;
        }
        for own in &mut self.products {
            for (at, sum) in own
                .blocks
                .iter_mut()
                .flat_map(|kind| kind.iter_mut().enumerate())
            {
                if !(finite[at % width] && finite[at / width % width]) {
                    *sum = 0.0;
                }
            }
            for (at, sum) in own
                .cells
                .iter_mut()
                .flat_map(|kind| kind.iter_mut().enumerate())
            {
                if !finite[at % width] {
                    *sum = 0.0;
                }
            }
        }
        finite
    }

    /// Squares of the last column, of rows that follow another and of those before, and their
    /// products.
    #[must_use]
    pub fn steps(&self) -> [f64; 3] {
        let area = self.width * self.width;
        let [present, previous, lagged, _] = &self.products[0].blocks;
        [present, previous, lagged].map(|kind| kind.chunks_exact(area).map(|b| b[area - 1]).sum())
    }
}

fn combined(sums: &[Vec<f64>; 4], factors: [f64; 4]) -> Vec<f64> {
    let [present, previous, lagged, first] = sums;
    let rows = present.iter().zip(previous).zip(lagged).zip(first);
    rows.map(|(((a, b), c), d)| factors[0] * a + factors[1] * b + factors[2] * c + factors[3] * d)
        .collect()
}

/// `sums += more`.
fn add(sums: &mut [f64], more: &[f64]) {
    for (sum, &value) in sums.iter_mut().zip(more) {
        *sum += value;
    }
}

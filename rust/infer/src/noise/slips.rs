//! Readings in groups some steps apart, as of cycles that were missed: a mixture, fitted.
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::density::NoiseDensity;
use crate::numeric::{PACK, Pack, on_widest};

/// Rounds of expectation and maximization, at most; [`GAIN`] ends most fits before.
const ROUNDS: usize = 40;
/// Log likelihood that a round must add: less changes no odds that a report shows.
const GAIN: f64 = 1e-3;
/// Probability that a group keeps, so that its logarithm is a number.
const LEAST: f64 = 1e-12;
/// Scale below which no group scatters \[m\].
const FINEST: f64 = 1e-5;

/// What is left of some readings, and the groups that they may be in.
#[derive(Clone, Copy, Debug)]
pub struct CycleSlips<'a> {
    /// Of each row \[m\].
    pub left: &'a [f64],
    /// Distance of two groups at each row \[m\].
    pub step: &'a [f64],
    /// Part of the table that has probabilities of its own, of each row.
    pub cells: &'a [usize],
    /// Part of the table that has a level of its own, of each row.
    pub segments: &'a [usize],
    /// Steps of each group.
    pub orders: &'a [f64],
    /// Degrees of freedom of the scatter in a group.
    pub freedom: f64,
    /// Standard deviation of a level before the data \[m\]; zero where the levels are known.
    pub spread: f64,
}

/// A mixture of groups.
#[derive(Clone, Debug)]
pub struct SlipMixture {
    /// Log likelihood.
    pub log: f64,
    /// Level of each row \[m\].
    pub level: Vec<f64>,
    /// Scale of the scatter in a group \[m\].
    pub scale: f64,
    /// Probability of each group, cell by cell.
    pub weights: Vec<f64>,
}

impl CycleSlips<'_> {
    /// Fits from some levels and a scale on, every group as probable as another.
    ///
    /// Expectation and maximization; Lange, Little & Taylor 1989, Journal of the American Statistical
    /// Association 84, 881, doi:10.1080/01621459.1989.10478852, has the weights of Student's t.
    #[must_use]
    pub fn fit(&self, level: Vec<f64>, scale: f64) -> SlipMixture {
        let cells = count(self.cells);
        let even = 1.0 / self.orders.len() as f64;
        let mut found = SlipMixture {
            log: f64::NEG_INFINITY,
            level,
            scale,
            weights: vec![even; cells.len() * self.orders.len()],
        };
        let mut sums = MixtureSums::default();
        for _ in 0..ROUNDS {
            let log = sums.gather(self, &found, cells.len());
            let before = core::mem::replace(&mut found.log, log);
            if log < before + GAIN {
                break;
            }
            sums.maximize(self, &mut found, &cells);
        }
        found
    }
}

/// Rows of each label.
fn count(labels: &[usize]) -> Vec<f64> {
    let mut counts = vec![0.0; labels.iter().max().map_or(0, |&last| last + 1)];
    labels.iter().for_each(|&label| counts[label] += 1.0);
    counts
}

/// Sums over rows under one mixture.
#[derive(Default)]
struct MixtureSums {
    /// Of each cell: rows in each group.
    members: Vec<f64>,
    /// Of each segment: what rows are off their groups, and how much they count.
    off: Vec<f64>,
    mass: Vec<f64>,
    /// Squares of what rows are off.
    squares: f64,
    shares: Vec<Pack>,
    logs: Vec<f64>,
}

impl MixtureSums {
    on_widest! {
        /// Sums over all rows; returns the log likelihood.
        gather gather_avx2 gather_avx512 gathered (slips: &CycleSlips<'_>, found: &SlipMixture, cells: usize) -> f64
    }

    #[inline(always)]
    fn gathered(&mut self, slips: &CycleSlips<'_>, found: &SlipMixture, cells: usize) -> f64 {
        let segments = slips.segments.iter().max().map_or(0, |&last| last + 1);
        for (sums, length) in [
            (&mut self.members, cells * slips.orders.len()),
            (&mut self.off, segments),
            (&mut self.mass, segments),
        ] {
            sums.clear();
            sums.resize(length, 0.0);
        }
        self.squares = 0.0;
        self.logs.clear();
        let logs = found.weights.iter().map(|weight| (weight + LEAST).ln());
        self.logs.extend(logs);
        let density = NoiseDensity::of(slips.freedom);
        let mut log = -(slips.left.len() as f64) * found.scale.ln();
        for first in (0..slips.left.len()).step_by(PACK) {
            log += self.add(slips, found, &density, first);
        }
        log
    }

    /// Adds one pack of rows; returns their log likelihood, of scale one.
    #[inline(always)]
    fn add(
        &mut self,
        slips: &CycleSlips<'_>,
        found: &SlipMixture,
        density: &NoiseDensity,
        first: usize,
    ) -> f64 {
        let groups = slips.orders.len();
        let rows = first..slips.left.len().min(first + PACK);
        let [left, step, level] = [slips.left, slips.step, &found.level].map(|column| {
            let mut lane = Pack::all(0.0);
            lane.0[..rows.len()].copy_from_slice(&column[rows.clone()]);
            lane
        });
        let inverse = Pack::all(1.0 / found.scale);
        let (left, own) = (left - level, &slips.cells[rows.clone()]);
        self.shares.clear();
        let mut top = Pack::all(f64::NEG_INFINITY);
        for (group, &order) in slips.orders.iter().enumerate() {
            let unit = (left - step * Pack::all(order)) * inverse;
            let mut log = Pack::all(0.0);
            for (log, cell) in log.0.iter_mut().zip(own) {
                *log = self.logs[cell * groups + group];
            }
            let log = density.log_density(unit * unit) + log;
            top = top.max(log);
            self.shares.push(log);
        }
        let mut total = Pack::all(0.0);
        for share in &mut self.shares {
            *share = (*share - top).exp();
            total = total + *share;
        }
        let (mut off, mut mass, mut squares) = (Pack::all(0.0), Pack::all(0.0), Pack::all(0.0));
        for (share, &order) in self.shares.iter_mut().zip(slips.orders) {
            *share = *share / total;
            let away = left - step * Pack::all(order);
            let square = away * away * inverse * inverse;
            let pull = *share * density.weight(square);
            off = off + pull * away;
            mass = mass + pull;
            squares = squares + pull * away * away;
        }
        let log = total.ln() + top;
        let mut sum = 0.0;
        for (lane, row) in rows.enumerate() {
            sum += log.0[lane];
            self.squares += squares.0[lane];
            self.off[slips.segments[row]] += off.0[lane] + mass.0[lane] * level.0[lane];
            self.mass[slips.segments[row]] += mass.0[lane];
            let members = &mut self.members[slips.cells[row] * groups..][..groups];
            for (members, share) in members.iter_mut().zip(&self.shares) {
                *members += share.0[lane];
            }
        }
        sum
    }

    /// The mixture that is likeliest given which rows are in which group.
    fn maximize(&self, slips: &CycleSlips<'_>, found: &mut SlipMixture, cells: &[f64]) {
        if slips.spread > 0.0 {
            let held = (found.scale / slips.spread).powi(2);
            for (level, &segment) in found.level.iter_mut().zip(slips.segments) {
                *level = self.off[segment] / (self.mass[segment] + held);
            }
        }
        found.scale = (self.squares / slips.left.len() as f64).sqrt().max(FINEST);
        let groups = slips.orders.len();
        for (place, weight) in found.weights.iter_mut().enumerate() {
            *weight = self.members[place] / cells[place / groups];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_far_apart_by_hand() {
        // eight rows at 0 and four one step further, each 0.1 or -0.1 off: nothing is in doubt
        let row = |i: usize| f64::from(i >= 8) + 0.1 * [1.0, -1.0][i % 2];
        let left: Vec<f64> = (0..12).map(row).collect();
        let slips = CycleSlips {
            left: &left,
            step: &[1.0; 12],
            cells: &[0; 12],
            segments: &[0; 12],
            orders: &[0.0, 1.0],
            freedom: f64::INFINITY,
            spread: 0.0,
        };
        let found = slips.fit(vec![0.0; 12], 0.2);
        assert!((found.weights[0] - 2.0 / 3.0).abs() < 1e-9);
        assert!((found.scale - 0.1).abs() < 1e-9);
        let each = -0.5 - 0.1_f64.ln() - 0.5 * (2.0 * core::f64::consts::PI).ln();
        let right = 12.0 * each + 8.0 * (2.0_f64 / 3.0).ln() + 4.0 * (1.0_f64 / 3.0).ln();
        assert!((found.log - right).abs() < 1e-8);
    }

    #[test]
    fn a_level_of_each_segment_is_found() {
        let left = [0.31, 0.29, 0.3, 1.3, -0.19, -0.21, -0.2, -0.2];
        let slips = CycleSlips {
            left: &left,
            step: &[1.0; 8],
            cells: &[0; 8],
            segments: &[0, 0, 0, 0, 1, 1, 1, 1],
            orders: &[-1.0, 0.0, 1.0],
            freedom: 4.0,
            spread: 100.0,
        };
        let found = slips.fit(vec![0.0; 8], 0.3);
        assert!((found.level[0] - 0.3).abs() < 1e-3 && (found.level[7] + 0.2).abs() < 1e-3);
        assert!((found.weights[2] - 1.0 / 8.0).abs() < 1e-3);
    }
}

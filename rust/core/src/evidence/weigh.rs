//! How probable the data are under one hypothesis, all sizes of its causes averaged.
//!
//! The coefficients have normal priors, in a mixture of three widths, cut off at their bounds; the
//! variance of the noise has Jeffreys's prior, and within the coefficients' prior it stands at its
//! estimate (a Laplace approximation). MacKay 1992, Neural Computation 4, 415,
//! doi:10.1162/neco.1992.4.3.415.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::hypothesis::Layout;
use super::lanes::{LANES, Lane};
use super::moments::Moments;
use super::stack::{Noises, Table};
use super::system::{Bounds, System};

/// Mixture of prior widths: nobody knows a magnitude well.
const WIDTHS: [f64; 3] = [1.0 / 3.0, 1.0, 3.0];
/// What a narrower prior and a bound may add to the log evidence, a coefficient: `ln 9 + ln 2`.
const NARROWER: f64 = 2.9;
/// Log odds against the best noise of a hypothesis beyond which a noise does not matter to it.
const OUT_OF_THE_RACE: f64 = 12.0;
/// The same while searching, where a hundredth of a unit of log evidence decides nothing.
const BEHIND: f64 = 8.0;

/// A hypothesis after the data.
#[derive(Clone, Debug, Default)]
pub struct Weighed {
    /// Without the hypothesis's prior, with an arbitrary constant common to all.
    pub log_evidence: f64,
    /// Coefficients of the free columns, in prior standard deviations.
    pub mean: Vec<f64>,
    /// Their covariance, row by row.
    pub covariance: Vec<f64>,
    /// Probability of each noise under this hypothesis.
    pub noise: Vec<f64>,
    /// Variance of the innovations.
    pub variance: f64,
}

/// Weighs hypotheses one after the other, with the memory of the last.
#[derive(Default)]
pub(super) struct Scales {
    /// Take the widest prior alone.
    one_width: bool,
    system: System,
    /// Of every noise: evidence at a quick look, and the variance that the best coefficients leave.
    scores: Vec<f64>,
    least: Vec<f64>,
    /// Noises in the race.
    race: Vec<usize>,
    /// Of each combination of widths, the width of each coefficient, by position.
    combinations: Vec<usize>,
    /// Evidence and variance by noises in the race, several at a time, and combination.
    refined: Vec<(Lane, Lane)>,
    variances: Vec<Lane>,
    precisions: Vec<Lane>,
    inverse: Vec<Lane>,
}

impl Scales {
    pub(super) fn new(one_width: bool) -> Self {
        Self {
            one_width,
            ..Self::default()
        }
    }

    /// What the log evidence is at most.
    pub(super) fn bound(&mut self, table: &Table, layout: &Layout) -> f64 {
        self.look(table, layout);
        let most = NARROWER * layout.free.len() as f64;
        log_sum(self.scores.iter().copied()) + most
    }

    /// Log evidence alone.
    pub(super) fn log_evidence(&mut self, table: &Table, layout: &Layout) -> f64 {
        self.look(table, layout);
        self.race(BEHIND);
        if layout.free.is_empty() {
            return log_sum(self.race.iter().map(|&noise| self.scores[noise]));
        }
        self.refine(table, layout);
        log_sum(self.parts().map(|(_, _, score)| score))
    }

    /// Probability of each noise under the hypothesis, with the widest priors.
    pub(super) fn noise(&mut self, table: &Table, layout: &Layout) -> Vec<f64> {
        self.look(table, layout);
        let total = log_sum(self.scores.iter().copied());
        self.scores.iter().map(|s| (s - total).exp()).collect()
    }

    /// Everything that is to be known about a hypothesis.
    pub(super) fn weigh(&mut self, table: &Table, layout: &Layout) -> Weighed {
        self.look(table, layout);
        self.race(OUT_OF_THE_RACE);
        self.refine(table, layout);
        let total = log_sum(self.parts().map(|(_, _, score)| score));
        let mut result = Weighed {
            log_evidence: total,
            noise: vec![0.0; table.noises()],
            ..Weighed::default()
        };
        for (noise, _, score) in self.parts() {
            result.noise[noise] += (score - total).exp();
        }
        self.average(table, layout, &mut result);
        result
    }

    /// A quick look: every noise, with the widest prior alone and no bounds.
    fn look(&mut self, table: &Table, layout: &Layout) {
        table.count(table.noises());
        self.scores.clear();
        self.least.clear();
        let widest = Lane::all(WIDTHS[2] * WIDTHS[2]);
        for first in (0..table.noises()).step_by(LANES) {
            self.system
                .take(table, layout, &Noises::Group(first / LANES));
            let least = self.system.least_squares();
            self.precisions.clear();
            self.precisions.resize(layout.free.len(), least / widest);
            let part = self.system.part(&self.precisions, layout.free.len());
            let count = LANES.min(table.noises() - first);
            let weights = &table.log_weight[first..first + count];
            let scores = weights.iter().zip(part.score.0);
            self.scores
                .extend(scores.map(|(weight, score)| weight + score));
            self.least.extend(&least.0[..count]);
        }
    }

    fn best_look(&self) -> f64 {
        self.scores
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The noises that the quick look leaves in the race.
    fn race(&mut self, far: f64) {
        let best = self.best_look();
        self.race.clear();
        let near = (0..self.scores.len()).filter(|&noise| self.scores[noise] > best - far);
        self.race.extend(near);
    }

    /// Every width and the bounds, for the noises in the race.
    fn refine(&mut self, table: &Table, layout: &Layout) {
        let order = layout.free.len();
        self.combine_widths(layout);
        let bounds = Bounds::of(layout, &WIDTHS);
        let even = (self.count(order) as f64).ln();
        self.refined.clear();
        table.count(self.race.len() * self.count(order));
        for first in (0..self.race.len()).step_by(LANES) {
            let (noises, least) = self.start(table, layout, first);
            for combination in 0..self.count(order) {
                let mut part = self.part(&least, order, combination, changed(layout, combination));
                for (score, noise) in part.score.0.iter_mut().zip(noises) {
                    *score += table.log_weight[noise] - even;
                }
                if !bounds.near.is_empty() {
                    self.system.coefficients(&bounds.near, &mut self.variances);
                    let chosen = &self.combinations[combination * order..];
                    let (system, variances) = (&self.system, &self.variances);
                    part.score =
                        part.score + bounds.within(system, variances, part.variance, chosen);
                }
                self.refined.push((part.score, part.variance));
            }
        }
    }

    /// Number of combinations of widths.
    fn count(&self, order: usize) -> usize {
        self.combinations.len().checked_div(order).unwrap_or(1)
    }

    /// Takes the products of noises in the race, from the `first` on; the last fills up.
    fn start(
        &mut self,
        table: &Table,
        layout: &Layout,
        first: usize,
    ) -> ([usize; LANES], [Lane; 3]) {
        let last = self.race.len() - 1;
        let noises = core::array::from_fn(|lane| self.race[(first + lane).min(last)]);
        self.system.take(table, layout, &Noises::Some(noises));
        let least = Lane(core::array::from_fn(|lane| self.least[noises[lane]]));
        (noises, WIDTHS.map(|width| least / Lane::all(width * width)))
    }

    /// One combination, of whose widths the first `changed` are others than at the call before.
    fn part(
        &mut self,
        least: &[Lane; 3],
        order: usize,
        combination: usize,
        changed: usize,
    ) -> super::system::Part {
        let widths = &self.combinations[combination * order..(combination + 1) * order];
        self.precisions.clear();
        self.precisions
            .extend(widths.iter().map(|&width| least[width]));
        self.system.part(&self.precisions, changed)
    }

    /// What was refined, part by part: noise, place and evidence.
    fn parts(&self) -> impl Iterator<Item = (usize, usize, f64)> + Clone + '_ {
        let each = self.refined.len() / self.race.len().div_ceil(LANES).max(1);
        let lanes = self.race.iter().enumerate().flat_map(move |(at, &noise)| {
            let first = at / LANES * each;
            (first..first + each).map(move |place| (noise, place, at % LANES))
        });
        lanes.map(|(noise, place, lane)| (noise, place, self.refined[place].0.0[lane]))
    }

    /// Means and covariances of the parts that matter, by their shares.
    fn average(&mut self, table: &Table, layout: &Layout, result: &mut Weighed) {
        let order = layout.free.len();
        let (each, mut sums) = (self.count(order), Moments::new(order));
        let scores = self.parts().map(|(_, _, score)| score);
        let least = scores.fold(f64::NEG_INFINITY, f64::max) - OUT_OF_THE_RACE;
        for first in (0..self.race.len()).step_by(LANES) {
            let count = LANES.min(self.race.len() - first);
            let places = first / LANES * each..(first / LANES + 1) * each;
            let mut started = None;
            for (combination, place) in places.enumerate() {
                let (score, variance) = self.refined[place];
                if score.0[..count].iter().all(|&score| score <= least) {
                    continue;
                }
                let least_of = *started.get_or_insert_with(|| self.start(table, layout, first).1);
                self.part(&least_of, order, combination, order);
                self.system.coefficients(&[], &mut self.variances);
                self.system.inverse(&mut self.inverse);
                let mut share = Lane::all(0.0);
                for lane in (0..count).filter(|&lane| score.0[lane] > least) {
                    share.0[lane] = (score.0[lane] - result.log_evidence).exp();
                }
                sums.add(&share, &variance, &self.system, &self.inverse);
            }
        }
        sums.into(result);
    }

    /// Every combination of widths, one width a cause, side by side.
    fn combine_widths(&mut self, layout: &Layout) {
        let choices = if self.one_width {
            2..3
        } else {
            0..WIDTHS.len()
        };
        self.combinations.clear();
        let causes = u32::try_from(layout.counts.len()).unwrap_or(u32::MAX);
        for mut code in 0..choices.len().pow(causes) {
            for &count in &layout.counts {
                let width = choices.start + code % choices.len();
                self.combinations.extend(core::iter::repeat_n(width, count));
                code /= choices.len();
            }
        }
    }
}

/// Columns whose width is another than in the combination before: the first causes' change most often.
fn changed(layout: &Layout, mut combination: usize) -> usize {
    if combination == 0 {
        return layout.free.len();
    }
    let mut columns = 0;
    for count in &layout.counts {
        columns += count;
        if !combination.is_multiple_of(WIDTHS.len()) {
            break;
        }
        combination /= WIDTHS.len();
    }
    columns
}

/// `ln(sum(exp(x)))`.
pub(super) fn log_sum(scores: impl Iterator<Item = f64> + Clone) -> f64 {
    let top = scores.clone().fold(f64::NEG_INFINITY, f64::max);
    if top == f64::NEG_INFINITY {
        return top;
    }
    top + scores.map(|score| (score - top).exp()).sum::<f64>().ln()
}

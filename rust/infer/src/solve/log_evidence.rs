//! How probable the data are under one hypothesis, all sizes of its causes averaged.
//!
//! docs/method.md, Eq. 11 to 17. The coefficients have normal priors, in a mixture of three widths; the
//! variance of the noise has Jeffreys's prior. The prior of the coefficients is scaled by the variance
//! over its least-squares estimate (a plug-in). With that the integrals over the coefficients and over
//! the variance are both exact. The cut at the bounds of a coefficient is an approximation: it
//! neglects correlations, and takes a normal distribution for Student's. MacKay 1992, Neural
//! Computation 4, 415, doi:10.1162/neco.1992.4.3.415.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::bounds::Bounds;
use super::fit::{Accuracy, HypothesisFit};
use super::hypothesis::{HypothesisColumns, Variant, columns};
use super::mixture::{Mixture, log_sum};
use super::moments::Moments;
use super::prior_widths::{WIDEST, WIDTHS, Widths};
use super::stack::{NoiseTable, Noises, WhitenedStack};
use super::system::{Part, System};
use crate::numeric::{PACK, Pack};
use crate::parallel::each_of;

/// What a narrower prior and a bound may add to the log evidence, a coefficient: `ln 9 + ln 2 = 2.89`,
/// for the widest prior is nine times the narrowest, and a bound at zero halves a prior. Two bounds
/// closer together than some 0.4 prior standard deviations may add more; no effect has such bounds (the
/// narrowest, of `unrecorded_humidity`, are two apart).
pub(crate) const NARROWER: f64 = 2.9;
/// Log odds against the best noise of a hypothesis beyond which a noise does not matter to it: of a
/// probability below 6e-6.
const NEGLIGIBLE_NOISE: f64 = 12.0;
/// The same while searching, where a hundredth of a unit of log evidence decides nothing.
const BEHIND: f64 = 8.0;
/// Log odds against the best part of a mixture beyond which a part does not move a size: its weight is
/// below 1.2e-4.
const UNMOVED: f64 = 9.0;
/// Part of the evidence that the noises left out may hold together.
const LEFT_OUT: f64 = 1e-4;
/// Share of a width, with the others' the widest, below which it is not combined with others.
const UNLIKELY: f64 = 1e-5;
/// Causes from which on there are so many combinations that it pays to look for those that matter.
const MANY: usize = 3;

/// Finds the log evidence of hypotheses one after the other, with the memory of the last.
#[derive(Default)]
pub(crate) struct EvidenceSolver {
    system: System,
    bounds: Bounds,
    widths: Widths,
    /// Of every noise: evidence at the first fit, and the variance that the best coefficients leave.
    scores: Vec<f64>,
    least: Vec<f64>,
    /// Noises that are probable enough to matter.
    contenders: Vec<usize>,
    mixture: Mixture,
    precisions: Vec<Pack>,
    inverse: Vec<Pack>,
}

impl EvidenceSolver {
    /// What the log evidence is at most, where at most one bound of each coefficient is near; see
    /// [`NARROWER`].
    pub(crate) fn bound(&mut self, table: &NoiseTable, layout: &HypothesisColumns) -> f64 {
        self.first_fit(table, layout);
        let most = NARROWER * layout.free.len() as f64;
        log_sum(self.scores.iter().copied()) + most
    }

    /// Log evidence; from three causes on, assumes independent posteriors.
    ///
    /// Of 812 sets of three and four causes in eight tables that missed the evidence by 0.2 (root mean
    /// square) and by 1.04 at most.
    pub(crate) fn estimate(&mut self, table: &NoiseTable, layout: &HypothesisColumns) -> f64 {
        self.first_fit(table, layout);
        self.keep_contenders(BEHIND);
        self.bounds = Bounds::of(layout, &WIDTHS);
        let rough = self.rough(table, layout);
        let scores = rough.unwrap_or_else(|| self.every(table, layout));
        log_sum(scores.into_iter())
    }

    /// Probability of each noise under the hypothesis, with the widest priors, and log evidence.
    pub(crate) fn noise(
        &mut self,
        table: &NoiseTable,
        layout: &HypothesisColumns,
    ) -> (Vec<f64>, f64) {
        self.first_fit(table, layout);
        let total = log_sum(self.scores.iter().copied());
        let shares = self.scores.iter().map(|s| (s - total).exp()).collect();
        (shares, total)
    }

    /// Everything that is to be known about a hypothesis.
    pub(crate) fn fit(
        &mut self,
        table: &NoiseTable,
        layout: &HypothesisColumns,
        accuracy: Accuracy,
    ) -> HypothesisFit {
        self.first_fit(table, layout);
        self.keep_contenders(NEGLIGIBLE_NOISE);
        self.bounds = Bounds::of(layout, &WIDTHS);
        let rough = match accuracy {
            Accuracy::Rough => self.rough(table, layout),
            Accuracy::Full | Accuracy::Widest => None,
        };
        let scores = match (rough, accuracy) {
            (Some(scores), _) => self.settled(table, layout, scores),
            (None, Accuracy::Widest) => {
                self.widths.one(layout, |_| WIDEST);
                self.refine(table);
                self.mixture.together(self.contenders.len(), 0.0)
            }
            (None, _) => self.every(table, layout),
        };
        let total = log_sum(scores.iter().copied());
        let mut result = HypothesisFit {
            log_evidence: total,
            noise: vec![0.0; table.noises()],
            ..HypothesisFit::default()
        };
        for (&noise, score) in self.contenders.iter().zip(&scores) {
            result.noise[noise] = (score - total).exp();
        }
        self.average(table, layout, &mut result);
        result
    }

    /// The first fit: every noise, with the widest prior alone and no bounds.
    fn first_fit(&mut self, table: &NoiseTable, layout: &HypothesisColumns) {
        table.count(table.noises());
        self.scores.clear();
        self.least.clear();
        let widest = Pack::all(WIDTHS[WIDEST] * WIDTHS[WIDEST]);
        self.system.begin(table, layout);
        for first in (0..table.noises()).step_by(PACK) {
            self.system.take(table, &Noises::Group(first / PACK));
            let least = self.system.least_squares();
            self.precisions.clear();
            self.precisions.resize(layout.free.len(), least / widest);
            let part = self.system.part(&self.precisions, layout.free.len());
            let count = PACK.min(table.noises() - first);
            let weights = &table.log_weight[first..first + count];
            let scores = weights.iter().zip(part.score.0);
            self.scores
                .extend(scores.map(|(weight, score)| weight + score));
            self.least.extend(&least.0[..count]);
        }
    }

    /// Keeps the noises that the first fit leaves within these log odds of the best.
    fn keep_contenders(&mut self, far: f64) {
        let best = self
            .scores
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        self.contenders.clear();
        let near = (0..self.scores.len()).filter(|&noise| self.scores[noise] > best - far);
        self.contenders.extend(near);
    }

    /// Scores of the contending noises, every combination of widths that matters averaged.
    fn every(&mut self, table: &NoiseTable, layout: &HypothesisColumns) -> Vec<f64> {
        let mut kept = vec![[true; WIDTHS.len()]; layout.counts.len()];
        if let Some(mut scores) = self.rough(table, layout) {
            for (cause, kept) in kept.iter_mut().enumerate() {
                let likely = self
                    .mixture
                    .shares(&scores, cause)
                    .map(|share| share > UNLIKELY);
                if likely.contains(&true) {
                    *kept = likely; // products that are no numbers make no width likely
                }
            }
            self.leave_out(&mut scores);
        }
        self.widths.every(layout, &kept);
        self.refine(table);
        let even = kept.len() as f64 * (WIDTHS.len() as f64).ln();
        self.mixture.together(self.contenders.len(), even)
    }

    /// Leaves the best combination of widths in place of those tried one at a time.
    fn settled(
        &mut self,
        table: &NoiseTable,
        layout: &HypothesisColumns,
        mut scores: Vec<f64>,
    ) -> Vec<f64> {
        let best = |cause| {
            let shares = self.mixture.shares(&scores, cause);
            (0..WIDTHS.len()).max_by(|&a, &b| shares[a].total_cmp(&shares[b]))
        };
        let best: Vec<_> = (0..layout.counts.len()).map(best).collect();
        self.leave_out(&mut scores);
        self.widths
            .one(layout, |cause| best[cause].unwrap_or(WIDEST));
        self.refine(table);
        for (part, scores) in self.mixture.parts.iter_mut().zip(scores.chunks(PACK)) {
            for (lane, score) in part.0.0.iter_mut().enumerate() {
                *score = scores[lane.min(scores.len() - 1)]; // the last fills up
            }
        }
        scores
    }

    /// Scores of the contending noises, one width changed at a time; none of few causes, and none
    /// where the causes depend on each other too much.
    fn rough(&mut self, table: &NoiseTable, layout: &HypothesisColumns) -> Option<Vec<f64>> {
        if layout.counts.len() < MANY {
            return None;
        }
        self.widths.star(layout);
        self.refine(table);
        let gains = layout.counts.iter().map(|&count| NARROWER * count as f64);
        let gains: Vec<f64> = gains.collect();
        self.mixture.independent(self.contenders.len(), &gains)
    }

    /// Takes those noises out that hold next to nothing together.
    fn leave_out(&mut self, scores: &mut Vec<f64>) {
        let total = log_sum(scores.iter().copied());
        let mut order: Vec<usize> = (0..scores.len()).collect();
        order.sort_by(|&a, &b| scores[a].total_cmp(&scores[b]));
        let mut left_out = 0.0;
        let beyond = |&place: &usize| {
            left_out += (scores[place] - total).exp();
            left_out < LEFT_OUT
        };
        let gone: Vec<usize> = order.into_iter().take_while(beyond).collect();
        let kept: Vec<usize> = (0..scores.len()).filter(|at| !gone.contains(at)).collect();
        self.contenders = kept.iter().map(|&at| self.contenders[at]).collect();
        *scores = kept.iter().map(|&at| scores[at]).collect();
    }

    /// Every combination of widths, with the bounds, for the contending noises.
    fn refine(&mut self, table: &NoiseTable) {
        self.mixture.clear(self.widths.len());
        table.count(self.contenders.len() * self.widths.len());
        for first in (0..self.contenders.len()).step_by(PACK) {
            let (weights, least) = self.start(table, first);
            for combination in 0..self.widths.len() {
                let changed = self.widths.changed(combination);
                let Part { score, variance } = self.part(&least, combination, changed);
                let mut score = score + weights;
                if !self.bounds.near.is_empty() {
                    let chosen = self.widths.of(combination);
                    score = score + self.system.within(&self.bounds, &variance, chosen);
                }
                self.mixture.parts.push((score, variance));
            }
        }
    }

    /// Takes the products of contending noises, from the `first` on; the last fills up. Returns
    /// their weights, and the variance that the best coefficients leave over each width squared.
    fn start(&mut self, table: &NoiseTable, first: usize) -> (Pack, [Pack; WIDTHS.len()]) {
        let last = self.contenders.len() - 1;
        let noises = core::array::from_fn(|lane| self.contenders[(first + lane).min(last)]);
        self.system.take(table, &table.beside(noises));
        let of = |values: &[f64]| Pack(noises.map(|noise| values[noise]));
        let least = of(&self.least);
        let over = WIDTHS.map(|width| least / Pack::all(width * width));
        (of(&table.log_weight), over)
    }

    /// One combination, of whose columns the first `changed` may have other widths than before.
    fn part(&mut self, least: &[Pack; WIDTHS.len()], combination: usize, changed: usize) -> Part {
        let widths = self.widths.of(combination);
        self.precisions.clear();
        self.precisions
            .extend(widths.iter().map(|&width| least[width]));
        self.system.part(&self.precisions, changed)
    }

    /// Means and covariances of the parts that matter, by their shares.
    fn average(
        &mut self,
        table: &NoiseTable,
        layout: &HypothesisColumns,
        result: &mut HypothesisFit,
    ) {
        let each = self.widths.len();
        let mut sums = Moments::new(layout.free.len());
        let best = self.mixture.best();
        for first in (0..self.contenders.len()).step_by(PACK) {
            let count = PACK.min(self.contenders.len() - first);
            let mut started = None;
            for combination in 0..each {
                let (score, variance) = self.mixture.parts[first / PACK * each + combination];
                let mut share = Pack::all(0.0);
                for lane in (0..count).filter(|&lane| score.0[lane] > best - UNMOVED) {
                    share.0[lane] = (score.0[lane] - best).exp();
                }
                if share.0 == [0.0; PACK] {
                    continue;
                }
                let least = *started.get_or_insert_with(|| self.start(table, first).1);
                self.part(&least, combination, layout.free.len());
                self.system.coefficients();
                self.system.inverse(&mut self.inverse);
                sums.add(&share, &variance, &self.system, &self.inverse);
            }
        }
        sums.into(result);
    }
}

/// The log evidence of hypotheses, each by itself; with `one_width` with the widest prior alone.
#[must_use]
pub fn log_evidence(
    stack: &WhitenedStack<'_>,
    hypotheses: &[Vec<Variant>],
    one_width: bool,
    threads: usize,
) -> Vec<HypothesisFit> {
    let accuracy = if one_width {
        Accuracy::Widest
    } else {
        Accuracy::Full
    };
    each_of(hypotheses, threads, || {
        let (mut solver, mut layout) = (EvidenceSolver::default(), HypothesisColumns::default());
        move |variants: &Vec<Variant>| {
            layout.fill(variants);
            let table = NoiseTable::of(stack, &columns(variants, stack.width - 1), 1);
            solver.fit(&table, &layout, accuracy)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three causes of one column each, the first two nearly alike, under two noises.
    fn table() -> (NoiseTable, HypothesisColumns) {
        let among = [[30.0, 28.0, 3.0], [28.0, 30.0, 1.0], [3.0, 1.0, 20.0]];
        let along = [31.0, 29.0, 4.0];
        let mut products = [[0.0; 4]; 4];
        for i in 0..3 {
            products[i][..3].copy_from_slice(&among[i]);
            (products[i][3], products[3][i]) = (along[i], along[i]);
        }
        products[3][3] = 90.0;
        let one = products.concat();
        let both = [one.clone(), one.iter().map(|x| 0.9 * x).collect()].concat();
        let stack = WhitenedStack {
            products: &both,
            log_weight: &[-1.0, -3.0],
            width: 4,
            degrees: 50.0,
            variance_floor: 1e-18,
        };
        let layout = HypothesisColumns {
            free: vec![0, 1, 2],
            counts: vec![1; 3],
            bounds: vec![
                (0.0, f64::INFINITY),
                (-2.0, 3.0),
                (f64::NEG_INFINITY, f64::INFINITY),
            ],
            ..HypothesisColumns::default()
        };
        (NoiseTable::of(&stack, &[0, 1, 2, 3], 1), layout)
    }

    #[test]
    fn widths_and_noises_that_are_left_out_do_not_matter() {
        let (table, layout) = table();
        let mut solver = EvidenceSolver::default();
        let found = solver.fit(&table, &layout, Accuracy::Full);
        solver.first_fit(&table, &layout);
        solver.keep_contenders(f64::INFINITY);
        solver.widths.every(&layout, &[[true; 3]; 3]);
        solver.refine(&table);
        let every = solver.mixture.together(2, 27.0_f64.ln());
        let right = log_sum(every.iter().copied());
        assert!((found.log_evidence - right).abs() < 2e-4);
        assert!((found.noise[0] - (every[0] - right).exp()).abs() < 2e-4);
    }

    #[test]
    fn an_estimate_is_near_whatever_the_bounds() {
        let (table, mut layout) = table();
        let mut solver = EvidenceSolver::default();
        let found = solver.fit(&table, &layout, Accuracy::Full).log_evidence;
        let rough = solver.fit(&table, &layout, Accuracy::Rough).log_evidence;
        assert_eq!(rough, solver.estimate(&table, &layout));
        assert!((rough - found).abs() < 1.1, "{rough} {found}");
        layout.bounds[0] = (-90.0, -80.0); // the wider a prior, the farther off
        layout.bounds[1] = (80.0, 90.0);
        let found = solver.fit(&table, &layout, Accuracy::Full).log_evidence;
        let rough = solver.estimate(&table, &layout);
        assert!((rough - found).abs() < 1.1, "{rough} {found}");
    }
}

//! The parts of a hypothesis's evidence: noises, several at a time, and combinations of widths.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::elementary::exp;
use super::lanes::{LANES, Lane};
use super::widths::{WIDEST, WIDTHS};

/// Evidence and variance by groups of noises and, within each, by combination.
#[derive(Default)]
pub(super) struct Mixture {
    pub parts: Vec<(Lane, Lane)>,
    combinations: usize,
}

impl Mixture {
    pub fn clear(&mut self, combinations: usize) {
        self.parts.clear();
        self.combinations = combinations;
    }

    /// Scores of some noises, all combinations together, less a constant.
    pub fn together(&self, noises: usize, less: f64) -> Vec<f64> {
        let groups = self.parts.chunks(self.combinations);
        let sums = groups.flat_map(|parts| {
            let scores = parts.iter().map(|part| part.0);
            let top = scores.clone().fold(parts[0].0, Lane::max);
            let sum = scores.fold(Lane::all(0.0), |sum, score| sum + (score - top).exp());
            (top + sum.ln() - Lane::all(less)).0
        });
        sums.take(noises).collect()
    }

    /// Scores of some noises where one width was changed at a time, as if the causes were
    /// independent; none where a narrower width gains more than it can by itself, for then bounds
    /// that the causes violate together are met by narrowing one of them.
    pub fn independent(&self, noises: usize, gain: impl Fn(usize) -> f64) -> Option<Vec<f64>> {
        let even = Lane::all((WIDTHS.len() as f64).ln());
        let mut scores = Vec::with_capacity(noises);
        for parts in self.parts.chunks(self.combinations) {
            let mut sum = parts[0].0;
            for (cause, narrower) in parts[1..].chunks(WIDEST).enumerate() {
                let own = narrower.iter().map(|part| part.0 - parts[0].0);
                let most = own.clone().fold(Lane::all(0.0), Lane::max);
                if most.0.iter().any(|&most| most > gain(cause)) {
                    return None;
                }
                let widest = (Lane::all(0.0) - most).exp();
                sum = sum - even + most + own.fold(widest, |sum, x| sum + (x - most).exp()).ln();
            }
            scores.extend(sum.0);
        }
        scores.truncate(noises);
        Some(scores)
    }

    /// Share of each width of a cause where one was changed at a time, given the noises' scores.
    pub fn shares(&self, scores: &[f64], cause: usize) -> [f64; WIDTHS.len()] {
        let total = log_sum(scores.iter().copied());
        let mut shares = [0.0; WIDTHS.len()];
        let groups = self.parts.chunks(self.combinations);
        for (parts, scores) in groups.zip(scores.chunks(LANES)) {
            let narrow = &parts[1 + cause * WIDEST..][..WIDEST];
            for (lane, score) in scores.iter().enumerate() {
                let own = |width: usize| narrow.get(width).unwrap_or(&parts[0]).0.0[lane];
                let sum = log_sum((0..WIDTHS.len()).map(own));
                for (width, share) in shares.iter_mut().enumerate() {
                    *share += exp(own(width) - sum + score - total);
                }
            }
        }
        shares
    }
}

/// `ln(sum(exp(x)))`.
pub(super) fn log_sum(scores: impl Iterator<Item = f64> + Clone) -> f64 {
    let top = scores.clone().fold(f64::NEG_INFINITY, f64::max);
    if top == f64::NEG_INFINITY {
        return top;
    }
    top + scores.map(|score| exp(score - top)).sum::<f64>().ln()
}

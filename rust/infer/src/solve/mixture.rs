//! The parts of a hypothesis's evidence: noises, several at a time, and combinations of widths
//! (docs/method.md, Eq. 16).
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::prior_widths::{WIDEST, WIDTHS};
use crate::numeric::exp;
use crate::numeric::{PACK, Pack, on_widest};

/// Evidence and variance by groups of noises and, within each, by combination.
#[derive(Default)]
pub(super) struct Mixture {
    pub parts: Vec<(Pack, Pack)>,
    combinations: usize,
}

impl Mixture {
    pub fn clear(&mut self, combinations: usize) {
        self.parts.clear();
        self.combinations = combinations;
    }

    /// The highest score; lanes that only fill up have that of another.
    pub fn best(&self) -> f64 {
        let scores = self.parts.iter().map(|part| part.0);
        let best = scores.fold(Pack::all(f64::NEG_INFINITY), Pack::max);
        best.0.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    on_widest! {
        /// Scores of some noises, all combinations together, less a constant.
        together together_avx2 together_avx512 summed (noises: usize, less: f64) -> Vec<f64>
    }
    on_widest! {
        /// Scores of some noises where one width was changed at a time, as if the causes were
        /// independent; `None` where a narrower width gains more than it can by itself: then the bounds
        /// make the causes dependent, and the estimate is not valid.
        independent independent_avx2 independent_avx512 multiplied (noises: usize, gains: &[f64]) -> Option<Vec<f64>>
    }
    on_widest! {
        /// Share of each width of a cause where one was changed at a time, given the noises' scores.
        shares shares_avx2 shares_avx512 shared (scores: &[f64], cause: usize) -> [f64; WIDTHS.len()]
    }

    #[inline(always)]
    fn summed(&mut self, noises: usize, less: f64) -> Vec<f64> {
        let mut found = Vec::with_capacity(noises + PACK);
        for parts in self.parts.chunks(self.combinations) {
            let mut top = parts[0].0;
            for part in parts {
                top = top.max(part.0);
            }
            let mut sum = Pack::all(0.0);
            for part in parts {
                sum = sum + (part.0 - top).exp();
            }
            found.extend((top + sum.ln() - Pack::all(less)).0);
        }
        found.truncate(noises);
        found
    }

    #[inline(always)]
    fn multiplied(&mut self, noises: usize, gains: &[f64]) -> Option<Vec<f64>> {
        let even = Pack::all((WIDTHS.len() as f64).ln());
        let mut scores = Vec::with_capacity(noises + PACK);
        for parts in self.parts.chunks(self.combinations) {
            let mut sum = parts[0].0;
            for (narrower, &gain) in parts[1..].chunks(WIDEST).zip(gains) {
                let mut most = Pack::all(0.0);
                for part in narrower {
                    most = most.max(part.0 - parts[0].0);
                }
                if most.0.iter().any(|&most| most > gain) {
                    return None;
                }
                let mut all = (Pack::all(0.0) - most).exp();
                for part in narrower {
                    all = all + (part.0 - parts[0].0 - most).exp();
                }
                sum = sum - even + most + all.ln();
            }
            scores.extend(sum.0);
        }
        scores.truncate(noises);
        Some(scores)
    }

    #[inline(always)]
    fn shared(&mut self, scores: &[f64], cause: usize) -> [f64; WIDTHS.len()] {
        let total = log_sum(scores.iter().copied());
        let mut shares = [0.0; WIDTHS.len()];
        let groups = self.parts.chunks(self.combinations);
        for (parts, scores) in groups.zip(scores.chunks(PACK)) {
            let mut weight = Pack::all(f64::NEG_INFINITY);
            for (weight, score) in weight.0.iter_mut().zip(scores) {
                *weight = score - total;
            }
            let mut own = [parts[0].0; WIDTHS.len()];
            for (own, part) in own.iter_mut().zip(&parts[1 + cause * WIDEST..][..WIDEST]) {
                *own = part.0;
            }
            let top = own[0].max(own[1]).max(own[2]);
            let own = own.map(|score| (score - top).exp());
            let weight = weight.exp() / (own[0] + own[1] + own[2]);
            for (share, own) in shares.iter_mut().zip(own) {
                *share += (own * weight).0.iter().sum::<f64>();
            }
        }
        shares
    }
}

/// `ln(sum(exp(x)))`.
pub(crate) fn log_sum(scores: impl Iterator<Item = f64> + Clone) -> f64 {
    let top = scores.clone().fold(f64::NEG_INFINITY, f64::max);
    if top == f64::NEG_INFINITY {
        return top;
    }
    top + scores.map(|score| exp(score - top)).sum::<f64>().ln()
}

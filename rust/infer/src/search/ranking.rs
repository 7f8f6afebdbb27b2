//! Probabilities of hypotheses and of sets of causes: docs/method.md, Eq. 18 and 20 to 22.
//!
//! A cause counts only as far as it is informative. The prior on a size allows sizes that no data of
//! this kind could show: a set with such a cause explains the rows no better and no worse than the set
//! without it, however many rows there are. Its probability says nothing about the data. So the part of
//! the prior where a cause stays below the noise, beside the other causes of its set, counts as its
//! absence.

use super::prior::Prior;
use crate::solve::{Variant, WIDTHS};
use core::cmp::Reverse;

/// Signal over noise, summed over rows, below which a cause does not show.
const VISIBLE: f64 = 1.0;

/// A hypothesis that is to be ranked.
#[derive(Clone, Debug)]
pub struct RankedHypothesis {
    /// Its forms, one of each cause.
    pub variants: Vec<Variant>,
    /// Log evidence and log prior, up to a constant common to all.
    pub log_posterior: f64,
    /// Variance of each coefficient, form by form \[prior variances\].
    pub variances: Vec<f64>,
}

/// Causes in ascending order; `None` is an unexplained term.
pub type CauseSet = Vec<Option<usize>>;

/// Probabilities of hypotheses and of sets of causes.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranking {
    /// Of each hypothesis; the sum is one (docs/method.md, Eq. 18).
    pub probability: Vec<f64>,
    /// Of each set of causes, most probable first; the sum is one.
    pub sets: Vec<(CauseSet, f64)>,
}

/// Ranks hypotheses and their sets of causes; `competing` is the number of candidate causes `M`.
///
/// The hypotheses come most probable first. The first of a set says what is informative in it.
#[must_use]
pub fn rank(hypotheses: &[RankedHypothesis], competing: usize, prior: &Prior) -> Ranking {
    let probability = normalized(hypotheses);
    let mut sets: Vec<Set<'_>> = Vec::new();
    for (hypothesis, &p) in hypotheses.iter().zip(&probability) {
        let causes = causes(hypothesis);
        match sets.iter_mut().find(|set| set.causes == causes) {
            Some(set) => set.before += p, // docs/method.md, Eq. 20
            None => sets.push(Set {
                causes,
                before: p,
                best: hypothesis,
            }),
        }
    }
    Ranking {
        sets: informative(&sets, competing, prior),
        probability,
    }
}

/// A set of causes.
struct Set<'a> {
    causes: CauseSet,
    /// Probability of all its hypotheses.
    before: f64,
    /// The most probable of them.
    best: &'a RankedHypothesis,
}

fn normalized(hypotheses: &[RankedHypothesis]) -> Vec<f64> {
    let logs = hypotheses.iter().map(|one| one.log_posterior);
    let top = logs.clone().fold(f64::NEG_INFINITY, f64::max);
    let shares: Vec<f64> = logs.map(|log| (log - top).exp()).collect();
    let total: f64 = shares.iter().sum();
    shares.into_iter().map(|share| share / total).collect()
}

fn causes(of: &RankedHypothesis) -> CauseSet {
    let each = of.variants.iter();
    let mut causes: CauseSet = each
        .map(|form| (!form.is_unexplained).then_some(form.cause))
        .collect();
    causes.sort_unstable();
    causes
}

/// Moves the part of each set's probability that says nothing of a cause to the set without it, from
/// the largest sets on: docs/method.md, Eq. 22.
fn informative(sets: &[Set<'_>], competing: usize, prior: &Prior) -> Vec<(CauseSet, f64)> {
    let mut after: Vec<f64> = sets.iter().map(|set| set.before).collect();
    let mut order: Vec<usize> = (0..sets.len()).collect();
    order.sort_by_key(|&at| Reverse(sets[at].causes.len()));
    for at in order {
        let set = &sets[at];
        let known = set.causes.iter().flatten().count();
        let mut moves = Vec::new();
        for (cause, part) in uninformative(set.best) {
            let without = set.causes.iter().filter(|&&other| other != Some(cause));
            let fewer: CauseSet = without.copied().collect();
            if let Some(to) = sets.iter().position(|other| other.causes == fewer) {
                let odds = prior.of_set(known, competing) / prior.of_set(known - 1, competing);
                moves.push((to, part * odds * sets[to].before));
            }
        }
        let moved: f64 = moves.iter().map(|&(_, p)| p).sum();
        let scale = (set.before / moved.max(1e-300)).min(1.0);
        for (to, p) in moves {
            after[at] -= scale * p;
            after[to] += scale * p;
        }
    }
    let total: f64 = after.iter().map(|p| p.max(0.0)).sum();
    let each = sets.iter().zip(after);
    let mut found: Vec<_> = each
        .map(|(set, p)| (set.causes.clone(), p.max(0.0) / total))
        .collect();
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    found
}

/// Part of the prior of each cause of a hypothesis at which it would not show beside the others:
/// docs/method.md, Eq. 21. A cause with a fixed column has no such part.
fn uninformative(of: &RankedHypothesis) -> Vec<(usize, f64)> {
    let usual = WIDTHS.iter().map(|width| width * width).sum::<f64>() / WIDTHS.len() as f64;
    let (mut found, mut rest) = (Vec::new(), &of.variances[..]);
    for form in &of.variants {
        let (own, others) = rest.split_at(form.free.len().min(rest.len()));
        rest = others;
        if form.is_unexplained || !form.offsets.is_empty() || own.is_empty() {
            continue;
        }
        let least = own.iter().copied().fold(f64::INFINITY, f64::min);
        let signal = (1.0 / least.max(1e-300) - 1.0 / usual).max(0.0).sqrt();
        let below = WIDTHS.map(|width| {
            let limit = VISIBLE / (signal * width).max(1e-12);
            libm::erf(limit / core::f64::consts::SQRT_2)
        });
        found.push((form.cause, below.iter().sum::<f64>() / WIDTHS.len() as f64));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(cause: usize) -> Variant {
        Variant {
            cause,
            is_unexplained: false,
            offsets: Vec::new(),
            free: vec![1 + cause],
            bounds: vec![(f64::NEG_INFINITY, f64::INFINITY)],
            weight: 1.0,
        }
    }

    fn ranked(causes: &[usize], log_posterior: f64, variance: f64) -> RankedHypothesis {
        RankedHypothesis {
            variants: causes.iter().map(|&cause| form(cause)).collect(),
            log_posterior,
            variances: vec![variance; causes.len()],
        }
    }

    const PRIOR: Prior = Prior {
        causes: [0.44, 0.45, 0.1, 0.01],
        unexplained: 0.05,
    };

    #[test]
    fn a_size_that_is_well_known_moves_nothing() {
        let hypotheses = [ranked(&[0], 0.0, 1e-9), ranked(&[], -1.0, 1.0)];
        let found = rank(&hypotheses, 5, &PRIOR);
        let share = 1.0 / (1.0 + (-1.0_f64).exp());
        assert!((found.probability[0] - share).abs() < 1e-15);
        assert_eq!(found.sets[0].0, [Some(0)]);
        assert!((found.sets[0].1 - share).abs() < 1e-4);
    }

    #[test]
    fn a_size_that_nobody_knows_is_no_cause() {
        // the variance of the prior: no information, so all of the prior is below the noise
        let usual = (1.0 / 9.0 + 1.0 + 9.0) / 3.0;
        let hypotheses = [ranked(&[], 0.0, 1.0), ranked(&[0], -3.0, usual)];
        let found = rank(&hypotheses, 2, &PRIOR);
        let before = found.probability[1];
        let moved = (0.45 / 2.0 / 0.44 * found.probability[0]).min(before);
        assert_eq!(found.sets[0].0, []);
        assert!((found.sets[0].1 - (found.probability[0] + moved)).abs() < 1e-12);
        assert!((found.sets[1].1 - (before - moved)).abs() < 1e-12);
    }

    #[test]
    fn forms_of_the_same_causes_are_one_set() {
        let hypotheses = [ranked(&[1, 0], 0.0, 1e-9), ranked(&[0, 1], 0.0, 1e-9)];
        let found = rank(&hypotheses, 2, &PRIOR);
        assert_eq!(found.sets, [(vec![Some(0), Some(1)], 1.0)]);
    }
}

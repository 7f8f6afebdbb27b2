//! How good a hypothesis must be to matter beside those known.

use super::candidates::{Candidate, Candidates};
use super::options::SearchOptions;
use crate::solve::EvidenceSolver;
use std::collections::HashMap;

/// The most probable sets that a further cause is added to.
pub(super) const EXTENDED: usize = 4;
/// The most probable hypotheses that are also tried beside an unexplained term.
pub(super) const BESIDE: usize = 8;
/// Log odds beyond which a hypothesis is not reported: a probability below one in a million.
pub(super) const NEGLIGIBLE: f64 = 14.0;
/// What an estimate of log evidence may miss: 1.04 at most in 812 sets of three and four causes, see
/// [`EvidenceSolver::estimate`].
const MISSED: f64 = 1.1;
/// Candidates that are scored before it is asked again what still matters; then twice as many, and so
/// on. Each thread of a usual machine has some to do.
const FIRST: usize = 16;

/// Scores the candidates that matter beside those found before: a bound on each comes first, and the
/// most promising are scored first.
pub(super) fn scored_if_they_matter(
    of: &Candidates<'_>,
    mut candidates: Vec<Candidate>,
    found: &[Candidate],
    leads: Option<usize>,
) -> Vec<Candidate> {
    let bounds = of.each(&candidates, EvidenceSolver::bound);
    for (candidate, bound) in candidates.iter_mut().zip(bounds) {
        candidate.score = bound;
    }
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    let (mut kept, mut batch) = (Vec::new(), FIRST);
    loop {
        let floor = floor(of, found.iter().chain(&kept), leads);
        let matters = candidates.iter().take_while(|c| c.score > floor).count();
        if matters == 0 {
            kept.retain(|c: &Candidate| c.score > floor);
            return kept;
        }
        let rest = candidates.split_off(matters.min(batch));
        kept.extend(of.scored(candidates));
        (candidates, batch) = (rest, 2 * batch);
    }
}

/// Score below which a hypothesis is neither reported nor extended by a further cause or by an
/// unexplained term.
///
/// `leads`: the number of causes of hypotheses that can be extended. Where nothing is pruned, every
/// hypothesis matters.
fn floor<'a>(
    of: &Candidates<'_>,
    known: impl Iterator<Item = &'a Candidate>,
    leads: Option<usize>,
) -> f64 {
    let options = of.options;
    if options.pruning_log_odds.is_infinite() {
        return f64::NEG_INFINITY;
    }
    let mut best: HashMap<Vec<usize>, f64> = HashMap::new();
    for candidate in known {
        let best = best
            .entry(of.causes_of(candidate))
            .or_insert(f64::NEG_INFINITY);
        *best = best.max(candidate.score);
    }
    let sets = best.iter().map(|(causes, &score)| (causes.len(), score));
    lowest(&sets.collect::<Vec<_>>(), options, leads)
}

/// The floor, from the number of causes and the best score of each set of causes.
fn lowest(sets: &[(usize, f64)], options: &SearchOptions, leads: Option<usize>) -> f64 {
    let nth = |wanted: &dyn Fn(usize) -> bool, place: usize| {
        let sets = sets.iter().filter(|(causes, _)| wanted(*causes));
        let mut scores: Vec<f64> = sets.map(|&(_, score)| score).collect();
        scores.sort_by(|a, b| b.total_cmp(a));
        scores.get(place - 1).copied().unwrap_or(f64::NEG_INFINITY)
    };
    let top = nth(&|_| true, 1);
    let mut needed = top - NEGLIGIBLE - MISSED;
    if let Some(count) = leads {
        let leading = nth(&|causes| causes == count, EXTENDED).min(nth(&|_| true, BESIDE));
        needed = needed.min(leading - options.form_preference);
    }
    needed.max(top - options.pruning_log_odds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_reported_or_leads_to_others_is_above_the_floor() {
        let sets: Vec<(usize, f64)> = (0..10).map(|k| (2, -2.0 * f64::from(k))).collect();
        let lowest = |sets: &[(usize, f64)], pruning_log_odds, leads| {
            let options = SearchOptions {
                pruning_log_odds,
                form_preference: 1.5,
                unlisted: 0.0,
            };
            lowest(sets, &options, leads)
        };
        // the eighth best is at -14: what leads there may be 1.5 below it
        assert_eq!(lowest(&sets, 25.0, Some(2)), -15.5);
        assert_eq!(lowest(&sets, 15.0, Some(2)), -15.0);
        assert_eq!(lowest(&sets, 25.0, None), -NEGLIGIBLE - MISSED);
        // fewer than four sets of three causes: every one may lead
        assert_eq!(lowest(&sets, 25.0, Some(3)), -25.0);
    }
}

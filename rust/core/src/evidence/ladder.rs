//! How good a hypothesis must be to matter beside those known.

use super::posterior::{Candidate, Search};
use std::collections::HashMap;

/// The most probable sets that a further cause is added to.
pub(super) const EXTENDED: usize = 4;
/// The most probable hypotheses that are also tried beside a shape.
pub(super) const BESIDE: usize = 8;
/// Log odds between two forms of the same causes below which neither is better.
pub(super) const UNDECIDED: f64 = 1.5;
/// Log odds beyond which a hypothesis is not reported: a probability below one in a million.
pub(super) const NEGLIGIBLE: f64 = 14.0;
/// What an estimate of log evidence may miss.
const MISSED: f64 = 1.1;

/// Score below which a hypothesis neither is reported nor leads to one of another cause or a shape.
///
/// Where it leads to others, it is of so many causes as `leads`. Where no odds are hopeless, every
/// hypothesis matters.
pub(super) fn floor<'a>(
    search: &Search<'_>,
    known: impl Iterator<Item = &'a Candidate>,
    leads: Option<usize>,
) -> f64 {
    if search.hopeless().is_infinite() {
        return f64::NEG_INFINITY;
    }
    let mut best: HashMap<Vec<usize>, f64> = HashMap::new();
    for candidate in known {
        let best = best
            .entry(search.causes_of(candidate))
            .or_insert(f64::NEG_INFINITY);
        *best = best.max(candidate.score);
    }
    let nth = |wanted: &dyn Fn(usize) -> bool, place: usize| {
        let sets = best.iter().filter(|(causes, _)| wanted(causes.len()));
        let mut scores: Vec<f64> = sets.map(|(_, &score)| score).collect();
        scores.sort_by(|a, b| b.total_cmp(a));
        scores.get(place - 1).copied().unwrap_or(f64::NEG_INFINITY)
    };
    let top = nth(&|_| true, 1);
    let mut needed = top - NEGLIGIBLE - MISSED;
    if let Some(count) = leads {
        let leading = nth(&|causes| causes == count, EXTENDED).min(nth(&|_| true, BESIDE));
        needed = needed.min(leading - UNDECIDED);
    }
    needed.max(top - search.hopeless())
}

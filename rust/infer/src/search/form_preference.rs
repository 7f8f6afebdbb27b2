//! Which of several forms of the same causes stands for them.

use super::candidates::{Candidate, Candidates};

/// Log odds between two forms of the same causes below which neither is preferred by its evidence, and
/// the one with more coefficients is taken: odds of 4.5, well below the 20 that count as "strong" in
/// Kass & Raftery 1995, doi:10.1080/01621459.1995.10476572.
pub(super) const FORM_PREFERENCE_LOG_ODDS: f64 = 1.5;

/// The best hypothesis of each set of causes, most probable first. Among forms of nearly the same
/// probability the one with more coefficients is preferred.
pub(super) fn preferred<'c>(of: &Candidates<'_>, found: &'c [Candidate]) -> Vec<&'c Candidate> {
    let mut sorted: Vec<&Candidate> = found.iter().collect();
    sorted.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut chosen: Vec<(Vec<usize>, f64, &Candidate)> = Vec::new();
    for candidate in sorted {
        let causes = of.causes_of(candidate);
        match chosen.iter_mut().find(|(same, _, _)| *same == causes) {
            None => chosen.push((causes, candidate.score, candidate)),
            Some((_, best, preferred)) => {
                let freer = of.freedom(candidate) > of.freedom(preferred);
                if freer && candidate.score > *best - FORM_PREFERENCE_LOG_ODDS {
                    *preferred = candidate;
                }
            }
        }
    }
    let each = chosen.into_iter();
    each.map(|(_, _, candidate)| candidate).collect()
}

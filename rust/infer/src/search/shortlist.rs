//! The shortlist: the forms of each cause that are combined with other causes.

use super::candidates::{Candidate, Candidates};
use std::collections::HashMap;

/// Forms of a cause on the shortlist: as many of the best by themselves.
const ALONE: usize = 2;
/// And as many of the best beside the best single cause: where another cause is large, the form
/// that is right by itself may be wrong (a step is best placed where the other cause has one).
const BESIDE: usize = 2;

/// Picks, for each cause, the best forms by themselves and beside the leading cause, and the one with
/// the most coefficients.
pub(super) fn shortlist(of: &Candidates<'_>, singles: &[Candidate]) -> Vec<Vec<usize>> {
    let alone: HashMap<usize, f64> = singles
        .iter()
        .filter_map(|c| Some((*c.variants.first()?, c.score)))
        .collect();
    let leader = alone
        .iter()
        .max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(a.0)));
    let beside = leader.map_or_else(HashMap::new, |(&leader, _)| scores_beside(of, leader));
    let freedom = |v: usize| of.variants[v].free.len();
    let each = of.causes.iter();
    each.map(|forms| best_forms(forms, &alone, &beside, freedom))
        .collect()
}

/// The best forms of one cause, given their scores alone and beside the leading cause.
fn best_forms(
    forms: &[usize],
    alone: &HashMap<usize, f64>,
    beside: &HashMap<usize, f64>,
    freedom: impl Fn(usize) -> usize,
) -> Vec<usize> {
    let score =
        |of: &HashMap<usize, f64>, v: usize| of.get(&v).copied().unwrap_or(f64::NEG_INFINITY);
    let mut rest = forms.to_vec();
    let mut kept = take_best(&mut rest, ALONE, |v| score(alone, v));
    kept.extend(take_best(&mut rest, BESIDE, |v| score(beside, v)));
    let most = kept.iter().map(|&v| freedom(v)).max();
    rest.sort_by(|&a, &b| score(alone, b).total_cmp(&score(alone, a)));
    kept.extend(rest.into_iter().find(|&v| Some(freedom(v)) > most));
    kept
}

/// Score of every form of every other cause of many forms beside one form.
fn scores_beside(of: &Candidates<'_>, leader: usize) -> HashMap<usize, f64> {
    let others = of.causes.iter().filter(|forms| !forms.contains(&leader));
    let many = others
        .filter(|forms| forms.len() > ALONE + BESIDE)
        .flatten();
    let pairs = many.map(|&v| of.candidate(vec![leader, v], 1.0));
    let scored = of.scored(pairs.collect());
    scored
        .into_iter()
        .map(|c| (c.variants[1], c.score))
        .collect()
}

/// Takes the forms of the highest scores out, best first.
fn take_best(forms: &mut Vec<usize>, count: usize, score: impl Fn(usize) -> f64) -> Vec<usize> {
    forms.sort_by(|&a, &b| score(b).total_cmp(&score(a)));
    let rest = forms.split_off(count.min(forms.len()));
    core::mem::replace(forms, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_alone_the_best_beside_and_the_most_coefficients() {
        let alone: HashMap<usize, f64> = (0..6).map(|v| (v, -(v as f64))).collect();
        let beside: HashMap<usize, f64> = (0..6).map(|v| (v, v as f64)).collect();
        let freedom = |v: usize| if v == 3 { 2 } else { 1 };
        let found = best_forms(&[0, 1, 2, 3, 4, 5], &alone, &beside, freedom);
        assert_eq!(found, [0, 1, 5, 4, 3]);
        let found = best_forms(&[0, 1, 2, 3, 4, 5], &alone, &HashMap::new(), |_| 1);
        assert_eq!(found, [0, 1, 2, 3]); // no score beside: the order of before
    }
}

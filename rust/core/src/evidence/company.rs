//! The forms of each cause worth combining with others.

use super::posterior::{Candidate, Search};
use std::collections::HashMap;

/// Forms of a cause that are tried in company: as many of the best by themselves.
const ALONE: usize = 2;
/// And as many of the best beside the best single cause: where another cause is large, the form
/// that is right by itself tells nothing (a step is best placed where the other cause has one).
const BESIDE: usize = 2;

/// Picks, for each cause, the best forms by themselves and beside the leading cause, and the freest.
pub(super) fn promising(search: &Search<'_>, singles: &[Candidate]) -> Vec<Vec<usize>> {
    let alone: HashMap<usize, f64> = singles
        .iter()
        .filter_map(|c| Some((*c.variants.first()?, c.score)))
        .collect();
    let score =
        |of: &HashMap<usize, f64>, v: usize| of.get(&v).copied().unwrap_or(f64::NEG_INFINITY);
    let leader = alone
        .iter()
        .max_by(|a, b| a.1.total_cmp(b.1).then(b.0.cmp(a.0)));
    let beside = leader.map_or_else(HashMap::new, |(&leader, _)| company_of(search, leader));
    let best = |forms: &Vec<usize>| {
        let mut rest = forms.clone();
        let mut kept = take_best(&mut rest, ALONE, |v| score(&alone, v));
        kept.extend(take_best(&mut rest, BESIDE, |v| score(&beside, v)));
        let freedom = |v: usize| search.variants[v].free.len();
        let most = kept.iter().map(|&v| freedom(v)).max();
        rest.sort_by(|&a, &b| score(&alone, b).total_cmp(&score(&alone, a)));
        kept.extend(rest.into_iter().find(|&v| Some(freedom(v)) > most));
        kept
    };
    search.causes.iter().map(best).collect()
}

/// Score of every form of every other cause of many forms beside one form.
fn company_of(search: &Search<'_>, leader: usize) -> HashMap<usize, f64> {
    let others = search
        .causes
        .iter()
        .filter(|forms| !forms.contains(&leader));
    let many = others
        .filter(|forms| forms.len() > ALONE + BESIDE)
        .flatten();
    let pairs = many.map(|&v| search.candidate(vec![leader, v], 1.0));
    let scored = search.scored(pairs.collect());
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

//! The posterior over hypotheses: no cause, each cause, each pair, larger sets greedily, and the best of
//! all beside an unexplained term (docs/method.md, Eq. 8 and 18, and section 5).

use super::candidates::{Candidate, Candidates, MOST_CAUSES};
use super::form_preference::preferred;
use super::noise_selection::NoiseSelection;
use super::options::SearchOptions;
use super::prior::Prior;
use super::pruning::{BESIDE, EXTENDED, NEGLIGIBLE, scored_if_they_matter};
use super::shortlist::shortlist;
use crate::parallel::each_of;
use crate::solve::{
    Accuracy, EvidenceSolver, HypothesisColumns, HypothesisFit, NoiseTable, Variant, WhitenedStack,
    columns, log_sum,
};
use std::collections::HashMap;

/// A hypothesis with its place in the posterior.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its variants, by index.
    pub variants: Vec<usize>,
    /// Probability before the data.
    pub prior: f64,
    /// After the data.
    pub fit: HypothesisFit,
}

impl Outcome {
    /// Up to the constant that normalizes: docs/method.md, Eq. 18.
    fn log_posterior(&self) -> f64 {
        self.fit.log_evidence + self.prior.ln()
    }
}

/// What a search found.
#[derive(Clone, Debug)]
pub struct Posterior {
    /// The hypotheses that are not pruned, most probable first.
    pub outcomes: Vec<Outcome>,
    /// Whether each noise was taken into account.
    pub noises: Vec<bool>,
    /// Number of linear systems solved.
    pub systems: usize,
}

/// Probability that the least probable hypotheses, which are fitted roughly, share: less than a
/// report shows.
const REMOTE: f64 = 1e-3;

/// The posterior over every hypothesis that competes.
///
/// The search takes the plausible noises into account; where its best hypotheses allow others, it is
/// made again with these.
#[must_use]
pub fn posterior(
    stack: &WhitenedStack<'_>,
    variants: &[Variant],
    prior: &Prior,
    options: &SearchOptions,
    threads: usize,
) -> Posterior {
    let (unexplained, causes) = by_cause(variants);
    let all = columns(variants, stack.width - 1);
    let every = NoiseTable::of(stack, &all, threads);
    let explained = prior.explained(!unexplained.is_empty());
    let before = (prior, options);
    let mut noises = NoiseSelection::of(&every, variants, &causes, &unexplained, before, threads);
    loop {
        let table = every.carried(&noises.search, &all, threads);
        let candidates = Candidates {
            table: table.as_ref().unwrap_or(&every),
            variants,
            causes: &causes,
            explained,
            prior,
            options,
            threads,
        };
        let found = competitors(&candidates, &unexplained);
        let best = preferred(&candidates, &found).into_iter().take(BESIDE);
        let best: Vec<_> = best.map(|c| c.variants.clone()).collect();
        if !noises.extend(&every, variants, &best, threads) {
            let table = every.carried(&noises.fit, &all, threads);
            let candidates = Candidates {
                table: table.as_ref().unwrap_or(&every),
                ..candidates
            };
            return Posterior {
                outcomes: outcomes(&candidates, found),
                noises: noises.fit,
                systems: every.solved(),
            };
        }
    }
}

/// Unexplained terms, and the variants of each cause in the order in which the causes appear.
fn by_cause(variants: &[Variant]) -> (Vec<usize>, Vec<Vec<usize>>) {
    let (unexplained, known): (Vec<usize>, Vec<usize>) =
        (0..variants.len()).partition(|&v| variants[v].is_unexplained);
    let mut causes: Vec<Vec<usize>> = Vec::new();
    let mut place = HashMap::new();
    for v in known {
        let at = *place.entry(variants[v].cause).or_insert_with(|| {
            causes.push(Vec::new());
            causes.len() - 1
        });
        causes[at].push(v);
    }
    (unexplained, causes)
}

/// Every hypothesis that is not pruned under the noises taken into account.
fn competitors(of: &Candidates<'_>, unexplained: &[usize]) -> Vec<Candidate> {
    let mut found = of.scored(of.singles());
    let shortlist = shortlist(of, &found);
    let forms = shortlist.iter().flatten().map(|&v| &of.variants[v]);
    let columns = columns(forms, of.table.width - 1);
    let narrow = of
        .table
        .only(&vec![true; of.table.noises()], &columns, of.threads);
    let short = Candidates {
        causes: &shortlist,
        table: &narrow,
        ..*of
    };
    let pairs = scored_if_they_matter(&short, short.pairs(), &found, Some(2));
    found.extend(pairs);
    for count in 3..=MOST_CAUSES {
        let smaller = preferred(&short, &found).into_iter();
        let smaller = smaller.filter(|c| c.variants.len() == count - 1);
        let smaller: Vec<_> = smaller.take(EXTENDED).collect();
        let extended = short.extended(&smaller, count);
        let before = top(&found);
        let larger = scored_if_they_matter(&short, extended, &found, Some(count));
        found.extend(larger);
        if top(&found) <= before {
            break;
        }
    }
    let short = Candidates {
        table: of.table,
        ..short
    };
    let sorted = preferred(&short, &found);
    let (chosen, others) = sorted.split_at(BESIDE.min(sorted.len()));
    let none = others.iter().filter(|c| c.variants.is_empty());
    let bases: Vec<&Candidate> = chosen.iter().chain(none).copied().collect();
    let beside = short.beside(&bases, unexplained);
    let beside = scored_if_they_matter(&short, beside, &found, None);
    found.extend(beside);
    without_needless(&short, &mut found, unexplained);
    found
}

/// Adds hypotheses beside an unexplained term without one of their causes, while that makes a better one.
///
/// The sets of causes are found without a term. Beside one, a cause may be needless that took its place.
fn without_needless(of: &Candidates<'_>, found: &mut Vec<Candidate>, unexplained: &[usize]) {
    for _ in 0..MOST_CAUSES {
        let mut best: Vec<&Candidate> = found.iter().collect();
        best.sort_by(|a, b| b.score.total_cmp(&a.score));
        best.truncate(EXTENDED);
        let mut smaller = of.without_one(&best, unexplained);
        smaller.retain(|one| found.iter().all(|known| !same(known, one)));
        let before = top(found);
        let smaller = scored_if_they_matter(of, smaller, found, None);
        found.extend(smaller);
        if top(found) <= before {
            break;
        }
    }
}

/// Whether two hypotheses have the same variants.
fn same(one: &Candidate, other: &Candidate) -> bool {
    one.variants.len() == other.variants.len()
        && one.variants.iter().all(|v| other.variants.contains(v))
}

fn top(found: &[Candidate]) -> f64 {
    let scores = found.iter().map(|c| c.score);
    scores.fold(f64::NEG_INFINITY, f64::max)
}

/// The fits of the hypotheses that are worth a report, most probable first.
fn outcomes(of: &Candidates<'_>, mut found: Vec<Candidate>) -> Vec<Outcome> {
    found.sort_by(|a, b| b.score.total_cmp(&a.score));
    let total = log_sum(found.iter().map(|c| c.score));
    found.retain(|c| c.score > total - NEGLIGIBLE || c.variants.is_empty());
    let mut before = 0.0;
    let with_accuracy = found.into_iter().filter_map(|candidate| {
        let accuracy = if before < 1.0 - REMOTE {
            Accuracy::Full
        } else {
            Accuracy::Rough
        };
        let listed = before < 1.0 - of.options.unlisted || candidate.variants.is_empty();
        before += (candidate.score - total).exp();
        listed.then_some((candidate, accuracy))
    });
    let all: Vec<_> = with_accuracy.collect();
    let mut outcomes = each_of(&all, of.threads, || {
        let (mut solver, mut layout) = (EvidenceSolver::default(), HypothesisColumns::default());
        move |(candidate, accuracy): &(Candidate, Accuracy)| {
            layout.fill(of.variants_of(candidate));
            Outcome {
                fit: solver.fit(of.table, &layout, *accuracy),
                variants: candidate.variants.clone(),
                prior: candidate.prior,
            }
        }
    });
    outcomes.sort_by(|a, b| b.log_posterior().total_cmp(&a.log_posterior()));
    outcomes
}

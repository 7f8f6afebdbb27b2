//! No cause, each cause, each pair, larger sets greedily, and the best of all beside a shape.

use super::company::promising;
use super::hypothesis::{Layout, Variant, columns};
use super::ladder::{BESIDE, EXTENDED, NEGLIGIBLE, UNDECIDED, floor};
use super::mixture::log_sum;
use super::noises::Carried;
use super::prior::{Prior, combinations};
use super::stack::{Stack, Table};
use super::threaded::each_of;
use super::weigh::{Care, Scales, Weighed};
use std::collections::HashMap;

/// A hypothesis with its place in the posterior.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its variants, by index.
    pub variants: Vec<usize>,
    /// Probability before the data.
    pub prior: f64,
    /// After the data.
    pub weighed: Weighed,
}

/// Causes at once that are tried, while each further one makes a better set.
const MOST: usize = 6;
/// Probability that the least probable hypotheses, which are weighed with less care, share.
const REMOTE: f64 = 1e-3;
/// Candidates that are scored before it is asked again what still matters; then twice as many, ...
const FIRST: usize = 16;

pub(super) struct Candidate {
    pub(super) variants: Vec<usize>,
    prior: f64,
    pub(super) score: f64,
}

/// Weighs every hypothesis that competes.
///
/// The search carries the plausible noises along; where its best hypotheses allow others, it is made
/// again with these.
///
/// Returns the hypotheses that are not hopeless, most probable first, with the noises that were
/// carried along, and the number of linear systems solved under these.
#[must_use]
pub fn posterior(
    stack: &Stack<'_>,
    variants: &[Variant],
    prior: &Prior,
    threads: usize,
) -> (Vec<Outcome>, Vec<bool>, usize) {
    let (shapes, known): (Vec<usize>, Vec<usize>) =
        (0..variants.len()).partition(|&v| variants[v].is_shape);
    let mut causes: Vec<Vec<usize>> = Vec::new();
    let mut place = HashMap::new();
    for v in known {
        let at = *place.entry(variants[v].cause).or_insert_with(|| {
            causes.push(Vec::new());
            causes.len() - 1
        });
        causes[at].push(v);
    }
    let all = columns(variants, stack.width - 1);
    let every = Table::of(stack, &all, threads);
    let share = if shapes.is_empty() {
        1.0
    } else {
        1.0 - prior.shape
    };
    let mut noises = Carried::of(&every, variants, &causes, &shapes, prior, threads);
    loop {
        let table = every.carried(&noises.search, &all, threads);
        let search = Search {
            table: table.as_ref().unwrap_or(&every),
            variants,
            causes: &causes,
            share,
            prior,
            threads,
        };
        let found = search.found(&shapes);
        let best = search.distinct(&found).into_iter().take(BESIDE);
        let best: Vec<_> = best.map(|c| c.variants.clone()).collect();
        if !noises.extend(&every, variants, &best, threads) {
            let table = every.carried(&noises.weigh, &all, threads);
            let search = Search {
                table: table.as_ref().unwrap_or(&every),
                ..search
            };
            return (search.outcomes(found), noises.weigh, every.solved());
        }
    }
}

fn top(found: &[Candidate]) -> f64 {
    let scores = found.iter().map(|c| c.score);
    scores.fold(f64::NEG_INFINITY, f64::max)
}

pub(super) struct Search<'a> {
    table: &'a Table,
    pub(super) variants: &'a [Variant],
    pub(super) causes: &'a [Vec<usize>],
    /// Probability that no shape is there.
    share: f64,
    prior: &'a Prior,
    threads: usize,
}

impl Search<'_> {
    /// Every hypothesis that is not hopeless under the noises carried along.
    fn found(&self, shapes: &[usize]) -> Vec<Candidate> {
        let mut found = self.scored(self.singles());
        let promising = promising(self, &found);
        let forms = promising.iter().flatten().map(|&v| &self.variants[v]);
        let columns = columns(forms, self.table.width - 1);
        let narrow = self
            .table
            .only(&vec![true; self.table.noises()], &columns, self.threads);
        let search = Search {
            causes: &promising,
            table: &narrow,
            ..*self
        };
        found.extend(search.weigh(search.pairs(), &found, Some(2)));
        for count in 3..=MOST {
            let extended = search.extended(&search.distinct(&found), count);
            let before = top(&found);
            found.extend(search.weigh(extended, &found, Some(count)));
            if top(&found) <= before {
                break;
            }
        }
        let search = Search {
            table: self.table,
            ..search
        };
        let beside = search.beside(&search.distinct(&found), shapes);
        found.extend(search.weigh(beside, &found, None));
        found
    }

    pub(super) fn candidate(&self, variants: Vec<usize>, prior: f64) -> Candidate {
        let weight: f64 = variants.iter().map(|&v| self.variants[v].weight).product();
        Candidate {
            variants,
            prior: prior * weight,
            score: f64::NAN,
        }
    }

    /// Nothing, and every form of every cause.
    fn singles(&self) -> Vec<Candidate> {
        let [none, one, ..] = self.prior.causes.map(|p| self.share * p);
        let count = self.causes.len() as f64;
        let forms = self.causes.iter().flatten();
        let each = forms.map(|&v| self.candidate(vec![v], one / count));
        [self.candidate(Vec::new(), none)]
            .into_iter()
            .chain(each)
            .collect()
    }

    /// Every pair of causes.
    fn pairs(&self) -> Vec<Candidate> {
        let count = self.causes.len() as f64;
        let prior = self.share * self.prior.causes[2] / (count * (count - 1.0) / 2.0);
        let mut made = Vec::new();
        for (i, first) in self.causes.iter().enumerate() {
            for second in self.causes[i + 1..].iter().flatten() {
                made.extend(
                    first
                        .iter()
                        .map(|&a| self.candidate(vec![a, *second], prior)),
                );
            }
        }
        made
    }

    /// The best sets of one cause less, each with every further cause.
    fn extended(&self, distinct: &[&Candidate], count: usize) -> Vec<Candidate> {
        let all = self.causes.len();
        if all < count {
            return Vec::new();
        }
        let prior = self.share * self.prior.of(count) / combinations(all, count);
        let place = |v: &usize| self.causes.iter().position(|forms| forms.contains(v));
        let smaller = distinct.iter().filter(|c| c.variants.len() == count - 1);
        let mut tried: Vec<Vec<usize>> = Vec::new();
        for set in smaller.take(EXTENDED) {
            let Some(set) = set.variants.iter().map(place).collect::<Option<Vec<_>>>() else {
                continue;
            };
            for further in (0..all).filter(|further| !set.contains(further)) {
                let mut larger = [&set[..], &[further]].concat();
                larger.sort_unstable();
                if !tried.contains(&larger) {
                    tried.push(larger);
                }
            }
        }
        let mut made = Vec::new();
        for set in tried {
            let mut chosen = vec![Vec::new()];
            for forms in set.iter().map(|&cause| &self.causes[cause]) {
                let longer = |some: &Vec<usize>| {
                    let some = some.clone();
                    forms.iter().map(move |&form| [&some[..], &[form]].concat())
                };
                chosen = chosen.iter().flat_map(longer).collect();
            }
            made.extend(chosen.into_iter().map(|some| self.candidate(some, prior)));
        }
        made
    }

    /// The best hypotheses, each beside every shape.
    fn beside(&self, distinct: &[&Candidate], shapes: &[usize]) -> Vec<Candidate> {
        let (chosen, others) = distinct.split_at(BESIDE.min(distinct.len()));
        let null = others.iter().filter(|c| c.variants.is_empty());
        let share = self.prior.shape / self.share / shapes.len().max(1) as f64;
        let mut made = Vec::new();
        for base in chosen.iter().chain(null) {
            for &shape in shapes {
                let variants = [&base.variants[..], &[shape]].concat();
                made.push(Candidate {
                    variants,
                    prior: base.prior * share,
                    score: f64::NAN,
                });
            }
        }
        made
    }

    /// The best hypotheses that name different causes, most probable first.
    fn distinct<'c>(&self, found: &'c [Candidate]) -> Vec<&'c Candidate> {
        let mut sorted: Vec<&Candidate> = found.iter().collect();
        sorted.sort_by(|a, b| b.score.total_cmp(&a.score));
        let mut chosen: Vec<(Vec<usize>, f64, &Candidate)> = Vec::new();
        for candidate in sorted {
            let causes = self.causes_of(candidate);
            match chosen.iter_mut().find(|(same, _, _)| *same == causes) {
                None => chosen.push((causes, candidate.score, candidate)),
                Some((_, best, preferred)) => {
                    let freer = self.freedom(candidate) > self.freedom(preferred);
                    if freer && candidate.score > *best - UNDECIDED {
                        *preferred = candidate;
                    }
                }
            }
        }
        chosen
            .into_iter()
            .map(|(_, _, candidate)| candidate)
            .collect()
    }

    fn freedom(&self, candidate: &Candidate) -> usize {
        candidate
            .variants
            .iter()
            .map(|&v| self.variants[v].free.len())
            .sum()
    }

    /// Scores the candidates that matter beside those found before: a quick look bounds each, and
    /// the most promising are scored first.
    fn weigh(
        &self,
        mut candidates: Vec<Candidate>,
        found: &[Candidate],
        leads: Option<usize>,
    ) -> Vec<Candidate> {
        let bounds = self.each(&candidates, Scales::bound);
        for (candidate, bound) in candidates.iter_mut().zip(bounds) {
            candidate.score = bound;
        }
        candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
        let (mut kept, mut batch) = (Vec::new(), FIRST);
        loop {
            let floor = floor(self, found.iter().chain(&kept), leads);
            let matters = candidates.iter().take_while(|c| c.score > floor).count();
            if matters == 0 {
                kept.retain(|c: &Candidate| c.score > floor);
                return kept;
            }
            let rest = candidates.split_off(matters.min(batch));
            kept.extend(self.scored(candidates));
            (candidates, batch) = (rest, 2 * batch);
        }
    }

    /// Scores all candidates.
    pub(super) fn scored(&self, mut candidates: Vec<Candidate>) -> Vec<Candidate> {
        let scores = self.each(&candidates, Scales::estimate);
        for (candidate, score) in candidates.iter_mut().zip(scores) {
            candidate.score = score;
        }
        candidates
    }

    /// Causes of a candidate.
    pub(super) fn causes_of(&self, candidate: &Candidate) -> Vec<usize> {
        let variants = candidate.variants.iter();
        variants.map(|&v| self.variants[v].cause).collect()
    }

    /// Log odds against the most probable beyond which a candidate is left out.
    pub(super) fn hopeless(&self) -> f64 {
        self.prior.hopeless
    }

    /// Log evidence, roughly or at most, of each candidate, its prior included.
    fn each(
        &self,
        candidates: &[Candidate],
        evidence: fn(&mut Scales, &Table, &Layout) -> f64,
    ) -> Vec<f64> {
        each_of(candidates, self.threads, || {
            let (mut scales, mut layout) = (Scales::default(), Layout::default());
            move |candidate: &Candidate| {
                layout.fill(candidate.variants.iter().map(|&v| &self.variants[v]));
                evidence(&mut scales, self.table, &layout) + candidate.prior.ln()
            }
        })
    }

    fn outcomes(&self, mut found: Vec<Candidate>) -> Vec<Outcome> {
        found.sort_by(|a, b| b.score.total_cmp(&a.score));
        let total = log_sum(found.iter().map(|c| c.score));
        found.retain(|c| c.score > total - NEGLIGIBLE || c.variants.is_empty());
        let mut before = 0.0;
        let careful = found.into_iter().map(|candidate| {
            let care = if before < 1.0 - REMOTE {
                Care::Every
            } else {
                Care::Rough
            };
            before += (candidate.score - total).exp();
            (candidate, care)
        });
        let careful: Vec<_> = careful.collect();
        let mut outcomes = each_of(&careful, self.threads, || {
            let (mut scales, mut layout) = (Scales::default(), Layout::default());
            move |(candidate, care): &(Candidate, Care)| {
                layout.fill(candidate.variants.iter().map(|&v| &self.variants[v]));
                Outcome {
                    weighed: scales.weigh(self.table, &layout, *care),
                    variants: candidate.variants.clone(),
                    prior: candidate.prior,
                }
            }
        });
        outcomes.sort_by(|a, b| b.log_posterior().total_cmp(&a.log_posterior()));
        outcomes
    }
}

impl Outcome {
    fn log_posterior(&self) -> f64 {
        self.weighed.log_evidence + self.prior.ln()
    }
}

/// Weighs hypotheses, each by itself; with `one_width` with the widest prior alone.
#[must_use]
pub fn weigh(
    stack: &Stack<'_>,
    hypotheses: &[Vec<Variant>],
    one_width: bool,
    threads: usize,
) -> Vec<Weighed> {
    let care = if one_width { Care::Widest } else { Care::Every };
    each_of(hypotheses, threads, || {
        let (mut scales, mut layout) = (Scales::default(), Layout::default());
        move |variants: &Vec<Variant>| {
            layout.fill(variants);
            let table = Table::of(stack, &columns(variants, stack.width - 1), 1);
            scales.weigh(&table, &layout, care)
        }
    })
}

//! Hypotheses that compete, and their scores.

use super::options::SearchOptions;
use super::prior::Prior;
use crate::parallel::each_of;
use crate::solve::{EvidenceSolver, HypothesisColumns, NoiseTable, Variant};

/// Causes at once that are tried, while each further one makes a better set.
pub(super) const MOST_CAUSES: usize = 6;

/// A hypothesis: one variant of each of its causes.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    /// Its variants, by index.
    pub variants: Vec<usize>,
    /// Probability before the data.
    pub prior: f64,
    /// Log evidence, estimated or at most, and log prior.
    pub score: f64,
}

impl Candidate {
    /// One that is not scored yet.
    pub fn new(variants: Vec<usize>, prior: f64) -> Self {
        Self {
            variants,
            prior,
            score: f64::NAN,
        }
    }
}

/// What hypotheses are made of, and how they are scored.
#[derive(Clone, Copy)]
pub(super) struct Candidates<'a> {
    /// Whitened products under the noises that the search takes along.
    pub table: &'a NoiseTable,
    /// Every variant.
    pub variants: &'a [Variant],
    /// Variants of each cause.
    pub causes: &'a [Vec<usize>],
    /// Probability that there is no unexplained term.
    pub explained: f64,
    /// Probabilities before the data.
    pub prior: &'a Prior,
    /// What is left out.
    pub options: &'a SearchOptions,
    /// Threads at most.
    pub threads: usize,
}

impl Candidates<'_> {
    /// A hypothesis with the probability of its causes, and of their variants.
    pub fn candidate(&self, variants: Vec<usize>, prior: f64) -> Candidate {
        let weight: f64 = variants.iter().map(|&v| self.variants[v].weight).product();
        Candidate::new(variants, prior * weight)
    }

    /// No cause, and every variant of every cause.
    pub fn singles(&self) -> Vec<Candidate> {
        let of = |count: usize| self.explained * self.prior.of_set(count, self.causes.len());
        let (none, one) = (of(0), of(1));
        let forms = self.causes.iter().flatten();
        let each = forms.map(|&v| self.candidate(vec![v], one));
        [self.candidate(Vec::new(), none)]
            .into_iter()
            .chain(each)
            .collect()
    }

    /// Every pair of causes.
    pub fn pairs(&self) -> Vec<Candidate> {
        let prior = self.explained * self.prior.of_set(2, self.causes.len());
        let mut made = Vec::new();
        for (i, first) in self.causes.iter().enumerate() {
            for second in self.causes[i + 1..].iter().flatten() {
                let both = first
                    .iter()
                    .map(|&a| self.candidate(vec![a, *second], prior));
                made.extend(both);
            }
        }
        made
    }

    /// Some sets of one cause less than `count`, each with every further cause.
    pub fn extended(&self, smaller: &[&Candidate], count: usize) -> Vec<Candidate> {
        let all = self.causes.len();
        if all < count {
            return Vec::new();
        }
        let prior = self.explained * self.prior.of_set(count, all);
        let place = |v: &usize| self.causes.iter().position(|forms| forms.contains(v));
        let mut tried: Vec<Vec<usize>> = Vec::new();
        for set in smaller {
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
        let each = tried.iter().flat_map(|set| self.combined(set));
        each.map(|some| self.candidate(some, prior)).collect()
    }

    /// Every choice of one variant of each of some causes.
    fn combined(&self, set: &[usize]) -> Vec<Vec<usize>> {
        let mut chosen = vec![Vec::new()];
        for forms in set.iter().map(|&cause| &self.causes[cause]) {
            let longer = |some: &Vec<usize>| {
                let some = some.clone();
                forms.iter().map(move |&form| [&some[..], &[form]].concat())
            };
            chosen = chosen.iter().flat_map(longer).collect();
        }
        chosen
    }

    /// Some hypotheses, each beside every unexplained term.
    pub fn beside(&self, bases: &[&Candidate], unexplained: &[usize]) -> Vec<Candidate> {
        let share = self.term_odds(unexplained);
        let mut made = Vec::new();
        for base in bases {
            for &term in unexplained {
                let variants = [&base.variants[..], &[term]].concat();
                made.push(Candidate::new(variants, base.prior * share));
            }
        }
        made
    }

    /// Prior odds of one of the unexplained terms against none.
    fn term_odds(&self, unexplained: &[usize]) -> f64 {
        self.prior.unexplained / self.explained / unexplained.len().max(1) as f64
    }

    /// Those of some hypotheses that are beside an unexplained term, each without one of its causes.
    pub fn without_one(&self, larger: &[&Candidate], unexplained: &[usize]) -> Vec<Candidate> {
        let share = self.term_odds(unexplained);
        let mut made: Vec<Candidate> = Vec::new();
        for set in larger {
            let (terms, known): (Vec<usize>, Vec<usize>) =
                set.variants.iter().partition(|v| unexplained.contains(v));
            if terms.is_empty() || known.is_empty() {
                continue;
            }
            let prior =
                self.explained * self.prior.of_set(known.len() - 1, self.causes.len()) * share;
            for out in &known {
                let rest = known.iter().filter(|v| *v != out).copied();
                let smaller = self.candidate(rest.chain(terms.iter().copied()).collect(), prior);
                if made.iter().all(|other| other.variants != smaller.variants) {
                    made.push(smaller);
                }
            }
        }
        made
    }

    /// Scores all candidates by estimates of their log evidence.
    pub fn scored(&self, mut candidates: Vec<Candidate>) -> Vec<Candidate> {
        let scores = self.each(&candidates, EvidenceSolver::estimate);
        for (candidate, score) in candidates.iter_mut().zip(scores) {
            candidate.score = score;
        }
        candidates
    }

    /// Log evidence, estimated or at most, of each candidate, its prior included.
    pub fn each(
        &self,
        candidates: &[Candidate],
        evidence: fn(&mut EvidenceSolver, &NoiseTable, &HypothesisColumns) -> f64,
    ) -> Vec<f64> {
        each_of(candidates, self.threads, || {
            let (mut solver, mut columns) = Default::default();
            move |candidate: &Candidate| {
                HypothesisColumns::fill(&mut columns, self.variants_of(candidate));
                evidence(&mut solver, self.table, &columns) + candidate.prior.ln()
            }
        })
    }

    /// Variants of a candidate.
    pub fn variants_of(&self, candidate: &Candidate) -> impl Iterator<Item = &Variant> {
        candidate.variants.iter().map(|&v| &self.variants[v])
    }

    /// Causes of a candidate.
    pub fn causes_of(&self, candidate: &Candidate) -> Vec<usize> {
        self.variants_of(candidate).map(|v| v.cause).collect()
    }

    /// Number of coefficients of a candidate.
    pub fn freedom(&self, candidate: &Candidate) -> usize {
        self.variants_of(candidate).map(|v| v.free.len()).sum()
    }
}

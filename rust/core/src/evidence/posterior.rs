//! No cause, each cause, each pair, the best triples, and the best of these beside a shape.

use super::hypothesis::{Layout, Variant};
use super::weigh::{Scales, Stack, Weighed, log_sum};
use std::collections::HashMap;

/// Probabilities before the data.
#[derive(Clone, Copy, Debug)]
pub struct Prior {
    /// Of no, one, two and three causes.
    pub causes: [f64; 4],
    /// Of a shape without a cause, independently.
    pub shape: f64,
}

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

/// The most probable pairs that a third cause is added to.
const EXTENDED: usize = 4;
/// The most causes at once.
const LARGEST: usize = 6;
/// How much less probable each cause beyond three makes a set, before the data.
const ANOTHER: f64 = 0.1;
/// The most probable hypotheses that are also tried beside a shape.
const BESIDE: usize = 8;
/// Probability of a noise below which it is not carried along.
const NEGLIGIBLE_NOISE: f64 = 1e-3;
/// Forms of a cause that are tried in company.
const FORMS: usize = 3;
/// Log odds between two forms of the same causes below which neither is better.
const UNDECIDED: f64 = 1.5;
/// Log odds against the most probable hypothesis beyond which one is left out.
const HOPELESS: f64 = 25.0;
/// Log odds beyond which a hypothesis is not reported: a probability below one in a million.
const NEGLIGIBLE: f64 = 14.0;
/// Hypotheses below which a thread costs more than it saves.
const PER_THREAD: usize = 64;

struct Candidate {
    variants: Vec<usize>,
    prior: f64,
    score: f64,
}

/// Weighs every hypothesis that competes.
///
/// Returns the hypotheses that are not hopeless, most probable first, with the noises that were
/// carried along.
#[must_use]
pub fn posterior(
    stack: &Stack,
    variants: &[Variant],
    prior: &Prior,
    threads: usize,
) -> (Vec<Outcome>, Vec<bool>) {
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
    let noises = plausible(stack, variants, &causes, &shapes);
    let mut search = Search {
        stack: &stack.only(&noises),
        variants,
        causes: &causes,
        share: if shapes.is_empty() {
            1.0
        } else {
            1.0 - prior.shape
        },
        prior,
        threads,
    };
    let mut found = search.scored(search.singles(), f64::NEG_INFINITY);
    let promising = search.promising(&found);
    search.causes = &promising;
    found.extend(search.weigh(search.pairs(), top(&found)));
    let triples = search.triples(&search.distinct(&found));
    found.extend(search.weigh(triples, top(&found)));
    for size in 3..LARGEST {
        let largest = search.grown(&search.distinct(&found), size);
        found.extend(search.weigh(largest, top(&found)));
    }
    let beside = search.beside(&search.distinct(&found), &shapes);
    found.extend(search.weigh(beside, top(&found)));
    (search.outcomes(found), noises)
}

fn top(found: &[Candidate]) -> f64 {
    found
        .iter()
        .map(|c| c.score)
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Noises worth carrying along: those that some simple or some very free hypothesis allows.
///
/// The free ones have every cause at once, beside one shape: what they leave is noise if anything
/// is.
fn plausible(
    stack: &Stack,
    variants: &[Variant],
    causes: &[Vec<usize>],
    shapes: &[usize],
) -> Vec<bool> {
    let freest = |forms: &Vec<usize>| {
        let free = |v: &usize| variants[*v].free.len();
        let most = forms.iter().map(free).max()?;
        forms.iter().copied().find(|v| free(v) == most)
    };
    let every: Vec<usize> = causes
        .iter()
        .filter_map(freest)
        .filter(|&v| variants[v].offsets.is_empty())
        .collect();
    let fixed = causes
        .iter()
        .flatten()
        .filter(|&&v| !variants[v].offsets.is_empty());
    let beside = fixed.chain(shapes).map(|&v| [&every[..], &[v]].concat());
    let simple = causes.iter().flatten().map(|&v| vec![v]);
    let tried = [Vec::new(), every.clone()]
        .into_iter()
        .chain(simple)
        .chain(beside);
    let (mut scales, mut layout) = (Scales::default(), Layout::default());
    let mut most = vec![0.0_f64; stack.log_weight.len()];
    for hypothesis in tried {
        layout.fill(hypothesis.iter().map(|&v| &variants[v]));
        for (most, share) in most.iter_mut().zip(scales.noise(stack, &layout)) {
            *most = most.max(share);
        }
    }
    most.iter().map(|&share| share > NEGLIGIBLE_NOISE).collect()
}

struct Search<'a> {
    stack: &'a Stack,
    variants: &'a [Variant],
    causes: &'a [Vec<usize>],
    /// Probability that no shape is there.
    share: f64,
    prior: &'a Prior,
    threads: usize,
}

impl Search<'_> {
    fn candidate(&self, variants: Vec<usize>, prior: f64) -> Candidate {
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

    /// The forms of each cause worth combining with others: the best by themselves, and the freest.
    fn promising(&self, singles: &[Candidate]) -> Vec<Vec<usize>> {
        let score = |v: usize| {
            let alone = singles.iter().find(|c| c.variants == [v]);
            alone.map_or(f64::NEG_INFINITY, |c| c.score)
        };
        let freedom = |v: usize| self.variants[v].free.len();
        let best = |forms: &Vec<usize>| {
            let mut sorted = forms.clone();
            sorted.sort_by(|&a, &b| score(b).total_cmp(&score(a)));
            let rest = sorted.split_off(FORMS.min(sorted.len()));
            let most = sorted.iter().map(|&v| freedom(v)).max();
            let freer = rest.into_iter().filter(|&v| Some(freedom(v)) > most);
            sorted.extend(freer.take(1).collect::<Vec<_>>());
            sorted
        };
        self.causes.iter().map(best).collect()
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

    /// The best pairs, each with every third cause.
    fn triples(&self, distinct: &[&Candidate]) -> Vec<Candidate> {
        let count = self.causes.len();
        if count < 3 {
            return Vec::new();
        }
        let sets = (count * (count - 1) * (count - 2) / 6) as f64;
        let prior = self.share * self.prior.causes[3] / sets;
        let place = |v: usize| self.causes.iter().position(|forms| forms.contains(&v));
        let mut tried: Vec<[usize; 3]> = Vec::new();
        for pair in distinct
            .iter()
            .filter(|c| c.variants.len() == 2)
            .take(EXTENDED)
        {
            let Some((a, b)) = place(pair.variants[0]).zip(place(pair.variants[1])) else {
                continue;
            };
            for third in (0..count).filter(|&third| third != a && third != b) {
                let mut set = [a, b, third];
                set.sort_unstable();
                if !tried.contains(&set) {
                    tried.push(set);
                }
            }
        }
        let mut made = Vec::new();
        for [a, b, c] in tried
            .into_iter()
            .map(|set| set.map(|cause| &self.causes[cause]))
        {
            for &x in a {
                for &y in b {
                    made.extend(c.iter().map(|&z| self.candidate(vec![x, y, z], prior)));
                }
            }
        }
        made
    }

    /// The most probable hypothesis, if it has this many causes, with every further one.
    fn grown(&self, distinct: &[&Candidate], size: usize) -> Vec<Candidate> {
        let Some(best) = distinct.first().filter(|c| c.variants.len() == size) else {
            return Vec::new();
        };
        let there = |v: &usize| best.variants.contains(v);
        let others: Vec<&Vec<usize>> = self
            .causes
            .iter()
            .filter(|forms| !forms.iter().any(there))
            .collect();
        let sets = others.len() as f64 / (size + 1) as f64; // each set grows out of as many smaller ones
        let prior = best.prior * ANOTHER / sets;
        let grow = |&v: &usize| {
            let variants = [&best.variants[..], &[v]].concat();
            let weight = self.variants[v].weight;
            Candidate {
                variants,
                prior: prior * weight,
                score: f64::NAN,
            }
        };
        others.into_iter().flatten().map(grow).collect()
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
            let causes: Vec<usize> = candidate
                .variants
                .iter()
                .map(|&v| self.variants[v].cause)
                .collect();
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

    /// Scores the candidates, on several threads, and keeps those that are not hopeless.
    fn weigh(&self, candidates: Vec<Candidate>, best: f64) -> Vec<Candidate> {
        let mut candidates = self.scored(candidates, best);
        let best = best.max(top(&candidates));
        candidates.retain(|c| c.score > best - HOPELESS);
        candidates
    }

    fn scored(&self, mut candidates: Vec<Candidate>, best: f64) -> Vec<Candidate> {
        let threads = self.threads.min(candidates.len() / PER_THREAD).max(1);
        let share = candidates.len().div_ceil(threads).max(1);
        std::thread::scope(|scope| {
            for part in candidates.chunks_mut(share) {
                if threads == 1 {
                    self.score(part, best);
                } else {
                    scope.spawn(move || self.score(part, best));
                }
            }
        });
        candidates
    }

    fn score(&self, candidates: &mut [Candidate], mut best: f64) {
        let (mut scales, mut layout) = (Scales::default(), Layout::default());
        for candidate in candidates {
            layout.fill(candidate.variants.iter().map(|&v| &self.variants[v]));
            let prior = candidate.prior.ln();
            let least = if candidate.variants.is_empty() {
                f64::NEG_INFINITY
            } else {
                best - HOPELESS - prior
            };
            candidate.score = scales.log_evidence(self.stack, &layout, least) + prior;
            best = best.max(candidate.score);
        }
    }

    fn outcomes(&self, mut found: Vec<Candidate>) -> Vec<Outcome> {
        let (mut scales, mut layout) = (Scales::default(), Layout::default());
        found.sort_by(|a, b| b.score.total_cmp(&a.score));
        let total = log_sum(found.iter().map(|c| c.score));
        found.retain(|c| c.score > total - NEGLIGIBLE || c.variants.is_empty());
        let outcome = |candidate: Candidate| {
            layout.fill(candidate.variants.iter().map(|&v| &self.variants[v]));
            Outcome {
                weighed: scales.weigh(self.stack, &layout),
                variants: candidate.variants,
                prior: candidate.prior,
            }
        };
        found.into_iter().map(outcome).collect()
    }
}

/// Weighs one hypothesis by itself; with `one_width` with the widest prior alone.
#[must_use]
pub fn weigh(stack: &Stack, variants: &[Variant], one_width: bool) -> Weighed {
    let mut layout = Layout::default();
    layout.fill(variants);
    Scales::new(one_width).weigh(stack, &layout)
}

//! Which noises a search takes into account.

use super::options::SearchOptions;
use super::prior::Prior;
use crate::parallel::each_of;
use crate::solve::{EvidenceSolver, HypothesisColumns, NARROWER, NoiseTable, Variant};

/// Probability of a noise beside a hypothesis below which a search leaves the noise out: the evidence
/// that is lost decides nothing.
const SEARCHED: f64 = 0.02;
/// The same of a simple hypothesis, when what was found is fitted.
const FITTED: f64 = 1e-3;
/// The same of the best hypotheses.
const LOST: f64 = 1e-5;

/// The first fit of a hypothesis: probability of each noise, and log evidence with the widest priors.
type FirstFit = (Vec<f64>, f64);

/// Which noises are taken into account, at first and in the end.
pub(super) struct NoiseSelection {
    /// While searching.
    pub search: Vec<bool>,
    /// When what was found is fitted.
    pub fit: Vec<bool>,
}

impl NoiseSelection {
    /// Noises that are probable beside all causes at once, or beside a single cause or none.
    ///
    /// Beside all causes and one unexplained term, the residual is mostly noise. Of a cause with an onset
    /// only one onset is included. Single causes that are pruned are not considered.
    pub fn of(
        table: &NoiseTable,
        variants: &[Variant],
        causes: &[Vec<usize>],
        unexplained: &[usize],
        (prior, options): (&Prior, &SearchOptions),
        threads: usize,
    ) -> Self {
        let free = all_causes(variants, causes, unexplained);
        let mut fits = fits(table, variants, &free, threads);
        let unpruned = unpruned(table, variants, causes, (prior, options), threads);
        let fit = above(FITTED, &unpruned, table.noises());
        fits.extend(unpruned);
        Self {
            search: above(SEARCHED, &fits, table.noises()),
            fit,
        }
    }

    /// Adds the noises that the best hypotheses allow; returns whether a search missed one.
    pub fn extend(
        &mut self,
        table: &NoiseTable,
        variants: &[Variant],
        best: &[Vec<usize>],
        threads: usize,
    ) -> bool {
        let fits = fits(table, variants, best, threads);
        let reported = above(LOST, &fits, table.noises());
        let needed = above(SEARCHED, &fits, table.noises());
        let mut missed = false;
        for (noise, needed) in needed.into_iter().enumerate() {
            missed |= needed && !self.search[noise];
            self.search[noise] |= needed;
            self.fit[noise] |= reported[noise] || self.search[noise];
        }
        missed
    }
}

/// All causes at once: alone, and beside one form that has a fixed column or one unexplained term. Of
/// each cause, the first of the forms with the most coefficients.
fn all_causes(
    variants: &[Variant],
    causes: &[Vec<usize>],
    unexplained: &[usize],
) -> Vec<Vec<usize>> {
    let most_coefficients = |forms: &Vec<usize>| {
        let free = |v: &usize| variants[*v].free.len();
        let most = forms.iter().map(free).max()?;
        forms.iter().copied().find(|v| free(v) == most)
    };
    let every: Vec<usize> = causes
        .iter()
        .filter_map(most_coefficients)
        .filter(|&v| variants[v].offsets.is_empty())
        .collect();
    let known = causes.iter().flatten().copied();
    let fixed = known.filter(|&v| !variants[v].offsets.is_empty());
    let beside = fixed.chain(unexplained.iter().copied());
    let beside = beside.map(|v| [&every[..], &[v]].concat());
    [every.clone()].into_iter().chain(beside).collect()
}

/// First fits of no cause and of each form of one, but for those that are pruned beside another.
fn unpruned(
    table: &NoiseTable,
    variants: &[Variant],
    causes: &[Vec<usize>],
    (prior, options): (&Prior, &SearchOptions),
    threads: usize,
) -> Vec<FirstFit> {
    let single = causes.iter().flatten().map(|&v| vec![v]);
    let simple: Vec<_> = [Vec::new()].into_iter().chain(single).collect();
    let mut fits = fits(table, variants, &simple, threads);
    let (none, each) = (prior.of_set(0, 0), prior.of_set(1, causes.len().max(1)));
    let mut most = Vec::new();
    for (first, hypothesis) in fits.iter_mut().zip(&simple) {
        let form = hypothesis.first().map(|&v| &variants[v]);
        first.1 += form.map_or(none, |form| each * form.weight).ln();
        let narrower = NARROWER * form.map_or(0.0, |form| form.free.len() as f64);
        most.push(first.1 + narrower);
    }
    let top = fits.iter().map(|first| first.1);
    let least = top.fold(f64::NEG_INFINITY, f64::max) - options.pruning_log_odds;
    let each = fits.into_iter().zip(most);
    each.filter_map(|(first, most)| (most >= least).then_some(first))
        .collect()
}

fn fits(
    table: &NoiseTable,
    variants: &[Variant],
    tried: &[Vec<usize>],
    threads: usize,
) -> Vec<FirstFit> {
    each_of(tried, threads, || {
        let (mut solver, mut layout) = (EvidenceSolver::default(), HypothesisColumns::default());
        move |hypothesis: &Vec<usize>| {
            layout.fill(hypothesis.iter().map(|&v| &variants[v]));
            solver.noise(table, &layout)
        }
    })
}

/// Noises of more than a probability beside at least one hypothesis.
fn above(least: f64, fits: &[FirstFit], noises: usize) -> Vec<bool> {
    let most = |noise: usize| fits.iter().map(move |first| first.0[noise]);
    (0..noises)
        .map(|noise| most(noise).any(|share| share > least))
        .collect()
}

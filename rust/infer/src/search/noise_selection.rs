//! Which noises a search takes into account.

use super::prior::Prior;
use crate::parallel::each_of;
use crate::solve::{EvidenceSolver, HypothesisColumns, NARROWER, NoiseTable, Variant};

/// Probability of a noise beside a hypothesis below which a search does without it: what some noises
/// less leave out of the evidence decides nothing there.
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
    /// Noises that some very free hypothesis allows, or some simple one that is not pruned beside
    /// another.
    ///
    /// The free ones have every cause at once, beside one unexplained term: what they leave is mostly noise, but
    /// of a cause with a place (a step, an edge) they have only one.
    pub fn of(
        table: &NoiseTable,
        variants: &[Variant],
        causes: &[Vec<usize>],
        unexplained: &[usize],
        prior: &Prior,
        threads: usize,
    ) -> Self {
        let free = freest(variants, causes, unexplained);
        let mut fits = fits(table, variants, &free, threads);
        let unpruned = unpruned(table, variants, causes, prior, threads);
        let fit = above(FITTED, &unpruned, table.noises());
        fits.extend(unpruned);
        Self {
            search: above(SEARCHED, &fits, table.noises()),
            fit,
        }
    }

    /// Adds the noises that the best hypotheses allow; tells whether a search missed one.
    pub fn extend(
        &mut self,
        table: &NoiseTable,
        variants: &[Variant],
        best: &[Vec<usize>],
        threads: usize,
    ) -> bool {
        let fits = fits(table, variants, best, threads);
        let told = above(LOST, &fits, table.noises());
        let needed = above(SEARCHED, &fits, table.noises());
        let mut missed = false;
        for (noise, needed) in needed.into_iter().enumerate() {
            missed |= needed && !self.search[noise];
            self.search[noise] |= needed;
            self.fit[noise] |= told[noise] || self.search[noise];
        }
        missed
    }
}

/// Every cause at once, by itself and beside one form that has a fixed column or one unexplained term.
fn freest(variants: &[Variant], causes: &[Vec<usize>], unexplained: &[usize]) -> Vec<Vec<usize>> {
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
    prior: &Prior,
    threads: usize,
) -> Vec<FirstFit> {
    let single = causes.iter().flatten().map(|&v| vec![v]);
    let simple: Vec<_> = [Vec::new()].into_iter().chain(single).collect();
    let mut fits = fits(table, variants, &simple, threads);
    let each = prior.causes[1] / causes.len().max(1) as f64;
    let mut most = Vec::new();
    for (first, hypothesis) in fits.iter_mut().zip(&simple) {
        let form = hypothesis.first().map(|&v| &variants[v]);
        first.1 += form.map_or(prior.causes[0], |form| each * form.weight).ln();
        let narrower = NARROWER * form.map_or(0.0, |form| form.free.len() as f64);
        most.push(first.1 + narrower);
    }
    let top = fits.iter().map(|first| first.1);
    let least = top.fold(f64::NEG_INFINITY, f64::max) - prior.pruning_log_odds;
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

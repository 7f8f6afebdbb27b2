//! Which noises a search carries along.

use super::hypothesis::{Layout, Variant};
use super::prior::Prior;
use super::stack::Table;
use super::threaded::each_of;
use super::weigh::{NARROWER, Scales};

/// Probability of a noise beside a hypothesis below which a search does without it: what some noises
/// less leave out of the evidence decides nothing there.
const SEARCHED: f64 = 0.02;
/// The same of a simple hypothesis, when what was found is weighed.
const WEIGHED: f64 = 1e-3;
/// The same of the best hypotheses.
const LOST: f64 = 1e-5;

/// A quick look at a hypothesis: probability of each noise, and log evidence with the widest priors.
type Look = (Vec<f64>, f64);

/// Which noises are carried along, at first and in the end.
pub(super) struct Carried {
    /// While searching.
    pub search: Vec<bool>,
    /// When what was found is weighed.
    pub weigh: Vec<bool>,
}

impl Carried {
    /// Noises that some very free hypothesis allows, or some simple one that is not hopeless beside
    /// another.
    ///
    /// The free ones have every cause at once, beside one shape: what they leave is mostly noise, but
    /// of a cause with a place (a step, an edge) they have only one.
    pub fn of(
        table: &Table,
        variants: &[Variant],
        causes: &[Vec<usize>],
        shapes: &[usize],
        prior: &Prior,
        threads: usize,
    ) -> Self {
        let free = freest(variants, causes, shapes);
        let mut looks = looks(table, variants, &free, threads);
        let hopeful = hopeful(table, variants, causes, prior, threads);
        let weigh = above(WEIGHED, &hopeful, table.noises());
        looks.extend(hopeful);
        Self {
            search: above(SEARCHED, &looks, table.noises()),
            weigh,
        }
    }

    /// Adds the noises that the best hypotheses allow; tells whether a search missed one.
    pub fn extend(
        &mut self,
        table: &Table,
        variants: &[Variant],
        best: &[Vec<usize>],
        threads: usize,
    ) -> bool {
        let looks = looks(table, variants, best, threads);
        let told = above(LOST, &looks, table.noises());
        let needed = above(SEARCHED, &looks, table.noises());
        let mut missed = false;
        for (noise, needed) in needed.into_iter().enumerate() {
            missed |= needed && !self.search[noise];
            self.search[noise] |= needed;
            self.weigh[noise] |= told[noise] || self.search[noise];
        }
        missed
    }
}

/// Every cause at once, by itself and beside one form that has a fixed column or one shape.
fn freest(variants: &[Variant], causes: &[Vec<usize>], shapes: &[usize]) -> Vec<Vec<usize>> {
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
    let beside = fixed.chain(shapes.iter().copied());
    let beside = beside.map(|v| [&every[..], &[v]].concat());
    [every.clone()].into_iter().chain(beside).collect()
}

/// Looks at no cause and at each form of one, but those that are hopeless beside another.
fn hopeful(
    table: &Table,
    variants: &[Variant],
    causes: &[Vec<usize>],
    prior: &Prior,
    threads: usize,
) -> Vec<Look> {
    let single = causes.iter().flatten().map(|&v| vec![v]);
    let simple: Vec<_> = [Vec::new()].into_iter().chain(single).collect();
    let mut looks = looks(table, variants, &simple, threads);
    let each = prior.causes[1] / causes.len().max(1) as f64;
    let mut most = Vec::new();
    for (look, hypothesis) in looks.iter_mut().zip(&simple) {
        let form = hypothesis.first().map(|&v| &variants[v]);
        look.1 += form.map_or(prior.causes[0], |form| each * form.weight).ln();
        let narrower = NARROWER * form.map_or(0.0, |form| form.free.len() as f64);
        most.push(look.1 + narrower);
    }
    let top = looks.iter().map(|look| look.1);
    let least = top.fold(f64::NEG_INFINITY, f64::max) - prior.hopeless;
    let each = looks.into_iter().zip(most);
    each.filter_map(|(look, most)| (most >= least).then_some(look))
        .collect()
}

fn looks(table: &Table, variants: &[Variant], tried: &[Vec<usize>], threads: usize) -> Vec<Look> {
    each_of(tried, threads, || {
        let (mut scales, mut layout) = (Scales::default(), Layout::default());
        move |hypothesis: &Vec<usize>| {
            layout.fill(hypothesis.iter().map(|&v| &variants[v]));
            scales.noise(table, &layout)
        }
    })
}

/// Noises of more than a probability beside at least one hypothesis.
fn above(least: f64, looks: &[Look], noises: usize) -> Vec<bool> {
    let most = |noise: usize| looks.iter().map(move |look| look.0[noise]);
    (0..noises)
        .map(|noise| most(noise).any(|share| share > least))
        .collect()
}

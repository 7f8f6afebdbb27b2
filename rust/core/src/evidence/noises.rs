//! Which noises a search carries along.

use super::hypothesis::{Layout, Variant};
use super::stack::Table;
use super::threaded::each_of;
use super::weigh::Scales;

/// Probability of a noise below which it is not carried along.
const NEGLIGIBLE: f64 = 1e-3;

/// Noises worth carrying along at first: those that some simple or some very free hypothesis allows.
///
/// The free ones have every cause at once, beside one shape: what they leave is mostly noise, but
/// of a cause with a place (a step, an edge) they have only one.
pub(super) fn plausible(
    table: &Table,
    variants: &[Variant],
    causes: &[Vec<usize>],
    shapes: &[usize],
    threads: usize,
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
    allowed(table, variants, tried, threads)
}

/// Noises that are not negligible beside at least one of some hypotheses.
pub(super) fn allowed(
    table: &Table,
    variants: &[Variant],
    tried: impl Iterator<Item = Vec<usize>>,
    threads: usize,
) -> Vec<bool> {
    let tried: Vec<Vec<usize>> = tried.collect();
    let shares = each_of(&tried, threads, || {
        let (mut scales, mut layout) = (Scales::default(), Layout::default());
        move |hypothesis: &Vec<usize>| {
            layout.fill(hypothesis.iter().map(|&v| &variants[v]));
            scales.noise(table, &layout)
        }
    });
    let mut most = vec![0.0_f64; table.noises()];
    for shares in shares {
        for (most, share) in most.iter_mut().zip(shares) {
            *most = most.max(share);
        }
    }
    most.iter().map(|&share| share > NEGLIGIBLE).collect()
}

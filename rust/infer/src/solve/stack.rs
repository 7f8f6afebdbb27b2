//! The whitened products of every noise, noise by noise and side by side.

use crate::numeric::{PACK, Pack};
use crate::parallel::each_of;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Whitened products of the columns under each noise; the last column is what the base simulation
/// leaves unexplained.
#[derive(Clone, Copy, Debug)]
pub struct WhitenedStack<'a> {
    /// Noise by noise, each `width * width`, symmetric.
    pub products: &'a [f64],
    /// What each noise adds to the log evidence of every hypothesis.
    pub log_weight: &'a [f64],
    /// Number of columns.
    pub width: usize,
    /// Rows less unknown levels.
    pub degrees: f64,
    /// Smallest variance of noise that is assumed.
    pub variance_floor: f64,
}

/// The same with the noises side by side, several at a time, of some columns.
pub(crate) struct NoiseTable {
    /// Of each column kept: products with itself and those before, each under every group of noises.
    values: Vec<Vec<Pack>>,
    groups: usize,
    /// Position of each column; `usize::MAX` if it was not kept.
    place: Vec<usize>,
    pub log_weight: Vec<f64>,
    pub width: usize,
    pub degrees: f64,
    pub variance_floor: f64,
    /// Linear systems solved so far, with those of the table that this one was taken from.
    solved: Arc<AtomicUsize>,
}

/// Position of the product of two columns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    line: usize,
    first: usize,
}

/// Noises whose products are taken side by side.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Noises {
    /// Those of a group.
    Group(usize),
    /// These.
    Some([usize; PACK]),
}

impl NoiseTable {
    /// Some columns, in ascending order, under every noise.
    pub fn of(stack: &WhitenedStack<'_>, columns: &[usize], threads: usize) -> Self {
        let noises: Vec<usize> = (0..stack.log_weight.len()).collect();
        let groups: Vec<_> = noises.chunks(PACK).map(filled).collect();
        let lines: Vec<&[usize]> = (1..=columns.len()).map(|count| &columns[..count]).collect();
        Self {
            values: each_of(&lines, threads, || {
                |own: &&[usize]| line(stack, &groups, own)
            }),
            groups: groups.len(),
            place: places(columns, stack.width),
            log_weight: stack.log_weight.to_vec(),
            width: stack.width,
            degrees: stack.degrees,
            variance_floor: stack.variance_floor,
            solved: Arc::default(),
        }
    }

    /// Some of the columns under the noises in `kept`; `None` if these are all noises.
    pub fn carried(&self, kept: &[bool], columns: &[usize], threads: usize) -> Option<Self> {
        (!kept.iter().all(|&kept| kept)).then(|| self.only(kept, columns, threads))
    }

    /// Some of the columns, in ascending order, under the noises in `kept`.
    pub fn only(&self, kept: &[bool], columns: &[usize], threads: usize) -> Self {
        let noises: Vec<usize> = (0..kept.len()).filter(|&noise| kept[noise]).collect();
        let groups: Vec<_> = noises.chunks(PACK).map(filled).collect();
        let groups: Vec<_> = groups.into_iter().map(|some| self.beside(some)).collect();
        let lines: Vec<&[usize]> = (1..=columns.len()).map(|count| &columns[..count]).collect();
        let line = |own: &&[usize]| {
            let mut line = Vec::with_capacity(own.len() * groups.len());
            for &column in *own {
                let place = self.place(own[own.len() - 1], column);
                line.extend(groups.iter().map(|some| self.at(place, some)));
            }
            line
        };
        Self {
            values: each_of(&lines, threads, || line),
            groups: groups.len(),
            place: places(columns, self.width),
            log_weight: noises.iter().map(|&n| self.log_weight[n]).collect(),
            solved: Arc::clone(&self.solved),
            ..*self
        }
    }

    /// Some noises, a whole group as such: its products are side by side already.
    pub fn beside(&self, noises: [usize; PACK]) -> Noises {
        let (group, last) = (noises[0] / PACK, self.noises() - 1);
        let whole = (group * PACK..).map(|noise| noise.min(last));
        if whole.zip(noises).all(|(own, noise)| own == noise) {
            Noises::Group(group)
        } else {
            Noises::Some(noises)
        }
    }

    /// Counts systems that are solved.
    pub fn count(&self, systems: usize) {
        self.solved.fetch_add(systems, Ordering::Relaxed);
    }

    /// Systems solved so far.
    pub fn solved(&self) -> usize {
        self.solved.load(Ordering::Relaxed)
    }

    /// Number of noises.
    pub fn noises(&self) -> usize {
        self.log_weight.len()
    }

    /// Position of the product of two columns.
    pub fn place(&self, i: usize, j: usize) -> Place {
        let (i, j) = (self.place[i], self.place[j]);
        Place {
            line: i.max(j),
            first: i.min(j) * self.groups,
        }
    }

    /// The product at a place, of some noises.
    #[inline(always)]
    pub fn at(&self, place: Place, noises: &Noises) -> Pack {
        let own = &self.values[place.line][place.first..][..self.groups];
        match noises {
            Noises::Group(group) => own[*group],
            Noises::Some(noises) => {
                let mut found = Pack::all(0.0);
                for (number, noise) in found.0.iter_mut().zip(noises) {
                    *number = own[noise / PACK].0[noise % PACK];
                }
                found
            }
        }
    }
}

/// Noises for all lanes: the last one fills them up.
fn filled(noises: &[usize]) -> [usize; PACK] {
    core::array::from_fn(|lane| noises[lane.min(noises.len() - 1)])
}

/// Position of each column among those chosen; `usize::MAX` if it is not.
fn places(columns: &[usize], width: usize) -> Vec<usize> {
    let mut place = vec![usize::MAX; width];
    for (at, &column) in columns.iter().enumerate() {
        place[column] = at;
    }
    place
}

/// Products of the last of some columns with each of them, the groups of noises side by side.
fn line(stack: &WhitenedStack<'_>, groups: &[[usize; PACK]], columns: &[usize]) -> Vec<Pack> {
    let (width, area) = (stack.width, stack.width * stack.width);
    let mut values = vec![Pack::all(0.0); columns.len() * groups.len()];
    for (group, noises) in groups.iter().enumerate() {
        let row = columns[columns.len() - 1] * width;
        let own = noises.map(|noise| &stack.products[noise * area + row..][..width]);
        let values = values[group..].iter_mut().step_by(groups.len());
        for (value, &column) in values.zip(columns) {
            *value = Pack(own.map(|own| own[column]));
        }
    }
    values
}

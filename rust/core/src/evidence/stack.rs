//! The whitened products of every noise, noise by noise and side by side.

use super::lanes::{LANES, Lane};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Whitened products of the columns under each noise; the last column is what the base simulation
/// leaves unexplained.
#[derive(Clone, Copy, Debug)]
pub struct Stack<'a> {
    /// Noise by noise, each `width * width`, symmetric.
    pub products: &'a [f64],
    /// What each noise adds to the log evidence of every hypothesis.
    pub log_weight: &'a [f64],
    /// Number of columns.
    pub width: usize,
    /// Rows less unknown levels.
    pub degrees: f64,
    /// Variance below which no noise is believed.
    pub finest: f64,
}

/// The same with the noises side by side, several at a time.
pub(super) struct Table {
    /// Lower triangle row by row; of each product every group of noises.
    values: Vec<Lane>,
    groups: usize,
    pub log_weight: Vec<f64>,
    pub width: usize,
    pub degrees: f64,
    pub finest: f64,
    /// Linear systems solved so far.
    pub solved: AtomicUsize,
}

/// Noises whose products are taken side by side.
#[derive(Clone, Copy, Debug)]
pub(super) enum Noises {
    /// Those of a group.
    Group(usize),
    /// These.
    Some([usize; LANES]),
}

impl Table {
    /// The noises in `kept` alone.
    pub fn of(stack: &Stack<'_>, kept: &[bool]) -> Self {
        let chosen: Vec<usize> = (0..kept.len()).filter(|&noise| kept[noise]).collect();
        let (width, groups) = (stack.width, chosen.len().div_ceil(LANES));
        let area = width * width;
        let mut values = vec![Lane::all(0.0); width * (width + 1) / 2 * groups];
        for (group, noises) in chosen.chunks(LANES).enumerate() {
            // the last noise fills its group up
            let noise = |lane: usize| noises[lane.min(noises.len() - 1)];
            let own: [&[f64]; LANES] =
                core::array::from_fn(|lane| &stack.products[noise(lane) * area..][..area]);
            let mut place = group;
            for i in 0..width {
                for j in 0..=i {
                    let at = i * width + j;
                    values[place] = Lane(core::array::from_fn(|lane| own[lane][at]));
                    place += groups;
                }
            }
        }
        Self {
            values,
            groups,
            log_weight: chosen.iter().map(|&n| stack.log_weight[n]).collect(),
            width,
            degrees: stack.degrees,
            finest: stack.finest,
            solved: AtomicUsize::new(0),
        }
    }

    /// Counts systems that are solved.
    pub fn count(&self, systems: usize) {
        self.solved.fetch_add(systems, Ordering::Relaxed);
    }

    /// Number of noises.
    pub fn noises(&self) -> usize {
        self.log_weight.len()
    }

    /// The product of two columns, of every group of noises.
    #[inline(always)]
    fn product(&self, i: usize, j: usize) -> &[Lane] {
        let (high, low) = if i < j { (j, i) } else { (i, j) };
        let first = (high * (high + 1) / 2 + low) * self.groups;
        &self.values[first..first + self.groups]
    }

    /// The product of two columns, of some noises.
    #[inline(always)]
    pub fn some(&self, i: usize, j: usize, noises: &Noises) -> Lane {
        let product = self.product(i, j);
        match *noises {
            Noises::Group(group) => product[group],
            Noises::Some(places) => {
                Lane(places.map(|noise| product[noise / LANES].0[noise % LANES]))
            }
        }
    }
}

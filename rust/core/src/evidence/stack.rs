//! The whitened products of every noise, noise by noise and side by side.

use super::lanes::{LANES, Lane};
use super::threaded::each_of;
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
    /// Of each group of noises: lower triangle row by row.
    values: Vec<Vec<Lane>>,
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
    pub fn of(stack: &Stack<'_>, kept: &[bool], threads: usize) -> Self {
        let chosen: Vec<usize> = (0..kept.len()).filter(|&noise| kept[noise]).collect();
        let groups: Vec<&[usize]> = chosen.chunks(LANES).collect();
        Self {
            values: each_of(&groups, threads, || {
                |noises: &&[usize]| group(stack, noises)
            }),
            log_weight: chosen.iter().map(|&n| stack.log_weight[n]).collect(),
            width: stack.width,
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

    /// The product of two columns, of some noises.
    #[inline(always)]
    pub fn some(&self, i: usize, j: usize, noises: &Noises) -> Lane {
        let (high, low) = if i < j { (j, i) } else { (i, j) };
        let place = high * (high + 1) / 2 + low;
        match noises {
            Noises::Group(group) => self.values[*group][place],
            Noises::Some(noises) => {
                let mut found = Lane::all(0.0);
                for (number, noise) in found.0.iter_mut().zip(noises) {
                    *number = self.values[noise / LANES][place].0[noise % LANES];
                }
                found
            }
        }
    }
}

/// Products of some noises side by side; the last noise fills the lanes up.
fn group(stack: &Stack<'_>, noises: &[usize]) -> Vec<Lane> {
    let (width, area) = (stack.width, stack.width * stack.width);
    let own: [&[f64]; LANES] = core::array::from_fn(|lane| {
        &stack.products[noises[lane.min(noises.len() - 1)] * area..][..area]
    });
    let mut values = vec![Lane::all(0.0); width * (width + 1) / 2];
    let mut rest = &mut values[..];
    for row in 0..width {
        let (line, others) = rest.split_at_mut(row + 1);
        for (lane, own) in own.iter().enumerate() {
            for (value, product) in line.iter_mut().zip(&own[row * width..]) {
                value.0[lane] = *product;
            }
        }
        rest = others;
    }
    values
}

//! Passes over the rows that make columns.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::maker::Maker;
use super::recipe::Recipe;
use super::table::Columns;
use crate::gram::{Reader, Source};
use crate::parallel::fill_spans;
use echocal_core::batch::{BLOCK, Line};

impl Columns<'_> {
    /// Finds what unknown levels take up of the tangents: their mean, in units of the slope, over
    /// each group. Without groups there is nothing to find.
    pub fn find_levels(&mut self) {
        let Some((groups, counts)) = &self.groups else {
            return;
        };
        let mut taken = vec![vec![0.0; counts.len()]; self.recipes.len()];
        let mut maker = Maker::new(self);
        let mut lines = vec![Line::of(0.0); self.recipes.len()];
        let mut slope = Line::of(1.0);
        for first in (0..self.distance.len()).step_by(BLOCK) {
            let count = BLOCK.min(self.distance.len() - first);
            let (mut block, memory) = maker.block(first, count);
            for (k, recipe) in self.recipes.iter().enumerate() {
                let Recipe::Tangent(term, level, ..) = recipe else {
                    continue;
                };
                memory.make(&mut block, recipe, &mut lines[k]);
                memory.slope(&mut block, term, level, &mut slope);
                for row in 0..count {
                    taken[k][groups[first + row] as usize] += lines[k].0[row] / slope.0[row];
                }
            }
        }
        for sums in &mut taken {
            for (sum, count) in sums.iter_mut().zip(counts) {
                *sum /= count;
            }
        }
        self.taken = taken;
    }

    /// Sum of some columns, each times a factor, at every row; on at most so many threads.
    #[must_use]
    pub fn combined(&self, chosen: &[(usize, f64)], threads: usize) -> Vec<f64> {
        let worker = || {
            let mut maker = Maker::new(self);
            let mut line = Line::of(0.0);
            move |first: usize, sums: &mut [f64]| {
                for (block, sums) in (first..).step_by(BLOCK).zip(sums.chunks_mut(BLOCK)) {
                    let (mut block, memory) = maker.block(block, sums.len());
                    for &(recipe, factor) in chosen {
                        memory.leveled(&mut block, recipe, &mut line);
                        for (sum, value) in sums.iter_mut().zip(line.0) {
                            *sum += factor * value;
                        }
                    }
                }
            }
        };
        let mut sums = vec![0.0; self.distance.len()];
        fill_spans(&mut sums, threads, worker);
        sums
    }

    /// Some of the columns at some rows (all by default), one after the other.
    #[must_use]
    pub fn made(&self, chosen: &[usize], rows: Option<&[usize]>) -> Vec<f64> {
        let all = self.distance.len();
        let length = rows.map_or(all, <[usize]>::len);
        let mut found = vec![0.0; chosen.len() * length];
        let mut maker = Maker::new(self);
        let mut line = Line::of(0.0);
        let mut written = 0;
        for first in (0..all).step_by(BLOCK) {
            let count = BLOCK.min(all - first);
            let inside = |row: &&usize| **row < first + count;
            let here = rows.map(|rows| {
                let left = &rows[written.min(rows.len())..];
                &left[..left.iter().take_while(inside).count()]
            });
            if here.is_some_and(<[usize]>::is_empty) {
                continue;
            }
            let (mut block, memory) = maker.block(first, count);
            for (k, &recipe) in chosen.iter().enumerate() {
                memory.leveled(&mut block, recipe, &mut line);
                let target = &mut found[k * length + written..];
                match here {
                    None => target[..count].copy_from_slice(&line.0[..count]),
                    Some(rows) => {
                        for (number, &row) in target.iter_mut().zip(rows) {
                            *number = line.0[row - first];
                        }
                    }
                }
            }
            written += here.map_or(count, <[usize]>::len);
        }
        found
    }
}

impl Source for Columns<'_> {
    fn width(&self) -> usize {
        self.recipes.len()
    }

    fn rows(&self) -> usize {
        self.distance.len()
    }

    fn reader(&self) -> Box<dyn Reader + '_> {
        Box::new(Maker::new(self))
    }
}

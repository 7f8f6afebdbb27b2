//! Columns of candidate causes, made from recipes where a pass needs them.
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::following::Following;
use super::legendre::Polynomials;
use super::recipe::{Level, Recipe, Shape};
use super::source::{Reader, Source};
use super::threaded::in_spans;
use super::waves::Waves;
use crate::batch::Column;
use crate::batch::staged::{BLOCK, Given, Line, Pass, Reading};
use crate::chain::Stage;
use crate::conditions::Quantity;
use crate::model::{Model, Term};
use crate::simd::{InstructionSet, active};

/// Rows of a table: borrowed columns, or one number for all rows.
#[derive(Clone, Copy, Debug)]
pub enum Numbers<'a> {
    /// One number per row.
    Each(&'a [f64]),
    /// The same number in every row.
    All(&'a f64),
}

impl Numbers<'_> {
    fn column(&self) -> Column {
        match *self {
            Self::Each(values) => Column::of(values),
            Self::All(value) => Column::constant(value),
        }
    }
}

/// A table with the columns that are to be made from it.
pub struct Columns<'a> {
    /// The base simulation.
    pub base: &'a Model,
    /// Reference distance or level of every row \[m\].
    pub distance: &'a [f64],
    /// Recorded quantities, in the order of [`Quantity::ALL`].
    pub recorded: [Numbers<'a>; Quantity::COUNT],
    /// Columns that are there.
    pub stored: Vec<&'a [f64]>,
    /// Group of each row and number of rows of each, where the level of a group is unknown.
    pub groups: Option<(&'a [u32], Vec<f64>)>,
    /// What to make.
    pub recipes: &'a [Recipe],
    /// Part of each tangent that the level of each group takes up; see [`Columns::find_levels`].
    pub taken: Vec<Vec<f64>>,
}

impl Columns<'_> {
    /// Finds what unknown levels take up of the tangents: their mean, in units of the slope, over
    /// each group. Without groups there is nothing to find.
    pub fn find_levels(&mut self) {
        let Some((groups, counts)) = &self.groups else {
            return;
        };
        let mut taken = vec![vec![0.0; counts.len()]; self.recipes.len()];
        let mut reader = self.maker();
        let mut lines = vec![Line::of(0.0); self.recipes.len()];
        let mut slope = Line::of(1.0);
        for first in (0..self.distance.len()).step_by(BLOCK) {
            let count = BLOCK.min(self.distance.len() - first);
            let base = reader.base(first, count);
            for (k, recipe) in self.recipes.iter().enumerate() {
                let Recipe::Tangent(term, level, ..) = recipe else {
                    continue;
                };
                reader.make(&base, recipe, first, count, &mut lines[k]);
                reader.slope(&base, term, level, first, count, &mut slope);
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
            let mut reader = self.maker();
            let mut line = Line::of(0.0);
            move |first: usize, end: usize| {
                let mut sums = vec![0.0; end - first];
                for (block, sums) in (first..).step_by(BLOCK).zip(sums.chunks_mut(BLOCK)) {
                    let base = reader.base(block, sums.len());
                    for &(recipe, factor) in chosen {
                        reader.leveled(&base, recipe, block, sums.len(), &mut line);
                        for (sum, value) in sums.iter_mut().zip(line.0) {
                            *sum += factor * value;
                        }
                    }
                }
                sums
            }
        };
        in_spans(self.distance.len(), threads, worker).concat()
    }

    fn maker(&self) -> Maker<'_> {
        Maker {
            of: self,
            given: Given::new(
                Column::of(self.distance),
                self.recorded.each_ref().map(Numbers::column),
            ),
            passes: [Pass::new(), Pass::new(), Pass::new()],
            following: Following::new(),
            polynomials: Polynomials::default(),
            waves: Waves::default(),
            distance: Line::of(0.0),
        }
    }

    /// Some of the columns at some rows (all by default), one after the other.
    #[must_use]
    pub fn made(&self, chosen: &[usize], rows: Option<&[usize]>) -> Vec<f64> {
        let all = self.distance.len();
        let length = rows.map_or(all, <[usize]>::len);
        let mut found = vec![0.0; chosen.len() * length];
        let mut reader = self.maker();
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
            let base = reader.base(first, count);
            for (k, &recipe) in chosen.iter().enumerate() {
                reader.leveled(&base, recipe, first, count, &mut line);
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
        Box::new(self.maker())
    }
}

struct Maker<'a> {
    of: &'a Columns<'a>,
    given: Given,
    passes: [Pass; 3],
    following: Following,
    polynomials: Polynomials,
    waves: Waves,
    distance: Line,
}

impl Reader for Maker<'_> {
    fn read(&mut self, first: usize, count: usize, into: &mut [Line]) {
        match active() {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: the instruction set is available, or a wider one.
            InstructionSet::Avx2 | InstructionSet::Avx512 => unsafe {
                self.read_avx2(first, count, into);
            },
            _ => self.read_all(first, count, into),
        }
    }
}

impl Maker<'_> {
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn read_avx2(&mut self, first: usize, count: usize, into: &mut [Line]) {
        self.read_all(first, count, into);
    }

    #[inline(always)]
    fn read_all(&mut self, first: usize, count: usize, into: &mut [Line]) {
        let base = self.base(first, count);
        for (recipe, line) in into.iter_mut().enumerate() {
            self.leveled(&base, recipe, first, count, line);
        }
    }

    /// The base simulation with its derivative to the distance.
    fn base(&mut self, first: usize, count: usize) -> Reading {
        // SAFETY: the distance and the recorded columns are as long as the table.
        let block = unsafe { self.given.block(first, count) };
        self.following.forget();
        self.passes[0].run(self.of.base, block.to_distance(true), Stage::Indication)
    }

    /// A column, without what an unknown level takes up.
    #[inline(always)]
    fn leveled(
        &mut self,
        base: &Reading,
        recipe: usize,
        first: usize,
        count: usize,
        line: &mut Line,
    ) {
        let made = &self.of.recipes[recipe];
        self.make(base, made, first, count, line);
        let (Some((groups, _)), Recipe::Tangent(term, level, ..)) = (&self.of.groups, made) else {
            return;
        };
        let Some(taken) = self.of.taken.get(recipe) else {
            return;
        };
        let mut slope = Line::of(1.0);
        self.slope(base, term, level, first, count, &mut slope);
        let groups = &groups[first..first + count];
        for ((number, slope), &group) in line.0.iter_mut().zip(&slope.0).zip(groups) {
            *number -= slope * taken[group as usize];
        }
    }

    #[inline(always)]
    fn make(
        &mut self,
        base: &Reading,
        recipe: &Recipe,
        first: usize,
        count: usize,
        line: &mut Line,
    ) {
        let rows = first..first + count;
        match recipe {
            Recipe::Slope => base.slopes(Stage::Indication, line),
            Recipe::Stored(at) => line.0[..count].copy_from_slice(&self.of.stored[*at][rows]),
            Recipe::Shift(term, level) => {
                let there = self.beside(base, term, level, None, first, count);
                there.values(Stage::Indication, line);
                let mut expected = Line::of(0.0);
                base.values(Stage::Indication, &mut expected);
                for (value, expected) in line.0.iter_mut().zip(expected.0) {
                    *value -= expected;
                }
            }
            Recipe::Tangent(term, level, parameter, scale) => {
                let at = (level, *parameter);
                self.tangent(base, term, at, *scale, (first, count), line);
            }
            Recipe::Of(of, shape, scale) => {
                let values = &self.of.stored[*of][rows];
                self.shape((*of, first), shape, *scale, values, line);
            }
        }
    }

    /// A function of a block's values of a column, times a scale.
    #[inline(always)]
    fn shape(
        &mut self,
        (of, first): (usize, usize),
        shape: &Shape,
        scale: f64,
        values: &[f64],
        line: &mut Line,
    ) {
        match *shape {
            Shape::Legendre {
                degree,
                between,
                line: (level, slope),
            } => {
                let (x, polynomial) = self.polynomials.of((of, between, first), values, degree);
                for ((number, x), p) in line.0.iter_mut().zip(&x.0).zip(&polynomial.0) {
                    *number = scale * (p - level - slope * x);
                }
            }
            Shape::Wave {
                period,
                multiple,
                cosine,
                mean,
            } => {
                let wave = (multiple, cosine);
                self.waves.of((of, period, first), values, wave, line);
                for number in &mut line.0 {
                    *number = scale * (*number - mean);
                }
            }
        }
    }

    /// Derivative of the reading to a parameter, at a level, times a scale.
    #[inline(always)]
    fn tangent(
        &mut self,
        base: &Reading,
        term: &Term,
        (level, parameter): (&Level, usize),
        scale: f64,
        (first, count): (usize, usize),
        line: &mut Line,
    ) {
        let (model, of) = (self.of.base, (term, parameter));
        if matches!(level, Level::OfBase) && self.following.tangent(model, base, of, scale, line) {
            return;
        }
        let there = self.beside(base, term, level, Some(parameter), first, count);
        there.slopes(Stage::Indication, line);
        for value in &mut line.0 {
            *value *= scale;
        }
    }

    /// The reading with an effect, and its derivative to a parameter.
    fn beside(
        &mut self,
        base: &Reading,
        term: &Term,
        level: &Level,
        seed: Option<usize>,
        first: usize,
        count: usize,
    ) -> Reading {
        let [_, at_level, there] = &mut self.passes;
        let Some(moved) = moved(&self.of.groups, level, first, count, &mut self.distance) else {
            return there.beside(self.of.base, base, term, seed);
        };
        let block = at_level.run(self.of.base, base.at(moved), Stage::Indication);
        there.beside(self.of.base, &block, term, seed)
    }

    /// Derivative of the reading to the distance with an effect at work.
    fn slope(
        &mut self,
        base: &Reading,
        term: &Term,
        level: &Level,
        first: usize,
        count: usize,
        line: &mut Line,
    ) {
        if matches!(level, Level::OfBase) {
            return base.slopes(Stage::Indication, line);
        }
        let moved = moved(&self.of.groups, level, first, count, &mut self.distance);
        let block = moved.map_or(*base, |moved| base.at(moved));
        let there = self.passes[2].with(self.of.base, block.to_distance(true), term);
        there.slopes(Stage::Indication, line);
    }
}

/// The distance of each row where that of its group is another than the base's.
fn moved<'l>(
    groups: &Option<(&[u32], Vec<f64>)>,
    level: &Level,
    first: usize,
    count: usize,
    line: &'l mut Line,
) -> Option<&'l Line> {
    let (Some((groups, _)), Level::OfGroups(levels)) = (groups, level) else {
        return None;
    };
    let groups = &groups[first..first + count];
    for (distance, &group) in line.0.iter_mut().zip(groups) {
        *distance = levels[group as usize];
    }
    line.0[count..].fill(levels[groups[count - 1] as usize]);
    Some(line)
}

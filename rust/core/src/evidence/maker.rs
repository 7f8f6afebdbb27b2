//! A block of rows of every column, from its recipe.
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::columns::{Columns, Numbers};
use super::following::Following;
use super::legendre::Polynomials;
use super::recipe::{Level, Recipe, Shape};
use super::source::Reader;
use super::waves::Waves;
use crate::batch::Column;
use crate::batch::staged::{BlockReader, Line, Pass, Reading};
use crate::chain::Stage;
use crate::conditions::Quantity;
use crate::model::Term;
use crate::simd::{InstructionSet, active};

/// One thread's memory for the columns of a table.
pub(super) struct Maker<'a> {
    given: BlockReader,
    base: Pass,
    tools: Tools<'a>,
}

/// What columns are made with, beside the base simulation.
pub(super) struct Tools<'a> {
    of: &'a Columns<'a>,
    passes: [Pass; 2],
    following: Following,
    polynomials: Polynomials,
    waves: Waves,
    distance: Line,
    /// Range of each quantity in the block, where it was asked for.
    ranges: [Option<(f64, f64)>; Quantity::COUNT],
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

impl<'a> Maker<'a> {
    pub(super) fn new(of: &'a Columns<'a>) -> Self {
        Self {
            given: BlockReader::new(
                Column::of(of.distance),
                of.recorded.each_ref().map(Numbers::column),
            ),
            base: Pass::new(),
            tools: Tools {
                of,
                passes: [Pass::new(), Pass::new()],
                following: Following::new(),
                polynomials: Polynomials::default(),
                waves: Waves::default(),
                distance: Line::of(0.0),
                ranges: [None; Quantity::COUNT],
            },
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma")]
    unsafe fn read_avx2(&mut self, first: usize, count: usize, into: &mut [Line]) {
        self.read_all(first, count, into);
    }

    #[inline(always)]
    fn read_all(&mut self, first: usize, count: usize, into: &mut [Line]) {
        let (base, tools) = self.base(first, count);
        for (recipe, line) in into.iter_mut().enumerate() {
            tools.leveled(&base, recipe, first, count, line);
        }
    }

    /// The base simulation with its derivative to the distance.
    pub(super) fn base(&mut self, first: usize, count: usize) -> (Reading<'_>, &mut Tools<'a>) {
        // SAFETY: the distance and the recorded columns are as long as the table.
        let block = unsafe { self.given.block(first, count) };
        let tools = &mut self.tools;
        tools.following.forget();
        tools.ranges = [None; Quantity::COUNT];
        let distance = block.to_distance(true);
        let base = self.base.run(tools.of.base, distance, Stage::Indication);
        (base, tools)
    }
}

impl Tools<'_> {
    /// A column, without what an unknown level takes up.
    #[inline(always)]
    pub(super) fn leveled(
        &mut self,
        base: &Reading<'_>,
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
    pub(super) fn make(
        &mut self,
        base: &Reading<'_>,
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
            Recipe::Between(term, later, parameter, scale) => {
                let of = (term, later, *parameter);
                self.between(base, of, *scale, (first, count), line);
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
        base: &Reading<'_>,
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

    /// What a tangent at the base has beyond one that sets in later.
    fn between(
        &mut self,
        base: &Reading<'_>,
        (term, later, parameter): (&Term, &Term, usize),
        scale: f64,
        (first, count): (usize, usize),
        line: &mut Line,
    ) {
        if self.alike(term, later, first, count) {
            return line.0.fill(0.0);
        }
        let (at, rows) = ((&Level::OfBase, parameter), (first, count));
        let mut beyond = Line::of(0.0);
        self.tangent(base, later, at, scale, rows, &mut beyond);
        self.tangent(base, term, at, scale, rows, line);
        for (value, beyond) in line.0.iter_mut().zip(beyond.0) {
            *value -= beyond;
        }
    }

    /// Whether a block has no row between the places where an effect sets in, here and later.
    fn alike(&mut self, term: &Term, later: &Term, first: usize, count: usize) -> bool {
        let Some((position, quantity)) = term.facts().divides() else {
            return false;
        };
        let range = &mut self.ranges[quantity as usize];
        let recorded = &self.of.recorded[quantity as usize];
        let (least, most) = *range.get_or_insert_with(|| recorded.range(first..first + count));
        most <= term.parameters[position] || least > later.parameters[position]
    }

    /// The reading with an effect, and its derivative to a parameter.
    fn beside<'b>(
        &'b mut self,
        base: &Reading<'b>,
        term: &Term,
        level: &Level,
        seed: Option<usize>,
        first: usize,
        count: usize,
    ) -> Reading<'b> {
        let [at_level, there] = &mut self.passes;
        let Some(moved) = moved(&self.of.groups, level, first, count, &mut self.distance) else {
            return there.beside(self.of.base, base, term, seed);
        };
        let block = at_level.run(self.of.base, base.at(moved), Stage::Indication);
        there.beside(self.of.base, &block, term, seed)
    }

    /// Derivative of the reading to the distance with an effect at work.
    pub(super) fn slope(
        &mut self,
        base: &Reading<'_>,
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
        let there = self.passes[1].with(self.of.base, block.to_distance(true), term);
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

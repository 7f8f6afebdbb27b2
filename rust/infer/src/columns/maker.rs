//! A block of rows of every column, from its recipe.
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::legendre::Polynomials;
use super::recipe::{BasisFunction, Level, Recipe};
use super::table::Columns;
use super::waves::Waves;
use crate::gram::Reader;
use echocal_core::Quantity;
use echocal_core::batch::{ExpansionPoint, Line, Sensitivities, SensitivityBlock};
use echocal_core::model::Term;
use echocal_core::simd::{InstructionSet, active};

/// One thread's memory for the columns of a table.
pub(super) struct Maker<'a> {
    simulation: Sensitivities<'a>,
    memory: BlockMaker<'a>,
}

/// What the columns of a block are made with, beside the simulation.
pub(super) struct BlockMaker<'a> {
    of: &'a Columns<'a>,
    polynomials: Polynomials,
    waves: Waves,
    /// Distance of each row where that of its group is another than the base's \[m\].
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
            simulation: Sensitivities::new(of.base, of.distance, &of.recorded),
            memory: BlockMaker {
                of,
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
        let (mut block, memory) = self.block(first, count);
        for (recipe, line) in into.iter_mut().enumerate() {
            memory.leveled(&mut block, recipe, line);
        }
    }

    /// The base simulation of a block, and what its columns are made with.
    pub(super) fn block(
        &mut self,
        first: usize,
        count: usize,
    ) -> (SensitivityBlock<'_>, &mut BlockMaker<'a>) {
        self.memory.ranges = [None; Quantity::COUNT];
        (self.simulation.block(first, count), &mut self.memory)
    }
}

impl BlockMaker<'_> {
    /// A column, without what an unknown level takes up.
    #[inline(always)]
    pub(super) fn leveled(
        &mut self,
        block: &mut SensitivityBlock<'_>,
        recipe: usize,
        line: &mut Line,
    ) {
        let made = &self.of.recipes[recipe];
        self.make(block, made, line);
        let (Some((groups, _)), Recipe::Tangent(term, level, ..)) = (&self.of.groups, made) else {
            return;
        };
        let Some(taken) = self.of.taken.get(recipe) else {
            return;
        };
        let mut slope = Line::of(1.0);
        self.slope(block, term, level, &mut slope);
        let groups = &groups[block.rows()];
        for ((number, slope), &group) in line.0.iter_mut().zip(&slope.0).zip(groups) {
            *number -= slope * taken[group as usize];
        }
    }

    /// A column as its recipe has it.
    #[inline(always)]
    pub(super) fn make(
        &mut self,
        block: &mut SensitivityBlock<'_>,
        recipe: &Recipe,
        line: &mut Line,
    ) {
        let rows = block.rows();
        match recipe {
            Recipe::Slope => block.slope(line),
            Recipe::Stored(at) => line.0[..rows.len()].copy_from_slice(&self.of.stored[*at][rows]),
            Recipe::Shift(term, level) => block.shift(term, self.point(block, level), line),
            Recipe::Tangent(term, level, parameter, scale) => {
                block.tangent((term, *parameter), self.point(block, level), *scale, line);
            }
            Recipe::Between(term, later, parameter, scale) => {
                self.between(block, (term, later, *parameter), *scale, line);
            }
            Recipe::Of(of, function, scale) => {
                let values = &self.of.stored[*of][rows.clone()];
                self.basis((*of, rows.start), function, *scale, values, line);
            }
        }
    }

    /// A basis function of a block's values of a column, times a scale.
    #[inline(always)]
    fn basis(
        &mut self,
        (of, first): (usize, usize),
        function: &BasisFunction,
        scale: f64,
        values: &[f64],
        line: &mut Line,
    ) {
        match *function {
            BasisFunction::Legendre {
                degree,
                between,
                line: (level, slope),
            } => {
                let (x, polynomial) = self.polynomials.of((of, between, first), values, degree);
                for ((number, x), p) in line.0.iter_mut().zip(&x.0).zip(&polynomial.0) {
                    *number = scale * (p - level - slope * x);
                }
            }
            BasisFunction::Wave {
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

    /// What a tangent at the base has beyond one that sets in later.
    fn between(
        &mut self,
        block: &mut SensitivityBlock<'_>,
        (term, later, parameter): (&Term, &Term, usize),
        scale: f64,
        line: &mut Line,
    ) {
        if self.alike(term, later, block.rows()) {
            return line.0.fill(0.0);
        }
        let (at, mut beyond) = (ExpansionPoint::OfBase, Line::of(0.0));
        block.tangent((later, parameter), at, scale, &mut beyond);
        block.tangent((term, parameter), at, scale, line);
        for (value, beyond) in line.0.iter_mut().zip(beyond.0) {
            *value -= beyond;
        }
    }

    /// Whether a block has no row between the places where an effect sets in, here and later.
    fn alike(&mut self, term: &Term, later: &Term, rows: core::ops::Range<usize>) -> bool {
        let Some((position, quantity)) = term.facts().divides() else {
            return false;
        };
        let range = &mut self.ranges[quantity as usize];
        let recorded = &self.of.recorded[quantity as usize];
        let (least, most) = *range.get_or_insert_with(|| recorded.range(rows));
        most <= term.parameters[position] || least > later.parameters[position]
    }

    /// Derivative of the reading to the distance with an effect at work.
    pub(super) fn slope(
        &mut self,
        block: &mut SensitivityBlock<'_>,
        term: &Term,
        level: &Level,
        line: &mut Line,
    ) {
        block.slope_with(term, self.point(block, level), line);
    }

    /// The distance at which an effect is evaluated: where that of its group is another than the
    /// base's, that of the group.
    fn point(&mut self, block: &SensitivityBlock<'_>, level: &Level) -> ExpansionPoint<'_> {
        let levels = match (level, &self.of.groups) {
            (Level::OfBase, _) => return ExpansionPoint::OfBase,
            (Level::OfGroups(levels), Some((groups, _))) => (levels, &groups[block.rows()]),
            (Level::OfGroups(_) | Level::Known, _) => return ExpansionPoint::Known,
        };
        let (levels, groups) = levels;
        for (distance, &group) in self.distance.0.iter_mut().zip(groups) {
            *distance = levels[group as usize];
        }
        self.distance.0[groups.len()..].fill(levels[groups[groups.len() - 1] as usize]);
        ExpansionPoint::Moved(&self.distance)
    }
}

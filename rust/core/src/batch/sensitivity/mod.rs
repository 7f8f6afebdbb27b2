//! How the readings of a base simulation change with the distance and with one more effect.
//!
//! The rows are taken a block at a time. What several columns of a block need is computed once.

mod following;
mod numbers;

pub use numbers::Numbers;

use super::staged::{BLOCK, BlockReader, Line, Pass, Reading};
use super::{Column, Precision};
use crate::chain::Stage;
use crate::conditions::Quantity;
use crate::model::{Model, Term};
use following::Following;

/// The distance at which derivatives are taken.
#[derive(Clone, Copy, Debug)]
pub enum ExpansionPoint<'a> {
    /// That of the base; the effect does nothing there, so that the base's derivatives hold.
    OfBase,
    /// That of the base, with the effect at work.
    Known,
    /// Another distance in each row \[m\], with the effect at work.
    Moved(&'a Line),
}

/// A base simulation over a table, and one thread's memory for its blocks.
pub struct Sensitivities<'a> {
    model: &'a Model,
    rows: usize,
    given: BlockReader,
    passes: [Pass; 3],
    following: Following,
}

impl<'a> Sensitivities<'a> {
    /// Of a table with the distance \[m\] and the recorded quantities, in the order of
    /// [`Quantity::ALL`], of each row.
    ///
    /// # Panics
    /// If a column has another length than the distance.
    #[must_use]
    pub fn new(
        model: &'a Model,
        distance: &'a [f64],
        recorded: &[Numbers<'a>; Quantity::COUNT],
    ) -> Self {
        assert!(recorded.iter().all(|column| column.has(distance.len())));
        let columns = recorded.each_ref().map(Numbers::column);
        Self {
            model,
            rows: distance.len(),
            given: BlockReader::new(Precision::Double, Column::of(distance), columns),
            passes: [Pass::new(), Pass::new(), Pass::new()],
            following: Following::new(),
        }
    }

    /// The base simulation of some rows, at most [`BLOCK`], with its derivative to the distance.
    ///
    /// # Panics
    /// If the table has not got the rows.
    pub fn block(&mut self, first: usize, count: usize) -> SensitivityBlock<'_> {
        assert!(count <= BLOCK && first + count <= self.rows);
        // SAFETY: the distance and the recorded columns are as long as the table.
        let block = unsafe { self.given.block(first, count) };
        self.following.forget();
        let [base, at_level, there] = &mut self.passes;
        SensitivityBlock {
            first,
            count,
            model: self.model,
            base: base.run(self.model, block.to_distance(true), Stage::Indication),
            at_level,
            there,
            following: &mut self.following,
        }
    }
}

/// One block of rows of a base simulation.
pub struct SensitivityBlock<'b> {
    first: usize,
    count: usize,
    model: &'b Model,
    base: Reading<'b>,
    at_level: &'b mut Pass,
    there: &'b mut Pass,
    following: &'b mut Following,
}

impl SensitivityBlock<'_> {
    /// The rows of the table that the block has.
    #[must_use]
    pub fn rows(&self) -> core::ops::Range<usize> {
        self.first..self.first + self.count
    }

    /// Derivative of the base's reading to the distance.
    pub fn slope(&self, into: &mut Line) {
        self.base.slopes(Stage::Indication, into);
    }

    /// Change of the base's reading by an effect at work \[m\].
    #[inline(always)]
    pub fn shift(&mut self, term: &Term, at: ExpansionPoint<'_>, into: &mut Line) {
        let expected = self.base.values(Stage::Indication);
        let found = self.beside(term, at, None).values(Stage::Indication);
        for ((shift, found), expected) in into.0.iter_mut().zip(found).zip(expected) {
            *shift = found - expected;
        }
    }

    /// Derivative of the reading to a parameter of an effect, by position, times a scale.
    #[inline(always)]
    pub fn tangent(
        &mut self,
        (term, parameter): (&Term, usize),
        at: ExpansionPoint<'_>,
        scale: f64,
        into: &mut Line,
    ) {
        let of_base = matches!(at, ExpansionPoint::OfBase);
        let (model, base, of) = (self.model, &self.base, (term, parameter));
        if of_base && self.following.tangent(model, base, of, scale, into) {
            return;
        }
        let there = self.beside(term, at, Some(parameter));
        there.slopes(Stage::Indication, into);
        for value in &mut into.0 {
            *value *= scale;
        }
    }

    /// Derivative of the reading to the distance with an effect at work.
    pub fn slope_with(&mut self, term: &Term, at: ExpansionPoint<'_>, into: &mut Line) {
        let block = match at {
            ExpansionPoint::OfBase => return self.slope(into),
            ExpansionPoint::Known => self.base,
            ExpansionPoint::Moved(distance) => self.base.at(distance),
        };
        let there = self.there.with(self.model, block.to_distance(true), term);
        there.slopes(Stage::Indication, into);
    }

    /// The reading with an effect, and its derivative to a parameter.
    fn beside<'r>(
        &'r mut self,
        term: &Term,
        at: ExpansionPoint<'r>,
        seed: Option<usize>,
    ) -> Reading<'r> {
        let ExpansionPoint::Moved(distance) = at else {
            return self.there.beside(self.model, &self.base, term, seed);
        };
        let moved = self.base.at(distance);
        let block = self.at_level.run(self.model, moved, Stage::Indication);
        self.there.beside(self.model, &block, term, seed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditions::Conditions;
    use crate::{Error, Law};

    const ROWS: usize = 7;

    fn at(distance: f64, temperature: f64) -> (f64, Conditions<f64>) {
        let mut values = [0.0; Quantity::COUNT];
        values[Quantity::Temperature as usize] = temperature;
        values[Quantity::Pressure as usize] = 101_325.0;
        (distance, Conditions::new(values))
    }

    /// Slopes, shifts and tangents against differences of single readings.
    #[test]
    fn a_block_has_the_differences_of_single_readings() -> Result<(), Error> {
        let base = Model::new(Law::parse("linear")?);
        let scaled = |scale: f64| base.clone().with("reference_scale", &[("scale", scale)]);
        let reading = |model: &Model, (distance, conditions): (f64, Conditions<f64>)| {
            let parameters = model.parameters();
            let chain = model.simulate(distance, &conditions, &parameters);
            chain.indication
        };
        let distance: [f64; ROWS] = core::array::from_fn(|row| 1.0 + 0.3 * row as f64);
        let temperature: [f64; ROWS] = core::array::from_fn(|row| 5.0 + 4.0 * row as f64);
        let (none, pressure) = (0.0, 101_325.0);
        let mut recorded = [Numbers::All(&none); Quantity::COUNT];
        recorded[Quantity::Pressure as usize] = Numbers::All(&pressure);
        recorded[Quantity::Temperature as usize] = Numbers::Each(&temperature);
        let mut all = Sensitivities::new(&base, &distance, &recorded);
        let mut block = all.block(2, 4);
        let term = Term::new("reference_scale", &[("scale", 0.02)])?;
        let neutral = Term::new("reference_scale", &[])?;
        let [mut slope, mut shift, mut tangent] = [Line::of(0.0); 3];
        block.slope(&mut slope);
        block.shift(&term, ExpansionPoint::Known, &mut shift);
        block.tangent((&neutral, 0), ExpansionPoint::OfBase, 2.0, &mut tangent);
        for (place, row) in block.rows().enumerate() {
            let (d, t, h) = (distance[row], temperature[row], 1e-5);
            let value = |model: &Model, d: f64| reading(model, at(d, t));
            let expected = (value(&base, d + h) - value(&base, d - h)) / (2.0 * h);
            assert!(
                (slope.0[place] - expected).abs() < 1e-9,
                "slope of row {row}"
            );
            let expected = value(&scaled(0.02)?, d) - value(&base, d);
            assert!(
                (shift.0[place] - expected).abs() < 1e-13,
                "shift of row {row}"
            );
            let expected = (value(&scaled(h)?, d) - value(&scaled(-h)?, d)) / h;
            assert!(
                (tangent.0[place] - expected).abs() < 1e-8,
                "tangent of row {row}"
            );
        }
        Ok(())
    }

    /// Where an effect does nothing, both ways to a derivative are one.
    #[test]
    fn derivatives_at_the_base_are_those_with_the_neutral_effect_at_work() -> Result<(), Error> {
        let base = Model::new(Law::parse("linear")?);
        let distance = [0.4, 1.5, 2.5];
        let twenty = 20.0;
        let recorded = [Numbers::All(&twenty); Quantity::COUNT];
        let mut all = Sensitivities::new(&base, &distance, &recorded);
        let mut block = all.block(0, 3);
        for id in ["fixed_delay", "zero_error", "reference_scale"] {
            let term = Term::new(id, &[])?;
            let [mut of_base, mut known, mut moved] = [Line::of(0.0); 3];
            block.tangent((&term, 0), ExpansionPoint::OfBase, 1.0, &mut of_base);
            block.tangent((&term, 0), ExpansionPoint::Known, 1.0, &mut known);
            let mut same = Line::of(1.0);
            same.0[..3].copy_from_slice(&distance);
            block.tangent((&term, 0), ExpansionPoint::Moved(&same), 1.0, &mut moved);
            for row in 0..3 {
                let size = known.0[row].abs();
                assert!(
                    (of_base.0[row] - known.0[row]).abs() <= 1e-14 * size,
                    "{id}"
                );
                assert_eq!(moved.0[row], known.0[row], "{id}");
            }
        }
        Ok(())
    }
}

//! Whole models as batch kernels.

#![allow(unsafe_code)]

use super::staged::{BLOCK, BlockReader, Line, Pass, Reading};
use super::{Column, Kernel, Precision, threads};
use crate::chain::Stage;
use crate::conditions::{Conditions, Quantity};
use crate::model::{Model, Term};

/// What a kernel of a model computes; its inputs are the quantity named here and every influence
/// quantity, in the order of [`Quantity::ALL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelOutput {
    /// Of a distance \[m\]: what the device indicates \[m\].
    Indication,
    /// Of a distance \[m\]: speed of sound on the path \[m/s\].
    SpeedOfSound,
    /// Of a distance \[m\]: recorded echo time \[s\].
    TimeOfFlight,
    /// Of an indication \[m\]: the distance \[m\], NaN where there is none.
    Correction,
    /// Of a recorded echo time \[s\]: the distance \[m\], NaN where there is none.
    Distance,
}

/// The kernel of a model. It computes in double precision, also between single-precision columns.
#[must_use]
pub fn of_model(model: Model, output: ModelOutput) -> Box<dyn Kernel> {
    Box::new(OfModel { model, output })
}

const INPUTS: usize = 1 + Quantity::COUNT;

struct OfModel {
    model: Model,
    output: ModelOutput,
}

impl Kernel for OfModel {
    fn arity(&self) -> usize {
        INPUTS
    }

    fn evaluate(&self, inputs: &[f64]) -> f64 {
        let (model, first) = (&self.model, inputs[0]);
        let recorded = Conditions::new(core::array::from_fn(|q| inputs[1 + q]));
        match self.output {
            ModelOutput::Indication => model.indicate(first, &recorded),
            ModelOutput::SpeedOfSound => model.speed_of_sound(first, &recorded),
            ModelOutput::TimeOfFlight => model.time_of_flight(first, &recorded),
            ModelOutput::Correction => model.correct(first, &recorded),
            ModelOutput::Distance => model.distance(first, &recorded),
        }
    }

    unsafe fn run_f64(&self, inputs: &[Column], output: Column, rows: usize, threads: usize) {
        // SAFETY: the caller's.
        unsafe { self.run(Precision::Double, inputs, output, rows, threads) }
    }

    unsafe fn run_f32(&self, inputs: &[Column], output: Column, rows: usize, threads: usize) {
        // SAFETY: the caller's.
        unsafe { self.run(Precision::Single, inputs, output, rows, threads) }
    }
}

impl OfModel {
    /// # Safety
    /// As for [`Kernel::run_f64`], for columns of this precision.
    unsafe fn run(
        &self,
        precision: Precision,
        inputs: &[Column],
        output: Column,
        rows: usize,
        threads: usize,
    ) {
        let span = |first: usize, count: usize| {
            let columns = core::array::from_fn(|q| inputs[1 + q].skip(first));
            let mut given = BlockReader::new(precision, inputs[0].skip(first), columns);
            let mut pass = Pass::new();
            for from in (0..count).step_by(BLOCK) {
                let some = BLOCK.min(count - from);
                // SAFETY: rows of columns that the caller guarantees.
                let block = unsafe { given.block(from, some) };
                let found = self.block(&mut pass, block);
                // SAFETY: as above; what was found lies in the memory of the pass.
                unsafe { precision.put(output.skip(first + from), &found[..some]) };
            }
        };
        threads::split(rows, threads, threads::OF_A_MODEL, &span);
    }

    fn block<'a>(&self, pass: &'a mut Pass, block: Reading<'a>) -> &'a [f64] {
        let model = &self.model;
        let last = match self.output {
            ModelOutput::Correction => {
                return pass.invert(model, block, Stage::Indication, false);
            }
            ModelOutput::Distance => {
                return pass.invert(model, block, Stage::Timer, true);
            }
            ModelOutput::Indication => Stage::Indication,
            ModelOutput::TimeOfFlight => Stage::Timer,
            ModelOutput::SpeedOfSound => Stage::Speed,
        };
        pass.run(model, block, last).values(last)
    }
}

/// Derivatives of the indication, row by row: to the distance, then to each parameter.
///
/// `inputs` are the distance and every influence quantity, in the order of [`Quantity::ALL`].
///
/// # Panics
/// If there are not as many inputs, or they differ in length.
#[must_use]
pub fn jacobian(model: &Model, inputs: &[&[f64]], threads: usize) -> Vec<f64> {
    let rows = inputs[0].len();
    assert!(inputs.len() == INPUTS && inputs.iter().all(|input| input.len() == rows));
    let terms = model.terms().iter().enumerate();
    let each = |(term, t): (usize, &Term)| (0..t.parameters.len()).map(move |p| Some((term, p)));
    let seeds: Vec<_> = [None].into_iter().chain(terms.flat_map(each)).collect();
    let mut found = vec![0.0; rows * seeds.len()];
    let output = Output(found.as_mut_ptr());
    let columns: [Column; INPUTS] = core::array::from_fn(|k| Column::of(inputs[k]));
    let span = |first: usize, count: usize| {
        let recorded = core::array::from_fn(|q| columns[1 + q].skip(first));
        let mut given = BlockReader::new(Precision::Double, columns[0].skip(first), recorded);
        let (mut pass, mut line) = (Pass::new(), Line::of(0.0));
        for from in (0..count).step_by(BLOCK) {
            let some = BLOCK.min(count - from);
            // SAFETY: rows of the inputs.
            let block = unsafe { given.block(from, some) };
            for (place, &seed) in seeds.iter().enumerate() {
                let here = block.to_distance(seed.is_none());
                let reached = pass.seeded(model, here, Stage::Indication, seed);
                reached.slopes(Stage::Indication, &mut line);
                for (row, &slope) in line.0[..some].iter().enumerate() {
                    let at = (first + from + row) * seeds.len() + place;
                    // SAFETY: a number of the output, which one thread alone writes.
                    unsafe { output.put(at, slope) };
                }
            }
        }
    };
    threads::split(rows, threads, threads::OF_A_MODEL, &span);
    found
}

/// Where threads put numbers, each its own.
#[derive(Clone, Copy)]
struct Output(*mut f64);

// SAFETY: who puts a number answers for its place.
unsafe impl Send for Output {}
// SAFETY: as above.
unsafe impl Sync for Output {}

impl Output {
    unsafe fn put(&self, at: usize, value: f64) {
        // SAFETY: the caller guarantees the place, and that nobody else has it.
        unsafe { *self.0.add(at) = value };
    }
}

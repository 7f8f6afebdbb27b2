//! One thread of the proof: row after row, block after block.

use super::claim::{Claim, SEED, Worst, fold};
use super::straight::Straight;
use crate::error::Error;
use crate::ir::{Block, LANES, Overflow, Program};
use crate::reference::place;

/// What holds for the echo times of one combination of conditions.
pub(super) struct Row {
    row: usize,
    /// End of the bounded domain \[unit\].
    far: f64,
    pub(super) bounded: Worst,
    pub(super) overall: Worst,
    pub(super) within: u64,
    pub(super) hash: u32,
}

/// One thread's working memory.
pub(super) struct Checker<'a> {
    claim: Claim<'a>,
    program: &'a Program,
    block: Block<'a>,
    times: Vec<f64>,
    truth: Vec<f64>,
}

impl<'a> Checker<'a> {
    pub(super) fn new(program: &'a Program, claim: Claim<'a>) -> Result<Self, Error> {
        let codes = claim.device.echo.codes;
        let times: Vec<f64> = (codes.minimum..=codes.maximum)
            .map(|code| claim.device.echo.value(code))
            .collect();
        let block = Block::new(program).map_err(|overflow| Error::Proof(overflow.to_string()))?;
        Ok(Self {
            claim,
            program,
            block,
            truth: vec![0.0; times.len()],
            times,
        })
    }

    /// Fill `truth` with what the model gives for a row \[unit\].
    fn look_up(&mut self, row: usize) {
        let Claim {
            device, reference, ..
        } = self.claim;
        reference.distances(&device.values(row), &self.times, &mut self.truth);
        let scale = |truth: &mut f64| *truth *= device.output.per_meter;
        self.truth.iter_mut().for_each(scale);
    }

    pub(super) fn row(&mut self, row: usize) -> Result<Row, Error> {
        let device = self.claim.device;
        let fault = |echo: i64, what: &str| format!("{what} {}", place(device, row, echo));
        let ends = (device.echo.codes.minimum, device.echo.codes.maximum);
        let overflow =
            |overflow: Overflow| Error::Proof(fault(ends.0, &format!("{overflow}, near")));
        self.look_up(row);
        let codes = device.codes(row);
        let straight = Straight::of(self.program, &codes, ends).map_err(overflow)?;
        if straight.is_none() {
            self.block.set_conditions(&codes).map_err(overflow)?;
        }
        let mut lanes = [0_i32; LANES];
        let mut result = Row::new(row, self.claim.maximum_distance * device.output.per_meter);
        let mut before = i32::MIN;
        for (index, truth) in self.truth.chunks(LANES).enumerate() {
            let first = ends.0 + (index * LANES) as i64;
            if let Some(straight) = straight {
                straight.fill(first, &mut lanes);
            } else {
                let found = self.block.evaluate(first, ends.1).map_err(overflow)?;
                let pairs = lanes.iter_mut().zip(found);
                pairs.for_each(|(lane, found)| *lane = *found as i32);
            }
            let outputs = &lanes[..truth.len()];
            if let Some(fall) = falls(before, outputs) {
                let what = "the output falls as the echo time grows, at";
                return Err(Error::Proof(fault(first + fall as i64, what)));
            }
            before = outputs[outputs.len() - 1];
            if !result.take(outputs, truth, first) {
                return Err(Error::Model(fault(
                    first,
                    "the model gives no distance near",
                )));
            }
        }
        Ok(result)
    }
}

/// |output - truth| \[unit\].
fn error(output: i32, truth: f64) -> f64 {
    (f64::from(output) - truth).abs()
}

impl Row {
    fn new(row: usize, far: f64) -> Self {
        let (bounded, overall) = (Worst::NONE, Worst::NONE);
        Self {
            row,
            far,
            bounded,
            overall,
            within: 0,
            hash: SEED,
        }
    }

    /// Take in one block of outputs and truths \[unit\] that starts at the echo code `first`; `false` if a truth is not
    /// finite.
    fn take(&mut self, outputs: &[i32], truth: &[f64], first: i64) -> bool {
        self.hash = outputs
            .iter()
            .fold(self.hash, |hash, output| fold(hash, *output as u32));
        let (mut overall, mut bounded, mut finite) = (-1.0_f64, -1.0_f64, 0.0);
        for (output, truth) in outputs.iter().zip(truth) {
            let error = error(*output, *truth);
            let inside = *truth <= self.far;
            finite += truth * 0.0;
            overall = overall.max(error);
            bounded = bounded.max(if inside { error } else { -1.0 });
            self.within += u64::from(inside);
        }
        let find = |largest: f64, limit: f64| {
            let mut pairs = outputs.iter().zip(truth);
            let found = pairs.position(|(o, t)| *t <= limit && error(*o, *t) >= largest);
            let echo = first + found.unwrap_or(0) as i64;
            Worst {
                error: largest,
                row: self.row,
                echo,
            }
        };
        if overall > self.overall.error {
            self.overall = find(overall, f64::INFINITY);
        }
        if bounded > self.bounded.error {
            self.bounded = find(bounded, self.far);
        }
        finite == 0.0
    }
}

/// The first place at which `outputs` fall, continuing from `before`.
fn falls(before: i32, outputs: &[i32]) -> Option<usize> {
    let fell = outputs
        .windows(2)
        .fold(outputs[0] < before, |fell, pair| fell | (pair[1] < pair[0]));
    let first = || {
        outputs
            .windows(2)
            .position(|pair| pair[1] < pair[0])
            .map_or(0, |position| position + 1)
    };
    fell.then(first)
}

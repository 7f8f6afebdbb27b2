//! Brute force: one row, every echo code, every step of the twin. It serves where nothing quicker is proven, and it is
//! what the quick proof is tested against.

use super::claim::Claim;
use super::row::{Fault, Row, truths};
use crate::error::Error;
use crate::hash::Hash;
use crate::ir::{Block, LANES, Program};

/// One thread's working memory.
pub(super) struct Checker<'a> {
    claim: Claim<'a>,
    block: Block<'a>,
    truth: Vec<f64>,
}

impl<'a> Checker<'a> {
    pub(super) fn new(program: &'a Program, claim: Claim<'a>) -> Result<Self, Error> {
        let block = Block::new(program).map_err(|overflow| Error::Proof(overflow.to_string()))?;
        Ok(Self {
            claim,
            block,
            truth: Vec::new(), // made where a row is checked
        })
    }

    pub(super) fn row(&mut self, row: usize) -> Result<(Row, Hash), Error> {
        let device = self.claim.device;
        let fault = Fault { device, row };
        let ends = (device.echo.codes.minimum, device.echo.codes.maximum);
        let overflow = |overflow| fault.overflow(&overflow, ends.0);
        self.truth.resize(device.echo.len(), 0.0);
        truths(self.claim, &device.values(row), ends.0, &mut self.truth);
        let codes = device.codes(row);
        self.block.set_conditions(&codes).map_err(overflow)?;
        let mut lanes = [0_i32; LANES];
        let mut result = Row::new(row, self.claim);
        let (mut before, mut hash) = (i32::MIN, Hash::default());
        for (index, truth) in self.truth.chunks(LANES).enumerate() {
            let first = ends.0 + (index * LANES) as i64;
            let found = self.block.evaluate(first, ends.1).map_err(overflow)?;
            let pairs = lanes.iter_mut().zip(found);
            pairs.for_each(|(lane, found)| *lane = *found as i32);
            let outputs = &lanes[..truth.len()];
            if let Some(fall) = falls(before, outputs) {
                return Err(fault.falls(first + fall as i64));
            }
            before = outputs[outputs.len() - 1];
            hash.extend(outputs);
            if !result.take(outputs, truth, first) {
                return Err(fault.no_distance(first));
            }
        }
        result.within = self
            .truth
            .iter()
            .map(|truth| u64::from(*truth <= result.far))
            .sum();
        Ok((result, hash))
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

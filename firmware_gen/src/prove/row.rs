//! What holds for one row: the echo times at one combination of conditions.

use super::claim::{Claim, Worst};
use crate::device::Device;
use crate::error::Error;
use crate::ir::Overflow;
use crate::reference::place;

/// What holds for the echo times of one combination of conditions.
pub(super) struct Row {
    row: usize,
    /// End of the bounded domain \[unit\].
    pub(super) far: f64,
    pub(super) bounded: Worst,
    pub(super) overall: Worst,
    pub(super) within: u64,
    /// Outputs at the first and the last echo code \[unit\].
    pub(super) ends: (i32, i32),
}

/// Fill `truth` with what the model gives \[unit\] from the echo code `from` on.
pub(super) fn truths(claim: Claim<'_>, conditions: &[f64], from: i64, truth: &mut [f64]) {
    let time = |(code, _)| claim.device.echo.value(code);
    let times: Vec<f64> = (from..).zip(truth.iter()).map(time).collect();
    claim.reference.distances(conditions, &times, truth);
    let scale = |truth: &mut f64| *truth *= claim.device.output.per_meter;
    truth.iter_mut().for_each(scale);
}

/// |output - truth| \[unit\].
fn error(output: i32, truth: f64) -> f64 {
    (f64::from(output) - truth).abs()
}

impl Row {
    pub(super) fn new(row: usize, claim: Claim<'_>) -> Self {
        let (bounded, overall) = (Worst::NONE, Worst::NONE);
        Self {
            row,
            far: claim.maximum_distance * claim.device.output.per_meter,
            bounded,
            overall,
            within: 0,
            ends: (i32::MAX, i32::MIN),
        }
    }

    /// Take in what was found for other echo codes of the same conditions.
    pub(super) fn join(&mut self, part: &Self) {
        self.bounded = self.bounded.or(part.bounded);
        self.overall = self.overall.or(part.overall);
        self.within += part.within;
        self.ends = (self.ends.0.min(part.ends.0), self.ends.1.max(part.ends.1));
    }

    /// Take in the errors of one block of outputs and truths \[unit\] that starts at the echo code `first`; `false` if a
    /// truth is not finite. Outputs never fall, so that the least and the largest are those of the ends.
    pub(super) fn take(&mut self, outputs: &[i32], truth: &[f64], first: i64) -> bool {
        let ends = (outputs[0], outputs[outputs.len() - 1]);
        self.ends = (self.ends.0.min(ends.0), self.ends.1.max(ends.1));
        let (mut overall, mut bounded, mut finite) = (-1.0_f64, -1.0_f64, 0.0);
        for (output, truth) in outputs.iter().zip(truth) {
            let error = error(*output, *truth);
            let inside = *truth <= self.far;
            finite += truth * 0.0;
            overall = overall.max(error);
            bounded = bounded.max(if inside { error } else { -1.0 });
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

/// Where something is wrong.
#[derive(Clone, Copy)]
pub(super) struct Fault<'a> {
    pub(super) device: &'a Device,
    pub(super) row: usize,
}

impl Fault<'_> {
    pub(super) fn at(&self, echo: i64, what: &str) -> String {
        format!("{what} {}", place(self.device, self.row, echo))
    }

    pub(super) fn overflow(&self, overflow: &Overflow, echo: i64) -> Error {
        Error::Proof(self.at(echo, &format!("{overflow}, near")))
    }

    pub(super) fn falls(&self, echo: i64) -> Error {
        Error::Proof(self.at(echo, "the output falls as the echo time grows, at"))
    }

    pub(super) fn no_distance(&self, echo: i64) -> Error {
        Error::Model(self.at(echo, "the model gives no distance near"))
    }
}

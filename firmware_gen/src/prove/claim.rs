//! The claim to be proven for a program, and the result of the proof.

use crate::device::Device;
use crate::reference::Reference;

/// The input at which the error is largest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worst {
    /// |output - model| \[unit\].
    pub error: f64,
    /// Combination of conditions, as [`Device::codes`] counts them.
    pub row: usize,
    /// Echo code.
    pub echo: i64,
}

impl Worst {
    /// Initial value, before the first input.
    pub(super) const NONE: Self = Self {
        error: -1.0,
        row: 0,
        echo: 0,
    };

    /// The larger error; of equal ones, that of the earlier row.
    pub(super) fn or(self, other: Self) -> Self {
        let earlier = other.error == self.error && other.row < self.row;
        if other.error > self.error || earlier {
            other
        } else {
            self
        }
    }
}

/// Outputs \[unit\] at the first and the last echo code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Accepted at all combinations of conditions.
    pub always: (i64, i64),
    /// Accepted at some.
    pub sometimes: (i64, i64),
}

impl Reach {
    /// Initial value, before the first row.
    pub(super) const NONE: Self = Self {
        always: (i64::MIN, i64::MAX),
        sometimes: (i64::MAX, i64::MIN),
    };

    /// With the nearest and the farthest output of another row.
    pub(super) fn with(self, (near, far): (i32, i32)) -> Self {
        let (near, far) = (i64::from(near), i64::from(far));
        Self {
            always: (self.always.0.max(near), self.always.1.min(far)),
            sometimes: (self.sometimes.0.min(near), self.sometimes.1.max(far)),
        }
    }
}

/// What was proven for every input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proof {
    /// Largest error where the model's distance is within the bounded domain.
    pub bounded: Worst,
    /// Largest error over all inputs.
    pub overall: Worst,
    /// Inputs that were checked.
    pub inputs: u64,
    /// Inputs within the bounded domain.
    pub bounded_inputs: u64,
    /// Outputs at the ends of the echo codes.
    pub reach: Reach,
    /// Hash of all outputs in order: see [`Hash`](crate::hash::Hash).
    pub hash: u64,
}

/// What is to be proven.
#[derive(Clone, Copy)]
pub struct Claim<'a> {
    /// The inputs.
    pub device: &'a Device,
    /// The model.
    pub reference: &'a dyn Reference,
    /// The bounded domain: distances up to this \[m\].
    pub maximum_distance: f64,
    /// The proof stops if the error in the bounded domain exceeds this \[unit\].
    pub most: f64,
    /// Threads to use.
    pub threads: usize,
}

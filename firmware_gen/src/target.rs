//! Targets: what an operation costs there, and what the text must respect.

use crate::error::Error;
use crate::ir::{Operation, Program};

/// What a program costs, for ranking candidates only: no report shows it as if it had been measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Code and tables, in bytes.
    pub size: u64,
    /// Time, in cycles.
    pub time: u64,
}

/// What the candidates are ranked by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prefer {
    /// The fewest bytes.
    Size,
    /// The fewest cycles.
    Speed,
}

impl Prefer {
    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Size => "size",
            Self::Speed => "speed",
        }
    }

    /// The preference of this name.
    ///
    /// # Errors
    /// If there is none.
    pub fn parse(name: &str) -> Result<Self, Error> {
        let known = [Self::Size, Self::Speed];
        let found = known.into_iter().find(|prefer| prefer.name() == name);
        found.ok_or_else(|| unknown("preference", name, &known.map(Self::name)))
    }

    /// The key to rank by: the preferred cost first, the other one to break ties.
    #[must_use]
    pub const fn key(self, cost: Cost) -> (u64, u64) {
        match self {
            Self::Size => (cost.size, cost.time),
            Self::Speed => (cost.time, cost.size),
        }
    }
}

/// A family of microcontrollers, or a language standard that stands for all of them.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Its name on the command line.
    pub name: &'static str,
    /// Least width of a local variable [bit].
    pub least_bits: u32,
    /// What one operation costs.
    cost: fn(Operation, u32) -> Cost,
}

/// Every target. To add one, write its costs and add its line.
pub const TARGETS: &[Target] = &[Target {
    name: "c99",
    least_bits: 16,
    cost: c99,
}];

impl Target {
    /// The target of this name.
    ///
    /// # Errors
    /// If there is none.
    pub fn parse(name: &str) -> Result<Self, Error> {
        let names: Vec<_> = TARGETS.iter().map(|target| target.name).collect();
        let found = TARGETS.iter().copied().find(|target| target.name == name);
        found.ok_or_else(|| unknown("target", name, &names))
    }

    /// The cost of a program: its operations and its tables.
    #[must_use]
    pub fn cost(&self, program: &Program) -> Cost {
        let tables = Cost {
            size: program.table_bytes() as u64,
            time: 0,
        };
        program.nodes.iter().fold(tables, |sum, node| {
            let cost = (self.cost)(node.operation, node.computed.bits());
            Cost {
                size: sum.size + cost.size,
                time: sum.time + cost.time,
            }
        })
    }
}

/// A 32-bit core with a multiplier, in round figures; wider operations are made of several.
fn c99(operation: Operation, bits: u32) -> Cost {
    let (size, time) = match operation {
        Operation::Input(_) => (0, 0),
        Operation::Constant(constant) if constant.unsigned_abs() < 256 => (0, 0),
        Operation::Constant(_) => (4, 1),
        Operation::Add(..) | Operation::Subtract(..) | Operation::ShiftRight(..) => (2, 1),
        Operation::LowBits(..) => (4, 1),
        Operation::Multiply(..) => (2, 2),
        Operation::Load(..) => (6, 3),
    };
    let words = if bits > 32 { 3 } else { 1 };
    Cost {
        size: size * words,
        time: time * words,
    }
}

fn unknown(what: &str, given: &str, known: &[&str]) -> Error {
    Error::Request(format!(
        "unknown {what} '{given}'; this version has {}",
        known.join(", ")
    ))
}

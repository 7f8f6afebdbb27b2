//! Targets: the cost of each operation, and the types and tables that the C text uses.

mod features;
mod weights;

pub use features::{FEATURES, Features, features};

use crate::error::Error;
use crate::ir::Program;
use weights::Weights;

/// What a program costs, for ranking candidates only: no report shows it as if it had been measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Code and tables, in tenths of a byte.
    pub size: u64,
    /// Time, in tenths of a cycle or an instruction.
    pub time: u64,
}

impl std::ops::Add for Cost {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            size: self.size + other.size,
            time: self.time + other.time,
        }
    }
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
    /// Whether shifts by whole bytes are much cheaper than others.
    pub byte_shifts: bool,
    /// Whether constant tables must be read from program memory by name, lest they take RAM.
    pub program_memory: bool,
    /// What the steps cost.
    weights: &'static Weights,
}

/// A 32-bit core: narrower variables would only be cut to size again and again.
const fn core(name: &'static str, weights: &'static Weights) -> Target {
    Target {
        name,
        least_bits: 32,
        byte_shifts: false,
        program_memory: false,
        weights,
    }
}

/// Every target. To add one, add its line and its core to `benches/costs.py`, which measures its weights.
pub const TARGETS: &[Target] = &[
    Target {
        least_bits: 16,
        ..core("c99", &weights::C99)
    },
    Target {
        least_bits: 8,
        byte_shifts: true,
        program_memory: true,
        ..core("avr", &weights::AVR)
    },
    core("cortex-m0", &weights::CORTEX_M0),
    core("cortex-m3", &weights::CORTEX_M3),
    core("cortex-m4f", &weights::CORTEX_M4F),
    core("rv32", &weights::RV32),
    core("rv32e", &weights::RV32E),
];

/// Cores for which the C of the first target is right as it is, and of which nothing is measured.
pub const ALSO: &[&str] = &["cortex-m4", "cortex-m7", "esp32", "rp2040", "msp430"];

impl Target {
    /// The target of this name.
    ///
    /// # Errors
    /// If there is none.
    pub fn parse(name: &str) -> Result<Self, Error> {
        let found = TARGETS.iter().copied().find(|target| target.name == name);
        let also = ALSO.iter().find(|also| **also == name);
        let c99 = also.map(|name| Self { name, ..TARGETS[0] });
        found.or(c99).ok_or_else(|| {
            let names = TARGETS.iter().map(|target| target.name);
            unknown(
                "target",
                name,
                &names.chain(ALSO.iter().copied()).collect::<Vec<_>>(),
            )
        })
    }

    /// The cost of a program's steps and tables, without what every function needs for its arguments.
    #[must_use]
    pub fn cost(&self, program: &Program) -> Cost {
        let mut counts = features(program);
        counts[0] = 0;
        self.weighted(program, &counts)
    }

    /// The cost of a whole function, as measured ones suggest it.
    #[must_use]
    pub fn expected(&self, program: &Program) -> Cost {
        self.weighted(program, &features(program))
    }

    fn weighted(&self, program: &Program, counts: &Features) -> Cost {
        let tables = Cost {
            size: 10 * program.table_bytes() as u64,
            time: 0,
        };
        let steps = self.weights.iter().zip(counts);
        steps.fold(tables, |sum, ((size, time), count)| Cost {
            size: sum.size + size * u64::from(*count),
            time: sum.time + time * u64::from(*count),
        })
    }
}

fn unknown(what: &str, given: &str, known: &[&str]) -> Error {
    Error::Request(format!(
        "unknown {what} '{given}'; this version has {}",
        known.join(", ")
    ))
}

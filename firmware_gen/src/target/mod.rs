//! Targets: what an operation costs there, and what the text must respect.

mod cost;

use crate::error::Error;
use crate::ir::{Node, Program};

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
    /// Whether shifts by whole bytes are much cheaper than others.
    pub byte_shifts: bool,
    /// Whether constant tables must be read from program memory by name, lest they take RAM.
    pub program_memory: bool,
    /// What one step costs.
    cost: fn(&Program, &Node) -> Cost,
}

/// A 32-bit core: narrower variables would only be cut to size again and again.
const fn core(name: &'static str) -> Target {
    Target {
        name,
        least_bits: 32,
        byte_shifts: false,
        program_memory: false,
        cost: cost::word,
    }
}

/// Every target. To add one, write its costs and add its line.
pub const TARGETS: &[Target] = &[
    Target {
        least_bits: 16,
        cost: cost::portable,
        ..core("c99")
    },
    Target {
        name: "avr",
        least_bits: 8,
        byte_shifts: true,
        program_memory: true,
        cost: cost::avr,
    },
    core("cortex-m0"),
    core("cortex-m3"),
    core("cortex-m4f"),
    Target {
        cost: cost::riscv,
        ..core("rv32")
    },
];

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
            let cost = (self.cost)(program, node);
            Cost {
                size: sum.size + cost.size,
                time: sum.time + cost.time,
            }
        })
    }
}

fn unknown(what: &str, given: &str, known: &[&str]) -> Error {
    Error::Request(format!(
        "unknown {what} '{given}'; this version has {}",
        known.join(", ")
    ))
}

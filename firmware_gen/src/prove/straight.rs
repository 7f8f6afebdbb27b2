//! The output over a row of echo times as one line, where the program itself shows that it is one: at fixed conditions
//! each step of most programs is a straight line in the echo time, or one such line cut off. Lines are monotone, so what
//! every step claims holds at all echo codes if it holds at the first and the last, and the output never falls.

use crate::hash::Hash;
use crate::ir::{Operation, Overflow, Program, Value};
use crate::types::Range;

/// The output `(start + slope * echo) >> bits`, and `after` on top of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Straight {
    start: i64,
    slope: i64,
    bits: u32,
    after: i64,
}

impl Straight {
    const fn fixed(start: i64) -> Self {
        Self {
            start,
            slope: 0,
            bits: 0,
            after: 0,
        }
    }

    /// The value, if it does not depend on the echo time.
    fn constant(self) -> Option<i64> {
        (self.slope == 0).then_some((self.start >> self.bits) + self.after)
    }

    fn plus(self, more: i64) -> Option<Self> {
        let after = self.after.checked_add(more)?;
        Some(Self { after, ..self })
    }

    /// The line alone, if nothing was cut off.
    fn line(self) -> Option<(i64, i64)> {
        (self.bits == 0).then_some((self.start + self.after, self.slope))
    }

    fn of_line(start: i64, slope: i64) -> Self {
        Self {
            start,
            slope,
            bits: 0,
            after: 0,
        }
    }

    fn add(self, other: Self) -> Option<Self> {
        match (self.constant(), other.constant()) {
            (_, Some(constant)) => self.plus(constant),
            (Some(constant), _) => other.plus(constant),
            // What is not cut off goes below the cut of the other.
            _ => match (self.line(), other.line()) {
                (_, Some(line)) => self.plus_line(line),
                (Some(line), _) => other.plus_line(line),
                _ => None,
            },
        }
    }

    fn plus_line(self, (start, slope): (i64, i64)) -> Option<Self> {
        let unit = 1_i64.checked_shl(self.bits)?;
        Some(Self {
            start: self.start.checked_add(start.checked_mul(unit)?)?,
            slope: self.slope.checked_add(slope.checked_mul(unit)?)?,
            ..self
        })
    }

    fn times(self, other: Self) -> Option<Self> {
        let (line, factor) = match (self.constant(), other.constant()) {
            (_, Some(factor)) => (self.line()?, factor),
            (Some(factor), _) => (other.line()?, factor),
            _ => return None,
        };
        Some(Self::of_line(
            line.0.checked_mul(factor)?,
            line.1.checked_mul(factor)?,
        ))
    }

    fn cut(self, bits: u32) -> Option<Self> {
        let unit = 1_i64.checked_shl(self.bits)?;
        Some(Self {
            start: self.start.checked_add(self.after.checked_mul(unit)?)?,
            slope: self.slope,
            bits: self.bits + bits,
            after: 0,
        })
    }

    /// The output of `program` at these conditions, its claims checked at the `first` and the `last` echo code; nothing
    /// if it is not such a line, rising.
    pub(crate) fn of(
        program: &Program,
        conditions: &[i64],
        (first, last): (i64, i64),
    ) -> Result<Option<Self>, Overflow> {
        let inputs = |echo: i64| [&[echo], conditions].concat();
        let (low, high) = (
            program.trace(&inputs(first))?,
            program.trace(&inputs(last))?,
        );
        let mut lines: Vec<Option<Self>> = Vec::with_capacity(program.nodes.len());
        for (index, node) in program.nodes.iter().enumerate() {
            let of = |value: Value| lines[value.index()];
            let line = || {
                Some(match node.operation {
                    _ if !node.per_echo => Self::fixed(low[index]),
                    Operation::Input(_) => Self::of_line(0, 1),
                    Operation::Add(a, b) => of(a)?.add(of(b)?)?,
                    Operation::Subtract(a, b) => of(a)?.plus(of(b)?.constant()?.checked_neg()?)?,
                    Operation::Multiply(a, b) => of(a)?.times(of(b)?)?,
                    Operation::ShiftRight(a, bits) => of(a)?.cut(bits)?,
                    _ => return None,
                })
            };
            let rising = line().filter(|line| line.slope >= 0);
            // What rises and is the same at both ends is the same between them.
            let same = low[index] == high[index];
            let found = rising.map(|line| if same { Self::fixed(low[index]) } else { line });
            // The lines must say what the twin says, or they are not the program's.
            let agrees = found.is_none_or(|line| {
                line.at(first) == Some(low[index]) && line.at(last) == Some(high[index])
            });
            lines.push(found.filter(|_| agrees));
            if node.per_echo && lines[index].is_none() {
                return Ok(None);
            }
        }
        Ok(lines[program.result.index()].filter(|line| line.at(last).is_some()))
    }

    fn at(self, echo: i64) -> Option<i64> {
        let line = self.slope.checked_mul(echo)?.checked_add(self.start)?;
        (line >> self.bits).checked_add(self.after)
    }

    /// The output at an echo code between the two that were checked.
    pub(crate) fn output(self, echo: i64) -> i32 {
        ((self.start_at(echo) >> self.bits) + self.after) as i32
    }

    /// The line at an echo code, before anything is cut off.
    pub(super) fn start_at(self, echo: i64) -> i64 {
        self.slope * echo + self.start
    }

    /// The same \[unit\].
    pub(super) fn line_at(self, echo: i64) -> f64 {
        self.start_at(echo) as f64 / self.unit() + self.after as f64
    }

    /// Growth of the line per echo code \[unit\].
    pub(super) fn growth(self) -> f64 {
        self.slope as f64 / self.unit()
    }

    /// The most that is cut off \[unit\].
    pub(super) fn cut_off(self) -> f64 {
        1.0 - self.unit().recip()
    }

    fn unit(self) -> f64 {
        f64::from(self.bits).exp2()
    }

    /// The hash of the outputs at all `codes`.
    pub(super) fn hash(self, codes: Range) -> Hash {
        let count = codes.maximum - codes.minimum + 1;
        let (start, slope) = (self.start_at(codes.minimum), self.slope as u64);
        Hash::of_line(start, slope, self.bits, self.after, count as u64)
    }
}

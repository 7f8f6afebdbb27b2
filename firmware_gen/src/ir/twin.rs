//! The bit-exact twin: a program evaluated on one input, every claim checked on the way.

use super::program::{Node, Operation, Program, Value};
use crate::types::{IntegerType, Range};

/// A violated claim: a value does not fit the type that the program claims for it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("step {node} does not fit {ty}: {what}", ty = .ty.c_name())]
pub struct Overflow {
    /// Index of the node.
    pub node: usize,
    /// The type that should have held it.
    pub ty: IntegerType,
    /// What does not fit.
    pub what: String,
}

impl Node {
    /// The values that the node claims to take: in its range, in the type it is computed in, in the type it is kept in.
    #[must_use]
    pub fn claim(&self) -> Range {
        let (held, computed) = (self.held.range(), self.computed.range());
        Range {
            minimum: self.range.minimum.max(held.minimum).max(computed.minimum),
            maximum: self.range.maximum.min(held.maximum).min(computed.maximum),
        }
    }
}

impl Program {
    /// The output for one input, exactly as the C text computes it.
    ///
    /// # Errors
    /// If any intermediate does not fit the type it is computed or held in.
    pub fn evaluate(&self, inputs: &[i64]) -> Result<i64, Overflow> {
        Ok(self.trace(inputs)?[self.result.0])
    }

    /// The value of every step for one input.
    ///
    /// # Errors
    /// If any of them does not fit the type it is computed or held in.
    pub fn trace(&self, inputs: &[i64]) -> Result<Vec<i64>, Overflow> {
        let mut values = Vec::with_capacity(self.nodes.len());
        for index in 0..self.nodes.len() {
            values.push(self.step(index, &values, inputs)?);
        }
        Ok(values)
    }

    /// The value of node `index`, given those before it.
    pub(super) fn step(
        &self,
        index: usize,
        values: &[i64],
        inputs: &[i64],
    ) -> Result<i64, Overflow> {
        let node = &self.nodes[index];
        let exact = self.exact(node.operation, |value| i128::from(values[value.0]), inputs);
        let fits = |exact: i128| {
            i64::try_from(exact)
                .ok()
                .filter(|value| node.claim().contains(*value))
        };
        exact.and_then(fits).ok_or_else(|| Overflow {
            node: index,
            ty: node.held,
            what: format!("{exact:?}"),
        })
    }

    /// The exact result of `operation`; `None` where it has none (index outside the table, shift of a negative number).
    fn exact(
        &self,
        operation: Operation,
        operand: impl Fn(Value) -> i128,
        inputs: &[i64],
    ) -> Option<i128> {
        let natural = |value| Some(operand(value)).filter(|value| *value >= 0);
        Some(match operation {
            Operation::Input(index) => i128::from(inputs[index]),
            Operation::Constant(constant) => i128::from(constant),
            Operation::Add(a, b) => operand(a) + operand(b),
            Operation::Subtract(a, b) => operand(a) - operand(b),
            Operation::Multiply(a, b) => operand(a) * operand(b),
            Operation::ShiftRight(a, bits) => natural(a)? >> bits,
            Operation::LowBits(a, bits) => natural(a)? & ((1 << bits) - 1),
            Operation::Load(table, index) => {
                let index = usize::try_from(operand(index)).ok()?;
                i128::from(*self.tables[table.0].entries.get(index)?)
            }
        })
    }

    /// Check what holds for the text rather than for an input: operands come before their readers and, as claimed, fit
    /// the type of the operation that reads them; entries fit their table; shifts stay inside their type.
    ///
    /// # Errors
    /// At the first claim that does not follow.
    pub fn check_claims(&self) -> Result<(), Overflow> {
        for (index, node) in self.nodes.iter().enumerate() {
            let wrong = |what: String| {
                Err(Overflow {
                    node: index,
                    ty: node.computed,
                    what,
                })
            };
            for operand in node.operation.operands() {
                let claim = self.nodes[operand.0].claim();
                let converted = !matches!(node.operation, Operation::Load(..));
                if operand.0 >= index || converted && !node.computed.range().covers(claim) {
                    return wrong(format!("operand {claim:?}"));
                }
            }
            match node.operation {
                Operation::ShiftRight(_, bits) | Operation::LowBits(_, bits)
                    if bits >= node.computed.bits() || node.computed.is_signed() =>
                {
                    return wrong(format!("shift by {bits}"));
                }
                Operation::Load(table, _) => {
                    let table = &self.tables[table.0];
                    if let Some(entry) = table
                        .entries
                        .iter()
                        .find(|entry| !table.ty.range().contains(**entry))
                    {
                        return wrong(format!("table entry {entry}"));
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }
}

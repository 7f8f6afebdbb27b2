//! The twin for many echo times at once: the same steps over lanes, every claim still checked on every lane.

use super::program::{Operation, Program, Value};
use super::twin::Overflow;

/// Echo times evaluated together. Set by hand: the lanes of a typical program fit the second-level cache.
pub const LANES: usize = 512;

type Lanes = [i64; LANES];

/// Largest magnitude in a lane: sums and differences of two such values fit `i64`.
const REACH: i64 = 1 << 61;

/// Working memory for one thread.
pub struct Block<'a> {
    program: &'a Program,
    values: Vec<i64>,
    lanes: Vec<Lanes>,
}

impl<'a> Block<'a> {
    /// Working memory for `program`, whose static claims are checked here.
    ///
    /// # Errors
    /// If a claim does not follow, or a value could leave the twin's own arithmetic.
    pub fn new(program: &'a Program) -> Result<Self, Overflow> {
        program.check_claims()?;
        for (index, node) in program
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, node)| node.per_echo)
        {
            let bounds = node.operation.operands().map(|value| {
                let claim = program.node(value).claim();
                i128::from(claim.minimum)
                    .abs()
                    .max(i128::from(claim.maximum).abs())
            });
            let product = matches!(node.operation, Operation::Multiply(..));
            let reach: i128 = if product {
                bounds.product()
            } else {
                bounds.sum()
            };
            let claim = node.claim();
            if reach > i128::from(REACH) || claim.minimum < -REACH || claim.maximum > REACH {
                return Err(Overflow {
                    node: index,
                    ty: node.computed,
                    what: format!("magnitudes up to {reach}"),
                });
            }
        }
        let lanes = vec![[0; LANES]; program.nodes.len()];
        Ok(Self {
            program,
            values: vec![0; program.nodes.len()],
            lanes,
        })
    }

    /// Take up new conditions: evaluate the steps that do not depend on the echo time.
    ///
    /// # Errors
    /// If one of them leaves its claim.
    pub fn set_conditions(&mut self, conditions: &[i64]) -> Result<(), Overflow> {
        let inputs: Vec<i64> = std::iter::once(0)
            .chain(conditions.iter().copied())
            .collect();
        let steps = self.program.nodes.iter().enumerate();
        for (index, _) in steps.filter(|(_, node)| !node.per_echo) {
            self.values[index] = self.program.step(index, &self.values, &inputs)?;
            self.lanes[index] = [self.values[index]; LANES];
        }
        Ok(())
    }

    /// Outputs for the echo codes `first .. first + LANES`. Lanes past `last` repeat `last`.
    ///
    /// # Errors
    /// If any step of any lane leaves its claim.
    pub fn evaluate(&mut self, first: i64, last: i64) -> Result<&Lanes, Overflow> {
        for (index, node) in self
            .program
            .nodes
            .iter()
            .enumerate()
            .filter(|(_, node)| node.per_echo)
        {
            let (before, from_here) = self.lanes.split_at_mut(index);
            let target = &mut from_here[0];
            let fault = |what: String| Overflow {
                node: index,
                ty: node.held,
                what,
            };
            if !step(node.operation, target, before, first, last) {
                return Err(fault("a table indexed by the echo time".into()));
            }
            let claim = node.claim();
            // The sign bit of either difference tells of a lane outside; `REACH` keeps the differences from wrapping.
            let outside = target.iter().fold(0, |seen, value| {
                seen | value.wrapping_sub(claim.minimum) | claim.maximum.wrapping_sub(*value)
            });
            if outside < 0 {
                return Err(fault(format!("an echo code in {first} .. {last}")));
            }
        }
        Ok(&self.lanes[self.program.result.0])
    }
}

/// One operation over all lanes; `false` if lanes cannot do it.
fn step(operation: Operation, target: &mut Lanes, before: &[Lanes], first: i64, last: i64) -> bool {
    let lanes = |value: Value| &before[value.0];
    match operation {
        Operation::Input(_) => {
            let codes = (first..).map(|code| code.min(last));
            target
                .iter_mut()
                .zip(codes)
                .for_each(|(value, code)| *value = code);
        }
        Operation::Add(a, b) => zip(target, lanes(a), lanes(b), i64::wrapping_add),
        Operation::Subtract(a, b) => zip(target, lanes(a), lanes(b), i64::wrapping_sub),
        Operation::Multiply(a, b) => zip(target, lanes(a), lanes(b), i64::wrapping_mul),
        Operation::ShiftRight(a, bits) => zip(target, lanes(a), lanes(a), |a, _| a >> bits),
        Operation::LowBits(a, bits) => {
            zip(target, lanes(a), lanes(a), |a, _| a & ((1 << bits) - 1))
        }
        Operation::Constant(_) | Operation::Load(..) => return false,
    }
    true
}

fn zip(target: &mut Lanes, a: &Lanes, b: &Lanes, operation: impl Fn(i64, i64) -> i64) {
    for lane in 0..LANES {
        target[lane] = operation(a[lane], b[lane]);
    }
}

//! What one step costs on each family, for ranking candidates: counted in the compilers' output, then held against
//! measurements of whole functions (`tests/firmware/silicon`). No report shows these figures.

use super::Cost;
use crate::ir::{Node, Operation, Program, Value};

/// The constant that a value is, if it is one.
fn constant(program: &Program, value: Value) -> Option<i64> {
    match program.node(value).operation {
        Operation::Constant(constant) => Some(constant),
        _ => None,
    }
}

/// The power of two that one factor is.
fn doublings(program: &Program, a: Value, b: Value) -> Option<u32> {
    let factor = constant(program, b).or_else(|| constant(program, a))?;
    (factor.count_ones() == 1).then(|| factor.trailing_zeros())
}

/// A 32-bit core with a multiplier and a barrel shifter; wider operations are made of several.
pub(super) fn word(_program: &Program, node: &Node) -> Cost {
    let (size, time) = match node.operation {
        Operation::Input(_) => (0, 0),
        Operation::Constant(constant) if constant.unsigned_abs() < 256 => (0, 0),
        Operation::Constant(_) => (4, 1),
        Operation::Add(..) | Operation::Subtract(..) | Operation::ShiftRight(..) => (2, 1),
        Operation::LowBits(..) => (4, 1),
        Operation::Multiply(..) => (2, 2),
        Operation::Load(..) => (6, 3),
    };
    let words = if node.computed.bits() > 32 { 3 } else { 1 };
    Cost {
        size: size * words,
        time: time * words,
    }
}

/// Any core: wide factors cost more where words are narrow, and nothing is gained by them where they are not.
pub(super) fn portable(program: &Program, node: &Node) -> Cost {
    let cost = word(program, node);
    let wide = match node.operation {
        Operation::Multiply(a, b) => [a, b].iter().any(|value| {
            !narrow(program, *value) && constant(program, *value).is_none_or(|c| c > 255)
        }),
        _ => false,
    };
    Cost {
        size: cost.size * if wide { 4 } else { 1 },
        time: cost.time * if wide { 4 } else { 1 },
    }
}

/// A 32-bit RISC-V: constants beyond 12 bits take two instructions.
pub(super) fn riscv(program: &Program, node: &Node) -> Cost {
    match node.operation {
        Operation::Constant(constant) => {
            let (size, time) = match constant.unsigned_abs() {
                0..32 => (0, 0),
                32..2048 => (4, 1),
                2048..131_072 => (6, 2),
                _ => (8, 2),
            };
            Cost { size, time }
        }
        // Of a small constant, gcc makes shifts and sums.
        Operation::Multiply(a, b) if node.computed.bits() <= 32 => {
            let small = [a, b]
                .iter()
                .any(|value| constant(program, *value).is_some_and(|c| c.abs() < 2048));
            let (size, time) = if small { (8, 4) } else { (4, 1) };
            Cost { size, time }
        }
        _ => word(program, node),
    }
}

/// Whether a value is a natural number of 16 bits.
fn narrow(program: &Program, value: Value) -> bool {
    let range = program.node(value).range;
    range.minimum >= 0 && range.maximum < 1 << 16
}

/// An 8-bit AVR with a multiplier: shifts go bit by bit, whole bytes are moved.
pub(super) fn avr(program: &Program, node: &Node) -> Cost {
    let bytes = u64::from(node.computed.bits() / 8);
    let held = u64::from(node.held.bits() / 8);
    let (size, time) = match node.operation {
        Operation::Input(_) | Operation::Constant(_) => (0, 0),
        Operation::Add(..) | Operation::Subtract(..) => (2 * bytes, bytes),
        Operation::Multiply(a, b) => match (doublings(program, a, b), bytes) {
            (Some(count), _) => (2 * held * u64::from(count), held * u64::from(count)),
            (None, 1) => (4, 4),
            (None, 2) => (12, 10),
            (None, 4) => product(program, a, b),
            (None, _) => (90, 500),
        },
        // Half a product is where it is already; a quarter off its end moves the rest, unused bytes too.
        Operation::ShiftRight(_, bits) if bits % 16 == 0 || held == 1 && bits % 8 == 0 => (0, 0),
        Operation::ShiftRight(_, 8) if bytes == 4 && held == 2 => (4, 2), // the middle bytes, named
        Operation::ShiftRight(_, bits) if bits % 8 == 0 => (2 * bytes, bytes),
        Operation::ShiftRight(_, bits) => (2 * bytes + 6, u64::from(bits) * (bytes + 3)),
        Operation::LowBits(_, bits) if bits % 8 == 0 => (0, 0),
        Operation::LowBits(..) => (2 * held, held),
        Operation::Load(table, _) => {
            let entry = u64::from(program.tables[table.index()].ty.bits() / 8);
            (2 * entry + 8, 3 * entry + 4)
        }
    };
    Cost { size, time }
}

/// Products of 32 bits on an AVR: of two 16-bit numbers, or of wider ones.
fn product(program: &Program, a: Value, b: Value) -> (u64, u64) {
    let narrow = |value| narrow(program, value);
    let signed = |value: Value| {
        let range = program.node(value).range;
        range.minimum >= -(1 << 15) && range.maximum < 1 << 15
    };
    if narrow(a) && narrow(b) {
        (10, 28)
    } else if (narrow(a) || signed(a)) && (narrow(b) || signed(b)) {
        (22, 40)
    } else {
        (60, 110)
    }
}

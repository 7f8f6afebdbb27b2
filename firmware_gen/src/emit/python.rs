//! A program as Python text, for MicroPython and CircuitPython: integers are exact there, so no type is named.

use super::text::Local;
use crate::ir::{Operation, Program, Value};

/// The statements of a program: its locals, and what it returns.
#[must_use]
pub fn statements(program: &Program) -> (Vec<Local>, String) {
    let named = program
        .nodes
        .iter()
        .enumerate()
        .filter_map(|(index, node)| {
            let (name, note) = node.name.as_ref()?;
            Some(Local {
                ty: "",
                name: name.clone(),
                expression: expression(program, Value(index)),
                note: note.clone(),
            })
        });
    (named.collect(), read(program, program.result))
}

/// The value of a node as an operand.
fn read(program: &Program, value: Value) -> String {
    let node = program.node(value);
    match (&node.name, node.operation) {
        (Some((name, _)), _) => name.clone(),
        (None, Operation::Constant(_) | Operation::Input(_) | Operation::Load(..)) => {
            expression(program, value)
        }
        (None, _) => format!("({})", expression(program, value)),
    }
}

fn expression(program: &Program, value: Value) -> String {
    let operand = |value| read(program, value);
    match program.node(value).operation {
        Operation::Input(index) => program.inputs[index].0.clone(),
        Operation::Constant(constant) => constant.to_string(),
        Operation::Add(a, b) => format!("{} + {}", operand(a), operand(b)),
        Operation::Subtract(a, b) => format!("{} - {}", operand(a), operand(b)),
        Operation::Multiply(a, b) => format!("{} * {}", operand(a), operand(b)),
        Operation::ShiftRight(a, bits) => format!("{} >> {bits}", operand(a)),
        Operation::LowBits(a, bits) => format!("{} & {}", operand(a), (1_u64 << bits) - 1),
        Operation::Load(table, index) => {
            format!(
                "_{}[{}]",
                program.tables[table.index()].name,
                operand(index)
            )
        }
    }
}

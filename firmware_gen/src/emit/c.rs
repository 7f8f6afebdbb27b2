//! A program as C text. Every conversion is written out, so that the text means the same on any width of `int`.

use super::Local;
use crate::ir::{IntegerType, Node, Operation, Program, Value};
/// The statements of a program: its locals, and what it returns.
#[must_use]
pub fn statements(program: &Program) -> (Vec<Local<'_>>, String) {
    let named = program
        .nodes
        .iter()
        .enumerate()
        .filter_map(|(index, node)| {
            let (name, note) = node.name.as_ref()?;
            let value = Value(index);
            Some(Local {
                ty: node.held.c_name(),
                name,
                expression: kept(program, value),
                note: note.clone(),
            })
        });
    (
        named.collect(),
        read(program, program.result, IntegerType::I32),
    )
}

/// The value of a node, converted to the type that it is kept in.
fn kept(program: &Program, value: Value) -> String {
    let node = program.node(value);
    match node.operation {
        // A variable that is only another name for a constant or a code.
        Operation::Constant(constant) => literal(constant, node.held),
        _ if node.computed == node.held => expression(program, value),
        // What is known to end up natural is computed modulo its type from the start: compilers then know it for natural.
        Operation::Add(a, b) if modular(node) => modulo(program, node, a, "+", b),
        Operation::Subtract(a, b) if modular(node) => modulo(program, node, a, "-", b),
        _ => format!("({})({})", node.held.c_name(), expression(program, value)),
    }
}

fn modular(node: &Node) -> bool {
    node.computed.is_signed() && !node.held.is_signed()
}

fn modulo(program: &Program, node: &Node, a: Value, sign: &str, b: Value) -> String {
    let operand = |value| read(program, value, node.held);
    format!(
        "({})({} {sign} {})",
        node.held.c_name(),
        operand(a),
        operand(b)
    )
}

/// The value of a node as an operand of type `wanted`.
fn read(program: &Program, value: Value, wanted: IntegerType) -> String {
    let node = program.node(value);
    let (text, given) = match (&node.name, node.operation) {
        (Some((name, _)), _) => (name.clone(), node.held),
        (None, Operation::Constant(constant)) => return literal(constant, wanted),
        (None, Operation::Input(index)) => {
            (program.inputs[index].0.clone(), program.inputs[index].1)
        }
        (None, Operation::Load(table, _)) => {
            (expression(program, value), program.tables[table.0].ty)
        }
        (None, _) => (format!("({})", expression(program, value)), node.computed),
    };
    if given == wanted {
        text
    } else {
        format!("({}){text}", wanted.c_name())
    }
}

/// The operation of a node, in the type that it is computed in.
fn expression(program: &Program, value: Value) -> String {
    let node = program.node(value);
    let operand = |value| read(program, value, node.computed);
    let text = match node.operation {
        Operation::Input(index) => return program.inputs[index].0.clone(),
        Operation::Constant(constant) => return literal(constant, node.computed),
        Operation::Load(table, index) => {
            let given = index_type(program.node(index));
            let table = &program.tables[table.0];
            let entry = format!("{}[{}]", table.name, read(program, index, given));
            return match (table.program_memory, table.ty.bits()) {
                (false, _) => entry,
                (true, 8) => from_program_memory("byte", &entry, table.ty),
                (true, 16) => from_program_memory("word", &entry, table.ty),
                (true, _) => from_program_memory("dword", &entry, table.ty),
            };
        }
        Operation::Add(a, b) => format!("{} + {}", operand(a), operand(b)),
        Operation::Subtract(a, b) => format!("{} - {}", operand(a), operand(b)),
        Operation::Multiply(a, b) => format!("{} * {}", operand(a), operand(b)),
        Operation::ShiftRight(a, bits) => format!("{} >> {bits}", operand(a)),
        Operation::LowBits(a, bits) => format!("{} & {}U", operand(a), (1_u64 << bits) - 1),
    };
    // Below 32 bits C computes in `int`: the value is the same, its type is not.
    if node.computed.bits() < 32 {
        format!("({})({text})", node.computed.c_name())
    } else {
        text
    }
}

/// An entry read with what `avr/pgmspace.h` has for its width, which is unsigned.
fn from_program_memory(width: &str, entry: &str, ty: IntegerType) -> String {
    let read = format!("pgm_read_{width}(&{entry})");
    if ty.is_signed() {
        format!("(({}){read})", ty.c_name())
    } else {
        read
    }
}

fn index_type(node: &Node) -> IntegerType {
    if node.name.is_some() {
        node.held
    } else {
        node.computed
    }
}

/// A constant; C gives it the first type that holds it.
fn literal(constant: i64, ty: IntegerType) -> String {
    if ty.is_signed() {
        constant.to_string()
    } else {
        format!("{constant}U")
    }
}

//! A program as Rust text. Each step has the types that the program claims, so a conversion changes no value.

use super::text::{Local, named};
use crate::ir::{IntegerType, Operation, Program, Table, Value};
use serde::Serialize;

/// A table as the template sees it.
#[derive(Serialize)]
pub struct TableText<'a> {
    name: String,
    ty: &'static str,
    note: &'a str,
    entries: &'a [i64],
}

/// The tables, whose names begin with `own`.
#[must_use]
pub fn tables<'a>(program: &'a Program, own: &str) -> Vec<TableText<'a>> {
    let text = |table| TableText {
        name: named(&constant_name(table), own),
        ty: name(table.ty),
        note: &table.note,
        entries: &table.entries,
    };
    program.tables.iter().map(text).collect()
}

/// The statements of a program: its locals, and what it returns.
#[must_use]
pub fn statements(program: &Program) -> (Vec<Local>, String) {
    let local = |(index, node): (usize, &crate::ir::Node)| {
        let (local, note) = node.name.clone()?;
        Some(Local {
            ty: name(node.held),
            name: local,
            expression: expression(program, Value(index)),
            note,
        })
    };
    let locals = program.nodes.iter().enumerate().filter_map(local).collect();
    (locals, read(program, program.result, program.output))
}

/// Name of a type in Rust.
pub(super) const fn name(ty: IntegerType) -> &'static str {
    match ty {
        IntegerType::U8 => "u8",
        IntegerType::I8 => "i8",
        IntegerType::U16 => "u16",
        IntegerType::I16 => "i16",
        IntegerType::U32 => "u32",
        IntegerType::I32 => "i32",
        IntegerType::U64 => "u64",
        IntegerType::I64 => "i64",
    }
}

fn constant_name(table: &Table) -> String {
    table.name.to_uppercase()
}

/// The value of a node as an operand of this type.
fn read(program: &Program, value: Value, wanted: IntegerType) -> String {
    let node = program.node(value);
    if let Operation::Constant(constant) = node.operation {
        return format!("{constant}_{}", name(wanted));
    }
    let text = match &node.name {
        Some((name, _)) => name.clone(),
        None => format!("({})", expression(program, value)),
    };
    if node.held == wanted {
        text
    } else {
        format!("({text} as {})", name(wanted))
    }
}

/// The value of a node in the type that it is held in.
fn expression(program: &Program, value: Value) -> String {
    let node = program.node(value);
    let ty = node.computed;
    let operand = |value| read(program, value, ty);
    let (text, ty) = match node.operation {
        Operation::Input(index) => {
            let (name, ty) = &program.inputs[index];
            (name.clone(), *ty)
        }
        Operation::Constant(constant) => return format!("{constant}_{}", name(node.held)),
        Operation::Add(a, b) => (format!("{} + {}", operand(a), operand(b)), ty),
        Operation::Subtract(a, b) => (format!("{} - {}", operand(a), operand(b)), ty),
        Operation::Multiply(a, b) => (format!("{} * {}", operand(a), operand(b)), ty),
        Operation::ShiftRight(a, bits) => (format!("{} >> {bits}", operand(a)), ty),
        Operation::LowBits(a, bits) => (format!("{} & {}", operand(a), (1_u64 << bits) - 1), ty),
        Operation::Load(table, at) => {
            let table = &program.tables[table.index()];
            let held = program.node(at).held;
            let text = format!(
                "{}[{} as usize]",
                constant_name(table),
                read(program, at, held)
            );
            (text, table.ty)
        }
    };
    if ty == node.held {
        text
    } else {
        format!("({text}) as {}", name(node.held))
    }
}

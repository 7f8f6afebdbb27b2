//! Parts of the texts that several languages share: local variables and tables.

use crate::ir::{IntegerType, Table};
use serde::Serialize;

/// A local variable of the generated function.
#[derive(Debug, Serialize)]
pub struct Local {
    /// Its type in C.
    #[serde(rename = "type")]
    pub ty: &'static str,
    /// Its name.
    pub name: String,
    /// Its value.
    pub expression: String,
    /// What it is, with its unit.
    pub note: String,
}

/// A table as the templates see it.
#[derive(Serialize)]
pub(super) struct TableText<'a> {
    ty: &'static str,
    name: String,
    note: &'a str,
    rows: Vec<String>,
    entries: &'a [i64],
    place: &'static str,
}

/// Entries in one line of a table. Set by hand: 12 entries of 16 bits take 90 characters.
const PER_LINE: usize = 12;

pub(super) fn table_text<'a>(table: &'a Table, name: &str) -> TableText<'a> {
    TableText {
        ty: table.ty.c_name(),
        name: named(&table.name, name),
        note: &table.note,
        rows: literal_list(&table.entries, table.ty),
        entries: &table.entries,
        place: if table.program_memory { " PROGMEM" } else { "" },
    }
}

/// Constants of one type, in lines.
pub(super) fn literal_list(entries: &[i64], ty: IntegerType) -> Vec<String> {
    let suffix = match (ty.is_signed(), ty.bits()) {
        (true, _) => "",
        (false, 32) => "UL",
        (false, _) => "U",
    };
    let literal = |entry: &i64| match (*entry, ty) {
        // Written out, this constant would have no type that holds it.
        (-2_147_483_648, IntegerType::I32) => "INT32_MIN".to_owned(),
        (entry, _) => format!("{entry}{suffix}"),
    };
    let line = |entries: &[i64]| entries.iter().map(literal).collect::<Vec<_>>().join(", ");
    entries.chunks(PER_LINE).map(line).collect()
}

/// Statements, whose identifiers begin with `name`.
pub(super) fn renamed(
    (mut locals, result): (Vec<Local>, String),
    name: &str,
) -> (Vec<Local>, String) {
    for local in &mut locals {
        local.expression = named(&local.expression, name);
    }
    (locals, named(&result, name))
}

/// A text of this crate, whose identifiers begin with `name` where they began with `echocal`.
pub(super) fn named(text: &str, name: &str) -> String {
    let title: String = name.split('_').map(capitalized).collect();
    text.replace("echocal_", &format!("{name}_"))
        .replace("ECHOCAL_", &format!("{}_", name.to_uppercase()))
        .replace("EchocalCorrection", &format!("{title}Correction"))
}

fn capitalized(word: &str) -> String {
    let (first, rest) = word.split_at(1.min(word.len()));
    first.to_uppercase() + rest
}

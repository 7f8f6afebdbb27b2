//! Texts: the header, the source, the golden vectors, the report. Identical input gives identical bytes.

mod c;
mod golden;
mod report;

pub use report::Provenance;

use crate::design::Design;
use crate::device::{Axis, Device};
use crate::error::Error;
use crate::ir::{Range, Table};
use crate::prove::Worst;
use crate::reference::place;
use minijinja::{Environment, UndefinedBehavior, context};
use serde::Serialize;

/// What the firmware consists of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Artifacts {
    /// `echocal_correction.h`.
    pub header: String,
    /// `echocal_correction.c`.
    pub source: String,
    /// `echocal_golden.csv`: inputs and bit-exact outputs.
    pub golden: String,
    /// `report.json`.
    pub report: String,
}

/// A table as the templates see it.
#[derive(Serialize)]
struct TableText<'a> {
    ty: &'static str,
    name: &'a str,
    note: &'a str,
    rows: Vec<String>,
    place: &'static str,
}

/// Entries in one line of a table.
const PER_LINE: usize = 12;

fn table_text(table: &Table) -> TableText<'_> {
    let suffix = match (table.ty.is_signed(), table.ty.bits()) {
        (true, _) => "",
        (false, 32) => "UL",
        (false, _) => "U",
    };
    let line = |entries: &[i64]| {
        let entries: Vec<String> = entries
            .iter()
            .map(|entry| format!("{entry}{suffix}"))
            .collect();
        entries.join(", ")
    };
    TableText {
        ty: table.ty.c_name(),
        name: &table.name,
        note: &table.note,
        rows: table.entries.chunks(PER_LINE).map(line).collect(),
        place: if table.program_memory { " PROGMEM" } else { "" },
    }
}

/// The condition under which a code is out of range, leaving out what its type excludes anyway.
fn outside(axis: &Axis) -> Vec<String> {
    let Range { minimum, maximum } = axis.codes;
    let suffix = if axis.ty.is_signed() { "" } else { "U" };
    let mut tests = Vec::new();
    if minimum > axis.ty.range().minimum {
        tests.push(format!("({} < {minimum}{suffix})", axis.name));
    }
    if maximum < axis.ty.range().maximum {
        tests.push(format!("({} > {maximum}{suffix})", axis.name));
    }
    tests
}

/// A parameter as the templates see it.
#[derive(Serialize)]
struct ParameterText<'a> {
    ty: &'static str,
    name: &'a str,
    meaning: String,
    first: i64,
    last: i64,
}

fn parameter(axis: &Axis) -> ParameterText<'_> {
    let zero = if axis.zero == 0.0 {
        String::new()
    } else {
        format!(" + {} {}", axis.zero, axis.unit)
    };
    let meaning = format!(
        "{} = {} * {} {}{zero}",
        axis.quantity, axis.name, axis.lsb, axis.unit
    );
    ParameterText {
        ty: axis.ty.c_name(),
        name: &axis.name,
        meaning,
        first: axis.codes.minimum,
        last: axis.codes.maximum,
    }
}

/// Write every text of a proven design.
///
/// # Errors
/// [`Error::Template`] if a template fails, a defect of this crate.
pub fn emit(design: &Design, device: &Device, provenance: &Provenance) -> Result<Artifacts, Error> {
    let context = context! {
        provenance,
        function => function_text(design, device),
        proof => proof_text(design, device, provenance.maximum_error),
    };
    Ok(Artifacts {
        header: render(
            "header.h.j2",
            include_str!("../../templates/header.h.j2"),
            &context,
        )?,
        source: render(
            "source.c.j2",
            include_str!("../../templates/source.c.j2"),
            &context,
        )?,
        golden: golden::golden(design, device),
        report: report::report(design, device, provenance),
    })
}

/// The function: parameters, range checks, tables, statements.
fn function_text(design: &Design, device: &Device) -> minijinja::Value {
    let (locals, result) = c::statements(&design.program);
    let read = |axis: &&Axis| design.program.reads(&axis.name) || !outside(axis).is_empty();
    let unused = device
        .axes()
        .filter(|axis| !read(axis))
        .map(|axis| axis.name.as_str());
    context! {
        parameters => device.axes().map(parameter).collect::<Vec<_>>(),
        outside => device.axes().flat_map(outside).collect::<Vec<_>>(),
        unused => unused.collect::<Vec<_>>(),
        locals, result,
        tables => design.program.tables.iter().map(table_text).collect::<Vec<_>>(),
        table_bytes => design.program.table_bytes(),
        program_memory => design.program.tables.iter().any(|table| table.program_memory),
        form => design.form.describe(),
    }
}

/// What is proven, as the header states it.
fn proof_text(design: &Design, device: &Device, asked: f64) -> minijinja::Value {
    let proof = &design.proof;
    let input = |worst: Worst| place(device, worst.row, worst.echo);
    context! {
        asked_mm => (asked * 1e12).round() / 1e9,
        proven_mm => millimeters(proof.bounded.error),
        worst => input(proof.bounded),
        overall_mm => millimeters(proof.overall.error),
        overall_worst => input(proof.overall),
        inputs => grouped(proof.inputs),
        bounded_inputs => grouped(proof.bounded_inputs),
        hash => format!("{:08x}", proof.hash),
    }
}

/// An error in mm to four places, rounded up: what is stated must hold.
fn millimeters(micrometers: f64) -> String {
    format!("{:.4}", (micrometers * 10.0).ceil() / 1e4)
}

/// A count with commas between thousands.
fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let comma = |(index, digit): (usize, char)| {
        let comma = index > 0 && (digits.len() - index).is_multiple_of(3);
        comma.then_some(',').into_iter().chain([digit])
    };
    digits.chars().enumerate().flat_map(comma).collect()
}

/// Text from outside, made safe inside a C comment: a file may be called `*/`.
fn comment(text: String) -> String {
    let visible = |letter: char| if letter.is_control() { ' ' } else { letter };
    let text: String = text.chars().map(visible).collect();
    text.replace("*/", "* /")
        .replace("/*", "/ *")
        .replace("??/", "?? /")
}

fn render(name: &str, template: &str, context: &minijinja::Value) -> Result<String, Error> {
    let mut environment = Environment::new();
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    environment.set_keep_trailing_newline(true);
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment.add_filter("comment", comment);
    environment
        .render_named_str(name, template, context)
        .map_err(|error| Error::Template(format!("{error:#}")))
}

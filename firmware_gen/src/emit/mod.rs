//! Texts: the header, the source, the golden vectors, the report. Identical input gives identical bytes.

mod c;
mod golden;
mod report;

pub use report::Provenance;

use crate::design::Design;
use crate::device::{Axis, Device};
use crate::error::Error;
use crate::ir::{Range, Table};
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
    name: &'static str,
    note: &'a str,
    rows: Vec<String>,
}

/// Entries in one line of a table.
const PER_LINE: usize = 12;

fn table_text(table: &Table) -> TableText<'_> {
    let suffix = if table.ty.is_signed() { "" } else { "U" };
    let line = |entries: &[i64]| {
        let entries: Vec<String> = entries
            .iter()
            .map(|entry| format!("{entry}{suffix}"))
            .collect();
        entries.join(", ")
    };
    TableText {
        ty: table.ty.c_name(),
        name: table.name,
        note: &table.note,
        rows: table.entries.chunks(PER_LINE).map(line).collect(),
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
    let axes: Vec<&Axis> = device.axes().collect();
    let (locals, result) = c::statements(&design.program);
    let read = |axis: &&&Axis| design.program.reads(&axis.name) || !outside(axis).is_empty();
    let unused: Vec<&str> = axes
        .iter()
        .filter(|axis| !read(axis))
        .map(|axis| axis.name.as_str())
        .collect();
    let worst = design.proof.bounded;
    let far = design.proof.overall;
    let context = context! {
        parameters => axes.iter().map(|axis| parameter(axis)).collect::<Vec<_>>(),
        outside => axes.iter().flat_map(|axis| outside(axis)).collect::<Vec<_>>(),
        unused, locals, result, provenance,
        tables => design.program.tables.iter().map(table_text).collect::<Vec<_>>(),
        table_bytes => design.program.table_bytes(),
        form => design.form.describe(),
        asked_mm => (provenance.maximum_error * 1e12).round() / 1e9,
        proven_mm => millimeters(worst.error),
        worst => place(device, worst.row, worst.echo),
        overall_mm => millimeters(far.error),
        overall_worst => place(device, far.row, far.echo),
        inputs => grouped(design.proof.inputs),
        bounded_inputs => grouped(design.proof.bounded_inputs),
        hash => format!("{:08x}", design.proof.hash),
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

fn render(name: &str, template: &str, context: &minijinja::Value) -> Result<String, Error> {
    let mut environment = Environment::new();
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    environment.set_keep_trailing_newline(true);
    environment.set_undefined_behavior(UndefinedBehavior::Strict);
    environment
        .render_named_str(name, template, context)
        .map_err(|error| Error::Template(format!("{error:#}")))
}

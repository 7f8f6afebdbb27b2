//! Texts: the header, the source, the golden vectors, the report. Equal input gives equal bytes.

mod c;
mod filter;
mod golden;
mod package;
mod parts;
mod python;
mod reach;
mod report;
mod rust;
mod selftest;
mod status;
mod templates;
mod text;
mod unit;

pub use package::{PACKAGES, Package};
pub use report::{Measurement, Provenance, Uncertainty};

use crate::design::Design;
use crate::device::{Axis, Device};
use crate::error::Error;
use crate::ir::Range;
use crate::prove::Worst;
use crate::reference::place;
use minijinja::context;
use serde::Serialize;
use text::{named, renamed, table_text};

pub use text::Local;
pub use unit::{air_files, unit_files};

/// Longest time \[us\] from the trigger pulse to the echo pulse, of a round number. An HC-SR04 takes 0.5 ms, some copies
/// take 12.3 ms (esphome/esphome, pull request 12897); this is twice that. Time-outs of `pulseIn()`, and of ESPHome
/// before 2026.1, begin with the trigger.
const SILENCE: f64 = 25_000.0;

/// The condition under which a code is out of range, leaving out what its type excludes anyway.
fn outside(axis: &Axis) -> Vec<String> {
    let Range { minimum, maximum } = axis.codes;
    let suffix = if axis.ty.is_signed() { "" } else { "U" };
    let mut tests = Vec::new();
    if wraps(axis) {
        return vec![format!(
            "(({} - {minimum}U) > {}U)",
            axis.name,
            maximum - minimum
        )];
    }
    if minimum > axis.ty.range().minimum {
        tests.push(format!("({} < {minimum}{suffix})", axis.name));
    }
    if maximum < axis.ty.range().maximum {
        tests.push(format!("({} > {maximum}{suffix})", axis.name));
    }
    tests
}

/// Whether one comparison tells codes on both sides of the accepted ones: below the first, the difference of natural
/// numbers wraps to a large one, whatever the width of `int`. Compilers that compare twice, or join two comparisons
/// themselves, take more.
fn wraps(axis: &Axis) -> bool {
    let (codes, held) = (axis.codes, axis.ty.range());
    !axis.ty.is_signed() && codes.minimum > held.minimum && codes.maximum < held.maximum
}

/// A parameter as the templates see it.
#[derive(Serialize)]
struct ParameterText<'a> {
    ty: &'static str,
    name: &'a str,
    quantity: &'a str,
    lsb: f64,
    zero: f64,
    meaning: String,
    /// Whether it is neither echo, temperature nor humidity.
    further: bool,
    /// The code in the middle of those that are accepted, and what it stands for.
    middle: i64,
    middle_value: String,
    /// Bits that the function drops, and codes in a step.
    shift: u32,
    step: i64,
    /// Ends of its type.
    least: i64,
    most: i64,
    first: i64,
    last: i64,
}

fn parameter<'a>(axis: &'a Axis, device: &Device) -> ParameterText<'a> {
    let further = device.further().map(|place| &device.conditions[place]);
    let middle = axis.code(axis.len() / 2);
    let zero = if axis.zero == 0.0 {
        String::new()
    } else {
        format!(" + {}", axis.with_unit(axis.zero))
    };
    let meaning = match &axis.curve {
        Some(curve) => format!("{} of {}", axis.quantity, curve.scale),
        None => format!(
            "{} = {} * {}{zero}",
            axis.quantity,
            axis.name,
            axis.with_unit(axis.lsb)
        ),
    };
    ParameterText {
        ty: axis.ty.c_name(),
        name: &axis.name,
        quantity: &axis.quantity,
        lsb: axis.lsb,
        zero: axis.zero,
        meaning,
        further: further == Some(axis),
        middle,
        middle_value: axis.with_unit(axis.value(middle)),
        shift: axis.shift,
        step: 1 << axis.shift,
        least: axis.ty.range().minimum,
        most: axis.ty.range().maximum,
        first: axis.codes.minimum,
        last: axis.codes.maximum,
    }
}

/// Write every text of a proven design: path and text of each file.
///
/// # Errors
/// [`Error::Request`] if there is no such packaging; [`Error::Template`] if a template fails, a defect of this crate.
pub fn emit(
    design: &Design,
    device: &Device,
    provenance: &Provenance,
    measured: &[Measurement],
    uncertainty: &Uncertainty,
) -> Result<Vec<(String, String)>, Error> {
    let reach = reach::reach(&design.proof, device);
    let package = Package::parse(&provenance.package)?;
    let (vectors, count) = selftest::columns(design, device);
    let outputs = format!("{:016x}", design.proof.hash);
    let context = context! {
        library => library(provenance),
        library_version => format!("{}+{outputs}", provenance.version),
        provenance,
        measured,
        function => function_text(design, device, &provenance.name),
        name => provenance.name,
        statuses => status::statuses(device),
        time_out => device.time_out(),
        reach,
        bounded_to => provenance.maximum_distance.min((reach.sometimes.1 * 1e3).ceil() / 1e3),
        uncertainty => uncertainty_text(uncertainty, device),
        echo_timeout_us => echo_timeout(&device.echo),
        python => python_text(design, &provenance.name),
        rust => rust_text(design, device, &provenance.name),
        proof => proof_text(design, device, provenance.maximum_error),
        selftest => context! { columns => vectors, count },
    };
    let filter = provenance.filter.as_ref();
    let mut files = package.render(&context, &provenance.name, filter.is_some())?;
    files.extend(filter.map(|filter| filter::golden(filter, &device.output, &provenance.name)));
    let golden = format!("{}_golden.csv", provenance.name);
    files.push((golden, golden::golden(design, device)));
    files.push((
        "report.json".into(),
        report::report(design, device, provenance, (measured, uncertainty), reach),
    ));
    Ok(files)
}

/// Name of a library: of one model, unless it was given.
fn library(provenance: &Provenance) -> String {
    match provenance.name.as_str() {
        "echocal" => format!("Echocal_{:.8}", provenance.model_hash),
        given => given.to_owned(),
    }
}

/// Longest time \[us\] from a trigger pulse to the end of an echo that the function accepts, however the timer rounds.
fn echo_timeout(echo: &Axis) -> f64 {
    (echo.us(echo.codes.maximum + 1) + SILENCE).round()
}

/// The function in Python.
fn python_text(design: &Design, name: &str) -> minijinja::Value {
    let (locals, result, heap) = python::statements(&design.program);
    let (locals, result) = renamed((locals, result), name);
    context! { locals, result, heap, tables => python::tables(&design.program, name) }
}

/// The function in Rust.
fn rust_text(design: &Design, device: &Device, name: &str) -> minijinja::Value {
    let (locals, result) = renamed(rust::statements(&design.program), name);
    let types = device.axes().map(|axis| rust::name(axis.ty));
    context! {
        locals, result,
        types => types.collect::<Vec<_>>(),
        output => rust::name(device.output.ty),
        tables => rust::tables(&design.program, name),
    }
}

/// The function: parameters, range checks, tables, statements.
fn function_text(design: &Design, device: &Device, name: &str) -> minijinja::Value {
    let (locals, result) = renamed(c::statements(&design.program), name);
    let read = |axis: &&Axis| design.program.reads(&axis.name) || !outside(axis).is_empty();
    let unused = device
        .axes()
        .filter(|axis| !read(axis))
        .map(|axis| axis.name.as_str());
    let middle = named(&format!("{}(", c::MIDDLE), name);
    let tables = design.program.tables.iter();
    let unchecked = device.axes().filter(|axis| outside(axis).is_empty());
    context! {
        unchecked => unchecked.map(|axis| axis.name.as_str()).collect::<Vec<_>>(),
        middle => locals.iter().any(|local| local.expression.contains(&middle)),
        parameters => device.axes().map(|axis| parameter(axis, device)).collect::<Vec<_>>(),
        outside => device.axes().flat_map(outside).collect::<Vec<_>>(),
        wraps => device.axes().any(wraps),
        unused => unused.collect::<Vec<_>>(),
        locals, result,
        tables => tables.map(|table| table_text(table, name)).collect::<Vec<_>>(),
        table_bytes => design.program.table_bytes(),
        program_memory => design.program.tables.iter().any(|table| table.program_memory),
        form => design.describe(device),
        name => format!("{name}_distance_{}", device.output.suffix()),
        suffix => device.output.suffix(),
        ty => device.output.ty.c_name(),
        out_of_range => out_of_range(device),
        unit => device.output.text(),
        unit_lsb => device.output.lsb,
    }
}

/// The output for codes that are not accepted, as C and as a number.
fn out_of_range(device: &Device) -> minijinja::Value {
    let output = &device.output;
    context! {
        macro => format!("INT{}_MIN", output.ty.bits()),
        value => output.out_of_range(),
    }
}

/// What is proven, as the header states it.
fn proof_text(design: &Design, device: &Device, asked: f64) -> minijinja::Value {
    let proof = &design.proof;
    let input = |worst: Worst| place(device, worst.row, worst.echo);
    context! {
        asked_mm => (asked * 1e12).round() / 1e9,
        proven_mm => millimeters(proof.bounded.error, device),
        worst => input(proof.bounded),
        overall_mm => millimeters(proof.overall.error, device),
        overall_worst => input(proof.overall),
        inputs => grouped(proof.inputs),
        bounded_inputs => grouped(proof.bounded_inputs),
        hash => format!("{:016x}", proof.hash),
    }
}

/// The expanded uncertainty, and the integers of the function that gives it to the device: [um] at 0, and [um] per 2^8
/// steps of the shifted output, both rounded up.
fn uncertainty_text(uncertainty: &Uncertainty, device: &Device) -> minijinja::Value {
    let shift = if device.output.is_coarse() { 0 } else { 8 };
    let step = device.output.lsb * 1e6 * f64::from(1 << shift); // um
    context! {
        includes => uncertainty.includes,
        expanded => uncertainty.expanded,
        shift,
        offset => (uncertainty.offset * 1e6).ceil() as u64,
        slope => (uncertainty.slope * step * 256.0).ceil() as u64,
    }
}

/// An error in mm to four places, rounded up: what is stated must hold.
fn millimeters(error: f64, device: &Device) -> String {
    let tenths_of_micrometers = error * (1e7 / device.output.per_meter);
    format!("{:.4}", tenths_of_micrometers.ceil() / 1e4)
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

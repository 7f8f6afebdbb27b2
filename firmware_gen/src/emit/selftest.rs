//! Vectors of the self-test: few enough for the smallest memory, at every edge of the accepted codes.

use super::text::literal_list;
use crate::design::Design;
use crate::device::{Axis, Device};
use crate::ir::{IntegerType, Range};
use serde::Serialize;
use std::collections::BTreeSet;

/// Codes of each axis inside its range, its ends among them. Set by hand: 4^3 vectors at most, so
/// that they fit a small flash.
const INSIDE: i64 = 4;

/// One column of the vectors.
#[derive(Serialize)]
pub struct Column<'a> {
    ty: &'static str,
    name: &'a str,
    /// Which reader of program memory it takes.
    width: &'static str,
    rows: Vec<String>,
}

/// A column for each parameter, then the outputs; and how many vectors there are.
pub fn columns<'a>(design: &Design, device: &'a Device) -> (Vec<Column<'a>>, usize) {
    let vectors = vectors(design, device);
    let column = |name: &'a str, ty: IntegerType, entries: Vec<i64>| Column {
        ty: ty.c_name(),
        name,
        width: match ty.bits() {
            8 => "byte",
            16 => "word",
            _ => "dword",
        },
        rows: literal_list(&entries, ty),
    };
    let mut columns: Vec<_> = device
        .axes()
        .enumerate()
        .map(|(index, axis)| {
            let entries = vectors.iter().map(|vector| vector[index]).collect();
            column(&axis.name, axis.ty, entries)
        })
        .collect();
    let outputs = vectors
        .iter()
        .map(|vector| i64::from(design.output(device, vector)));
    columns.push(column("distance", device.output.ty, outputs.collect()));
    let statuses = vectors.iter().map(|vector| device.status(vector) as i64);
    columns.push(column("status", IntegerType::U8, statuses.collect()));
    (columns, vectors.len())
}

/// A grid inside, each code next to a range with the others in the middle of theirs, and the worst inputs.
fn vectors(design: &Design, device: &Device) -> BTreeSet<Vec<i64>> {
    let axes: Vec<_> = device.axes().collect();
    let mut grid: BTreeSet<Vec<i64>> = BTreeSet::from([Vec::new()]);
    for axis in &axes {
        let codes = inside(axis.codes);
        let extended = grid.iter().flat_map(|vector| {
            codes
                .iter()
                .map(move |code| [&vector[..], &[*code]].concat())
        });
        grid = extended.collect();
    }
    let middle: Vec<i64> = axes.iter().map(|axis| middle(axis.codes)).collect();
    for (index, axis) in axes.iter().enumerate() {
        let time_out = device.time_out().filter(|_| index == 0);
        for code in beside(axis).chain(time_out) {
            let mut vector = middle.clone();
            vector[index] = code;
            grid.insert(vector);
        }
    }
    for worst in [design.proof.bounded, design.proof.overall] {
        grid.insert([&[worst.echo][..], &device.codes(worst.row)].concat());
    }
    grid
}

fn inside(codes: Range) -> BTreeSet<i64> {
    let span = codes.maximum - codes.minimum;
    (0..INSIDE)
        .map(|k| codes.minimum + span * k / (INSIDE - 1))
        .collect()
}

fn middle(codes: Range) -> i64 {
    codes.minimum + (codes.maximum - codes.minimum) / 2
}

/// The codes just outside the accepted ones, and the ends of the type.
fn beside(axis: &Axis) -> impl Iterator<Item = i64> {
    let (codes, held) = (axis.codes, axis.ty.range());
    let outside = [
        codes.minimum - 1,
        codes.maximum + 1,
        held.minimum,
        held.maximum,
    ];
    outside.into_iter().filter(move |code| held.contains(*code))
}

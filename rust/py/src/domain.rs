//! Where laws hold: a mask of reason codes, and both sides of the comparison for one row.

use echocal_core::Law;
use echocal_core::air::domain::RELAXATION;
use echocal_core::air::{Air, Departure, Finding};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::border::{Column, same_length};
use crate::errors::to_python;
use crate::laws::LawText;

/// Name, value, lowest, highest, unit.
type Comparison = (&'static str, f64, f64, f64, &'static str);

/// What a row consists of.
const NAMES: [&str; 5] = [
    "temperature",
    "relative_humidity",
    "pressure",
    "co2_mole_fraction",
    "frequency",
];

/// Whether a row, in the order of [`NAMES`], lies outside; no law: absorption.
fn examine(
    law: Option<&Law>,
    [t, humidity, pressure, co2, frequency]: [f64; 5],
) -> Option<Finding> {
    let air = Air {
        temperature: t,
        relative_humidity: humidity,
        pressure,
        co2_mole_fraction: co2,
    };
    match law {
        Some(law) => law.examine(&air, frequency),
        None => RELAXATION.examine(&air, frequency),
    }
}

fn parse(law: Option<LawText<'_>>) -> PyResult<Option<Law>> {
    law.map(|law| Law::parse(law.0))
        .transpose()
        .map_err(|e| to_python(&e))
}

/// Position in `departure_names()` of the first reason why each row lies outside; 0 inside.
#[pyfunction]
pub fn departures<'py>(
    py: Python<'py>,
    law: Option<LawText<'_>>,
    columns: [Column<'py, f64>; 5],
) -> PyResult<Bound<'py, PyArray1<u8>>> {
    let law = parse(law)?;
    let views = columns.each_ref().map(|column| &**column);
    let rows = same_length(&core::array::from_fn::<_, 5, _>(|k| {
        (NAMES[k], views[k].len())
    }))?;
    let code = |row: usize| {
        let found = examine(law.as_ref(), views.map(|view| view[row]));
        found.map_or(Departure::None, |finding| finding.departure) as u8
    };
    Ok(PyArray1::from_iter(py, (0..rows).map(code)))
}

/// What lies outside in one row, with its value, its range and their unit.
#[pyfunction]
pub fn departure(law: Option<LawText<'_>>, row: [f64; 5]) -> PyResult<Option<Comparison>> {
    let found = examine(parse(law)?.as_ref(), row);
    Ok(found.map(|finding| {
        let name = Departure::NAMES[finding.departure as usize];
        (
            name,
            finding.value,
            finding.range.0,
            finding.range.1,
            finding.unit,
        )
    }))
}

/// Names of what can lie outside, in the order of the codes.
#[pyfunction]
pub fn departure_names() -> Vec<&'static str> {
    Departure::NAMES.to_vec()
}

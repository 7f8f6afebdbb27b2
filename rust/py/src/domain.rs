//! Where laws hold: a mask of reason codes, and both sides of the comparison for one row.

use echocal_core::Law;
use echocal_core::air::domain::RELAXATION;
use echocal_core::air::{Air, Departure, Finding};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::errors::to_python;

/// Name, value, lowest, highest, unit.
type Comparison = (&'static str, f64, f64, f64, &'static str);

/// Temperature, relative humidity, pressure, CO2 mole fraction, frequency; no law: absorption.
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

fn parse(law: Option<&str>) -> PyResult<Option<Law>> {
    law.map(Law::parse).transpose().map_err(|e| to_python(&e))
}

/// Position in `departure_names()` of the first reason why each row lies outside; 0 inside.
#[pyfunction]
pub fn departures<'py>(
    py: Python<'py>,
    law: Option<&str>,
    columns: [PyReadonlyArray1<'py, f64>; 5],
) -> PyResult<Bound<'py, PyArray1<u8>>> {
    let law = parse(law)?;
    let views = columns.each_ref().map(PyReadonlyArray1::as_array);
    let rows = views.iter().map(|view| view.len()).min().unwrap_or(0);
    let code = |row| {
        let found = examine(law.as_ref(), views.map(|view| view[row]));
        found.map_or(Departure::None, |finding| finding.departure) as u8
    };
    Ok(PyArray1::from_iter(py, (0..rows).map(code)))
}

/// What lies outside in one row, with its value, its range and their unit.
#[pyfunction]
pub fn departure(law: Option<&str>, row: [f64; 5]) -> PyResult<Option<Comparison>> {
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

//! Values that no air has, and that mean another unit: fifty for a relative humidity of 50 %.
//!
//! A law may be used a little outside its domain without a word (`departures` tells the rows). These ranges are
//! far wider: what lies beyond them is no air in which a ranger works.

use std::ffi::CString;

use numpy::{PyReadonlyArrayDyn, PyUntypedArray};
use pyo3::exceptions::PyWarning;
use pyo3::prelude::*;
use pyo3::types::PyList;

use super::arguments::{Input, Range};

/// Of an input that may be anything.
pub const ANY: Range = (f64::NEG_INFINITY, f64::INFINITY);

/// Elements of an array that are looked at, evenly spaced: a wrong unit is wrong in all of them.
const SAMPLE: usize = 64;

/// Of a distance: no ultrasound comes back from so far through air.
const LENGTH: Range = (f64::NEG_INFINITY, 100.0);
const TIME: Range = (f64::NEG_INFINITY, 1.0);
const IN_SECONDS: &str = "it is in s: 8700 us is 0.0087";
const IN_METERS: &str = "it is in m: 1500 mm is 1.5";

/// The range of an input, and what is meant: ice of carbon dioxide to an oven; 20 km of altitude to ten atmospheres.
const KNOWN: [(&str, Range, &str); 8] = [
    ("time", TIME, IN_SECONDS),
    ("time_of_flight", TIME, IN_SECONDS),
    ("distance", LENGTH, IN_METERS),
    ("indication", LENGTH, IN_METERS),
    ("temperature", (-100.0, 200.0), "it is in degC"),
    (
        "relative_humidity",
        (0.0, 1.05),
        "it is a number from 0 to 1: 50 % is 0.5",
    ),
    ("pressure", (5e3, 1e6), "it is in Pa: 1013 hPa is 101300"),
    (
        "co2_mole_fraction",
        (0.0, 0.5),
        "it is a mole fraction: 400 ppm is 4e-4",
    ),
];

/// The range of an input by its name, at compile time where the name is known there.
pub const fn range_of(name: &str) -> Range {
    let mut place = 0;
    while place < KNOWN.len() {
        let (known, range, _) = KNOWN[place];
        if same(known.as_bytes(), name.as_bytes()) {
            return range;
        }
        place += 1;
    }
    ANY
}

const fn same(one: &[u8], other: &[u8]) -> bool {
    if one.len() != other.len() {
        return false;
    }
    let mut place = 0;
    while place < one.len() {
        if one[place] != other[place] {
            return false;
        }
        place += 1;
    }
    true
}

/// Warn of plain numbers that lie outside.
pub fn look_at_numbers(py: Python<'_>, inputs: &[Input<'_, '_>], values: &[f64]) -> PyResult<()> {
    for (input, value) in inputs.iter().zip(values) {
        look(py, input, *value)?;
    }
    Ok(())
}

/// Warn of some elements of arrays that lie outside.
pub fn look_at_arrays(py: Python<'_>, inputs: &[Input<'_, '_>]) -> PyResult<()> {
    for input in inputs.iter().filter(|input| input.range != ANY) {
        let Some(given) = input.given else { continue };
        if let Some(value) = input.number() {
            look(py, input, value)?;
        } else if let Ok(list) = given.cast::<PyList>() {
            let first = list.get_item(0).and_then(|first| first.extract::<f64>());
            first.map_or(Ok(()), |value| look(py, input, value))?;
        } else if let Ok(array) = given.cast::<PyUntypedArray>() {
            look_at(py, input, array)?;
        } else if is_pandas(given)
            && let Ok(values) = given.getattr("values")
            && let Ok(array) = values.cast::<PyUntypedArray>()
        {
            look_at(py, input, array)?;
        }
    }
    Ok(())
}

fn look_at(
    py: Python<'_>,
    input: &Input<'_, '_>,
    array: &Bound<'_, PyUntypedArray>,
) -> PyResult<()> {
    if let Ok(array) = array.extract::<PyReadonlyArrayDyn<'_, f64>>() {
        look_along(py, input, array.as_slice().unwrap_or_default(), |value| {
            value
        })
    } else if let Ok(array) = array.extract::<PyReadonlyArrayDyn<'_, i64>>() {
        #[allow(clippy::cast_precision_loss)] // only the size counts
        let number = |value: i64| value as f64;
        look_along(py, input, array.as_slice().unwrap_or_default(), number)
    } else {
        Ok(())
    }
}

fn look_along<T: Copy>(
    py: Python<'_>,
    input: &Input<'_, '_>,
    rows: &[T],
    number: impl Fn(T) -> f64,
) -> PyResult<()> {
    let step = rows.len().div_ceil(SAMPLE).max(1);
    let mut sample = rows.iter().step_by(step).map(|value| number(*value));
    let strange = sample.find(|value| outside(input, *value));
    strange.map_or(Ok(()), |value| look(py, input, value))
}

fn is_pandas(given: &Bound<'_, PyAny>) -> bool {
    let module = given.get_type().module();
    module.is_ok_and(|name| {
        name.to_str()
            .is_ok_and(|name| name == "pandas" || name.starts_with("pandas."))
    })
}

fn outside(input: &Input<'_, '_>, value: f64) -> bool {
    value < input.range.0 || value > input.range.1
}

#[inline]
fn look(py: Python<'_>, input: &Input<'_, '_>, value: f64) -> PyResult<()> {
    if outside(input, value) {
        return warn(py, input, value);
    }
    Ok(())
}

#[cold]
fn warn(py: Python<'_>, input: &Input<'_, '_>, value: f64) -> PyResult<()> {
    let hint = KNOWN
        .iter()
        .find(|(name, ..)| *name == input.name)
        .map_or("", |(_, _, hint)| hint);
    let (low, high) = input.range;
    let message = format!(
        "{} is {value}, not {}{high}: {hint}; the result means nothing",
        input.name,
        if low.is_finite() {
            format!("{low} .. ")
        } else {
            "at most ".to_owned()
        },
    );
    let category = py.import("echocal.errors")?.getattr("DomainWarning")?;
    let category = category.cast_into::<pyo3::types::PyType>()?;
    debug_assert!(category.is_subclass_of::<PyWarning>()?);
    PyErr::warn(py, &category, &CString::new(message)?, input.depth)
}

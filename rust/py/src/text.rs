//! Rows of separated text, as NumPy columns and as bytes.

use echocal_text::{Layout, Results};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::border::{Column, same_length, within};

/// The lines of a block that are all plain rows.
#[pyclass(name = "PlainRows", module = "echocal._core", frozen, get_all)]
pub struct CorePlainRows {
    /// Place behind the last byte of each line, without what ends it.
    ends: Py<PyArray1<u32>>,
    /// The wanted columns.
    columns: Vec<Py<PyArray1<f64>>>,
    /// Whether the last line is ended.
    ended: bool,
}

/// The rows of a block; None if one of its lines is not plain.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // as Python sees it
pub fn plain_rows(
    py: Python<'_>,
    data: &[u8],
    separator: u8,
    width: usize,
    places: Vec<usize>,
    missing: Vec<Vec<u8>>,
    comment: Option<u8>,
    end: &[u8],
) -> PyResult<Option<CorePlainRows>> {
    within("place", places.iter().copied(), width)?;
    if end.is_empty() {
        return Err(PyValueError::new_err("end has no byte"));
    }
    let layout = Layout {
        separator,
        width,
        places: &places,
        missing: &missing,
        comment,
        end,
    };
    let Some(found) = py.detach(|| echocal_text::plain_rows(data, &layout)) else {
        return Ok(None);
    };
    let columns = found.columns.into_iter();
    Ok(Some(CorePlainRows {
        ends: PyArray1::from_vec(py, found.ends).unbind(),
        columns: columns
            .map(|own| PyArray1::from_vec(py, own).unbind())
            .collect(),
        ended: found.ended,
    }))
}

/// The lines of a block, each with its results; None if a number is too large to be written here.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // as Python sees it
pub fn with_results<'py>(
    py: Python<'py>,
    data: &[u8],
    ends: Column<'py, u32>,
    between: usize,
    separator: u8,
    distance: Column<'py, f64>,
    uncertainty: Column<'py, f32>,
    codes: Column<'py, i16>,
    tails: Vec<Vec<u8>>,
) -> PyResult<Option<Bound<'py, PyBytes>>> {
    let (ends, distance) = (&*ends, &*distance);
    let (uncertainty, codes) = (&*uncertainty, &*codes);
    same_length(&[
        ("ends", ends.len()),
        ("distance", distance.len()),
        ("uncertainty", uncertainty.len()),
        ("codes", codes.len()),
    ])?;
    let mut begin = 0;
    for &end in ends {
        if !(begin..=data.len()).contains(&(end as usize)) {
            let message = format!(
                "a line ends at byte {end}, outside of {begin} to {}",
                data.len()
            );
            return Err(PyValueError::new_err(message));
        }
        begin = (end as usize).saturating_add(between);
    }
    let places = codes
        .iter()
        .map(|&code| usize::try_from(code).unwrap_or(usize::MAX));
    within("code", places, tails.len())?;
    let results = Results {
        distance,
        uncertainty,
        codes,
        tails: &tails,
    };
    let found = py.detach(|| echocal_text::with_results(data, ends, between, separator, &results));
    Ok(found.map(|bytes| PyBytes::new(py, &bytes)))
}

//! Tables as text: the lines of some megabytes, the numbers in them, and results behind them.

use echocal_text::columns::{Dialect, numbers};
use echocal_text::fields::{Texts, texts};
use echocal_text::lines::{ending, ends};
use echocal_text::results::{Results, appended};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::border::{Column, same_length, within};

/// Bytes of the fields of a column, and where each begins.
type Fields<'py> = (Bound<'py, PyBytes>, Bound<'py, PyArray1<i32>>);

/// Whole lines that all end alike, none of them blank.
#[pyclass(name = "Lines", module = "echocal._core", frozen)]
pub struct CoreLines {
    data: Py<PyBytes>,
    ends: Vec<u32>,
    ending: usize,
}

#[pymethods]
impl CoreLines {
    /// The lines of a text that ends with the last of them; None where they are not plain.
    #[staticmethod]
    fn of(py: Python<'_>, data: Py<PyBytes>, with_return: bool) -> Option<Self> {
        let bytes = data.as_bytes(py);
        let ends = py.detach(|| ends(bytes, with_return))?;
        Some(Self {
            data,
            ends,
            ending: ending(with_return),
        })
    }

    fn __len__(&self) -> usize {
        self.ends.len()
    }

    /// Numbers of the columns at some ascending places; None where the fields are not plainly such.
    fn numbers<'py>(
        &self,
        py: Python<'py>,
        places: Vec<usize>,
        width: usize,
        separator: u8,
        decimal: u8,
        absent: Vec<Vec<u8>>,
    ) -> Option<Vec<Bound<'py, PyArray1<f64>>>> {
        let data = self.data.as_bytes(py);
        let dialect = Dialect {
            separator,
            decimal,
            width,
            absent: &absent,
        };
        let found = py.detach(|| {
            if !data.contains(&b'"') {
                return numbers(data, &self.ends, self.ending, &places, dialect);
            }
            let columns = texts(data, &self.ends, self.ending, &places, separator, width)?;
            let number = |column: &Texts| column.numbers(decimal, &absent);
            columns.iter().map(number).collect()
        })?;
        let arrays = found
            .into_iter()
            .map(|column| PyArray1::from_vec(py, column));
        Some(arrays.collect())
    }

    /// Fields of the columns at some ascending places: their bytes, where each begins, and where the last one
    /// ends; None where they are not plain.
    fn texts<'py>(
        &self,
        py: Python<'py>,
        places: Vec<usize>,
        width: usize,
        separator: u8,
    ) -> Option<Vec<Fields<'py>>> {
        let data = self.data.as_bytes(py);
        let found =
            py.detach(|| texts(data, &self.ends, self.ending, &places, separator, width))?;
        let plain = |own: Texts| {
            let bounds = PyArray1::from_vec(py, own.bounds);
            (PyBytes::new(py, &own.data), bounds)
        };
        Some(found.into_iter().map(plain).collect())
    }

    /// The lines with the results of each, as bytes; the last one ends like the others, or has no end.
    #[allow(clippy::too_many_arguments)] // as Python sees it
    fn with_results<'py>(
        &self,
        py: Python<'py>,
        distance: Column<'py, f64>,
        uncertainty: Column<'py, f32>,
        codes: Column<'py, i16>,
        status: Vec<Vec<u8>>,
        separator: Vec<u8>,
        decimal: u8,
        ended: bool,
    ) -> PyResult<Bound<'py, PyArray1<u8>>> {
        let (distance, uncertainty, codes) = (&*distance, &*uncertainty, &*codes);
        same_length(&[
            ("the text", self.ends.len()),
            ("distance", distance.len()),
            ("uncertainty", uncertainty.len()),
            ("codes", codes.len()),
        ])?;
        let place = |&code: &i16| usize::try_from(code).unwrap_or(usize::MAX);
        within("status", codes.iter().map(place), status.len())?;
        let data = self.data.as_bytes(py);
        let results = Results {
            distance,
            uncertainty,
            codes,
            status: &status,
        };
        let mut written =
            py.detach(|| appended(data, &self.ends, self.ending, results, &separator, decimal));
        if !ended {
            written.truncate(written.len().saturating_sub(self.ending));
        }
        Ok(PyArray1::from_vec(py, written))
    }
}

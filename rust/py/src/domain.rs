//! Where laws hold: masks and messages for rows outside.

use echocal_core::air::domain::RELAXATION;
use echocal_core::air::{Air, Departure, Finding};
use echocal_core::{Law, Limits};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::errors::to_python;

type Column<'py> = PyReadonlyArray1<'py, f64>;

/// Rows of temperature, relative humidity, pressure, CO2 and frequency; no law: absorption.
#[pyclass(module = "echocal._core", frozen)]
pub struct Domain {
    law: Option<Law>,
}

#[pymethods]
impl Domain {
    #[new]
    fn new(law: Option<&str>) -> PyResult<Self> {
        let law = law.map(Law::parse).transpose();
        Ok(Self {
            law: law.map_err(|e| to_python(&e))?,
        })
    }

    /// Position in `departure_names()` of the first reason why a row lies outside; 0 inside.
    fn codes<'py>(&self, py: Python<'py>, columns: [Column<'py>; 5]) -> Bound<'py, PyArray1<u8>> {
        let rows = 0..columns[0].len().unwrap_or(0);
        let code = |row| {
            let found = self.examine(&columns, row);
            found.map_or(Departure::None, |finding| finding.departure) as u8
        };
        PyArray1::from_iter(py, rows.map(code))
    }

    /// Name, value, lowest, highest and unit of what lies outside in a row.
    fn finding(
        &self,
        columns: [Column<'_>; 5],
        row: usize,
    ) -> PyResult<Option<(&'static str, f64, f64, f64, &'static str)>> {
        if columns.iter().any(|column| row >= column.len().unwrap_or(0)) {
            return Err(PyIndexError::new_err(format!("no row {row}")));
        }
        Ok(self.examine(&columns, row).map(|found| {
            let (low, high) = found.range;
            let name = Departure::NAMES[found.departure as usize];
            (name, found.value, low, high, found.unit)
        }))
    }
}

//! Numbers from Python that must lie in a range before the inference trusts them.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Refuses what is not as it must be, by name and number.
pub fn required(is_right: bool, what: &str, must: &str, found: f64) -> PyResult<()> {
    if is_right {
        return Ok(());
    }
    let message = format!("{what} must be {must}, but is {found}");
    Err(PyValueError::new_err(message))
}

/// Refuses what is no probability.
pub fn probability(what: &str, found: f64) -> PyResult<()> {
    required((0.0..=1.0).contains(&found), what, "from 0 to 1", found)
}

/// Refuses what is not above zero, or has no end.
pub fn positive(what: &str, found: f64) -> PyResult<()> {
    let is_right = found > 0.0 && found.is_finite();
    required(is_right, what, "finite and above 0", found)
}

/// Refuses what is below zero, or no number.
pub fn not_negative(what: &str, found: f64) -> PyResult<()> {
    required(found >= 0.0, what, "0 or more", found)
}

/// Refuses what no coefficient of an autoregression or of a moving average can be.
pub fn coefficient(what: &str, found: f64) -> PyResult<()> {
    let is_right = found.abs() < 1.0;
    required(is_right, what, "between -1 and 1", found)
}

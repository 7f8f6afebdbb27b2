//! Laws as arguments.

use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::errors::raise;

/// A law as text.
pub struct LawText<'a>(pub &'a str);

impl<'a, 'py> FromPyObject<'a, 'py> for LawText<'a> {
    type Error = PyErr;

    fn extract(given: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        given.extract().map(Self).or_else(|_| {
            let told = given.repr()?;
            let message = format!(
                "the law is {told}; give a name ('cramer') or an expression ('331.3+0.606*T')"
            );
            Err(raise("ModelError", message))
        })
    }
}

/// The text of a law, or of a constant speed.
pub fn speed_text(given: &Bound<'_, PyAny>) -> PyResult<String> {
    if given.is_instance_of::<PyString>()
        && let Ok(text) = given.extract()
    {
        return Ok(text);
    }
    match given.extract::<f64>() {
        Ok(speed) if speed.is_finite() => Ok(format!("{speed}")),
        _ => {
            let told = given.repr()?;
            let message =
                format!("reading_speed is {told}; give a speed in m/s, or a law such as 'linear'");
            Err(raise("UsageError", message))
        }
    }
}

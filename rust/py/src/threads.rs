//! How many threads work, as the environment says.

use echocal_core::batch::limit_threads;
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use std::env::{VarError, var};

const VARIABLE: &str = "ECHOCAL_NUM_THREADS";

/// Reads the variable once, when the module is imported; without it, all processors work.
pub fn limit_from_environment() -> PyResult<()> {
    let given = match var(VARIABLE) {
        Ok(given) if !given.is_empty() => given,
        Ok(_) | Err(VarError::NotPresent) => return Ok(()),
        Err(VarError::NotUnicode(given)) => given.to_string_lossy().into_owned(),
    };
    let most = given.trim().parse().map_err(|_| {
        PyImportError::new_err(format!(
            "{VARIABLE} is {given:?}; give the most threads that work at once, a whole number from 1 on, or unset it"
        ))
    })?;
    limit_threads(most);
    Ok(())
}

//! What a batch function is called with.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt};

use crate::errors::raise;

/// Lowest and highest value.
pub type Range = (f64, f64);

/// An input as given, and the value that it has when it is not.
pub struct Input<'a, 'py> {
    pub name: &'static str,
    pub given: Option<&'a Bound<'py, PyAny>>,
    pub default: f64,
    /// Beyond it another unit is meant.
    pub range: Range,
    /// Python calls between the user and this function, for a warning.
    pub depth: i32,
}

/// What a function returns, for results that carry labels.
#[derive(Clone, Copy)]
pub struct Label {
    pub name: &'static str,
    pub unit: &'static str,
}

/// The arguments that every batch function has beside its inputs.
pub struct Options<'a, 'py> {
    pub out: Option<&'a Bound<'py, PyAny>>,
    pub condition: Option<&'a Bound<'py, PyAny>>,
    pub n_threads: Option<Threads>,
}

/// Threads that a caller allows: at least one.
#[derive(Clone, Copy)]
pub struct Threads(pub(super) usize);

impl<'py> FromPyObject<'_, 'py> for Threads {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let truth = given.is_instance_of::<PyBool>(); // a number to Python, and no count
        let count = given.extract::<i64>().ok().filter(|_| !truth);
        let count = count.map(usize::try_from);
        match count {
            Some(Ok(count)) if count > 0 => Ok(Self(count)),
            _ => {
                let told = given.repr()?;
                let message =
                    format!("n_threads is {told}; give 1 or more, or None for every processor");
                Err(raise("UsageError", message))
            }
        }
    }
}

impl Input<'_, '_> {
    /// The value where it is a plain Python number.
    pub fn number(&self) -> Option<f64> {
        match self.given {
            None => Some(self.default),
            Some(given) if given.is_exact_instance_of::<PyFloat>() => given.extract().ok(),
            Some(given) if given.is_exact_instance_of::<PyInt>() => given.extract().ok(),
            Some(_) => None,
        }
    }
}

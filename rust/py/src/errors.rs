//! The one place where errors of the core become Python exceptions.

use echocal_core::Error;
use pyo3::prelude::*;

/// The exception of `echocal.errors` for an error of the core.
pub fn to_python(error: &Error) -> PyErr {
    raise("ModelError", error.to_string())
}

/// An exception of `echocal.errors` by its class name.
pub fn raise(class: &str, message: String) -> PyErr {
    Python::attach(|py| {
        let made = py
            .import("echocal.errors")
            .and_then(|module| module.getattr(class))
            .and_then(|class| class.call1((message,)));
        match made {
            Ok(exception) => PyErr::from_value(exception),
            Err(error) => error,
        }
    })
}

//! What the module offers beside its functions.

use echocal_core::simd::{self, InstructionSet};
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;

use super::cache::decoded;
use crate::errors::raise;

/// Looks up a ufunc by the name that it was pickled under.
#[pyfunction]
#[pyo3(name = "__getattr__")]
pub fn module_attribute<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    decoded(py, name).unwrap_or_else(|| {
        let message = format!("module 'echocal._core' has no attribute '{name}'");
        Err(PyAttributeError::new_err(message))
    })
}

/// The instruction sets that this processor has, from the narrowest.
#[pyfunction]
pub fn instruction_sets() -> Vec<&'static str> {
    let available = InstructionSet::ALL
        .into_iter()
        .filter(|set| set.is_available());
    available.map(InstructionSet::name).collect()
}

/// Computes with this instruction set from now on; None: the widest. For tests and benches.
#[pyfunction]
#[pyo3(signature = (name))]
pub fn set_instruction_set(name: Option<&str>) -> PyResult<()> {
    let wanted = name.map(|name| {
        InstructionSet::ALL
            .into_iter()
            .find(|set| set.name() == name)
    });
    if wanted == Some(None) || !simd::force(wanted.flatten()) {
        let message = format!(
            "instruction set '{}' is not available; available: {}",
            name.unwrap_or_default(),
            instruction_sets().join(", ")
        );
        return Err(raise("UsageError", message));
    }
    Ok(())
}

//! One call of a batch function, whatever comes in.

use std::sync::OnceLock;

use echocal_core::batch::available_threads;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyTuple};

use super::absurd::{look_at_arrays, look_at_numbers};
use super::arguments::{Input, Label, Options, Threads};
use super::cache::Entry;
use super::direct::direct;
use super::explain::{check_condition, common_shape, explained};
use super::output;
use super::ufunc::{MOST_INPUTS, with_threads};
use crate::errors::raise;

/// The function's value: a float for plain numbers, else whatever the ufunc makes of the inputs.
pub fn call<'py>(
    py: Python<'py>,
    entry: &Entry,
    label: Label,
    inputs: &[Input<'_, 'py>],
    options: &Options<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let kernel = entry.kernel();
    if options.condition.is_none() {
        if options.out.is_none()
            && let Some(values) = numbers(inputs)
        {
            look_at_numbers(py, inputs, &values)?;
            let value = kernel.evaluate(&values[..inputs.len()]);
            return Ok(PyFloat::new(py, value).into_any());
        }
        look_at_arrays(py, inputs)?;
        let threads = threads(options.n_threads);
        if let Some(result) = direct(py, kernel, inputs, options.out, threads) {
            return Ok(result);
        }
    }
    through_ufunc(py, entry, label, inputs, options)
}

/// The long way, kept apart: a call with plain numbers sets up nothing of it.
#[inline(never)]
fn through_ufunc<'py>(
    py: Python<'py>,
    entry: &Entry,
    label: Label,
    inputs: &[Input<'_, 'py>],
    options: &Options<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    options.condition.map_or(Ok(()), check_condition)?;
    options.out.map_or(Ok(()), output::check)?;
    let inputs: Vec<_> = inputs
        .iter()
        .map(|input| (input.name, filled(py, input)))
        .collect();
    let threads = threads(options.n_threads);
    let arguments = PyTuple::new(py, inputs.iter().map(|(_, value)| value))?;
    let ufunc = entry.ufunc(py)?;
    let result = keywords(py, &arguments, options)
        .and_then(|keywords| with_threads(threads, || ufunc.call(arguments, keywords.as_ref())));
    match result {
        Ok(result) if options.out.is_some() => Ok(result),
        Ok(result) => labelled(result, label),
        Err(error) => Err(explained(py, error, &inputs, options)),
    }
}

/// The inputs where all of them are plain Python numbers.
fn numbers(inputs: &[Input<'_, '_>]) -> Option<[f64; MOST_INPUTS]> {
    let mut values = [0.0; MOST_INPUTS];
    for (value, input) in values.iter_mut().zip(inputs) {
        // NumPy's double is a float too; its single is not.
        *value = match input.given {
            Some(given) if given.is_instance_of::<PyFloat>() => given.extract().ok()?,
            _ => input.number()?,
        };
    }
    Some(values)
}

fn filled<'py>(py: Python<'py>, input: &Input<'_, 'py>) -> Bound<'py, PyAny> {
    match input.given {
        Some(given) => given.clone(),
        None => PyFloat::new(py, input.default).into_any(),
    }
}

fn threads(asked: Option<Threads>) -> usize {
    static AVAILABLE: OnceLock<usize> = OnceLock::new();
    asked.map_or_else(
        || *AVAILABLE.get_or_init(available_threads),
        |Threads(count)| count,
    )
}

fn keywords<'py>(
    py: Python<'py>,
    arguments: &Bound<'py, PyTuple>,
    options: &Options<'_, 'py>,
) -> PyResult<Option<Bound<'py, PyDict>>> {
    if options.out.is_none() && options.condition.is_none() {
        return Ok(None);
    }
    let keywords = PyDict::new(py);
    if let Some(condition) = options.condition {
        keywords.set_item("where", condition)?;
    }
    match (options.out, options.condition) {
        (Some(out), _) => keywords.set_item("out", out)?,
        // NumPy would leave what happens to be in memory where the condition is false.
        (None, Some(condition)) => keywords.set_item("out", nans(arguments, condition)?)?,
        (None, None) => {}
    }
    Ok(Some(keywords))
}

/// An array of NaN in the shape and precision of the result.
fn nans<'py>(
    arguments: &Bound<'py, PyTuple>,
    condition: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let numpy = arguments.py().import("numpy")?;
    let shape = common_shape(&numpy, arguments.iter().chain([condition.clone()]))?;
    let kind = numpy.call_method1("result_type", arguments)?;
    let single = kind.eq(numpy.getattr("float32")?)?;
    let kind = numpy.getattr(if single { "float32" } else { "float64" })?;
    numpy.call_method1("full", (shape, f64::NAN, kind))
}

/// Results that carry labels get those of the function, not those of its first input.
fn labelled(result: Bound<'_, PyAny>, label: Label) -> PyResult<Bound<'_, PyAny>> {
    let py = result.py();
    let class = result.get_type();
    let module = class.module()?;
    match module.to_str()?.split('.').next().unwrap_or_default() {
        "numpy" if !result.hasattr("__len__")? => {
            Ok(PyFloat::new(py, result.extract()?).into_any()) // NumPy's own scalar
        }
        "xarray" if class.name()? == "Dataset" => {
            let message =
                "an xarray Dataset is several variables; give one of them, as in ds['temperature']";
            Err(raise("UsageError", message.to_owned()))
        }
        "xarray" => {
            let attributes = PyDict::new(py);
            attributes.set_item("units", label.unit)?;
            attributes.set_item("long_name", label.name.replace('_', " "))?;
            result.setattr("attrs", attributes)?;
            result.setattr("name", label.name)?;
            Ok(result)
        }
        "pandas" if result.hasattr("name")? => {
            result.setattr("name", label.name)?;
            Ok(result)
        }
        "polars" => result.call_method1("alias", (label.name,)),
        _ => Ok(result),
    }
}

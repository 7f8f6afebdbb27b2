//! NumPy's errors in terms of the functions' own arguments.

use pyo3::exceptions::{PyNotImplementedError, PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyModule, PyTuple};

use super::arguments::Options;
use crate::errors::raise;

/// An input and its name.
pub type Named<'py> = (&'static str, Bound<'py, PyAny>);

/// The error of a ufunc that refused its arguments, as one that names the argument at fault.
pub fn explained<'py>(
    py: Python<'py>,
    error: PyErr,
    inputs: &[Named<'py>],
    options: &Options<'_, 'py>,
) -> PyErr {
    let about_arguments = error.is_instance_of::<PyValueError>(py)
        || error.is_instance_of::<PyTypeError>(py)
        || error.is_instance_of::<PyOverflowError>(py)
        || error.is_instance_of::<PyNotImplementedError>(py);
    let Ok(numpy) = py.import("numpy") else {
        return error;
    };
    if !about_arguments {
        return error;
    }
    let told = inputs
        .iter()
        .find_map(|(name, value)| about_input(&numpy, name, value));
    let told = told.or_else(|| about_shapes(&numpy, inputs, options));
    let told = told.or_else(|| about_out(&numpy, inputs, options));
    let Some(message) = told else {
        return error; // what pandas, xarray or dask have to say, for instance
    };
    let explained = raise("UsageError", message);
    explained.set_cause(py, Some(error));
    explained
}

/// Refuses a condition that is not made of truth values: NumPy takes any text for true.
pub fn check_condition(condition: &Bound<'_, PyAny>) -> PyResult<()> {
    let numpy = condition.py().import("numpy")?;
    let kind = match condition.getattr("dtype") {
        Ok(kind) if kind.hasattr("kind")? => kind,
        _ => dtype(&numpy, condition).map_err(|error| {
            let why = error.value(condition.py());
            raise(
                "UsageError",
                format!("where is no array of truth values: {why}"),
            )
        })?,
    };
    if letter(&kind) == Some('b') {
        return Ok(());
    }
    let message = format!("where must be true or false in each row, but has dtype {kind}");
    Err(raise("UsageError", message))
}

fn about_input(
    numpy: &Bound<'_, PyModule>,
    name: &str,
    value: &Bound<'_, PyAny>,
) -> Option<String> {
    let kind = match dtype(numpy, value) {
        Ok(kind) => kind,
        Err(error) => {
            return Some(format!(
                "{name} is no array of numbers: {}",
                error.value(numpy.py())
            ));
        }
    };
    if !letter(&kind).is_some_and(|letter| "fiub".contains(letter)) {
        return Some(format!("{name} must be real numbers, but has dtype {kind}"));
    }
    let bytes: usize = kind.getattr("itemsize").ok()?.extract().ok()?;
    (bytes > size_of::<f64>()).then(|| {
        format!(
            "{name} has dtype {kind}, and the result would have fewer digits; convert it with \
             .astype(float)"
        )
    })
}

fn about_shapes<'py>(
    numpy: &Bound<'py, PyModule>,
    inputs: &[Named<'py>],
    options: &Options<'_, 'py>,
) -> Option<String> {
    let error = result_shape(numpy, inputs, options).err()?;
    let condition = options.condition.map(|condition| ("where", condition));
    let each = inputs.iter().map(|(name, value)| (*name, value));
    let shapes = each.chain(condition).filter_map(|(name, value)| {
        let shape = shape(numpy, value).ok()?.str().ok()?.to_string();
        (shape != "()").then(|| format!("{name} {shape}"))
    });
    let shapes = shapes.collect::<Vec<_>>().join(", ");
    let why = error.value(numpy.py());
    Some(format!("shapes do not broadcast: {shapes} ({why})"))
}

fn about_out<'py>(
    numpy: &Bound<'py, PyModule>,
    inputs: &[Named<'py>],
    options: &Options<'_, 'py>,
) -> Option<String> {
    let mut out = options.out?.clone();
    if let Ok(several) = out.cast_exact::<PyTuple>() {
        if several.len() != 1 {
            let count = several.len();
            return Some(format!("out must be one array, but is a tuple of {count}"));
        }
        out = several.get_item(0).ok()?;
    }
    let array = numpy.getattr("ndarray").ok()?;
    if !out.is_instance(&array).ok()? {
        let class = out.get_type().name().ok()?;
        return Some(format!("out must be a NumPy array, but is a {class}"));
    }
    let writeable = out.getattr("flags").ok()?.getattr("writeable").ok()?;
    if !writeable.is_truthy().ok()? {
        return Some("out is read-only; give an array that can be written to".to_owned());
    }
    let kind = out.getattr("dtype").ok()?;
    let fits = numpy.call_method1("can_cast", ("float64", &kind, "same_kind"));
    if !fits.ok()?.is_truthy().ok()? {
        return Some(format!(
            "out has dtype {kind}, which cannot hold the result; give an array of float64 or float32"
        ));
    }
    let (wanted, given) = (
        result_shape(numpy, inputs, options).ok()?,
        shape(numpy, &out).ok()?,
    );
    let differ = wanted.ne(&given).ok()?;
    differ.then(|| format!("out has shape {given}, but the result has shape {wanted}"))
}

/// The shape that the inputs and the condition have together.
fn result_shape<'py>(
    numpy: &Bound<'py, PyModule>,
    inputs: &[Named<'py>],
    options: &Options<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let values = inputs.iter().map(|(_, value)| value.clone());
    common_shape(numpy, values.chain(options.condition.cloned()))
}

/// The shape that some values have together.
pub fn common_shape<'py>(
    numpy: &Bound<'py, PyModule>,
    values: impl Iterator<Item = Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let shapes: PyResult<Vec<_>> = values.map(|value| shape(numpy, &value)).collect();
    numpy.call_method1("broadcast_shapes", PyTuple::new(numpy.py(), shapes?)?)
}

fn shape<'py>(
    numpy: &Bound<'py, PyModule>,
    value: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    numpy.call_method1("shape", (value,))
}

fn dtype<'py>(
    numpy: &Bound<'py, PyModule>,
    value: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    numpy.call_method1("asarray", (value,))?.getattr("dtype")
}

/// NumPy's letter for the kind of a dtype.
fn letter(kind: &Bound<'_, PyAny>) -> Option<char> {
    kind.getattr("kind").ok()?.extract().ok()
}

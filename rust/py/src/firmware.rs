//! Firmware: a request in, texts and the bit-exact twin out.

use echocal_core::Conditions;
use echocal_firmware::lower::{describe, lower};
use echocal_firmware::{
    Artifacts, Axis, Design, Device, Error, Prefer, Progress, Provenance, Request, Target, design,
    emit,
};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::errors::raise;
use crate::model::CoreModel;

/// A proven design, its texts and its twin.
#[pyclass(name = "Firmware", module = "echocal._core", frozen)]
pub struct CoreFirmware {
    artifacts: Artifacts,
    design: Design,
    device: Device,
}

#[pymethods]
impl CoreFirmware {
    /// Text of `echocal_correction.h`.
    #[getter]
    fn header(&self) -> &str {
        &self.artifacts.header
    }

    /// Text of `echocal_correction.c`.
    #[getter]
    fn source(&self) -> &str {
        &self.artifacts.source
    }

    /// Text of `echocal_golden.csv`.
    #[getter]
    fn golden(&self) -> &str {
        &self.artifacts.golden
    }

    /// Text of `report.json`.
    #[getter]
    fn report(&self) -> &str {
        &self.artifacts.report
    }

    /// Outputs \[um\] of the twin for columns of codes of equal length, the echo time first.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        codes: Vec<PyReadonlyArray1<'py, i64>>,
    ) -> Bound<'py, PyArray1<i32>> {
        let rows = codes.first().map_or(0, |column| column.as_array().len());
        let row = |row: usize| -> i32 {
            let inputs: Vec<i64> = codes.iter().map(|column| column.as_array()[row]).collect();
            self.design.output(&self.device, &inputs)
        };
        PyArray1::from_iter(py, (0..rows).map(row))
    }
}

/// What Python asks for.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Wish {
    target: String,
    prefer: String,
    form: Option<String>,
    temperature: (f64, f64, f64, f64),
    humidity: Option<(f64, f64, f64)>,
    echo_max_us: i64,
    maximum_error: f64,
    maximum_distance: f64,
    maximum_table: usize,
    threads: usize,
    accept: Vec<String>,
    assumed: Vec<f64>,
    command: String,
    model_hash: String,
}

/// Design, prove and write a firmware; `progress(form, checked, total)` is told of each candidate and its proof.
#[pyfunction]
pub fn design_firmware(
    py: Python<'_>,
    model: &CoreModel,
    wish: Wish,
    progress: Option<Py<PyAny>>,
) -> PyResult<CoreFirmware> {
    let model = &model.model;
    let mut interrupted = None;
    let result = py.detach(|| {
        fulfil(model, &wish, &mut |form, checked, total| {
            let told = Python::attach(|py| {
                py.check_signals()?;
                let call = |told: &Py<PyAny>| told.call1(py, (form, checked, total)).map(drop);
                progress.as_ref().map_or(Ok(()), call)
            });
            interrupted = told.err();
            interrupted.is_none()
        })
    });
    interrupted.map_or_else(|| result.map_err(|error| to_python(&error)), Err)
}

fn fulfil(
    model: &echocal_core::Model,
    wish: &Wish,
    progress: &mut dyn FnMut(&str, u64, u64) -> bool,
) -> Result<CoreFirmware, Error> {
    let (lsb, low, high, zero) = wish.temperature;
    let mut device = Device {
        echo: Axis::echo(wish.echo_max_us)?,
        conditions: vec![Axis::temperature(lsb, low, high, zero)?],
    };
    if let Some((lsb, low, high)) = wish.humidity {
        device.conditions.push(Axis::humidity(lsb, low, high)?);
    }
    let assumed = Conditions::new(core::array::from_fn(|quantity| wish.assumed[quantity]));
    let lowered = lower(
        model,
        &device,
        &assumed,
        &wish.accept,
        wish.maximum_distance,
    )?;
    let request = Request {
        reference: &lowered,
        device: &device,
        maximum_error: wish.maximum_error,
        maximum_distance: wish.maximum_distance,
        maximum_table: wish.maximum_table,
        form: wish.form.as_deref(),
        target: Target::parse(&wish.target)?,
        prefer: Prefer::parse(&wish.prefer)?,
        threads: wish.threads,
    };
    let mut form = String::new();
    let design = design(request, &mut |event| match event {
        Progress::Candidate(candidate) => {
            candidate.clone_into(&mut form);
            progress(&form, 0, device.inputs())
        }
        Progress::Checked(checked) => progress(&form, checked, device.inputs()),
    })?;
    let provenance = Provenance {
        version: env!("CARGO_PKG_VERSION").into(),
        command: wish.command.clone(),
        target: wish.target.clone(),
        prefer: wish.prefer.clone(),
        model_hash: wish.model_hash.clone(),
        model: describe(model),
        assumptions: lowered.omissions.iter().map(ToString::to_string).collect(),
        maximum_error: wish.maximum_error,
        maximum_distance: wish.maximum_distance,
    };
    let artifacts = emit(&design, &device, &provenance)?;
    Ok(CoreFirmware {
        artifacts,
        design,
        device,
    })
}

fn to_python(error: &Error) -> PyErr {
    let class = match error {
        Error::Codes(_) | Error::Request(_) | Error::Refused(_) => "UsageError",
        Error::Model(_) => "ModelError",
        Error::Bound(_) => "BoundError",
        Error::Stopped | Error::Proof(_) | Error::Template(_) => "EchocalError",
    };
    raise(class, error.to_string())
}

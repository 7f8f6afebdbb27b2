//! Firmware: a request in, texts and the bit-exact twin out.

use echocal_core::{Conditions, Quantity};
use echocal_firmware::emit::{air_files, unit_files};
use echocal_firmware::lower::{Lowered, Omission, describe, lower, lower_without_echo};
use echocal_firmware::output::OUTPUTS;
use echocal_firmware::target;
use echocal_firmware::{
    Axis, Design, Device, Error, Filter, Measurement, Output, Package, Prefer, Progress,
    Provenance, Request, Target, Uncertainty, design, emit,
};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::sync::Arc;

use crate::border::{Column, same_length};
use crate::errors::raise;
use crate::firmware_request::{Condition, Further, Measured, Scale, StatedUncertainty, conditions};
use crate::model::CoreModel;

/// Outputs of rows \[um\].
type Outputs<'py> = Bound<'py, PyArray1<i32>>;
/// Statuses of rows.
type Statuses<'py> = Bound<'py, PyArray1<u8>>;

/// Path and text of each file.
type Files = Vec<(String, String)>;

/// A proven design, its texts and its twin.
#[pyclass(name = "Firmware", module = "echocal._core", frozen)]
pub struct CoreFirmware {
    design: Arc<Design>,
    provenance: Provenance,
    device: Device,
}

#[pymethods]
impl CoreFirmware {
    /// Path and text of each file; what was measured goes into header and report.
    fn files(
        &self,
        measured: Vec<Measured>,
        uncertainty: Option<StatedUncertainty>,
    ) -> PyResult<Files> {
        let measured: Vec<_> = measured.into_iter().map(Measurement::from).collect();
        let uncertainty = uncertainty.map_or_else(Uncertainty::default, Uncertainty::from);
        let (design, device) = (&self.design, &self.device);
        emit(design, device, &self.provenance, &measured, &uncertainty)
            .map_err(|error| to_python(&error))
    }

    /// Path and text of the files for the parameters of single units; `layout` holds their integers, as JSON.
    fn unit_files(&self, layout: &str) -> PyResult<Files> {
        unit_files(&self.device, &self.provenance.name, layout).map_err(|error| to_python(&error))
    }

    /// Path and text of the files for a thermometer that lags; `layout` holds their integers, as JSON.
    fn air_files(&self, layout: &str) -> PyResult<Files> {
        air_files(&self.device, &self.provenance.name, layout).map_err(|error| to_python(&error))
    }

    /// Bytes and cycles (or instructions) by the cost model that ranked this design. Not measured.
    fn ranked_by(&self) -> PyResult<(u64, u64)> {
        let target = Target::parse(&self.provenance.target).map_err(|error| to_python(&error))?;
        let cost = target.expected(&self.design.program);
        Ok((cost.size.div_ceil(10), cost.time.div_ceil(10)))
    }

    /// The kinds of step in the function and how many there are of each: the input of the cost model.
    fn steps(&self) -> Vec<(&'static str, u32)> {
        let counts = target::features(&self.design.program);
        target::FEATURES.into_iter().zip(counts).collect()
    }

    /// Outputs and statuses of the median filter for measurements in order; none if there is no filter.
    fn filtered<'py>(
        &self,
        py: Python<'py>,
        distances: Column<'py, i32>,
        statuses: Column<'py, u8>,
    ) -> PyResult<Option<(Outputs<'py>, Statuses<'py>)>> {
        let lengths = [("distances", distances.len()), ("statuses", statuses.len())];
        let rows = same_length(&lengths)?;
        let Some(filter) = &self.provenance.filter else {
            return Ok(None);
        };
        let found = filter.run((0..rows).map(|row| (distances[row], statuses[row])));
        let outputs = PyArray1::from_iter(py, found.iter().map(|(output, _)| *output));
        let statuses = PyArray1::from_iter(py, found.iter().map(|(_, status)| *status));
        Ok(Some((outputs, statuses)))
    }

    /// Outputs and statuses of the twin for columns of codes of equal length, the echo time first.
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        codes: Vec<Column<'py, i64>>,
    ) -> PyResult<(Outputs<'py>, Statuses<'py>)> {
        let names: Vec<&str> = self.device.axes().map(|axis| &*axis.name).collect();
        if codes.len() != names.len() {
            let (takes, got) = (names.len(), codes.len());
            let message = format!("the function takes {takes} codes, but got {got}");
            return Err(PyValueError::new_err(message));
        }
        let lengths = codes.iter().map(|column| column.len());
        let lengths: Vec<_> = names.into_iter().zip(lengths).collect();
        let rows = same_length(&lengths)?;
        let inputs = |row| -> Vec<i64> { codes.iter().map(|column| column[row]).collect() };
        let output = |row| self.design.output(&self.device, &inputs(row));
        let status = |row| self.device.status(&inputs(row)) as u8;
        let outputs = PyArray1::from_iter(py, (0..rows).map(output));
        Ok((outputs, PyArray1::from_iter(py, (0..rows).map(status))))
    }
}

/// The request from Python.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct FirmwareRequest {
    target: String,
    package: String,
    prefer: String,
    form: Option<String>,
    temperature: Condition,
    /// In place of those codes: the first code, temperatures from it on \[degC\], and words.
    thermistor: Option<Scale>,
    humidity: Option<Condition>,
    further: Option<Further>,
    /// Tick, shortest and longest echo time \[us\], bits of the timer.
    echo: (f64, f64, f64, u32),
    output_unit: String,
    output_type: Option<String>,
    maximum_error: f64,
    maximum_distance: f64,
    maximum_table: usize,
    widest: u32,
    threads: usize,
    accept: Vec<String>,
    assumed: [f64; Quantity::COUNT],
    /// Window and gate \[m\] of a median filter.
    median: Option<(usize, Option<f64>)>,
    name: String,
    command: String,
    model_hash: String,
    diagnosis: Vec<String>,
    standard_uncertainty: Vec<(f64, f64)>,
    fitted: Vec<String>,
    outside_domain: Vec<String>,
}

/// Names of targets: those with a core of their own, and those that the C of the first is for, too.
#[pyfunction]
pub fn firmware_targets() -> (Vec<&'static str>, Vec<&'static str>) {
    let own = target::TARGETS.iter().map(|target| target.name);
    (own.collect(), target::ALSO.to_vec())
}

/// Names of the units of an output, each with the end of the function's name.
#[pyfunction]
pub fn output_units() -> Vec<(&'static str, &'static str)> {
    let names = OUTPUTS.iter().map(|output| (output.unit, output.suffix()));
    names.collect()
}

/// What the echo times of a device depend on.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct EchoTimesRequest {
    temperature: Condition,
    /// In place of those codes: the first code, temperatures from it on \[degC\], and words.
    thermistor: Option<Scale>,
    humidity: Option<Condition>,
    further: Option<Further>,
    maximum_distance: f64,
    accept: Vec<String>,
    assumed: [f64; Quantity::COUNT],
}

/// The least and the greatest echo time \[s\] at each of `distances` \[m\], over all conditions that the device accepts.
#[pyfunction]
pub fn echo_times(
    py: Python<'_>,
    model: &CoreModel,
    request: EchoTimesRequest,
    distances: Vec<f64>,
) -> PyResult<Vec<(f64, f64)>> {
    let model = &model.model;
    let mut interrupted = None;
    let found = py.detach(|| {
        let conditions = conditions(
            request.temperature,
            &request.thermistor,
            request.humidity,
            &request.further,
        )?;
        let assumed = Conditions::new(request.assumed);
        let (accept, far) = (&request.accept, request.maximum_distance);
        let lowered = lower_without_echo(model, &conditions, &assumed, accept, far)?;
        let times = lowered.echo_times(&conditions, &distances, &mut || {
            interrupted = Python::attach(|py| py.check_signals()).err();
            interrupted.is_none()
        });
        times.ok_or(Error::Stopped)
    });
    interrupted.map_or_else(|| found.map_err(|error| to_python(&error)), Err)
}

/// Design, prove and write a firmware. `progress(form, checked, total)` is called for each candidate and during its proof.
#[pyfunction]
pub fn design_firmware(
    py: Python<'_>,
    model: &CoreModel,
    request: FirmwareRequest,
    progress: Option<Py<PyAny>>,
) -> PyResult<CoreFirmware> {
    let model = &model.model;
    let mut interrupted = None;
    let result = py.detach(|| {
        meet(model, &request, &mut |form, checked, total| {
            let told = Python::attach(|py| {
                py.check_signals()?;
                let call = |told: &Py<PyAny>| told.call1(py, (form, checked, total)).map(drop);
                progress.as_ref().map_or(Ok(()), call)
            });
            interrupted = told.err();
            interrupted.is_none()
        })
    });
    interrupted.map_or_else(|| result.map_err(|failure| failure.raise(py)), Err)
}

/// The reason why no firmware was generated; if it is the error bound, the firmware with the smallest error.
struct Failure {
    error: Error,
    best: Option<Box<CoreFirmware>>,
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self { error, best: None }
    }
}

impl Failure {
    fn raise(self, py: Python<'_>) -> PyErr {
        let raised = to_python(&self.error);
        let told = self
            .best
            .map_or(Ok(()), |best| raised.value(py).setattr("best", *best));
        told.err().unwrap_or(raised)
    }
}

/// What the device measures.
fn device(request: &FirmwareRequest) -> Result<Device, Error> {
    let (tick, shortest, longest, bits) = request.echo;
    Ok(Device {
        echo: Axis::timer(tick, shortest, longest, bits)?,
        conditions: conditions(
            request.temperature,
            &request.thermistor,
            request.humidity,
            &request.further,
        )?,
        output: Output::parse(&request.output_unit)?.typed(request.output_type.as_deref())?,
    })
}

fn lowered(
    model: &echocal_core::Model,
    device: &Device,
    request: &FirmwareRequest,
) -> Result<Lowered, Error> {
    let assumed = Conditions::new(request.assumed);
    lower(
        model,
        device,
        &assumed,
        &request.accept,
        request.maximum_distance,
    )
}

fn meet(
    model: &echocal_core::Model,
    request: &FirmwareRequest,
    progress: &mut dyn FnMut(&str, u64, u64) -> bool,
) -> Result<CoreFirmware, Failure> {
    let package = Package::parse(&request.package)?; // before the proof, which may take a minute
    let device = device(request)?;
    package.check(&device)?;
    let filter = request.median.map(|(window, gate)| {
        package.check_filter()?;
        Filter::new(window, gate, &device.output)
    });
    let filter = filter.transpose()?;
    let lowered = lowered(model, &device, request)?;
    let search = Request {
        reference: &lowered,
        device: &device,
        maximum_error: request.maximum_error,
        maximum_distance: request.maximum_distance,
        maximum_table: request.maximum_table,
        widest: request.widest,
        form: request.form.as_deref(),
        target: Target::parse(&request.target)?,
        prefer: Prefer::parse(&request.prefer)?,
        threads: request.threads,
    };
    let mut form = String::new();
    let found = design(search, &mut |event| match event {
        Progress::Candidate(candidate) => {
            candidate.clone_into(&mut form);
            progress(&form, 0, device.inputs())
        }
        Progress::Checked(checked) => progress(&form, checked, device.inputs()),
    });
    let provenance = Provenance {
        version: env!("CARGO_PKG_VERSION").into(),
        name: request.name.clone(),
        command: request.command.clone(),
        target: request.target.clone(),
        package: request.package.clone(),
        prefer: request.prefer.clone(),
        model_hash: request.model_hash.clone(),
        model: describe(model),
        diagnosis: request.diagnosis.clone(),
        standard_uncertainty: request.standard_uncertainty.clone(),
        fitted: request.fitted.clone(),
        outside_domain: request.outside_domain.clone(),
        filter,
        resolution: lowered.resolution(&device, request.maximum_distance),
        assumptions: lowered.omissions.iter().map(ToString::to_string).collect(),
        omissions: lowered.omissions.iter().map(Omission::to_json).collect(),
        maximum_error: request.maximum_error,
        maximum_distance: request.maximum_distance,
    };
    let firmware = |design| CoreFirmware {
        design,
        provenance,
        device,
    };
    match found {
        Ok(design) => Ok(firmware(Arc::new(design))),
        Err(failure) => {
            let best = failure
                .best
                .map(|design| Box::new(firmware(Arc::from(design))));
            let error = failure.error;
            Err(Failure { error, best })
        }
    }
}

fn to_python(error: &Error) -> PyErr {
    let class = match error {
        Error::Codes(_) | Error::Request(_) | Error::Refused(_) => "UsageError",
        Error::Model(_) => "ModelError",
        Error::Bound(_) => "BoundError",
        Error::Stopped | Error::Proof(_) | Error::Beyond(_) | Error::Template(_) => "EchocalError",
    };
    raise(class, error.to_string())
}

//! Models over arrays.

use std::iter;
use std::sync::OnceLock;

use echocal_core::batch::{ModelOutput, available_threads, jacobian, of_model};
use echocal_core::{Law, Model, Quantity};
use numpy::prelude::*;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::batch::{ANY, Entry, Input, Label, Options, Threads, call, range_of};
use crate::border::{Column, same_length};
use crate::errors::to_python;
use crate::laws::LawText;

/// A law with effects, evaluated over columns of equal length.
#[pyclass(name = "Model", module = "echocal._core", frozen)]
pub struct CoreModel {
    pub(crate) model: Model,
    entries: [OnceLock<Entry>; 5],
}

/// One value or column per influence quantity; None where it was not recorded.
type RecordedQuantities<'py> = [Option<Bound<'py, PyAny>>; Quantity::COUNT];

#[pymethods]
impl CoreModel {
    /// `effects`: pairs of id and pairs of parameter name and value.
    #[new]
    fn new(law: LawText<'_>, effects: Vec<(String, Vec<(String, f64)>)>) -> PyResult<Self> {
        let law = Law::parse(law.0).map_err(|e| to_python(&e))?;
        let mut model = Model::new(law);
        for (id, parameters) in &effects {
            let parameters: Vec<_> = parameters.iter().map(|(n, v)| (n.as_str(), *v)).collect();
            model = model.with(id, &parameters).map_err(|e| to_python(&e))?;
        }
        Ok(Self {
            model,
            entries: Default::default(),
        })
    }

    /// The law's name or expression, normalized.
    #[getter]
    fn law(&self) -> String {
        self.model.law().text()
    }

    /// Names of the influence quantities that the law reacts to.
    #[getter]
    fn law_reads(&self) -> Vec<&'static str> {
        let reads = self.model.law().reads().iter();
        reads.map(|quantity| quantity.facts().name).collect()
    }

    /// Effect id with its parameter values in the order of its facts, in the order of the chain.
    #[getter]
    fn terms(&self) -> Vec<(&'static str, Vec<f64>)> {
        let terms = self.model.terms().iter();
        terms
            .map(|t| (t.facts().id, t.parameters.clone()))
            .collect()
    }

    /// Indication \[m\] at a true distance \[m\].
    #[pyo3(signature = (distance, conditions, out=None, n_threads=None))]
    fn indicate<'py>(
        &self,
        distance: &Bound<'py, PyAny>,
        conditions: RecordedQuantities<'py>,
        out: Option<&Bound<'py, PyAny>>,
        n_threads: Option<Threads>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.call(
            ModelOutput::Indication,
            ("distance", distance),
            &conditions,
            out,
            n_threads,
        )
    }

    /// Speed of sound on the path \[m/s\] at a true distance \[m\].
    #[pyo3(signature = (distance, conditions, out=None, n_threads=None))]
    fn speed_of_sound<'py>(
        &self,
        distance: &Bound<'py, PyAny>,
        conditions: RecordedQuantities<'py>,
        out: Option<&Bound<'py, PyAny>>,
        n_threads: Option<Threads>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.call(
            ModelOutput::SpeedOfSound,
            ("distance", distance),
            &conditions,
            out,
            n_threads,
        )
    }

    /// Recorded echo time \[s\] at a true distance \[m\].
    #[pyo3(signature = (distance, conditions, out=None, n_threads=None))]
    fn time_of_flight<'py>(
        &self,
        distance: &Bound<'py, PyAny>,
        conditions: RecordedQuantities<'py>,
        out: Option<&Bound<'py, PyAny>>,
        n_threads: Option<Threads>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.call(
            ModelOutput::TimeOfFlight,
            ("distance", distance),
            &conditions,
            out,
            n_threads,
        )
    }

    /// True distance \[m\] of an indication \[m\].
    #[pyo3(signature = (indication, conditions, out=None, n_threads=None))]
    fn correct<'py>(
        &self,
        indication: &Bound<'py, PyAny>,
        conditions: RecordedQuantities<'py>,
        out: Option<&Bound<'py, PyAny>>,
        n_threads: Option<Threads>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.call(
            ModelOutput::Correction,
            ("indication", indication),
            &conditions,
            out,
            n_threads,
        )
    }

    /// True distance \[m\] of a recorded echo time \[s\].
    #[pyo3(signature = (time, conditions, out=None, n_threads=None))]
    fn distance<'py>(
        &self,
        time: &Bound<'py, PyAny>,
        conditions: RecordedQuantities<'py>,
        out: Option<&Bound<'py, PyAny>>,
        n_threads: Option<Threads>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.call(
            ModelOutput::Distance,
            ("time", time),
            &conditions,
            out,
            n_threads,
        )
    }

    /// Derivatives of the indication: columns are the distance, then each parameter.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        distance: Column<'py, f64>,
        conditions: [Column<'py, f64>; Quantity::COUNT],
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let names = iter::once("distance").chain(Quantity::ALL.iter().map(|facts| facts.name));
        let columns: Vec<_> = names
            .zip(iter::once(&distance).chain(&conditions))
            .collect();
        let lengths: Vec<_> = columns.iter().map(|(name, c)| (*name, c.len())).collect();
        let rows = same_length(&lengths)?;
        let inputs: Vec<&[f64]> = columns.into_iter().map(|(_, column)| &**column).collect();
        let width = 1 + self.model.parameters().len();
        let found = py.detach(|| jacobian(&self.model, &inputs, available_threads()));
        PyArray1::from_vec(py, found).reshape([rows, width])
    }
}

impl CoreModel {
    fn call<'py>(
        &self,
        output: ModelOutput,
        (name, first): (&'static str, &Bound<'py, PyAny>),
        conditions: &RecordedQuantities<'py>,
        out: Option<&Bound<'py, PyAny>>,
        n_threads: Option<Threads>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = first.py();
        let quantities = Quantity::ALL.iter().zip(conditions);
        let recorded = quantities.map(|(facts, given)| Input {
            name: facts.name,
            given: given.as_ref(),
            default: facts.default.unwrap_or(f64::NAN),
            range: ANY, // the Python side tells the domain
            depth: 1,
        });
        let first = Input {
            name,
            given: Some(first),
            default: f64::NAN,
            range: range_of(name),
            depth: 3,
        };
        let inputs: Vec<_> = iter::once(first).chain(recorded).collect();
        let options = Options {
            out,
            condition: None,
            n_threads,
        };
        let label = label(output);
        let entry = self.entries[output as usize].get_or_init(|| {
            let name = format!("model_{}", label.name);
            Entry::new(name, of_model(self.model.clone(), output))
        });
        call(py, entry, label, &inputs, &options)
    }
}

fn label(output: ModelOutput) -> Label {
    let (name, unit) = match output {
        ModelOutput::Indication => ("indication", "m"),
        ModelOutput::SpeedOfSound => ("speed_of_sound", "m/s"),
        ModelOutput::TimeOfFlight => ("time_of_flight", "s"),
        ModelOutput::Correction | ModelOutput::Distance => ("distance", "m"),
    };
    Label { name, unit }
}

//! Models over arrays.

use echocal_core::{Conditions, Law, Model, Quantity};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::errors::to_python;

type Column<'py> = PyReadonlyArray1<'py, f64>;

/// A law with effects, evaluated over columns of equal length.
#[pyclass(name = "Model", module = "echocal._core", frozen)]
pub struct CoreModel {
    pub(crate) model: Model,
}

#[pymethods]
impl CoreModel {
    /// `effects`: pairs of id and pairs of parameter name and value.
    #[new]
    fn new(law: &str, effects: Vec<(String, Vec<(String, f64)>)>) -> PyResult<Self> {
        let law = Law::parse(law).map_err(|e| to_python(&e))?;
        let mut model = Model::new(law);
        for (id, parameters) in &effects {
            let parameters: Vec<_> = parameters.iter().map(|(n, v)| (n.as_str(), *v)).collect();
            model = model.with(id, &parameters).map_err(|e| to_python(&e))?;
        }
        Ok(Self { model })
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
    fn indicate<'py>(
        &self,
        py: Python<'py>,
        distance: Column<'py>,
        conditions: Vec<Column<'py>>,
    ) -> Bound<'py, PyArray1<f64>> {
        self.map(py, &distance, &conditions, Model::indicate)
    }

    /// Speed of sound on the path \[m/s\] at a true distance \[m\].
    fn speed_of_sound<'py>(
        &self,
        py: Python<'py>,
        distance: Column<'py>,
        conditions: Vec<Column<'py>>,
    ) -> Bound<'py, PyArray1<f64>> {
        self.map(py, &distance, &conditions, Model::speed_of_sound)
    }

    /// Recorded echo time \[s\] at a true distance \[m\].
    fn time_of_flight<'py>(
        &self,
        py: Python<'py>,
        distance: Column<'py>,
        conditions: Vec<Column<'py>>,
    ) -> Bound<'py, PyArray1<f64>> {
        self.map(py, &distance, &conditions, Model::time_of_flight)
    }

    /// True distance \[m\] of an indication \[m\].
    fn correct<'py>(
        &self,
        py: Python<'py>,
        indication: Column<'py>,
        conditions: Vec<Column<'py>>,
    ) -> Bound<'py, PyArray1<f64>> {
        self.map(py, &indication, &conditions, Model::correct)
    }

    /// True distance \[m\] of a recorded echo time \[s\].
    fn distance<'py>(
        &self,
        py: Python<'py>,
        time: Column<'py>,
        conditions: Vec<Column<'py>>,
    ) -> Bound<'py, PyArray1<f64>> {
        self.map(py, &time, &conditions, Model::distance)
    }

    /// Derivatives of the indication: columns are the distance, then each parameter.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        distance: Column<'py>,
        conditions: Vec<Column<'py>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> = rows(&distance, &conditions)
            .map(|(d, at)| self.model.jacobian(d, &at))
            .collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }
}

impl CoreModel {
    fn map<'py>(
        &self,
        py: Python<'py>,
        input: &Column<'py>,
        conditions: &[Column<'py>],
        function: impl Fn(&Model, f64, &Conditions<f64>) -> f64,
    ) -> Bound<'py, PyArray1<f64>> {
        let output = rows(input, conditions).map(|(x, at)| function(&self.model, x, &at));
        PyArray1::from_iter(py, output)
    }
}

/// The rows of an input column beside the columns of conditions, in the order of the quantities.
fn rows<'a>(
    input: &'a Column<'_>,
    conditions: &'a [Column<'_>],
) -> impl Iterator<Item = (f64, Conditions<f64>)> + 'a {
    let input = input.as_array();
    (0..input.len()).map(move |row| {
        let values = core::array::from_fn(|q| conditions[q].as_array()[row]);
        const { assert!(Quantity::COUNT > 0) };
        (input[row], Conditions::new(values))
    })
}

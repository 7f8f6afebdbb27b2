//! Laws, effects and quantities, as data.

use echocal_core::effects::{ALL, Facts, Firmware, Role, Tried};
use echocal_core::{Law, Quantity};
use pyo3::prelude::*;
use pyo3::types::PyDict;

fn names(quantities: &[Quantity]) -> Vec<&'static str> {
    quantities.iter().map(|q| q.facts().name).collect()
}

/// Facts of every effect, in the order of the registry.
#[pyfunction]
pub fn effects(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    ALL.iter().map(|facts| effect(py, facts)).collect()
}

fn effect<'py>(py: Python<'py>, facts: &Facts) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("id", facts.id)?;
    dict.set_item("stage", facts.stage.name())?;
    dict.set_item("sentence", facts.sentence)?;
    dict.set_item("formula", facts.formula)?;
    dict.set_item("source", facts.source)?;
    dict.set_item("reads", names(facts.reads))?;
    dict.set_item("requires", names(facts.requires))?;
    dict.set_item("excludes", names(facts.excludes))?;
    dict.set_item("supplies", facts.supplies.map(|q| q.facts().name))?;
    dict.set_item("calls", facts.calls)?;
    dict.set_item("extends", facts.extends.to_vec())?;
    dict.set_item("edges", facts.edges)?;
    dict.set_item("recurs", facts.recurs)?;
    dict.set_item("prior", facts.prior)?;
    dict.set_item("domain", facts.domain)?;
    dict.set_item("check", facts.check)?;
    let (form, detail) = match facts.firmware {
        Firmware::Folded => ("folded", None),
        Firmware::Needs(quantity) => ("needs", Some(quantity.facts().name)),
        Firmware::Refused(reason) => ("refused", Some(reason)),
    };
    dict.set_item("firmware", form)?;
    dict.set_item("firmware_detail", detail)?;
    let parameters: PyResult<Vec<_>> = facts
        .parameters
        .iter()
        .map(|p| {
            let dict = PyDict::new(py);
            dict.set_item("name", p.name)?;
            dict.set_item("unit", p.unit)?;
            let role = match p.role {
                Role::Size => "size",
                Role::Shape => "shape",
            };
            dict.set_item("role", role)?;
            dict.set_item("neutral", p.neutral)?;
            dict.set_item("bounds", p.bounds)?;
            dict.set_item("prior_scale", p.prior_scale)?;
            dict.set_item("known", p.known.to_vec())?;
            let (along, tried) = match p.tried {
                Tried::Nothing => (None, &[][..]),
                Tried::Values(values) => (None, values),
                Tried::DistanceQuantiles(quantiles) => (Some("distance"), quantiles),
                Tried::Quantiles(quantity, quantiles) => (Some(quantity.facts().name), quantiles),
            };
            dict.set_item("tried", tried.to_vec())?;
            dict.set_item("tried_along", along)?;
            dict.set_item("tail", p.tail)?;
            dict.set_item("over", p.over.map(|(q, range)| (q.facts().name, range)))?;
            dict.set_item("divides", p.divides.map(|q| q.facts().name))?;
            Ok(dict)
        })
        .collect();
    dict.set_item("parameters", parameters?)?;
    Ok(dict)
}

/// Facts of every law.
#[pyfunction]
pub fn laws(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let all = Law::ALL.iter().map(|facts| {
        let dict = PyDict::new(py);
        dict.set_item("id", facts.id)?;
        dict.set_item("sentence", facts.sentence)?;
        dict.set_item("formula", facts.formula)?;
        dict.set_item("source", facts.source)?;
        dict.set_item("reads", names(facts.reads))?;
        dict.set_item("domain", facts.domain)?;
        Ok(dict)
    });
    all.collect()
}

/// Influence quantities in the order in which models take them.
#[pyfunction]
pub fn quantities(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let all = Quantity::ALL.iter().map(|facts| {
        let dict = PyDict::new(py);
        dict.set_item("name", facts.name)?;
        dict.set_item("unit", facts.unit)?;
        dict.set_item("default", facts.default)?;
        dict.set_item("derived_from", facts.derived_from)?;
        dict.set_item("field_range", facts.field)?;
        dict.set_item("field_from", facts.field_from.map(|q| q.facts().name))?;
        Ok(dict)
    });
    all.collect()
}

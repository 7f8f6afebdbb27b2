//! What the tests of single effects share.

use crate::{Conditions, Law, Model};

/// A law with one effect.
pub(super) fn model(law: &str, id: &str, parameters: &[(&str, f64)]) -> Model {
    let law = Law::parse(law).unwrap();
    Model::new(law).with(id, parameters).unwrap()
}

/// Indication minus distance of a law with one effect \[m\].
pub(super) fn error(
    law: &str,
    id: &str,
    parameters: &[(&str, f64)],
    distance: f64,
    recorded: &Conditions<f64>,
) -> f64 {
    model(law, id, parameters).indicate(distance, recorded) - distance
}

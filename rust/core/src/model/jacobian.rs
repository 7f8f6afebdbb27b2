//! Exact derivatives of the indication.

use super::{Model, constants};
use crate::conditions::Conditions;
use crate::dual::Dual;
use crate::scalar::Scalar;

impl Model {
    /// Derivatives of the indication: first to the distance, then to each parameter.
    #[must_use]
    pub fn jacobian(&self, distance: f64, recorded: &Conditions<f64>) -> Vec<f64> {
        const AT_ONCE: usize = 4; // with the distance, most effects; each more is another copy of all effects
        let values = self.parameters();
        let recorded = constants(recorded);
        let mut row = Vec::with_capacity(1 + values.len());
        while row.len() <= values.len() {
            let first = row.len();
            let seed = |position: usize, value| match position.checked_sub(first) {
                Some(index) if index < AT_ONCE => Dual::<AT_ONCE>::variable(value, index),
                _ => Dual::constant(value),
            };
            let parameters: Vec<_> = values
                .iter()
                .enumerate()
                .map(|(i, &value)| seed(i + 1, value))
                .collect();
            let chain = self.simulate(seed(0, distance), &recorded, &parameters);
            let count = AT_ONCE.min(1 + values.len() - first);
            row.extend_from_slice(&chain.indication.derivatives[..count]);
        }
        row
    }
}

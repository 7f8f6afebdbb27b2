//! The zero of the ruler is not the acoustic center.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`ZeroError::FACTS`].
pub struct ZeroError;

impl Effect for ZeroError {
    const FACTS: Facts = Facts {
        id: "zero_error",
        stage: Stage::Path,
        sentence: "The ruler's zero is not the acoustic center, so every distance is off by a constant.",
        formula: "d' = d + offset",
        source: "holodeck2.blogspot.com, URS - Calibration (about 6 mm seen)",
        reads: &[],
        parameters: &[ParameterFacts {
            name: "offset",
            unit: "m",
            neutral: 0.0,
            bounds: (-0.1, 0.1),
            prior_scale: 5e-3,
            known: &[],
        }],
        supplies: None,
        domain: "any",
        firmware: Firmware::Folded,
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.path = chain.path + parameters[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::model::Model;
    use crate::{Conditions, Law};

    #[test]
    fn five_millimeters_stay_five_millimeters() {
        let model = Model::new(Law::parse("cramer").unwrap())
            .with("zero_error", &[("offset", 5e-3)])
            .unwrap();
        for temperature in [0.0, 20.0, 50.0] {
            let indication = model.indicate(2.0, &Conditions::at(temperature));
            assert!((indication - 2.005).abs() < 1e-12);
        }
    }
}

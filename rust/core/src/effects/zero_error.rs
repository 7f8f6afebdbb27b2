//! The zero of the ruler is not the acoustic center.

use super::{Effect, Facts, Firmware, ParameterFacts, Role};
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
        requires: &[],
        excludes: &[],
        supplies: None,
        calls: None,
        parameters: &[ParameterFacts {
            name: "offset",
            unit: "m",
            role: Role::Size,
            neutral: 0.0,
            bounds: (-0.1, 0.1),
            prior_scale: 5e-3,
            known: &[],
            ..ParameterFacts::USUAL
        }],
        domain: "any distance and air",
        check: "measure the zero again with a caliper; if there is one distance only, measure a second",
        firmware: Firmware::Folded,
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.path = chain.path + parameters[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    #[test]
    fn five_millimeters_are_five_millimeters() {
        let offset = &[("offset", 5e-3)];
        let error = error("cramer", "zero_error", offset, 2.0, &Conditions::at(20.0));
        assert!((error - 5e-3).abs() < 1e-15);
    }

    #[test]
    fn is_the_same_at_every_temperature_and_distance() {
        let at = |d, t| {
            let at = Conditions::at(t);
            error("cramer", "zero_error", &[("offset", -7e-3)], d, &at)
        };
        for (distance, temperature) in [(0.1, 0.0), (2.0, 50.0), (4.0, -20.0)] {
            assert!((at(distance, temperature) + 7e-3).abs() < 1e-14);
        }
    }
}

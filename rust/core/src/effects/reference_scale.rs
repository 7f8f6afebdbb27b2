//! A tape or printed ruler whose divisions are too far apart or too close.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`ReferenceScale::FACTS`].
pub struct ReferenceScale;

impl Effect for ReferenceScale {
    const FACTS: Facts = Facts {
        id: "reference_scale",
        stage: Stage::Path,
        sentence: "The ruler that the reference distances were read from is too short (positive) or too long.",
        formula: "d' = d / (1 + scale), where d is what the ruler says",
        source: "tapes and printed rulers 0.02 % to 0.3 % (general knowledge; class II tapes 0.02 %)",
        parameters: &[ParameterFacts {
            name: "scale",
            bounds: (-0.05, 0.05),
            prior_scale: 1e-3,
            ..ParameterFacts::USUAL
        }],
        check: "measure one distance with another ruler or a laser meter",
        firmware: Firmware::Refused(
            "the ruler is wrong and not the device: correct the reference distances and calibrate again",
        ),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.path = chain.path / (S::constant(1.0) + parameters[0]);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::{error, model};

    #[test]
    fn a_part_in_a_thousand_is_2_millimeters_at_2_meters() {
        let scale = &[("scale", 1e-3)];
        let error = error(
            "linear",
            "reference_scale",
            scale,
            2.0,
            &Conditions::at(20.0),
        );
        assert!((error - -2.0 * 1e-3 / 1.001).abs() < 1e-15);
    }

    #[test]
    fn the_echo_knows_the_true_distance_and_not_the_ruler() {
        let base = model("cramer", "reference_scale", &[]);
        let model = model("cramer", "reference_scale", &[("scale", 0.02)]);
        for at in [-10.0, 20.0, 50.0].map(Conditions::at) {
            let time = model.time_of_flight(1.02 * 1.5, &at);
            assert!((time / base.time_of_flight(1.5, &at) - 1.0).abs() < 1e-15);
        }
    }
}

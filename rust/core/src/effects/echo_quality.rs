//! A target that answers softer, where the device records how good the echo was.

use super::{Effect, Facts, Firmware, ParameterFacts, Role, Tried};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`EchoQuality::FACTS`].
pub struct EchoQuality;

impl Effect for EchoQuality {
    const FACTS: Facts = Facts {
        id: "echo_quality",
        stage: Stage::Transducer,
        sentence: "Grass, snow, rain or rough ground change where the echo comes from, and its recorded quality with it.",
        formula: "t' = t + 2 gain (q - reference) / c, with q the quality number as it was recorded",
        source: "soft ground returns a weaker leading edge, and a quality number says how weak: manual of the SR50A, \
                 152 to 210 good, up to 600 uncertain (general knowledge)",
        reads: &[Quantity::EchoQuality],
        requires: &[Quantity::EchoQuality],
        parameters: &[
            ParameterFacts {
                name: "gain",
                unit: "m",
                bounds: (-1.0, 1.0),
                // 10 mm over all that a table spans: the number has no unit
                prior_scale: 1e-4,
                over: Some((Quantity::EchoQuality, 100.0)),
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "reference",
                role: Role::Shape,
                neutral: 180.0,
                bounds: (-1e6, 1e6),
                prior_scale: 20.0,
                // where the distance is right: at the usual echo of a table, or at the best, at either end
                tried: Tried::Quantiles(Quantity::EchoQuality, &[0.05, 0.5, 0.95]),
                ..ParameterFacts::USUAL
            },
        ],
        domain: "one kind of device and of ground; a number that also follows the distance or the air says less",
        check: "lay a hard plate on the ground for a day",
        firmware: Firmware::Needs(Quantity::EchoQuality),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let worse = chain.recorded.get(Quantity::EchoQuality) - parameters[1];
        let later = S::constant(2.0) * worse / chain.speed;
        chain.time = parameters[0].mul_add(later, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(quality: f64, temperature: f64) -> f64 {
        let at = Conditions::at(temperature).with(Quantity::EchoQuality, quality);
        let given = [("gain", -8e-5), ("reference", 180.0)];
        1e3 * error("linear", "echo_quality", &given, 2.0, &at)
    }

    #[test]
    fn a_hundred_units_of_0_08_millimeters_are_8_millimeters() {
        assert!((millimeters(280.0, 20.0) - -8.0).abs() < 1e-9);
    }

    #[test]
    fn nothing_at_the_reference_and_the_same_in_any_air() {
        assert_eq!(millimeters(180.0, 20.0), 0.0);
        assert!((millimeters(160.0, -10.0) - millimeters(160.0, 40.0)).abs() < 1e-12);
    }
}

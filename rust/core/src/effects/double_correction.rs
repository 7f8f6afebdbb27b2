//! A temperature correction on top of a reading that has it already.

use super::{Effect, Facts, ParameterFacts, Role};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`DoubleCorrection::FACTS`].
pub struct DoubleCorrection;

impl Effect for DoubleCorrection {
    const FACTS: Facts = Facts {
        id: "double_correction",
        stage: Stage::Firmware,
        sentence: "A reading that the device had corrected for temperature was corrected once more.",
        formula: "c_device' = c_device (1 + weight (c_device / speed - 1)); weight 1 is the second correction",
        source: "distance_2 = distance_1 c(T) / speed; 343.4 m/s is 331.4 + 0.6 T at 20 degC; 331.4 m/s that of \
                 rangers whose readings are multiplied by sqrt(T / 273.15 K) (SR50)",
        parameters: &[
            ParameterFacts {
                name: "weight",
                bounds: (-1.0, 2.0), // room on both sides of 0 and 1 for a free fit
                known: &[1.0],
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "speed",
                unit: "m/s",
                role: Role::Shape,
                neutral: 343.4,
                bounds: (300.0, 400.0),
                prior_scale: 1.0,
                known: &[331.4, 340.0, 343.0, 343.4],
                ..ParameterFacts::USUAL
            },
        ],
        domain: "indications of a device whose law reads the temperature",
        check: "read the firmware, or compare echo time and indication at two temperatures",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let (weight, speed) = (parameters[0], parameters[1]);
        let surplus = (chain.firmware_speed / speed - S::constant(1.0)) * chain.firmware_speed;
        chain.firmware_speed = weight.mul_add(surplus, chain.firmware_speed);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    const TWICE: &[(&str, f64)] = &[("weight", 1.0), ("speed", 343.4)];

    #[test]
    fn minus_three_and_a_half_percent_at_0_degc_and_five_at_50() {
        for (temperature, speed) in [(0.0, 331.4), (20.0, 343.4), (50.0, 361.4)] {
            let error = error(
                "linear",
                "double_correction",
                TWICE,
                2.0,
                &Conditions::at(temperature),
            );
            assert!((error - 2.0 * (speed / 343.4 - 1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn undoes_a_fixed_speed_where_that_was_the_mistake() {
        // first order: the two have opposite signs
        for temperature in [19.0, 21.0] {
            let at = Conditions::at(temperature);
            let fixed = &[("weight", 1.0), ("speed", 343.4)];
            let fixed = error("linear", "fixed_speed", fixed, 2.0, &at);
            let twice = error("linear", "double_correction", TWICE, 2.0, &at);
            assert!((fixed + twice).abs() < 2e-3 * twice.abs());
        }
    }
}

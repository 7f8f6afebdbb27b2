//! A device that converts with one fixed speed of sound.

use super::{Effect, Facts, ParameterFacts, Role};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`FixedSpeed::FACTS`].
///
/// Linear in `weight` for each `speed`: a search runs over the few speeds in use and has a known
/// size 1 for each; a free fit of both is the device's intercept and slope.
pub struct FixedSpeed;

impl Effect for FixedSpeed {
    const FACTS: Facts = Facts {
        id: "fixed_speed",
        stage: Stage::Firmware,
        sentence: "The device converts with one fixed speed of sound at every temperature.",
        formula: "c_device' = c_device + weight (speed - c_device); weight 1 is the fixed speed alone",
        source: "340 and 343 m/s (adafruit_hcsr04, esphome 2212); cm = us / divisor is 20000 / divisor m/s: \
                 57 (NewPing), 58 or 29 for one way (Arduino), 58.2 or 29.1, 59, 60 in public HC-SR04 code",
        parameters: &[
            ParameterFacts {
                name: "weight",
                unit: "1",
                role: Role::Size,
                neutral: 0.0,
                bounds: (-1.0, 2.0), // room on both sides of 0 and 1 for a free fit
                prior_scale: 1.0,
                known: &[1.0],
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "speed",
                unit: "m/s",
                role: Role::Shape,
                neutral: 343.0,
                bounds: (300.0, 400.0),
                prior_scale: 5.0,
                known: &[
                    340.0,
                    343.0,
                    2e4 / 57.0,
                    2e4 / 58.0,
                    2e4 / 58.2,
                    2e4 / 59.0,
                    2e4 / 60.0,
                ],
                ..ParameterFacts::USUAL
            },
        ],
        domain: "indications of the device; recorded echo times do not know it",
        check: "read the firmware, or compare echo time and indication at two temperatures",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let (weight, speed) = (parameters[0], parameters[1]);
        chain.firmware_speed = weight.mul_add(speed - chain.firmware_speed, chain.firmware_speed);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::{error, model};

    const FIXED: &[(&str, f64)] = &[("weight", 1.0), ("speed", 343.0)];

    #[test]
    fn three_and_a_half_percent_at_0_degc_and_minus_five_at_50() {
        for (temperature, speed) in [(0.0, 331.4), (50.0, 361.4)] {
            let error = error(
                "linear",
                "fixed_speed",
                FIXED,
                2.0,
                &Conditions::at(temperature),
            );
            assert!((error - 2.0 * (343.0 / speed - 1.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_device_no_longer_sees_the_air_nor_the_law() {
        for (law, temperature) in [("linear", -20.0), ("cramer", 10.0), ("ideal_gas", 40.0)] {
            let (model, at) = (
                model(law, "fixed_speed", FIXED),
                Conditions::at(temperature),
            );
            let speed = 2.0 * model.indicate(1.5, &at) / model.time_of_flight(1.5, &at);
            assert!((speed - 343.0).abs() < 1e-12);
        }
    }
}

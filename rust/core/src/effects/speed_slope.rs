//! A wrong growth of the speed of sound with temperature.

use super::{Effect, Facts, Firmware, ParameterFacts, Role};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`SpeedSlope::FACTS`].
pub struct SpeedSlope;

impl Effect for SpeedSlope {
    const FACTS: Facts = Facts {
        id: "speed_slope",
        stage: Stage::Speed,
        sentence: "The true speed of sound grows with the air's temperature otherwise than the law says.",
        formula: "c' = c + slope T, T in degC",
        source: "0.59 to 0.61 m/s per K in public HC-SR04 code (arduino-lib-hc-sr04 PR 4, \
                 hcsr04-nodemcu PR 1)",
        reads: &[Quantity::Temperature],
        requires: &[Quantity::Temperature],
        excludes: &[],
        supplies: None,
        calls: None,
        parameters: &[ParameterFacts {
            name: "slope",
            unit: "m/(s K)",
            role: Role::Size,
            neutral: 0.0,
            bounds: (-0.5, 0.5),
            prior_scale: 0.02,
            known: &[],
            ..ParameterFacts::USUAL
        }],
        domain: "any distance and air",
        check: "check the thermometer at two temperatures; what remains is the slope",
        firmware: Firmware::Folded,
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.speed = parameters[0].mul_add(chain.air.temperature, chain.speed);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    fn at(slope: f64, temperature: f64) -> f64 {
        let at = Conditions::at(temperature);
        error("linear", "speed_slope", &[("slope", slope)], 2.0, &at)
    }

    #[test]
    fn six_hundredths_off_in_a_hundred() {
        // 0.606 in nature against 0.6 in the law: 0.12 m/s at 20 degC, 0.7 mm at 2 m
        assert!((at(0.006, 20.0) - -2.0 * 0.12 / 343.52).abs() < 1e-12);
    }

    #[test]
    fn vanishes_at_0_degc_and_changes_sign_there() {
        assert_eq!(at(0.02, 0.0), 0.0);
        assert!(at(0.02, 1.0) < 0.0 && at(0.02, -1.0) > 0.0);
    }
}

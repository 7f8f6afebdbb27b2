//! A wrong speed of sound at 0 degC.

use super::{Effect, Facts, Firmware, ParameterFacts, Role};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`SpeedIntercept::FACTS`].
pub struct SpeedIntercept;

impl Effect for SpeedIntercept {
    const FACTS: Facts = Facts {
        id: "speed_intercept",
        stage: Stage::Speed,
        sentence: "The true speed of sound differs from the law by a constant: a wrong speed at 0 degC.",
        formula: "c' = c + intercept",
        source: "330, 331.3, 331.4, 331.5 and 332 m/s in public HC-SR04 code \
                 (arduino-lib-hc-sr04 PR 4, esp-idf-lib PR 619, opencistern 3)",
        reads: &[],
        requires: &[],
        excludes: &[],
        supplies: None,
        calls: None,
        parameters: &[ParameterFacts {
            name: "intercept",
            unit: "m/s",
            role: Role::Size,
            neutral: 0.0,
            bounds: (-20.0, 20.0),
            prior_scale: 1.0,
            known: &[],
            ..ParameterFacts::USUAL
        }],
        domain: "any distance and air",
        check: "a second thermometer and a reference clock: what they leave over is the intercept",
        firmware: Firmware::Folded,
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.speed = chain.speed + parameters[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    #[test]
    fn one_meter_per_second_is_0_29_percent() {
        let at = Conditions::at(20.0);
        let error = error("linear", "speed_intercept", &[("intercept", 1.0)], 2.0, &at);
        // 2 m at 344.4 m/s, converted with 343.4 m/s: 5.8 mm short
        assert!((error - -2.0 / 344.4).abs() < 1e-12);
    }

    #[test]
    fn is_a_temperature_offset_where_the_law_is_linear() {
        for temperature in [-20.0, 0.0, 35.0] {
            let at = Conditions::at(temperature);
            let intercept = error("linear", "speed_intercept", &[("intercept", 0.6)], 2.0, &at);
            let offset = error("linear", "temperature_offset", &[("offset", 1.0)], 2.0, &at);
            assert!((intercept - offset).abs() < 1e-14);
        }
    }
}

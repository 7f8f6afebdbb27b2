//! A thermometer with a scale error.

use super::{Effect, Facts, Firmware, ParameterFacts, Role};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`TemperatureGain::FACTS`].
pub struct TemperatureGain;

impl Effect for TemperatureGain {
    const FACTS: Facts = Facts {
        id: "temperature_gain",
        stage: Stage::Air,
        sentence: "The thermometer has a scale error: the air is warmer by a part of the recorded degC.",
        formula: "T' = T + gain T_recorded, in degC; the device converts with the recorded T",
        source: "an LM35 read against a 5 V USB supply is off by the supply's few percent \
                 (general knowledge)",
        reads: &[Quantity::Temperature],
        requires: &[Quantity::Temperature],
        excludes: &[],
        supplies: None,
        calls: None,
        parameters: &[ParameterFacts {
            name: "gain",
            unit: "1",
            role: Role::Size,
            neutral: 0.0,
            bounds: (-0.5, 0.5),
            prior_scale: 0.03,
            known: &[],
            ..ParameterFacts::USUAL
        }],
        domain: "any distance and air",
        check: "put the thermometer into an ice bath and a warm bath",
        firmware: Firmware::Folded,
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        // of the recorded value: the order among the thermometer's errors does not matter
        let recorded = chain.recorded.get(Quantity::Temperature);
        chain.air.temperature = parameters[0].mul_add(recorded, chain.air.temperature);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    fn at(law: &str, temperature: f64) -> f64 {
        let at = Conditions::at(temperature);
        error(law, "temperature_gain", &[("gain", 0.03)], 2.0, &at)
    }

    #[test]
    fn three_percent_of_20_degc_are_2_1_millimeters_at_2_meters() {
        // 0.6 K warmer: 0.36 m/s faster than the 343.4 m/s of the device
        assert!((at("linear", 20.0) - -2.0 * 0.36 / 343.76).abs() < 1e-12);
    }

    #[test]
    fn vanishes_at_0_degc_and_is_a_speed_slope_where_the_law_is_linear() {
        assert_eq!(at("cramer", 0.0), 0.0);
        let same = &[("slope", 0.03 * 0.6)];
        for temperature in [-10.0, 20.0, 50.0] {
            let slope = error(
                "linear",
                "speed_slope",
                same,
                2.0,
                &Conditions::at(temperature),
            );
            assert!((at("linear", temperature) - slope).abs() < 1e-14);
        }
    }
}

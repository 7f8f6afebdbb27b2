//! A timer whose clock drifts with the temperature.

use super::{Effect, Facts, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`ClockTemperatureCoefficient::FACTS`].
pub struct ClockTemperatureCoefficient;

impl Effect for ClockTemperatureCoefficient {
    const FACTS: Facts = Facts {
        id: "clock_temperature_coefficient",
        stage: Stage::Timer,
        sentence: "The timer's clock runs faster (or slower) the further the temperature is from 25 degC.",
        formula: "t' = t (1 + coefficient (T - 25 degC))",
        source: "about 10 ppm/K, board with a ceramic resonator over 20 h (forum.arduino.cc 69316)",
        reads: &[Quantity::Temperature],
        requires: &[Quantity::Temperature],
        parameters: &[ParameterFacts {
            name: "coefficient",
            unit: "1/K",
            bounds: (-1e-3, 1e-3),
            prior_scale: 20e-6,
            ..ParameterFacts::USUAL
        }],
        domain: "a clock at the temperature of the air",
        check: "count a reference second (GPS, real-time clock) at two temperatures",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let warmer = chain.recorded.get(Quantity::Temperature) - S::constant(25.0);
        chain.time = (parameters[0] * warmer).mul_add(chain.time, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    fn millimeters(temperature: f64) -> f64 {
        let coefficient = &[("coefficient", 10e-6)];
        let at = Conditions::at(temperature);
        1e3 * error(
            "linear",
            "clock_temperature_coefficient",
            coefficient,
            2.0,
            &at,
        )
    }

    #[test]
    fn ten_ppm_a_kelvin_are_a_millimeter_at_2_meters_over_50_kelvin() {
        assert!((millimeters(50.0) - millimeters(0.0) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn vanishes_at_25_degc_and_is_odd_about_it() {
        assert_eq!(millimeters(25.0), 0.0);
        assert!((millimeters(35.0) + millimeters(15.0)).abs() < 1e-9);
    }
}

//! A thermometer that its own board warms.

use super::{Effect, Facts, Firmware, ParameterFacts, Role, Tried};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`TemperatureSelfHeating::FACTS`].
pub struct TemperatureSelfHeating;

impl Effect for TemperatureSelfHeating {
    const FACTS: Facts = Facts {
        id: "temperature_self_heating",
        stage: Stage::Air,
        sentence: "Since power-on the board warms the thermometer: the air is colder than recorded.",
        formula: "T' = T - rise (1 - exp(-s / time_constant)), with s the time since the first row",
        source: "LM35 below 0.1 K in still air (data sheet); a regulator beside it 0.5 to 3 K (general knowledge)",
        reads: &[Quantity::ElapsedTime],
        requires: &[Quantity::Temperature, Quantity::ElapsedTime],
        parameters: &[
            ParameterFacts {
                name: "rise",
                unit: "K",
                bounds: (0.0, 20.0),
                prior_scale: 1.0,
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "time_constant",
                unit: "s",
                role: Role::Shape,
                neutral: 600.0,
                bounds: (10.0, 1e5),
                prior_scale: 600.0,
                tried: Tried::Values(&[150.0, 300.0, 600.0, 1200.0, 2400.0]),
                ..ParameterFacts::USUAL
            },
        ],
        domain: "tables that begin at power-on, at the temperature of the air",
        check: "log from a cold start, or change the duty cycle",
        firmware: Firmware::Needs(Quantity::ElapsedTime),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let elapsed = chain.recorded.get(Quantity::ElapsedTime);
        let warmed = S::constant(1.0) - (-elapsed / parameters[1]).exp();
        chain.air.temperature = (-parameters[0]).mul_add(warmed, chain.air.temperature);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(elapsed: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::ElapsedTime, elapsed);
        let parameters = &[("rise", 1.0), ("time_constant", 600.0)];
        1e3 * error("linear", "temperature_self_heating", parameters, 2.0, &at)
    }

    #[test]
    fn a_kelvin_is_3_5_millimeters_at_2_meters_once_warm() {
        assert!((millimeters(1e6) - 2e3 * 0.6 / 342.8).abs() < 1e-9);
        let after_one = millimeters(600.0) / millimeters(1e6);
        assert!((after_one - (1.0 - (-1.0_f64).exp())).abs() < 1e-3);
    }

    #[test]
    fn nothing_at_the_cold_start_and_an_offset_after_warm_up() {
        assert_eq!(millimeters(0.0), 0.0);
        let offset = &[("offset", -1.0)];
        let offset = error(
            "linear",
            "temperature_offset",
            offset,
            2.0,
            &Conditions::at(20.0),
        );
        assert!((millimeters(1e5) - 1e3 * offset).abs() < 1e-9);
    }
}

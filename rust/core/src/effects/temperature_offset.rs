//! A thermometer that is off by a constant.

use super::{Effect, Facts, Firmware, ParameterFacts, Role};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`TemperatureOffset::FACTS`].
pub struct TemperatureOffset;

impl Effect for TemperatureOffset {
    const FACTS: Facts = Facts {
        id: "temperature_offset",
        stage: Stage::Air,
        sentence: "The thermometer is off by a constant: the air is warmer than recorded by the offset.",
        formula: "T' = T + offset; the device converts with the recorded T",
        source: "data sheets: DS18B20 and LM35 0.5 K, DHT11 2 K",
        reads: &[],
        requires: &[Quantity::Temperature],
        excludes: &[],
        supplies: None,
        calls: None,
        parameters: &[ParameterFacts {
            name: "offset",
            unit: "K",
            role: Role::Size,
            neutral: 0.0,
            bounds: (-20.0, 20.0),
            prior_scale: 1.0,
            known: &[],
            ..ParameterFacts::USUAL
        }],
        domain: "any distance and air",
        check: "a second thermometer in the sound path, or an ice bath",
        firmware: Firmware::Folded,
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.air.temperature = chain.air.temperature + parameters[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::{error, model};

    #[test]
    fn one_kelvin_is_3_5_millimeters_at_2_meters() {
        let at = Conditions::at(20.0);
        let error = error("linear", "temperature_offset", &[("offset", 1.0)], 2.0, &at);
        assert!((error - -2.0 * 0.6 / 344.0).abs() < 1e-12);
    }

    #[test]
    fn the_echo_sees_the_true_air_and_the_device_the_recorded_one() {
        let base = model("cramer", "temperature_offset", &[]);
        let warmer = model("cramer", "temperature_offset", &[("offset", 2.5)]);
        let (recorded, truth) = (Conditions::at(17.5), Conditions::at(20.0));
        let time = warmer.time_of_flight(2.0, &recorded);
        assert_eq!(time, base.time_of_flight(2.0, &truth));
        let speed = base.indicate(2.0, &recorded) / base.time_of_flight(2.0, &recorded);
        assert!((warmer.indicate(2.0, &recorded) - time * speed).abs() < 1e-15);
    }
}

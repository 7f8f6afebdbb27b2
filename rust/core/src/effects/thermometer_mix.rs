//! A path whose air is between two thermometers.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`ThermometerMix::FACTS`].
pub struct ThermometerMix;

impl Effect for ThermometerMix {
    const FACTS: Facts = Facts {
        id: "thermometer_mix",
        stage: Stage::Air,
        sentence: "The air on the path is between two thermometers, and only one of them was used.",
        formula: "T' = T + weight (T_2 - T), with T_2 the further thermometer",
        source: "arithmetic of a mean; the air over a warm or cold ground changes with height as in Monin and \
                 Obukhov 1954, so that no single thermometer has the mean of a path",
        reads: &[Quantity::Temperature, Quantity::SecondTemperature],
        requires: &[Quantity::Temperature, Quantity::SecondTemperature],
        parameters: &[ParameterFacts {
            name: "weight",
            // 0 to 1 is between the two. A recorded thermometer that feels 17 % of the box it hangs on has
            // -0.2; a second one that is sluggish or shaded has 1.2.
            bounds: (-0.2, 1.2),
            // nothing is known of where between them the path is: the rms of an even spread is 0.58
            prior_scale: 0.5,
            ..ParameterFacts::USUAL
        }],
        domain: "thermometers whose own errors are small beside their difference; temperature_lag beside it is what \
                 both follow late",
        check: "hang a shielded thermometer into the middle of the path for a day and a night",
        firmware: Firmware::Needs(Quantity::SecondTemperature),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        // of the recorded value: the order among the thermometer's errors does not matter
        let recorded = chain.recorded.get(Quantity::Temperature);
        let apart = chain.recorded.get(Quantity::SecondTemperature) - recorded;
        chain.air.temperature = parameters[0].mul_add(apart, chain.air.temperature);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn mixed(weight: f64, first: f64, second: f64) -> f64 {
        let at = Conditions::at(first).with(Quantity::SecondTemperature, second);
        error("linear", "thermometer_mix", &[("weight", weight)], 2.0, &at)
    }

    #[test]
    fn half_of_ten_kelvin_are_minus_17_millimeters_at_2_meters() {
        // 5 K warmer than recorded: 3 m/s faster than the 343.4 m/s of the device
        assert!((mixed(0.5, 20.0, 30.0) - -2.0 * 3.0 / 346.4).abs() < 1e-12);
    }

    #[test]
    fn all_of_it_is_the_other_thermometer_and_two_that_agree_are_one() {
        let other = 2.0 * ((331.4 + 0.6 * 20.0) / (331.4 + 0.6 * 26.0) - 1.0);
        assert!((mixed(1.0, 20.0, 26.0) - other).abs() < 1e-12);
        for weight in [-0.2, 0.3, 1.2] {
            assert_eq!(mixed(weight, 20.0, 20.0), mixed(0.0, 20.0, 20.0));
        }
    }
}

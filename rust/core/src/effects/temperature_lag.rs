//! A thermometer that follows the air late.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`TemperatureLag::FACTS`].
pub struct TemperatureLag;

impl Effect for TemperatureLag {
    const FACTS: Facts = Facts {
        id: "temperature_lag",
        stage: Stage::Air,
        sentence: "The thermometer follows the air with a time constant: warming air is warmer than recorded.",
        formula: "T' = T + time_constant dT/ds, from the recorded rate of change",
        source: "SMT160 data sheet: 60 s in still air; a screen without a fan 3 to 20 min (Harrison 2010, Q. J. R. \
                 Meteorol. Soc. 136, 253, doi:10.1002/qj.537): 95 % of the prior",
        reads: &[Quantity::TemperatureRate],
        requires: &[Quantity::Temperature, Quantity::TemperatureRate],
        parameters: &[ParameterFacts {
            name: "time_constant",
            unit: "s",
            bounds: (0.0, 7200.0),
            prior_scale: 600.0,
            ..ParameterFacts::USUAL
        }],
        domain: "rows closer in time than a few time constants",
        check: "sweep the temperature up and down, or step it",
        firmware: Firmware::Needs(Quantity::TemperatureRate),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let rate = chain.recorded.get(Quantity::TemperatureRate);
        chain.air.temperature = parameters[0].mul_add(rate, chain.air.temperature);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(rate: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::TemperatureRate, rate);
        1e3 * error(
            "linear",
            "temperature_lag",
            &[("time_constant", 150.0)],
            2.0,
            &at,
        )
    }

    #[test]
    fn a_kelvin_in_150_seconds_is_minus_3_5_millimeters_at_2_meters() {
        assert!((millimeters(1.0 / 150.0) - -2e3 * 0.6 / 344.0).abs() < 1e-9);
    }

    #[test]
    fn changes_sign_between_heating_and_cooling_and_vanishes_at_rest() {
        assert_eq!(millimeters(0.0), 0.0);
        let (up, down) = (millimeters(1e-3), millimeters(-1e-3));
        assert!((up + down).abs() < 1e-3 * up.abs() && up < 0.0);
    }

    #[test]
    fn undoes_a_first_order_lag_exactly() {
        // a body that follows a ramp of 0.02 K/s from balance: B = A - r tau (1 - exp(-s/tau))
        let (ramp, constant, elapsed) = (0.02_f64, 150.0, 90.0);
        let behind = ramp * constant * (1.0 - f64::exp(-elapsed / constant));
        let at = Conditions::at(20.0 - behind).with(Quantity::TemperatureRate, behind / constant);
        let model = crate::effects::testing::model(
            "linear",
            "temperature_lag",
            &[("time_constant", constant)],
        );
        assert!((model.speed_of_sound(2.0, &at) - 343.4).abs() < 1e-12);
    }
}

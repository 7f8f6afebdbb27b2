//! A supply voltage that shifts the comparator.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`SupplyVoltage::FACTS`].
pub struct SupplyVoltage;

impl Effect for SupplyVoltage {
    const FACTS: Facts = Facts {
        id: "supply_voltage",
        stage: Stage::Transducer,
        sentence: "Burst and threshold move with the supply: below 5 V the echo is detected later.",
        formula: "t' = t + slope (5 V - V)",
        source: "0 to 100 us/V (general knowledge); gross failures of a sagging rail: forum.arduino.cc 593047",
        reads: &[Quantity::SupplyVoltage],
        requires: &[Quantity::SupplyVoltage],
        parameters: &[ParameterFacts {
            name: "slope",
            unit: "s/V",
            bounds: (-1e-3, 1e-3),
            prior_scale: 60e-6,
            ..ParameterFacts::USUAL
        }],
        domain: "5 V sensors between brown-out and 5.5 V; another nominal voltage is one with a fixed delay",
        check: "vary the supply on purpose",
        firmware: Firmware::Needs(Quantity::SupplyVoltage),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let lower = S::constant(5.0) - chain.recorded.get(Quantity::SupplyVoltage);
        chain.time = parameters[0].mul_add(lower, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn error_at(voltage: f64, distance: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::SupplyVoltage, voltage);
        error(
            "linear",
            "supply_voltage",
            &[("slope", 60e-6)],
            distance,
            &at,
        )
    }

    #[test]
    fn sixty_microseconds_a_volt_are_5_millimeters_half_a_volt_low() {
        // 1 us is 0.172 mm at 20 degC
        assert!((1e3 * error_at(4.5, 2.0) - 30.0 * 0.1717).abs() < 1e-9);
    }

    #[test]
    fn nothing_at_5_volts_and_the_same_at_every_distance() {
        assert!(error_at(5.0, 2.0).abs() < 1e-15);
        assert!((error_at(4.0, 0.2) - error_at(4.0, 8.0)).abs() < 1e-14);
    }
}

//! A device that takes the speed of sound for proportional to the root of the pressure.

use super::pressure::STANDARD;
use super::{Effect, Facts, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`PressureSqrtLaw::FACTS`].
pub struct PressureSqrtLaw;

impl Effect for PressureSqrtLaw {
    const FACTS: Facts = Facts {
        id: "pressure_sqrt_law",
        stage: Stage::Firmware,
        sentence: "The device scales the speed of sound with the square root of the pressure, which air does not.",
        formula: "c_device' = c_device (1 + coefficient (sqrt(p / 101325 Pa) - 1)); 1 is the mistake in full",
        source: "Laplace's c = sqrt(gamma p / rho) with rho held constant, as in the study's pressure correction",
        reads: &[Quantity::Pressure],
        requires: &[Quantity::Pressure],
        parameters: &[ParameterFacts::COEFFICIENT],
        domain: "indications of the device; recorded echo times do not know it",
        check: "compare indications at two altitudes, or read the firmware",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let ratio = chain.recorded.get(Quantity::Pressure) * S::constant(1.0 / STANDARD);
        let surplus = (ratio.sqrt() - S::constant(1.0)) * chain.firmware_speed;
        chain.firmware_speed = parameters[0].mul_add(surplus, chain.firmware_speed);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(pressure: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::Pressure, pressure);
        1e3 * error(
            "linear",
            "pressure_sqrt_law",
            &[("coefficient", 1.0)],
            2.0,
            &at,
        )
    }

    #[test]
    fn ten_millimeters_a_kilopascal_at_2_meters() {
        let slope = millimeters(101_825.0) - millimeters(100_825.0);
        assert!((slope - 9.9).abs() <= 0.05, "{slope}");
    }

    #[test]
    fn four_times_the_pressure_is_twice_the_indication() {
        assert_eq!(millimeters(101_325.0), 0.0);
        assert!((millimeters(4.0 * 101_325.0) - 2000.0).abs() < 1e-9);
    }
}

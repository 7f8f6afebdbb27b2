//! A thermometer in the sun.

use super::{Effect, Facts, Firmware, ParameterFacts, Role, Tried};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`TemperatureRadiation::FACTS`].
pub struct TemperatureRadiation;

impl Effect for TemperatureRadiation {
    const FACTS: Facts = Facts {
        id: "temperature_radiation",
        stage: Stage::Air,
        sentence: "The sun warms the thermometer's housing: the air is colder than recorded, by the irradiance.",
        formula: "T' = T - gain (I - lag dI/ds), with I the irradiance",
        source: "1 to 10 K unshielded; Nakamura and Mahrt 2005, J. Atmos. Oceanic Technol. 22, 1046, \
                 doi:10.1175/JTECH1762.1",
        reads: &[Quantity::Radiation, Quantity::RadiationRate],
        requires: &[
            Quantity::Temperature,
            Quantity::Radiation,
            Quantity::RadiationRate,
        ],
        parameters: &[
            ParameterFacts {
                name: "gain",
                unit: "K m^2/W",
                bounds: (0.0, 0.03),
                prior_scale: 3e-3,
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "lag",
                unit: "s",
                role: Role::Shape,
                neutral: 0.0,
                bounds: (0.0, 3600.0),
                prior_scale: 300.0,
                tried: Tried::Values(&[0.0, 200.0, 500.0, 1000.0]),
                ..ParameterFacts::USUAL
            },
        ],
        domain: "light wind; a housing that follows the sun within minutes, of which lag is the number in seconds; \
                 also the own thermometer of a ranger that compensates its reading",
        check: "shade the thermometer for an hour",
        firmware: Firmware::Needs(Quantity::Radiation),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let rate = chain.recorded.get(Quantity::RadiationRate);
        let felt = (-parameters[1]).mul_add(rate, chain.recorded.get(Quantity::Radiation));
        chain.air.temperature = (-parameters[0]).mul_add(felt, chain.air.temperature);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(radiation: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::Radiation, radiation);
        let at = at.with(Quantity::RadiationRate, 0.01); // of which a housing without inertia feels none
        1e3 * error(
            "linear",
            "temperature_radiation",
            &[("gain", 3e-3)],
            2.0,
            &at,
        )
    }

    #[test]
    fn three_kelvin_in_full_sun_are_10_millimeters_at_2_meters() {
        assert!((millimeters(1000.0) - 2e3 * 1.8 / 341.6).abs() < 1e-9);
    }

    #[test]
    fn nothing_at_night_and_a_negative_offset_by_day() {
        assert_eq!(millimeters(0.0), 0.0);
        let offset = error(
            "linear",
            "temperature_offset",
            &[("offset", -1.5)],
            2.0,
            &Conditions::at(20.0),
        );
        assert!((millimeters(500.0) - 1e3 * offset).abs() < 1e-9);
    }
}

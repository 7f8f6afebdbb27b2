//! A thermometer in a sun that nobody recorded.

use super::recorded_angle::versine;
use super::{Effect, Facts, Firmware, ParameterFacts, Role, Tried};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// One hour of the clock as an angle \[rad\].
const HOUR: f64 = core::f64::consts::PI / 12.0;

/// See [`TemperatureDaylight::FACTS`].
pub struct TemperatureDaylight;

impl Effect for TemperatureDaylight {
    const FACTS: Facts = Facts {
        id: "temperature_daylight",
        stage: Stage::Air,
        sentence: "The sun warms the thermometer's housing and nobody records it: the clock stands in for the sun.",
        formula: "T' = T - gain max(0, cos(h - lag)), with h the hour angle of the clock",
        source: "1 to 10 K unshielded; Nakamura and Mahrt 2005, J. Atmos. Oceanic Technol. 22, 1046, \
                 doi:10.1175/JTECH1762.1; the sun of an equinox, up from 6 to 18 h",
        reads: &[Quantity::HourAngle],
        requires: &[Quantity::Temperature, Quantity::HourAngle],
        excludes: &[Quantity::Radiation],
        parameters: &[
            ParameterFacts {
                name: "gain",
                unit: "K",
                bounds: (0.0, 20.0),
                prior_scale: 2.0,
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "lag",
                unit: "rad",
                role: Role::Shape,
                neutral: 0.0,
                bounds: (-3.0 * HOUR, 4.0 * HOUR),
                prior_scale: HOUR,
                tried: Tried::Values(&[-HOUR, 0.0, HOUR, 2.0 * HOUR]),
                ..ParameterFacts::USUAL
            },
        ],
        edges: true,
        domain: "clear days of about twelve hours; a clock in local time (--time-zone), of which lag is how late the \
                 housing is; also the own thermometer of a ranger that compensates its reading",
        check: "shade the thermometer for an hour, or record the irradiance",
        firmware: Firmware::Needs(Quantity::HourAngle),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let height =
            S::constant(1.0) - versine(chain.recorded.get(Quantity::HourAngle) - parameters[1]);
        let sun = height.max(S::constant(0.0));
        chain.air.temperature = (-parameters[0]).mul_add(sun, chain.air.temperature);
    }
}

#[cfg(test)]
mod tests {
    use super::HOUR;
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(hour: f64, lag: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::HourAngle, (hour - 12.0) * HOUR);
        1e3 * error(
            "linear",
            "temperature_daylight",
            &[("gain", 3.0), ("lag", lag * HOUR)],
            2.0,
            &at,
        )
    }

    #[test]
    fn three_kelvin_at_noon_are_10_millimeters_at_2_meters() {
        assert!((millimeters(12.0, 0.0) - 2e3 * 1.8 / 341.6).abs() < 1e-9);
        assert!((millimeters(14.0, 2.0) - millimeters(12.0, 0.0)).abs() < 1e-9);
    }

    #[test]
    fn nothing_from_evening_to_morning() {
        for hour in [0.0, 3.0, 5.9, 18.1, 23.9] {
            assert_eq!(millimeters(hour, 0.0), 0.0, "{hour} h");
        }
    }
}

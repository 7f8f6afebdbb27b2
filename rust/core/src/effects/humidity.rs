//! Recorded humidity that the law ignores.

use super::{Effect, Facts, Firmware, ParameterFacts, Role};
use crate::air::{Air, Cramer, LawOfRows, SpeedLaw};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Rows;

/// How much faster sound is in this air than in the same air without water \[m/s\].
#[inline(always)]
pub(super) fn rise<S: Rows>(air: &Air<S>) -> S {
    Cramer.speed_of_rows(air) - Cramer.at_composition(air, S::constant(0.0))
}

/// See [`Humidity::FACTS`].
pub struct Humidity;

impl Effect for Humidity {
    const FACTS: Facts = Facts {
        id: "humidity",
        stage: Stage::Speed,
        sentence: "Humid air carries sound faster; the recorded humidity was not used.",
        formula: "c' = c + coefficient (c_cramer(T, h, p, x_c) - c_cramer(T, 0, p, x_c)); physics says 1",
        source: "Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
            Quantity::Co2MoleFraction,
        ],
        requires: &[Quantity::Temperature, Quantity::RelativeHumidity],
        excludes: &[],
        supplies: Some(Quantity::RelativeHumidity),
        calls: Some("cramer"),
        parameters: &[ParameterFacts {
            name: "coefficient",
            unit: "1",
            role: Role::Size,
            neutral: 0.0,
            bounds: (-5.0, 5.0), // wide: a free fit far from 1 is a finding
            prior_scale: 1.0,
            known: &[1.0],
            ..ParameterFacts::USUAL
        }],
        domain: "water mole fraction up to 0.06, where Cramer's equation holds",
        check: "vary the humidity at constant temperature",
        firmware: Firmware::Needs(Quantity::RelativeHumidity),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Rows>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.speed = parameters[0].mul_add(rise(&chain.air), chain.speed);
    }
}

#[cfg(test)]
mod tests {
    use super::rise;
    use crate::air::{Air, Cramer, SpeedLaw};
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn moist(temperature: f64, humidity: f64) -> Conditions<f64> {
        Conditions::at(temperature).with(Quantity::RelativeHumidity, humidity)
    }

    #[test]
    fn millimeters_at_2_meters_for_half_and_full_saturation() {
        // first order, from Cramer's equation, as printed: temperature, humidity, half a digit
        let printed = [
            (0.94, 0.0, 0.5, 0.005),
            (1.9, 0.0, 1.0, 0.05),
            (3.7, 20.0, 0.5, 0.05),
            (7.3, 20.0, 1.0, 0.05),
            (19.0, 50.0, 0.5, 0.5),
            (39.0, 50.0, 1.0, 0.5),
        ];
        for (millimeters, temperature, humidity, half_a_digit) in printed {
            let air = Air::recorded(&moist(temperature, humidity));
            let found = 2e3 * rise(&air) / Cramer.speed(&air.dry());
            assert!((found - millimeters).abs() <= half_a_digit, "{found}");
        }
    }

    #[test]
    fn vanishes_in_dry_air_and_adds_in_proportion_to_its_coefficient() {
        let relative = |temperature, humidity, coefficient| {
            let parameters = &[("coefficient", coefficient)];
            let at = moist(temperature, humidity);
            // indication = d c0 / (c0 + k rise)
            2.0 / (2.0 + error("linear", "humidity", parameters, 2.0, &at)) - 1.0
        };
        assert_eq!(relative(20.0, 0.0, 1.0), 0.0);
        let once = rise(&Air::recorded(&moist(30.0, 0.6))) / 349.4;
        assert!((relative(30.0, 0.6, 1.0) / once - 1.0).abs() < 1e-12);
        assert!((relative(30.0, 0.6, 3.0) / once - 3.0).abs() < 1e-12);
    }
}

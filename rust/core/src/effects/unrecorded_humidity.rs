//! Constant humidity that nobody recorded.

use super::humidity::rise;
use super::{Effect, Facts, Firmware, ParameterFacts, Role};
use crate::air::Air;
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Rows;

/// See [`UnrecordedHumidity::FACTS`].
pub struct UnrecordedHumidity;

impl Effect for UnrecordedHumidity {
    const FACTS: Facts = Facts {
        id: "unrecorded_humidity",
        stage: Stage::Speed,
        sentence: "Humid air carries sound faster; nobody recorded the humidity, taken as constant.",
        formula: "c' = c + c_cramer(T, relative_humidity, p, x_c) - c_cramer(T, 0, p, x_c)",
        source: "Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827",
        reads: &[
            Quantity::Temperature,
            Quantity::Pressure,
            Quantity::Co2MoleFraction,
        ],
        requires: &[Quantity::Temperature],
        excludes: &[Quantity::RelativeHumidity],
        supplies: None, // a law that reads humidity takes the air for dry where none is recorded
        calls: Some("cramer"),
        parameters: &[ParameterFacts {
            name: "relative_humidity",
            unit: "1",
            role: Role::Size,
            neutral: 0.0,
            bounds: (0.0, 1.0),
            prior_scale: 0.5,
            known: &[],
            ..ParameterFacts::USUAL
        }],
        domain: "water mole fraction up to 0.06, where Cramer's equation holds",
        check: "record the humidity",
        firmware: Firmware::Folded,
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Rows>(chain: &mut Chain<S>, parameters: &[S]) {
        let moist = Air {
            relative_humidity: parameters[0],
            ..chain.air
        };
        chain.speed = chain.speed + rise(&moist);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    #[test]
    fn half_saturation_is_3_7_millimeters_at_2_meters_and_20_degc() {
        let half = &[("relative_humidity", 0.5)];
        let error = error(
            "linear",
            "unrecorded_humidity",
            half,
            2.0,
            &Conditions::at(20.0),
        );
        let first_order = 2.0 * (2.0 / (2.0 + error) - 1.0); // as the table's figure is
        assert!((1e3 * first_order - 3.7).abs() < 0.05);
    }

    #[test]
    fn is_the_humidity_effect_at_constant_humidity() {
        for (temperature, humidity) in [(0.0, 0.2), (25.0, 0.7), (45.0, 1.0)] {
            let at = Conditions::at(temperature);
            let constant = &[("relative_humidity", humidity)];
            let unrecorded = error("linear", "unrecorded_humidity", constant, 3.0, &at);
            let at = at.with(Quantity::RelativeHumidity, humidity);
            let recorded = error("linear", "humidity", &[("coefficient", 1.0)], 3.0, &at);
            assert!((unrecorded - recorded).abs() < 1e-14);
        }
    }

    #[test]
    fn in_cramers_law_it_is_the_law_in_moist_air() {
        let at = Conditions::at(30.0);
        let unrecorded = &[("relative_humidity", 0.8)];
        let model = crate::effects::testing::model("cramer", "unrecorded_humidity", unrecorded);
        let moist = crate::Model::new(crate::Law::parse("cramer").unwrap());
        let truth = moist.time_of_flight(2.0, &at.with(Quantity::RelativeHumidity, 0.8));
        assert!((model.time_of_flight(2.0, &at) - truth).abs() < 1e-17);
    }
}

//! Recorded pressure that the law ignores.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::air::{Air, Cramer, LawOfRows};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Rows;

/// Standard atmosphere \[Pa\].
pub(super) const STANDARD: f64 = 101_325.0;

/// See [`Pressure::FACTS`].
pub struct Pressure;

impl Effect for Pressure {
    const FACTS: Facts = Facts {
        id: "pressure",
        stage: Stage::Speed,
        sentence: "Thin air is a slightly different gas, and holds a larger part of vapor; the pressure was not used.",
        formula: "c' = c + coefficient (c_cramer(T, h, p, x_c) - c_cramer(T, h, 101325 Pa, x_c)); physics says 1",
        source: "Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
            Quantity::Co2MoleFraction,
        ],
        requires: &[Quantity::Temperature, Quantity::Pressure],
        supplies: Some(Quantity::Pressure),
        calls: Some("cramer"),
        parameters: &[ParameterFacts::COEFFICIENT],
        domain: "water mole fraction up to 0.06, where Cramer's equation holds",
        check: "log a barometer over days of weather, or climb a hill",
        firmware: Firmware::Needs(Quantity::Pressure),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Rows>(chain: &mut Chain<S>, parameters: &[S]) {
        let standard = Air {
            pressure: S::constant(STANDARD),
            ..chain.air
        };
        let change = Cramer.speed_of_rows(&chain.air) - Cramer.speed_of_rows(&standard);
        chain.speed = parameters[0].mul_add(change, chain.speed);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::model;
    use crate::{Conditions, Quantity};

    /// Change of the speed of sound \[m/s\] from 103 kPa to 95 kPa.
    fn change(temperature: f64, humidity: f64) -> f64 {
        let model = model("linear", "pressure", &[("coefficient", 1.0)]);
        let at = Conditions::at(temperature).with(Quantity::RelativeHumidity, humidity);
        let speed = |pressure| model.speed_of_sound(2.0, &at.with(Quantity::Pressure, pressure));
        speed(103e3) - speed(95e3)
    }

    #[test]
    fn meters_per_second_as_printed() {
        for temperature in [0.0, 20.0, 50.0] {
            assert!(change(temperature, 0.0).abs() <= 0.0105, "{temperature}");
        }
        assert!((change(20.0, 0.5) - -0.05).abs() <= 5e-3);
        assert!((change(50.0, 0.5) - -0.28).abs() <= 5e-3);
    }

    #[test]
    fn nothing_at_standard_pressure() {
        let model = model("linear", "pressure", &[("coefficient", 1.0)]);
        let at = Conditions::at(20.0).with(Quantity::RelativeHumidity, 0.7);
        assert_eq!(model.speed_of_sound(2.0, &at), 343.4);
    }
}

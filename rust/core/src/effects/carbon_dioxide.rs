//! Recorded carbon dioxide that the law ignores.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::air::composition::water_vapor_mole_fraction_of_rows;
use crate::air::{Cramer, SpeedLaw};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Rows;

/// Mole fraction that laws without carbon dioxide stand for: 400 ppm.
const USUAL: f64 = 4e-4;

/// See [`CarbonDioxide::FACTS`].
pub struct CarbonDioxide;

impl Effect for CarbonDioxide {
    const FACTS: Facts = Facts {
        id: "carbon_dioxide",
        stage: Stage::Speed,
        sentence: "Sound is slower where the air holds more carbon dioxide; the recorded column was not used.",
        formula: "c' = c + coefficient (c_cramer(T, h, p, x_c) - c_cramer(T, h, p, 400 ppm)); physics says 1",
        source: "Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
            Quantity::Co2MoleFraction,
        ],
        requires: &[Quantity::Temperature, Quantity::Co2MoleFraction],
        supplies: Some(Quantity::Co2MoleFraction),
        calls: Some("cramer"),
        parameters: &[ParameterFacts::COEFFICIENT],
        domain: "carbon dioxide up to 1 %, where Cramer's equation holds",
        check: "open the window and watch both columns",
        firmware: Firmware::Needs(Quantity::Co2MoleFraction),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Rows>(chain: &mut Chain<S>, parameters: &[S]) {
        let water = water_vapor_mole_fraction_of_rows(&chain.air);
        let mut usual = chain.air;
        usual.co2_mole_fraction = S::constant(USUAL);
        let change =
            Cramer.at_composition(&chain.air, water) - Cramer.at_composition(&usual, water);
        chain.speed = parameters[0].mul_add(change, chain.speed);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(excess: f64, id: &str, parameters: &[(&str, f64)]) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::Co2MoleFraction, 4e-4 + excess);
        1e3 * error("linear", id, parameters, 2.0, &at)
    }

    #[test]
    fn a_thousand_ppm_more_are_half_a_millimeter_at_2_meters() {
        let found = millimeters(1e-3, "carbon_dioxide", &[("coefficient", 1.0)]);
        assert!((found - 0.5).abs() < 0.05, "{found}");
        assert_eq!(
            millimeters(0.0, "carbon_dioxide", &[("coefficient", 1.0)]),
            0.0
        );
    }

    #[test]
    fn is_what_gas_composition_would_find_without_the_column() {
        let recorded = millimeters(3e-3, "carbon_dioxide", &[("coefficient", 1.0)]);
        let guessed = millimeters(0.0, "gas_composition", &[("excess", 3e-3)]);
        assert!((recorded - guessed).abs() < 1e-9, "{recorded} {guessed}");
    }
}

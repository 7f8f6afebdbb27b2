//! Air with more carbon dioxide, or with another gas in it.

use super::{Effect, Facts, ParameterFacts};
use crate::air::composition::water_vapor_mole_fraction_of_rows;
use crate::air::{Cramer, SpeedLaw};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Rows;

/// See [`GasComposition::FACTS`].
pub struct GasComposition;

impl Effect for GasComposition {
    const FACTS: Facts = Facts {
        id: "gas_composition",
        stage: Stage::Speed,
        sentence: "The air holds more carbon dioxide than usual, or another gas: sound is slower (or faster).",
        formula: "c' = c + c_cramer(T, h, p, x_c + excess) - c_cramer(T, h, p, x_c)",
        source: "Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
            Quantity::Co2MoleFraction,
        ],
        requires: &[Quantity::Temperature],
        excludes: &[Quantity::Co2MoleFraction],
        calls: Some("cramer"),
        parameters: &[ParameterFacts {
            name: "excess",
            bounds: (-0.2, 0.3),
            prior_scale: 1e-3,
            tail: 60.0, // pure nitrogen, 1.6 % faster, acts as an excess of -0.06
            ..ParameterFacts::USUAL
        }],
        domain: "carbon dioxide up to 1 %; beyond, and below zero, it stands for the speed of another gas",
        check: "a carbon dioxide meter, or open the window",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Rows>(chain: &mut Chain<S>, parameters: &[S]) {
        let water = water_vapor_mole_fraction_of_rows(&chain.air);
        let mut other = chain.air;
        other.co2_mole_fraction = other.co2_mole_fraction + parameters[0];
        let change =
            Cramer.at_composition(&other, water) - Cramer.at_composition(&chain.air, water);
        chain.speed = chain.speed + change;
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::{error, model};

    #[test]
    fn a_thousand_ppm_are_half_a_millimeter_at_2_meters() {
        let excess = &[("excess", 1e-3)];
        let error = 1e3
            * error(
                "linear",
                "gas_composition",
                excess,
                2.0,
                &Conditions::at(20.0),
            );
        assert!((error.abs() - 0.5).abs() <= 0.05, "{error}"); // slower sound reads longer
        assert!(error > 0.0);
        for (temperature, printed) in [(0.0, -0.085), (50.0, -0.096)] {
            let at = Conditions::at(temperature);
            let rich = model("linear", "gas_composition", excess).speed_of_sound(2.0, &at);
            let usual = model("linear", "gas_composition", &[]).speed_of_sound(2.0, &at);
            assert!((rich - usual - printed).abs() <= 1e-3, "{}", rich - usual);
        }
    }

    #[test]
    fn nitrogen_lies_within_the_tail_of_the_prior() {
        // 1.6 % faster by its molar mass, 28.013 g/mol
        let at = Conditions::at(20.0);
        let nitrogen = model("linear", "gas_composition", &[("excess", -0.06)]);
        let faster = nitrogen.speed_of_sound(2.0, &at) / 343.4 - 1.0;
        assert!((faster - 0.016).abs() < 1e-3, "{faster}");
    }
}

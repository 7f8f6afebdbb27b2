//! A linear law where air has a curved one.

use super::{Effect, Facts, ParameterFacts};
use crate::air::{Cramer, SpeedLaw};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`LinearSpeedLaw::FACTS`].
pub struct LinearSpeedLaw;

impl Effect for LinearSpeedLaw {
    const FACTS: Facts = Facts {
        id: "linear_speed_law",
        stage: Stage::Speed,
        sentence: "The law is linear in temperature; what dry air does is curved, which shows above 35 degC.",
        formula: "c' = c + coefficient (c_cramer(T, 0, p, x_c) - c); physics says 1",
        source: "Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827; near 331.3 sqrt(1 + T / 273.15)",
        reads: &[
            Quantity::Temperature,
            Quantity::Pressure,
            Quantity::Co2MoleFraction,
        ],
        requires: &[Quantity::Temperature],
        calls: Some("cramer"),
        extends: &["linear"],
        parameters: &[ParameterFacts::COEFFICIENT],
        domain: "linear laws of the temperature; humidity is an effect of its own",
        check: "measure above 35 degC, where the two laws part",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let curved = Cramer.at_composition(&chain.air, S::constant(0.0));
        chain.speed = parameters[0].mul_add(curved - chain.speed, chain.speed);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::{error, model};

    const WHOLE: &[(&str, f64)] = &[("coefficient", 1.0)];

    fn millimeters(temperature: f64) -> f64 {
        1e3 * error(
            "linear",
            "linear_speed_law",
            WHOLE,
            2.0,
            &Conditions::at(temperature),
        )
    }

    #[test]
    fn millimeters_at_2_meters_as_printed_against_cramers_dry_air() {
        for (temperature, printed) in [(0.0, -0.3), (20.0, 0.2), (50.0, 5.6)] {
            assert!(
                (millimeters(temperature) - printed).abs() <= 0.05,
                "{}",
                millimeters(temperature)
            );
        }
    }

    #[test]
    fn parts_from_the_line_as_the_root_law_does() {
        // 331.3 sqrt(1 + T / 273.15): 0.29 % or 5.8 mm at 50 degC, a quarter of a millimeter further
        let root = 2e3 * (361.4 / (331.3 * (1.0 + 50.0 / 273.15_f64).sqrt()) - 1.0);
        assert!((root - 5.8).abs() <= 0.1);
        assert!((root - millimeters(50.0)).abs() < 0.3);
    }

    #[test]
    fn with_it_any_linear_law_is_dry_cramer() {
        for law in ["linear", "331.3+0.606*T"] {
            let (found, at) = (model(law, "linear_speed_law", WHOLE), Conditions::at(33.0));
            let dry = model("cramer", "clock_error", &[]).speed_of_sound(2.0, &at);
            assert!((found.speed_of_sound(2.0, &at) - dry).abs() < 1e-12);
        }
    }
}

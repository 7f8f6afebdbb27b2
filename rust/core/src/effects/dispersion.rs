//! Sound at 40 kHz is not sound at 0 Hz.

use super::{Effect, Facts, Firmware, ParameterFacts, Role};
use crate::air::dispersed;
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`Dispersion::FACTS`].
pub struct Dispersion;

impl Effect for Dispersion {
    const FACTS: Facts = Facts {
        id: "dispersion",
        stage: Stage::Speed,
        sentence: "Laws hold at zero frequency; oxygen and nitrogen relax too slowly for ultrasound, which is faster.",
        formula: "c' = c + coefficient (c(frequency) - c), 1/c(f) = 1/c - sum alpha_r / (2 pi f_r); physics says 1",
        source: "IEC 61094-2:2009, F.3, with the relaxations of ISO 9613-1:1993",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
        ],
        requires: &[Quantity::Temperature, Quantity::RelativeHumidity],
        extends: &["ideal_gas", "cramer", "virial"],
        parameters: &[
            ParameterFacts::COEFFICIENT,
            ParameterFacts {
                name: "frequency",
                unit: "Hz",
                role: Role::Shape,
                neutral: 40e3,
                bounds: (20e3, 400e3),
                prior_scale: 10e3,
                known: &[40e3],
                ..ParameterFacts::USUAL
            },
        ],
        domain: "laws at zero frequency; -20..50 degC, 0.05..5 % water, as ISO 9613-1",
        check: "only its size tells: 0.025 % at 20 degC and 50 %; a reference distance to 0.01 % and a hygrometer",
        firmware: Firmware::Needs(Quantity::RelativeHumidity),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let change = dispersed(chain.speed, &chain.air, parameters[1]) - chain.speed;
        chain.speed = parameters[0].mul_add(change, chain.speed);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::model;
    use crate::{Conditions, Quantity};

    fn faster(humidity: f64, frequency: f64) -> f64 {
        let parameters = &[("coefficient", 1.0), ("frequency", frequency)];
        let at = Conditions::at(20.0).with(Quantity::RelativeHumidity, humidity);
        let speed = |parameters| model("cramer", "dispersion", parameters).speed_of_sound(2.0, &at);
        speed(parameters) - speed(&[])
    }

    #[test]
    fn meters_per_second_at_20_degc_as_measured() {
        for (humidity, printed) in [(0.0, 0.137), (0.5, 0.087), (1.0, 0.045)] {
            assert!(
                (faster(humidity, 40e3) - printed).abs() <= 5e-4,
                "{}",
                faster(humidity, 40e3)
            );
        }
    }

    #[test]
    fn rises_with_the_frequency_and_levels_off() {
        let steps = [20e3, 40e3, 80e3, 160e3, 320e3].map(|frequency| faster(0.5, frequency));
        assert!(steps.is_sorted());
        assert!(steps[4] - steps[3] < steps[1] - steps[0]);
    }
}

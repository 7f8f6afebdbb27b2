//! Wind across the beam.

use super::wind_along::mach_square;
use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`WindAcross::FACTS`].
pub struct WindAcross;

impl Effect for WindAcross {
    const FACTS: Facts = Facts {
        id: "wind_across",
        stage: Stage::Flight,
        sentence: "Wind blows across the beam: sound must head into it to come back, and takes longer.",
        formula: "t' = t (1 + coefficient (1 / sqrt(1 - w^2 / c^2) - 1)), from c_eff = sqrt(c^2 - w^2); physics says 1",
        source: "geometry of moving air, as in sonic anemometers: Kaimal and Businger 1963, J. Appl. Meteorol. 2, 156",
        reads: &[Quantity::WindSpeed],
        requires: &[Quantity::WindSpeed],
        parameters: &[ParameterFacts::COEFFICIENT],
        domain: "steady wind, well below the speed of sound; gusts add noise",
        check: "an anemometer beside the beam",
        firmware: Firmware::Needs(Quantity::WindSpeed),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let one = S::constant(1.0);
        let longer = (one / (one - mach_square(chain)).sqrt() - one) * chain.time;
        chain.time = parameters[0].mul_add(longer, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(wind: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::WindSpeed, wind);
        1e3 * error("linear", "wind_across", &[("coefficient", 1.0)], 2.0, &at)
    }

    #[test]
    fn half_a_millimeter_or_more_at_10_meters_a_second() {
        // half of what the same wind does along the beam, 1.7 mm at 2 m
        assert!((millimeters(10.0) - 0.85).abs() <= 0.05);
    }

    #[test]
    fn half_of_wind_along_the_beam_at_first_order() {
        for wind in [2.0, 5.0, 10.0] {
            let at = Conditions::at(20.0).with(Quantity::WindSpeed, wind);
            let along = 1e3 * error("linear", "wind_along", &[("coefficient", 1.0)], 2.0, &at);
            assert!((millimeters(wind) / along - 0.5).abs() < 1e-3);
        }
    }
}

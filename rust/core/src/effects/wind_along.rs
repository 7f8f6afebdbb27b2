//! Wind along the beam.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// The square of the wind's Mach number \[1\].
#[inline(always)]
pub(super) fn mach_square<S: Scalar>(chain: &Chain<S>) -> S {
    let mach = chain.recorded.get(Quantity::WindSpeed) / chain.speed;
    mach * mach
}

/// See [`WindAlong::FACTS`].
pub struct WindAlong;

impl Effect for WindAlong {
    const FACTS: Facts = Facts {
        id: "wind_along",
        stage: Stage::Flight,
        sentence: "Wind blows along the beam: what it gains on one way it more than loses on the other.",
        formula: "t' = t (1 + coefficient (1 / (1 - w^2 / c^2) - 1)), from d / (c + w) + d / (c - w); physics says 1",
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
        let share = mach_square(chain);
        let longer = share / (S::constant(1.0) - share) * chain.time;
        chain.time = parameters[0].mul_add(longer, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(wind: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::WindSpeed, wind);
        1e3 * error("linear", "wind_along", &[("coefficient", 1.0)], 2.0, &at)
    }

    #[test]
    fn millimeters_at_2_meters_as_printed() {
        // the catalog's column: m/s, millimeters, half a digit
        for (wind, printed, half_a_digit) in
            [(2.0, 0.07, 5e-3), (5.0, 0.42, 5e-3), (10.0, 1.7, 0.05)]
        {
            assert!((millimeters(wind) - printed).abs() <= half_a_digit);
        }
    }

    #[test]
    fn out_and_back_is_as_a_pedestrian_would_count() {
        let there_and_back = 2.0 / (343.4 + 30.0) + 2.0 / (343.4 - 30.0);
        let expected = 1e3 * (0.5 * 343.4 * there_and_back - 2.0);
        assert!((millimeters(30.0) - expected).abs() < 1e-9);
        assert_eq!(millimeters(-30.0), millimeters(30.0));
    }
}

//! A tilted sensor that measures along its beam.

use super::recorded_angle::versine;
use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`SlantRange::FACTS`].
pub struct SlantRange;

impl Effect for SlantRange {
    const FACTS: Facts = Facts {
        id: "slant_range",
        stage: Stage::Path,
        sentence: "The sensor is tilted over rough ground or water and measures along its beam, the slant range.",
        formula: "d' = d (1 + coefficient (1 / cos(angle) - 1)); geometry says 1, which is d / cos(angle)",
        source: "geometry of a right triangle: rough ground scatters sound back along the beam",
        reads: &[Quantity::Angle],
        requires: &[Quantity::Angle],
        parameters: &[ParameterFacts::COEFFICIENT],
        domain: "a rough target, which scatters sound back; the angle is that of the beam to the perpendicular",
        check: "tilt the sensor on purpose and record the angle: distance / cos(angle), not distance cos(angle)",
        firmware: Firmware::Needs(Quantity::Angle),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let shorter = versine(chain.recorded.get(Quantity::Angle));
        let longer = shorter / (S::constant(1.0) - shorter) * chain.path;
        chain.path = parameters[0].mul_add(longer, chain.path);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn longer(distance: f64, degrees: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::Angle, degrees.to_radians());
        let slant = &[("coefficient", 1.0)];
        error("linear", "slant_range", slant, distance, &at)
    }

    #[test]
    fn at_60_degrees_the_beam_is_twice_as_long_as_the_perpendicular() {
        assert!((longer(1.5, 60.0) - 1.5).abs() < 1e-14);
        assert_eq!(longer(1.5, 0.0), 0.0);
    }

    #[test]
    fn its_foot_is_beside_that_of_the_perpendicular() {
        for degrees in [-40.0, 10.0, 25.0, 40.0_f64] {
            let beam = 2.0 + longer(2.0, degrees);
            let foot = 2.0 * degrees.to_radians().tan();
            assert!((beam * beam - foot * foot - 4.0).abs() < 1e-13);
        }
    }
}

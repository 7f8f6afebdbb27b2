//! A flat target that does not stand square to the beam.

use super::{Effect, Facts, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`ObliqueTarget::FACTS`].
pub struct ObliqueTarget;

impl Effect for ObliqueTarget {
    const FACTS: Facts = Facts {
        id: "oblique_target",
        stage: Stage::Path,
        sentence: "The target stands oblique: its nearest point, which answers first, is nearer than the reference.",
        formula: "d' = d (1 - shortening), with shortening = 1 - cos(angle of incidence)",
        source: "geometry of a flat mirror; beams are 15 degrees wide (arduinoos.com, Range finder 1)",
        parameters: &[ParameterFacts {
            name: "shortening",
            bounds: (0.0, 0.3),  // up to 45 degrees
            prior_scale: 3.8e-3, // 5 degrees
            ..ParameterFacts::USUAL
        }],
        domain: "a flat target larger than the beam, tilted by less than the beam's half width",
        check: "rotate the target, or record the angle: the error follows d cos(angle)",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.path = (-parameters[0]).mul_add(chain.path, chain.path);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    #[test]
    fn millimeters_at_2_meters_as_printed() {
        // the catalog's column: degrees, millimeters, half a digit
        for (degrees, printed, half_a_digit) in
            [(5.0, -7.6, 0.05), (8.0, -19.0, 0.5), (15.0, -68.0, 0.5)]
        {
            let shortening = 1.0 - f64::to_radians(degrees).cos();
            let parameters = &[("shortening", shortening)];
            let found = error(
                "linear",
                "oblique_target",
                parameters,
                2.0,
                &Conditions::at(20.0),
            );
            assert!((1e3 * found - printed).abs() <= half_a_digit, "{found}");
        }
    }

    #[test]
    fn is_a_slow_clock() {
        // proportional to the distance at every temperature: nothing but the cause tells them apart
        for (distance, temperature) in [(0.1, 0.0), (2.0, 50.0), (4.0, -20.0)] {
            let at = Conditions::at(temperature);
            let oblique = error(
                "cramer",
                "oblique_target",
                &[("shortening", 0.01)],
                distance,
                &at,
            );
            let slow = error(
                "cramer",
                "clock_error",
                &[("frequency_error", -0.01)],
                distance,
                &at,
            );
            assert!((oblique - slow).abs() < 1e-15);
        }
    }
}

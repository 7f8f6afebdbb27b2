//! Sender and receiver stand side by side.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`TransducerSpacing::FACTS`].
pub struct TransducerSpacing;

/// A spacing's square that no distance shows \[m^2\].
const SMALLEST: f64 = 1e-36;

impl Effect for TransducerSpacing {
    const FACTS: Facts = Facts {
        id: "transducer_spacing",
        stage: Stage::Path,
        sentence: "Sender and receiver stand apart, so the echo runs along two sides of a triangle.",
        formula: "d' = sqrt(d^2 + square / 4), with square the spacing's square",
        source: "geometry; 26 mm between the centers of an HC-SR04's transducers (general knowledge)",
        parameters: &[ParameterFacts {
            name: "square",
            unit: "m^2",
            bounds: (0.0, 0.01),  // up to 0.1 m apart
            prior_scale: 6.76e-4, // 26 mm
            ..ParameterFacts::USUAL
        }],
        bends: true,
        domain: "two transducers; distances from the transducers' faces",
        check: "measure very short distances, where it is largest, and the spacing with a caliper",
        firmware: Firmware::Refused(
            "no form that is straight in the echo time follows it; beyond 0.5 m it is below 0.2 mm",
        ),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let path = chain.path;
        let square = S::constant(0.25) * parameters[0];
        // without a spacing, the root at distance 0 would have no derivative for a search to follow
        let side = path.mul_add(path, square + S::constant(SMALLEST)).sqrt();
        // side - |d|, and for a path behind the sensor, which only a search passes through, on along a rising line
        chain.path = path + square / (side + path.abs());
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Law, Model};

    fn millimeters(distance: f64) -> f64 {
        let square = &[("square", 0.026 * 0.026)];
        1e3 * error(
            "cramer",
            "transducer_spacing",
            square,
            distance,
            &Conditions::at(20.0),
        )
    }

    #[test]
    fn as_printed_at_a_tenth_of_a_meter_and_at_one() {
        assert!((millimeters(0.1) - 0.8).abs() <= 0.05);
        assert!((millimeters(1.0) - 0.08).abs() <= 0.005);
    }

    #[test]
    fn without_a_spacing_echo_time_zero_is_distance_zero() {
        let model = Model::new(Law::parse("cramer").unwrap())
            .with("transducer_spacing", &[("square", 0.0)])
            .unwrap();
        assert!(model.distance(0.0, &Conditions::at(20.0)).abs() < 1e-15);
    }

    #[test]
    fn falls_with_the_distance_as_the_square_over_eight_times_the_distance() {
        for distance in [1.0, 2.0, 4.0] {
            let first_order = 1e3 * 0.026 * 0.026 / (8.0 * distance);
            assert!((millimeters(distance) / first_order - 1.0).abs() < 1e-3 / distance);
        }
    }
}

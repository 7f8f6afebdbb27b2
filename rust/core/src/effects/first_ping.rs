//! The first reading of a burst.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`FirstPing::FACTS`].
pub struct FirstPing;

impl Effect for FirstPing {
    const FACTS: Facts = Facts {
        id: "first_ping",
        stage: Stage::Transducer,
        sentence: "The first ping of a burst differs: the sensor wakes, or the gain still settles.",
        formula: "t' = t + delay in the first row of each group",
        source: "-0.7 mm seen in desk data, first of each burst",
        reads: &[Quantity::PositionInGroup],
        requires: &[Quantity::PositionInGroup],
        parameters: &[ParameterFacts {
            name: "delay",
            unit: "s",
            bounds: (-1e-3, 1e-3),
            prior_scale: 4e-6, // 0.7 mm
            ..ParameterFacts::USUAL
        }],
        edges: true,
        domain: "bursts with a recorded group or order",
        check: "record the order of the readings in each burst",
        firmware: Firmware::Needs(Quantity::PositionInGroup),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let first = S::constant(0.5) - chain.recorded.get(Quantity::PositionInGroup);
        chain.time = chain.time + S::select(first, parameters[0], S::constant(0.0));
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(position: f64, distance: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::PositionInGroup, position);
        1e3 * error("linear", "first_ping", &[("delay", -4e-6)], distance, &at)
    }

    #[test]
    fn four_microseconds_are_seven_tenths_of_a_millimeter() {
        assert!((millimeters(0.0, 2.0) - -0.7).abs() <= 0.05);
    }

    #[test]
    fn only_the_first_and_the_same_at_every_distance() {
        assert!((1..9).all(|position| millimeters(f64::from(position), 2.0).abs() < 1e-12));
        assert!((millimeters(0.0, 0.3) - millimeters(0.0, 4.0)).abs() < 1e-11);
    }
}

//! A sensor that was bumped, or a part that was swapped.

use super::facts::EVENLY;
use super::{Effect, Facts, Firmware, ParameterFacts, Role, Tried};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`StepChange::FACTS`].
pub struct StepChange;

impl Effect for StepChange {
    const FACTS: Facts = Facts {
        id: "step_change",
        stage: Stage::Path,
        sentence: "At some moment the sensor was bumped or a part swapped: distances are off by a constant from then.",
        formula: "d' = d + offset where s > time, with s the time since the first row",
        source: "5 mm for a bumped mount (general knowledge)",
        reads: &[Quantity::ElapsedTime],
        requires: &[Quantity::ElapsedTime],
        parameters: &[
            ParameterFacts {
                name: "offset",
                unit: "m",
                bounds: (-0.5, 0.5),
                prior_scale: 5e-3,
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "time",
                unit: "s",
                role: Role::Shape,
                neutral: 1800.0,
                bounds: (0.0, 1e10),
                prior_scale: 3600.0,
                tried: Tried::Quantiles(Quantity::ElapsedTime, EVENLY),
                divides: Some(Quantity::ElapsedTime),
                ..ParameterFacts::USUAL
            },
        ],
        edges: true,
        recurs: false,
        domain: "one campaign, one step",
        check: "the log book; measure the first point again",
        firmware: Firmware::Refused("it belongs to one campaign: calibrate again after the step"),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let before = parameters[1] - chain.recorded.get(Quantity::ElapsedTime);
        chain.path = chain.path + S::select(before, S::constant(0.0), parameters[0]);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn at(elapsed: f64, distance: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::ElapsedTime, elapsed);
        error(
            "linear",
            "step_change",
            &[("offset", 5e-3), ("time", 100.0)],
            distance,
            &at,
        )
    }

    #[test]
    fn five_millimeters_from_then_on() {
        assert!((at(100.1, 2.0) - 5e-3).abs() < 1e-15);
        assert_eq!((at(0.0, 2.0), at(100.0, 2.0)), (0.0, 0.0));
    }

    #[test]
    fn is_a_zero_error_after_the_step() {
        for distance in [0.1, 1.0, 4.0] {
            let zero = error(
                "linear",
                "zero_error",
                &[("offset", 5e-3)],
                distance,
                &Conditions::at(20.0),
            );
            assert_eq!(at(1e4, distance), zero);
        }
    }
}

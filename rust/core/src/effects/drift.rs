//! A mount that creeps.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// A day \[s\], the campaign that the prior is stated for.
const DAY: f64 = 86_400.0;

/// See [`Drift::FACTS`].
pub struct Drift;

impl Effect for Drift {
    const FACTS: Facts = Facts {
        id: "drift",
        stage: Stage::Path,
        sentence: "The mount creeps (or a part ages), so every distance moves away steadily with time.",
        formula: "d' = d + rate s, with s the time since the first row",
        source: "5 mm in a campaign (general knowledge)",
        reads: &[Quantity::ElapsedTime],
        requires: &[Quantity::ElapsedTime],
        parameters: &[ParameterFacts {
            name: "rate",
            unit: "m/s",
            bounds: (-1e-5, 1e-5),
            prior_scale: 5e-3 / DAY,
            over: Some((Quantity::ElapsedTime, DAY)),
            ..ParameterFacts::USUAL
        }],
        domain: "one campaign: it tells nothing about another",
        check: "measure the first point again at the end",
        firmware: Firmware::Refused("it belongs to one campaign: fasten the mount and calibrate again"),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let elapsed = chain.recorded.get(Quantity::ElapsedTime);
        chain.path = parameters[0].mul_add(elapsed, chain.path);
    }
}

#[cfg(test)]
mod tests {
    use super::DAY;
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn after(days: f64, distance: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::ElapsedTime, days * DAY);
        error("linear", "drift", &[("rate", 5e-3 / DAY)], distance, &at)
    }

    #[test]
    fn five_millimeters_a_day() {
        assert!((after(1.0, 2.0) - 5e-3).abs() < 1e-15);
    }

    #[test]
    fn nothing_at_the_first_row_and_steady_at_every_distance() {
        assert_eq!(after(0.0, 2.0), 0.0);
        assert!((after(3.0, 0.5) - 3.0 * after(1.0, 4.0)).abs() < 1e-14);
    }
}

//! A mount that creeps.

use super::{Effect, Facts, Firmware, ParameterFacts, Role, Tried};
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
        sentence: "The mount creeps (or a part ages), so every distance moves away with time.",
        formula: "d' = d + rate s + settling (1 - exp(-s / time_constant)), with s the time since the first row",
        source: "5 mm in a campaign (general knowledge); steady and settling creep: Burgers's body, Findley, Lai and \
                 Onaran 1976, Creep and Relaxation of Nonlinear Viscoelastic Materials, chapter 5",
        reads: &[Quantity::ElapsedTime],
        requires: &[Quantity::ElapsedTime],
        parameters: &[
            ParameterFacts {
                name: "rate",
                unit: "m/s",
                bounds: (-1e-5, 1e-5),
                prior_scale: 5e-3 / DAY,
                over: Some((Quantity::ElapsedTime, DAY)),
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "settling",
                unit: "m",
                bounds: (-0.1, 0.1),
                prior_scale: 1e-3,
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "time_constant",
                unit: "s",
                role: Role::Shape,
                neutral: DAY,
                bounds: (600.0, 1e8),
                prior_scale: 0.05 * DAY,
                tried: Tried::Values(&[0.01 * DAY, 0.05 * DAY, 0.25 * DAY, DAY, 4.0 * DAY]),
                ..ParameterFacts::USUAL
            },
        ],
        recurs: false,
        domain: "one campaign: it tells nothing about another",
        check: "measure the first point again at the end",
        firmware: Firmware::Refused(
            "it belongs to one campaign: fasten the mount and calibrate again",
        ),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let elapsed = chain.recorded.get(Quantity::ElapsedTime);
        let settled = S::constant(1.0) - (-elapsed / parameters[2]).exp();
        chain.path = parameters[0].mul_add(elapsed, parameters[1].mul_add(settled, chain.path));
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
    fn settles_by_two_thirds_in_one_time_constant() {
        let at = Conditions::at(20.0).with(Quantity::ElapsedTime, 3600.0);
        let settling = &[("settling", 1e-3), ("time_constant", 3600.0)];
        let expected = 1e-3 * (1.0 - (-1.0_f64).exp());
        assert!((error("linear", "drift", settling, 2.0, &at) - expected).abs() < 1e-15);
    }

    #[test]
    fn nothing_at_the_first_row_and_steady_at_every_distance() {
        assert_eq!(after(0.0, 2.0), 0.0);
        assert!((after(3.0, 0.5) - 3.0 * after(1.0, 4.0)).abs() < 1e-14);
    }
}

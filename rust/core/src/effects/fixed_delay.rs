//! A fixed electronic delay.

use super::{Effect, Facts, Firmware, ParameterFacts, Role};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`FixedDelay::FACTS`].
pub struct FixedDelay;

impl Effect for FixedDelay {
    const FACTS: Facts = Facts {
        id: "fixed_delay",
        stage: Stage::Transducer,
        sentence: "Trigger, comparator and interrupt add a fixed time to every echo.",
        formula: "t' = t + delay",
        source: "NewPing header (PING_OVERHEAD 5 us); regression offsets of about 30 us in the field",
        reads: &[],
        requires: &[],
        excludes: &[],
        supplies: None,
        calls: None,
        parameters: &[ParameterFacts {
            name: "delay",
            unit: "s",
            role: Role::Size,
            neutral: 0.0,
            bounds: (-2e-4, 2e-4), // negative where the firmware subtracts too much
            prior_scale: 3e-5,
            known: &[],
            ..ParameterFacts::USUAL
        }],
        domain: "any distance and air",
        check: "measure a short distance at two temperatures, or loop the echo pin back electrically",
        firmware: Firmware::Folded,
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.time = chain.time + parameters[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    const DELAY: &[(&str, f64)] = &[("delay", 30e-6)];

    #[test]
    fn thirty_microseconds_are_five_millimeters_at_20_degc() {
        let error = error("linear", "fixed_delay", DELAY, 2.0, &Conditions::at(20.0));
        assert!((error - 343.4 * 30e-6 / 2.0).abs() < 1e-12);
    }

    #[test]
    fn grows_with_the_speed_of_sound_and_not_with_distance() {
        let at = |d, t| error("linear", "fixed_delay", DELAY, d, &Conditions::at(t));
        assert!((at(2.0, 50.0) / at(2.0, 0.0) - 361.4 / 331.4).abs() < 1e-10);
        assert!((at(0.2, 20.0) - at(4.0, 20.0)).abs() < 1e-14);
    }
}

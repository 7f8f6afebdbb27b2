//! A fixed electronic delay.

use super::{Effect, Facts, Firmware, ParameterFacts};
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
        parameters: &[ParameterFacts {
            name: "delay",
            unit: "s",
            neutral: 0.0,
            bounds: (-2e-4, 2e-4),
            prior_scale: 3e-5,
            known: &[],
        }],
        supplies: None,
        domain: "any",
        firmware: Firmware::Folded,
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.time = chain.time + parameters[0];
    }
}

#[cfg(test)]
mod tests {
    use crate::model::Model;
    use crate::{Conditions, Law};

    #[test]
    fn thirty_microseconds_are_five_millimeters_at_20_degc() {
        let model = Model::new(Law::parse("linear").unwrap())
            .with("fixed_delay", &[("delay", 30e-6)])
            .unwrap();
        let error = model.indicate(2.0, &Conditions::at(20.0)) - 2.0;
        assert!((error - 343.4 * 30e-6 / 2.0).abs() < 1e-12);
    }
}

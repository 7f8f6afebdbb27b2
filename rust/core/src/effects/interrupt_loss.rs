//! A software timer that loses counts to interrupts.

use super::{Effect, Facts, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`InterruptLoss::FACTS`].
pub struct InterruptLoss;

impl Effect for InterruptLoss {
    const FACTS: Facts = Facts {
        id: "interrupt_loss",
        stage: Stage::Timer,
        sentence: "A counting loop (pulseIn) loses turns to interrupts, so every time comes out too short.",
        formula: "t' = t (1 - loss)",
        source: "68 us of 11.6 ms with the Arduino core's pulseIn() on an emulated UNO; none with noInterrupts()",
        parameters: &[ParameterFacts {
            name: "loss",
            bounds: (0.0, 0.1),
            prior_scale: 5.8e-3,
            ..ParameterFacts::USUAL
        }],
        domain: "timers that count loop turns with interrupts on; echoes longer than a timer's period (1 ms)",
        check: "time with the input-capture unit of a timer; with pulseIn() and noInterrupts() on AVR boards only",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.time = (-parameters[0]).mul_add(chain.time, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::{error, model};

    #[test]
    fn half_a_percent_and_more_is_68_microseconds_of_11_6_milliseconds() {
        let (at, loss) = (Conditions::at(20.0), &[("loss", 5.8e-3)]);
        let base = model("linear", "interrupt_loss", &[]);
        let distance = base.distance(11.6e-3, &at);
        let time = model("linear", "interrupt_loss", loss).time_of_flight(distance, &at);
        assert!((1e6 * (11.6e-3 - time) - 68.0).abs() <= 1.0);
    }

    #[test]
    fn is_a_slow_clock() {
        let at = Conditions::at(35.0);
        let lost = error("cramer", "interrupt_loss", &[("loss", 5e-3)], 3.0, &at);
        let slow = error(
            "cramer",
            "clock_error",
            &[("frequency_error", -5e-3)],
            3.0,
            &at,
        );
        assert!((lost - slow).abs() < 1e-15);
    }
}

//! A timer whose clock runs fast or slow.

use super::{Effect, Facts, ParameterFacts, Role};
use crate::chain::{Chain, Stage};
use crate::scalar::Scalar;

/// See [`ClockError::FACTS`].
pub struct ClockError;

impl Effect for ClockError {
    const FACTS: Facts = Facts {
        id: "clock_error",
        stage: Stage::Timer,
        sentence: "The timer's clock runs fast (positive) or slow, so every time is off by a factor.",
        formula: "t' = t (1 + frequency_error)",
        source: "ceramic resonator 0.5 %; one board 2021 ppm slow (forum.arduino.cc 69316); \
                 crystal 60 ppm (shelvin.de)",
        parameters: &[ParameterFacts {
            name: "frequency_error",
            unit: "1",
            role: Role::Size,
            neutral: 0.0,
            bounds: (-0.05, 0.05),
            prior_scale: 3e-3,
            ..ParameterFacts::USUAL
        }],
        check: "count a reference second (GPS, real-time clock) with the same timer",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        chain.time = parameters[0].mul_add(chain.time, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    fn at(distance: f64, temperature: f64) -> f64 {
        let slow = &[("frequency_error", -2021e-6)];
        error(
            "cramer",
            "clock_error",
            slow,
            distance,
            &Conditions::at(temperature),
        )
    }

    #[test]
    fn a_board_2021_ppm_slow_is_4_millimeters_short_at_2_meters() {
        assert!((at(2.0, 20.0) + 4.042e-3).abs() < 1e-15);
    }

    #[test]
    fn is_proportional_to_distance_whatever_the_air() {
        assert!((at(4.0, -20.0) - 8.0 * at(0.5, 50.0)).abs() < 1e-14);
    }
}

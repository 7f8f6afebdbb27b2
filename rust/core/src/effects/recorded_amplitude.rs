//! A threshold that a fainter echo crosses later, where the echo's amplitude was recorded.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// Amplitude that the delay is stated for, relative to full scale.
const REFERENCE: f64 = 0.5;
/// How many times later an echo can be, as for `amplitude_walk`.
const LATEST: f64 = 10.0;
/// Amplitude below which nothing is an echo: keeps the division finite.
const FAINTEST: f64 = 1e-4;

/// See [`RecordedAmplitude::FACTS`].
pub struct RecordedAmplitude;

impl Effect for RecordedAmplitude {
    const FACTS: Facts = Facts {
        id: "recorded_amplitude",
        stage: Stage::Transducer,
        sentence: "A fainter echo crosses the threshold later (amplitude_walk); the recorded amplitude was not used.",
        formula: "t' = t + delay u (1 + 1/10) / (1 + u/10), u = 0.5 / A, A the amplitude relative to full scale",
        source: "an echo that rises in proportion crosses after a time as threshold / amplitude: Parrilla, \
                 Anaya and Fritsch 1991, IEEE Trans. Instrum. Meas. 40, 759",
        reads: &[Quantity::Amplitude],
        requires: &[Quantity::Amplitude],
        parameters: &[ParameterFacts {
            name: "delay",
            unit: "s",
            bounds: (0.0, 2e-3),
            prior_scale: 20e-6,
            ..ParameterFacts::USUAL
        }],
        domain: "an amplifier that does not clip: beyond full scale the amplitude tells nothing",
        check: "change the target's reflectivity at one distance",
        firmware: Firmware::Needs(Quantity::Amplitude),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let amplitude = chain.recorded.get(Quantity::Amplitude);
        let fainter = S::constant(REFERENCE) / amplitude.max(S::constant(FAINTEST));
        let latest = S::constant(1.0 / LATEST).mul_add(fainter, S::constant(1.0));
        let later = fainter * S::constant(1.0 + 1.0 / LATEST) / latest;
        chain.time = parameters[0].mul_add(later, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use super::LATEST;
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(distance: f64, amplitude: f64) -> f64 {
        let at = Conditions::at(20.0).with(Quantity::Amplitude, amplitude);
        1e3 * error(
            "linear",
            "recorded_amplitude",
            &[("delay", 20e-6)],
            distance,
            &at,
        )
    }

    #[test]
    fn twenty_microseconds_at_half_scale_are_3_millimeters() {
        // 1 us is 0.1717 mm at 20 degC
        for distance in [0.3, 2.0, 5.0] {
            assert!((millimeters(distance, 0.5) - 20.0 * 0.1717).abs() < 1e-9);
        }
    }

    #[test]
    fn later_as_the_echo_fades_up_to_a_limit() {
        let steps = [1.0, 0.5, 0.2, 0.1, 0.01, 0.0].map(|amplitude| millimeters(2.0, amplitude));
        assert!(steps.is_sorted_by(|a, b| a <= b), "{steps:?}");
        assert!(steps[5] < 20.0 * 0.1717 * (LATEST + 1.0));
    }
}

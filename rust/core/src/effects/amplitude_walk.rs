//! A threshold that a fainter echo crosses later.

use super::{Effect, Facts, Firmware, ParameterFacts, Role, Tried};
use crate::air::absorption;
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// Carrier of most rangers \[Hz\].
const FREQUENCY: f64 = 40e3;
/// Distance that the delay is stated for \[m\].
const REFERENCE: f64 = 4.0;
/// How many times later an echo can be.
const LATEST: f64 = 10.0;
/// Decibels in a neper.
const DECIBEL_PER_NEPER: f64 = 8.685_889_638_065_035;

/// See [`AmplitudeWalk::FACTS`].
pub struct AmplitudeWalk;

impl Effect for AmplitudeWalk {
    const FACTS: Facts = Facts {
        id: "amplitude_walk",
        stage: Stage::Transducer,
        sentence: "A fainter echo rises more slowly and crosses the comparator's threshold later.",
        formula: "t' = t + delay u (1 + 1/10) / (1 + u/10), u = (d / 4 m) exp(2 steepness alpha (d - 4 m)), alpha \
                  the absorption of air at 40 kHz",
        source: "threshold detectors err by millimeters to centimeters: Parrilla, Anaya and Fritsch 1991, IEEE \
                 Trans. Instrum. Meas. 40, 759; absorption: ISO 9613-1:1993",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
        ],
        requires: &[Quantity::Temperature],
        parameters: &[
            ParameterFacts {
                name: "delay",
                unit: "s",
                bounds: (0.0, 2e-3),
                prior_scale: 40e-6,
                ..ParameterFacts::USUAL
            },
            ParameterFacts {
                name: "steepness",
                role: Role::Shape,
                neutral: 1.0,
                bounds: (0.0, 3.0),
                prior_scale: 0.5,
                tried: Tried::Values(&[1.0, 1.7, 2.5]),
                ..ParameterFacts::USUAL
            },
        ],
        domain: "one target; 0.1 to 6 m; without recorded humidity alpha is that of the model's assumed air",
        check: "record the echo's amplitude, or change the target's reflectivity at one distance",
        firmware: Firmware::Refused(
            "its delay grows with the echo; the generator's forms have one delay for all echoes",
        ),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let neper = absorption(&chain.air, S::constant(FREQUENCY)) * S::constant(1.0 / DECIBEL_PER_NEPER);
        let further = chain.path - S::constant(REFERENCE);
        let fainter = (S::constant(2.0) * parameters[1] * neper * further).exp();
        let fainter = chain.path * S::constant(1.0 / REFERENCE) * fainter;
        // an echo that is ten times later than that from 4 m is lost in noise
        let latest = S::constant(1.0 / LATEST).mul_add(fainter, S::constant(1.0));
        let later = fainter * S::constant(1.0 + 1.0 / LATEST) / latest;
        chain.time = parameters[0].mul_add(later, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use super::REFERENCE;
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    fn millimeters(distance: f64, temperature: f64, humidity: f64) -> f64 {
        let at = Conditions::at(temperature).with(Quantity::RelativeHumidity, humidity);
        1e3 * error("linear", "amplitude_walk", &[("delay", 40e-6)], distance, &at)
    }

    #[test]
    fn forty_microseconds_at_4_meters_are_7_millimeters() {
        // 1 us is 0.1717 mm at 20 degC, whatever the absorption
        for humidity in [0.1, 0.5, 0.9] {
            assert!((millimeters(REFERENCE, 20.0, humidity) - 40.0 * 0.1717).abs() < 1e-9);
        }
    }

    #[test]
    fn grows_with_distance_and_where_air_absorbs_more() {
        let steps = [0.1, 0.5, 1.0, 2.0, 4.0, 8.0].map(|distance| millimeters(distance, 20.0, 0.5));
        assert!(steps.is_sorted() && steps[0] < 0.2);
        // half way, u is a half less what the further half absorbs: 1.32 dB/m at 20 degC and 50 %
        let half = 0.5 * 10_f64.powf(-1.32 * 2.0 * 2.0 / 20.0);
        let expected = 40.0 * 0.1717 * 1.1 * half / (1.0 + 0.1 * half);
        assert!((steps[3] / expected - 1.0).abs() < 0.01, "{} {expected}", steps[3]);
    }
}

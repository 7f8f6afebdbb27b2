//! Transducers whose resonance leaves the carrier.

use super::{Effect, Facts, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`ResonanceDrift::FACTS`].
pub struct ResonanceDrift;

impl Effect for ResonanceDrift {
    const FACTS: Facts = Facts {
        id: "resonance_drift",
        stage: Stage::Transducer,
        sentence: "Away from 25 degC the transducers' resonance leaves 40 kHz: the echo is fainter and detected later.",
        formula: "t' = t + delay ((T - 25 degC) / 25 K)^2",
        source: "400PT120 data sheet (prowave): center within 1 kHz, 2 kHz wide at -6 dB",
        reads: &[Quantity::Temperature],
        requires: &[Quantity::Temperature],
        parameters: &[ParameterFacts {
            name: "delay",
            unit: "s",
            bounds: (0.0, 1e-3),
            prior_scale: 15e-6,
            ..ParameterFacts::USUAL
        }],
        domain: "transducers that are in tune at 25 degC; 40 K to either side",
        check: "measure at two distances and 0, 25 and 50 degC: it does not grow with distance",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let away = (chain.recorded.get(Quantity::Temperature) - S::constant(25.0))
            * S::constant(1.0 / 25.0);
        chain.time = (parameters[0] * away).mul_add(away, chain.time);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::error;

    fn millimeters(distance: f64, temperature: f64) -> f64 {
        let at = Conditions::at(temperature);
        1e3 * error(
            "linear",
            "resonance_drift",
            &[("delay", 15e-6)],
            distance,
            &at,
        )
    }

    #[test]
    fn fifteen_microseconds_at_0_and_at_50_degc() {
        assert!((millimeters(2.0, 0.0) - 15.0 * 0.1657).abs() < 1e-9);
        assert!((millimeters(2.0, 50.0) - 15.0 * 0.1807).abs() < 1e-9);
    }

    #[test]
    fn nothing_at_25_degc_and_the_same_at_every_distance() {
        assert!(millimeters(2.0, 25.0).abs() < 1e-12);
        assert!((millimeters(0.2, 5.0) - millimeters(8.0, 5.0)).abs() < 1e-11);
    }
}

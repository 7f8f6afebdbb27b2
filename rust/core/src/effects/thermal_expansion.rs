//! A mount that grows with the warmth.

use super::{Effect, Facts, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// Temperature at which people measure where the sensor sits \[degC\].
const REFERENCE: f64 = 20.0;

/// See [`ThermalExpansion::FACTS`].
pub struct ThermalExpansion;

impl Effect for ThermalExpansion {
    const FACTS: Facts = Facts {
        id: "thermal_expansion",
        stage: Stage::Path,
        sentence: "Mast, bracket or tank grow with the warmth and carry the sensor away from the target.",
        formula: "d' = d + expansion (T - 20 degC)",
        source: "2 m of steel at 12e-6/K or 0.3 m of PVC at 80e-6/K are 24 um/K: Kaye and Laby 2.3.5 \
                 (general knowledge for the lengths)",
        reads: &[Quantity::Temperature],
        requires: &[Quantity::Temperature],
        parameters: &[ParameterFacts {
            name: "expansion",
            unit: "m/K",
            bounds: (-1e-3, 1e-3),
            prior_scale: 25e-6,
            ..ParameterFacts::USUAL
        }],
        domain: "a mount as warm as the air; the sun on it does more",
        check: "measure the mount's height at noon and at dawn, or the same target with another bracket",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let warmer = chain.air.temperature - S::constant(REFERENCE);
        chain.path = parameters[0].mul_add(warmer, chain.path);
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
            "thermal_expansion",
            &[("expansion", 24e-6)],
            distance,
            &at,
        )
    }

    #[test]
    fn two_meters_of_steel_move_half_a_millimeter_in_20_kelvin() {
        // 2 m x 12e-6/K x 20 K
        assert!((millimeters(2.0, 40.0) - 0.48).abs() < 1e-9);
    }

    #[test]
    fn the_same_at_every_distance_and_of_either_sign() {
        assert_eq!(millimeters(2.0, 20.0), 0.0);
        assert!((millimeters(0.5, 35.0) - millimeters(4.0, 35.0)).abs() < 1e-9);
        assert!((millimeters(1.0, 0.0) + millimeters(1.0, 40.0)).abs() < 1e-9);
    }
}

//! Air that is warmer further away.

use super::{Effect, Facts, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// See [`TemperatureGradient::FACTS`].
pub struct TemperatureGradient;

impl Effect for TemperatureGradient {
    const FACTS: Facts = Facts {
        id: "temperature_gradient",
        stage: Stage::Air,
        sentence: "The thermometer hangs at the sensor, and the air along the path is warmer or colder by distance.",
        formula: "T' = T + gradient d / 2, the mean over the path",
        source: "0.2 to 2 K/m indoors and above ground (general knowledge)",
        requires: &[Quantity::Temperature],
        parameters: &[ParameterFacts {
            name: "gradient",
            unit: "K/m",
            bounds: (-20.0, 20.0),
            prior_scale: 0.8,
            ..ParameterFacts::USUAL
        }],
        of_distance: true,
        bends: true,
        // even, it took the place of a comparator's time walk, which is as curved
        prior: 0.1,
        domain: "a gradient that is even along the path",
        check: "a second thermometer at the target, or several distances",
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let half = S::constant(0.5) * chain.distance;
        chain.air.temperature = parameters[0].mul_add(half, chain.air.temperature);
    }
}

#[cfg(test)]
mod tests {
    use crate::Conditions;
    use crate::effects::testing::{error, model};

    #[test]
    fn eight_tenths_of_a_kelvin_a_meter_are_minus_3_millimeters_at_2_meters() {
        // 0.8 K on the mean of the path: -0.6 G' d^2 / c with G' = 0.4 K/m
        let gradient = &[("gradient", 0.8)];
        let error = error(
            "linear",
            "temperature_gradient",
            gradient,
            2.0,
            &Conditions::at(20.0),
        );
        assert!((error - -2.0 * 0.48 / 343.88).abs() < 1e-12);
    }

    #[test]
    fn grows_with_the_square_of_the_distance_and_is_an_offset_at_each() {
        for distance in [0.5, 2.0, 8.0] {
            let at = Conditions::at(10.0);
            let offset = &[("offset", 0.5 * distance)];
            let warm = model("cramer", "temperature_offset", offset).indicate(distance, &at);
            let found = model("cramer", "temperature_gradient", &[("gradient", 1.0)])
                .indicate(distance, &at);
            assert!((found - warm).abs() < 1e-14);
        }
    }
}

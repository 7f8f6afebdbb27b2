//! A recorded angle of incidence that the device does not use.

use super::{Effect, Facts, Firmware, ParameterFacts};
use crate::chain::{Chain, Stage};
use crate::conditions::Quantity;
use crate::scalar::{Scalar, polynomial};

/// `1 - cos(angle)` as its series, cut below 2e-17 for a quarter turn either way.
#[inline(always)]
pub(super) fn versine<S: Scalar>(angle: S) -> S {
    const SERIES: [f64; 11] = {
        let mut series = [0.5; 11]; // 1/2!, -1/4!, 1/6!, ...
        let mut k = 1;
        while k < series.len() {
            let n = 2.0 * k as f64;
            series[k] = -series[k - 1] / ((n + 1.0) * (n + 2.0));
            k += 1;
        }
        series
    };
    let square = angle * angle;
    square * polynomial(square, SERIES)
}

/// See [`RecordedAngle::FACTS`].
pub struct RecordedAngle;

impl Effect for RecordedAngle {
    const FACTS: Facts = Facts {
        id: "recorded_angle",
        stage: Stage::Path,
        sentence: "The angle at which the sensor looks at the target was recorded and not used.",
        formula: "d' = d (1 - coefficient (1 - cos(angle))); geometry says 1",
        source: "geometry of a flat mirror: the perpendicular from sensor to target is d cos(angle)",
        reads: &[Quantity::Angle],
        requires: &[Quantity::Angle],
        parameters: &[ParameterFacts::COEFFICIENT],
        domain: "a flat target larger than the beam; angles within the beam's half width",
        check: "turn the sensor on purpose and record the angle",
        firmware: Firmware::Needs(Quantity::Angle),
        ..Facts::USUAL
    };

    #[inline(always)]
    fn apply<S: Scalar>(chain: &mut Chain<S>, parameters: &[S]) {
        let shorter = versine(chain.recorded.get(Quantity::Angle)) * chain.path;
        chain.path = (-parameters[0]).mul_add(shorter, chain.path);
    }
}

#[cfg(test)]
mod tests {
    use super::versine;
    use crate::effects::testing::error;
    use crate::{Conditions, Quantity};

    #[test]
    fn series_of_one_minus_cosine() {
        for degrees in -90..=90 {
            let angle = f64::from(degrees).to_radians();
            assert!(
                (versine(angle) - (1.0 - angle.cos())).abs() < 4e-16,
                "{degrees}"
            );
        }
    }

    #[test]
    fn millimeters_at_2_meters_as_printed_and_nothing_square_on() {
        let at = |degrees: f64| {
            let at = Conditions::at(20.0).with(Quantity::Angle, degrees.to_radians());
            1e3 * error(
                "linear",
                "recorded_angle",
                &[("coefficient", 1.0)],
                2.0,
                &at,
            )
        };
        // the catalog's column: degrees, millimeters, half a digit
        for (degrees, printed, half_a_digit) in
            [(5.0, -7.6, 0.05), (8.0, -19.0, 0.5), (15.0, -68.0, 0.5)]
        {
            assert!((at(degrees) - printed).abs() <= half_a_digit);
            assert!((at(degrees) - at(-degrees)).abs() < 1e-12);
        }
        assert_eq!(at(0.0), 0.0);
    }
}

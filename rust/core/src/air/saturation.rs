//! Saturation pressure of water vapor for many rows: a polynomial in place of an exponential.

use super::vapor_pressure::saturation_pressure;
use crate::scalar::{Rows, Scalar, polynomial};

/// Middle and half width of the polynomial's range, -40..85 degC.
const MIDDLE: f64 = 22.5;
const HALF_WIDTH: f64 = 62.5;

/// Chebyshev interpolation of [`saturation_pressure`] at 14 points, in powers of
/// `x = (t - MIDDLE) / HALF_WIDTH`, even powers and odd powers apart: two short chains of
/// dependent operations instead of a long one.
const EVEN: [f64; 7] = [
    2726.942268928173,
    17184.490258078593,
    8847.142119827204,
    195.04845892714468,
    -15.98719617292019,
    0.9160806246634046,
    -0.023618426706109728,
];
const ODD: [f64; 7] = [
    10356.780280112467,
    16021.730869698928,
    2644.937314894814,
    -110.67127124982655,
    7.1920598449983775,
    -0.4878417886793616,
    0.026613580329077586,
];

/// [`saturation_pressure`] \[Pa\] within 2e-9 relative (below 1e-11 m/s in the speed of sound); the
/// formula itself outside -40..85 degC. A row's value does not depend on its neighbors.
#[inline(always)]
pub(super) fn saturation_pressure_of_rows<S: Rows>(temperature: S) -> S {
    let x = (temperature - S::constant(MIDDLE)) * S::constant(1.0 / HALF_WIDTH);
    let inside = S::constant(1.0) - x.abs();
    let fitted = interpolant(x);
    if inside.all_non_negative() {
        return fitted;
    }
    S::select(inside, fitted, saturation_pressure(temperature))
}

#[inline(always)]
fn interpolant<S: Scalar>(x: S) -> S {
    let square = x * x;
    polynomial(square, ODD).mul_add(x, polynomial(square, EVEN))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relative_error(temperature: f64) -> f64 {
        saturation_pressure_of_rows(temperature) / saturation_pressure(temperature) - 1.0
    }

    #[test]
    fn follows_the_formula_where_it_is_fitted() {
        let worst = (-40_000..=85_000)
            .map(|t| relative_error(f64::from(t) * 1e-3).abs())
            .fold(0.0, f64::max);
        assert!(worst < 2e-9, "{worst}");
        assert!(worst > 1e-12, "the polynomial is not in use");
    }

    #[test]
    fn is_the_formula_elsewhere() {
        for temperature in [-60.0, -40.001, 85.001, 120.0] {
            assert_eq!(relative_error(temperature), 0.0);
        }
        assert!(saturation_pressure_of_rows(f64::NAN).is_nan());
    }

    #[test]
    fn single_precision_keeps_its_digits() {
        for t in -40_i16..=85 {
            let single = f64::from(saturation_pressure_of_rows(f32::from(t)));
            let exact = saturation_pressure(f64::from(t));
            assert!(
                (single - exact).abs() < 2e-6 * exact + 1e-2,
                "{t}: {single} {exact}"
            );
        }
    }
}

//! Saturation pressure of water vapor; for many rows a polynomial in place of an exponential.

use crate::scalar::{Rows, Scalar, polynomial};

/// 0 degC \[K\].
pub const ZERO_CELSIUS: f64 = 273.15;

/// CIPM vapor pressure, `exp(A T^2 + B T + C + D/T)` with T in K; `tail` is `[C, B, A]`.
#[inline(always)]
fn vapor_pressure<S: Scalar>(temperature: S, tail: [f64; 3], over_kelvin: f64) -> S {
    let kelvin = temperature + S::constant(ZERO_CELSIUS);
    (S::constant(over_kelvin) / kelvin + polynomial(kelvin, tail)).exp()
}

/// Saturation pressure of water vapor over liquid water, also supercooled \[Pa\]; t in degC.
///
/// Davis 1992 (CIPM-81/91), Metrologia 29, 67, eq. (A1.1), doi:10.1088/0026-1394/29/1/008.
#[inline(always)]
pub fn saturation_pressure<S: Scalar>(temperature: S) -> S {
    const TAIL: [f64; 3] = [33.937_110_47, -1.912_131_6e-2, 1.237_884_7e-5];
    vapor_pressure(temperature, TAIL, -6_343.164_5)
}

/// Saturation pressure \[Pa\] of the older CIPM-81, which Cramer's appendix (eq. A3) prints.
///
/// Giacomo 1982, Metrologia 18, 33, doi:10.1088/0026-1394/18/1/006. Not used by any law here:
/// tables older than 1992 were computed with it.
#[inline(always)]
pub fn saturation_pressure_giacomo<S: Scalar>(temperature: S) -> S {
    const TAIL: [f64; 3] = [34.049_260_34, -1.950_987_4e-2, 1.281_180_5e-5];
    vapor_pressure(temperature, TAIL, -6_353.631_1)
}

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

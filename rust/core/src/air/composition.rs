//! How much water is in moist air.

use super::Air;
use crate::scalar::{Scalar, polynomial};

/// 0 degC \[K\].
pub const ZERO_CELSIUS: f64 = 273.15;

/// Saturation pressure of water vapor over liquid water \[Pa\], t in degC.
///
/// Davis 1992 (CIPM-81/91), Metrologia 29, 67, eq. (A1.1), doi:10.1088/0026-1394/29/1/008.
#[inline(always)]
pub fn saturation_pressure<S: Scalar>(temperature: S) -> S {
    let kelvin = temperature + S::constant(ZERO_CELSIUS);
    let tail = polynomial(kelvin, [33.937_110_47, -1.912_131_6e-2, 1.237_884_7e-5]);
    (S::constant(-6_343.164_5) / kelvin + tail).exp()
}

/// Enhancement factor of moist air against pure water vapor \[1\].
///
/// Davis 1992, eq. (A1.2); the quadratic term takes t in degC.
#[inline(always)]
pub fn enhancement_factor<S: Scalar>(temperature: S, pressure: S) -> S {
    let at_pressure = S::constant(3.14e-8).mul_add(pressure, S::constant(1.000_62));
    (S::constant(5.6e-7) * temperature).mul_add(temperature, at_pressure)
}

/// Mole fraction of water vapor \[1\].
#[inline(always)]
pub fn water_vapor_mole_fraction<S: Scalar>(air: &Air<S>) -> S {
    let saturated = saturation_pressure(air.temperature);
    let enhanced = enhancement_factor(air.temperature, air.pressure) * saturated;
    air.relative_humidity * enhanced / air.pressure
}

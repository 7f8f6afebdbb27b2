//! How much water is in moist air, and what a mole of it weighs.

use super::Air;
use super::saturation::saturation_pressure_of_rows;
use crate::scalar::{Rows, Scalar, polynomial};

/// 0 degC \[K\].
pub const ZERO_CELSIUS: f64 = 273.15;
/// Molar gas constant \[J/(mol K)\], SI brochure 9th edition (exact).
pub const GAS_CONSTANT: f64 = 8.314_462_618_153_24;
/// Molar mass of dry air with 400 ppm CO2 \[kg/mol\], CIPM-2007 (Picard et al. 2008,
/// doi:10.1088/0026-1394/45/2/004), eq. (3).
const DRY_AIR: f64 = 28.965_46e-3;
/// What a mole of CO2 adds to it \[kg/mol\]: it takes the place of oxygen, CIPM-2007 eq. (3).
const CO2_FOR_OXYGEN: f64 = 12.011e-3;
/// Molar mass of water \[kg/mol\], CIPM-2007.
const WATER: f64 = 18.015_28e-3;
/// CO2 mole fraction that [`DRY_AIR`] stands for \[1\].
const CO2: f64 = 4e-4;

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

/// Enhancement factor of moist air against pure water vapor \[1\].
///
/// Davis 1992, eq. (A1.2); the quadratic term takes t in degC.
#[inline(always)]
pub fn enhancement_factor<S: Scalar>(temperature: S, pressure: S) -> S {
    let at_pressure = S::constant(3.14e-8).mul_add(pressure, S::constant(1.000_62));
    (S::constant(5.6e-7) * temperature).mul_add(temperature, at_pressure)
}

/// Mole fraction of water vapor \[1\], Davis 1992, section 3.
///
/// Relative humidity is over liquid water at every temperature, as meteorology reports it
/// (WMO-No. 8, annex 4.A); over ice it would be smaller by 18 % at -20 degC.
#[inline(always)]
pub fn water_vapor_mole_fraction<S: Scalar>(air: &Air<S>) -> S {
    diluted(air, saturation_pressure(air.temperature))
}

/// The same for many rows, whose saturation pressure comes from a polynomial where one holds.
#[inline(always)]
pub(crate) fn water_vapor_mole_fraction_of_rows<S: Rows>(air: &Air<S>) -> S {
    diluted(air, saturation_pressure_of_rows(air.temperature))
}

#[inline(always)]
fn diluted<S: Scalar>(air: &Air<S>, saturated: S) -> S {
    let enhanced = enhancement_factor(air.temperature, air.pressure) * saturated;
    air.relative_humidity * enhanced / air.pressure
}

/// CO2 mole fraction beyond the one that dry air's constants stand for \[1\].
#[inline(always)]
pub(super) fn co2_excess<S: Scalar>(air: &Air<S>) -> S {
    air.co2_mole_fraction - S::constant(CO2)
}

/// Molar mass of moist air \[kg/mol\], CIPM-2007 eq. (1) to (3).
#[inline(always)]
pub(super) fn molar_mass<S: Scalar>(water: S, co2_excess: S) -> S {
    let dry = S::constant(CO2_FOR_OXYGEN).mul_add(co2_excess, S::constant(DRY_AIR));
    water.mul_add(S::constant(WATER) - dry, dry)
}

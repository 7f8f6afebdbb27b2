//! How much water is in moist air, and what a mole of it weighs.

use super::Air;
use super::saturation::saturation_pressure_of_rows;
use crate::scalar::{Rows, Scalar};

pub use super::vapor_pressure::{ZERO_CELSIUS, saturation_pressure, saturation_pressure_giacomo};

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

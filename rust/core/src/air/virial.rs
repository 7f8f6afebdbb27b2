//! Acoustic virial equation of moist air: holds where Cramer's polynomial ends.

use super::composition::{GAS_CONSTANT, ZERO_CELSIUS, co2_excess, molar_mass};
use super::domain::MOIST_AIR;
use super::virial_coefficients as coefficients;
use super::{Air, LawFacts, SpeedLaw};
use crate::conditions::Quantity;
use crate::scalar::{Scalar, polynomial};

/// The speed in the ideal mixture, times what molecules do to each other, in powers of density.
///
/// Ideal part: heat capacities of dry air (Lemmon et al. 2000, doi:10.1063/1.1285884), water vapor
/// (IAPWS R6-95, doi:10.1063/1.1461829) and CO2 in the place of oxygen. Virial part: fitted half
/// way between ASHRAE RP-1485 (CoolProp's `HAPropsSI`) and IAPWS G8-10, which part by up to
/// 0.03 % next to saturated steam; see `tests/reference/fit_virial.py`.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Virial;

impl SpeedLaw for Virial {
    const FACTS: LawFacts = LawFacts {
        id: "virial",
        sentence: "Zero-frequency speed of sound in moist air with CO2, also where it is hot and wet.",
        formula: "c^2 = gamma R T / M (1 + beta q + gamma' q^2 + delta q^3), q = p / (R T)",
        source: "fitted by tests/reference/fit_virial.py to ASHRAE RP-1485 \
                 (doi:10.1080/10789669.2009.10390874) and IAPWS G8-10",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
            Quantity::Co2MoleFraction,
        ],
        domain: "-20..60 degC, 60..110 kPa, 0..100 % relative humidity, xc <= 0.01",
        limits: MOIST_AIR,
    };

    #[inline(always)]
    fn at_composition<S: Scalar>(&self, air: &Air<S>, water: S) -> S {
        let one = S::constant(1.0);
        let hundreds = air.temperature * S::constant(0.01);
        let thermal = (air.temperature + S::constant(ZERO_CELSIUS)) * S::constant(GAS_CONSTANT);
        let capacity = heat_capacity(hundreds, water, co2_excess(air));
        let mass = molar_mass(water, co2_excess(air));
        let density = air.pressure * S::constant(1e-6) / thermal;
        let real = density.mul_add(interaction(hundreds, water, density), one);
        (capacity * thermal * real / ((capacity - one) * mass)).sqrt()
    }
}

/// Molar heat capacity of the ideal mixture at constant pressure, over R \[1\].
#[inline(always)]
fn heat_capacity<S: Scalar>(hundreds: S, water: S, co2_excess: S) -> S {
    let air = polynomial(hundreds, coefficients::AIR_HEAT_CAPACITY);
    let co2 = polynomial(hundreds, coefficients::CO2_HEAT_CAPACITY);
    let air = co2.mul_add(co2_excess, air);
    let vapor = polynomial(hundreds, coefficients::WATER_HEAT_CAPACITY);
    water.mul_add(vapor - air, air)
}

/// Acoustic virials of the mixture, `beta + gamma q + delta q^2` \[cm^3/mol\]; q in mol/cm^3.
#[inline(always)]
fn interaction<S: Scalar>(hundreds: S, water: S, density: S) -> S {
    let air = S::constant(1.0) - water;
    let air_second = polynomial(hundreds, coefficients::AIR_SECOND);
    let cross_second = polynomial(hundreds, coefficients::CROSS_SECOND);
    let water_second = polynomial(hundreds, coefficients::WATER_SECOND);
    let second = (air * air).mul_add(
        air_second,
        water * air.mul_add(cross_second, water * water_second),
    );
    let cube = water * water * water;
    let third = cube.mul_add(
        S::constant(coefficients::WATER_THIRD[0]),
        air * air * air * S::constant(coefficients::AIR_THIRD[0]),
    );
    let fourth = cube * water * S::constant(coefficients::WATER_FOURTH[0]);
    density.mul_add(density.mul_add(fourth, third), second)
}

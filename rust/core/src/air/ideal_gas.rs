//! Moist air as a mixture of ideal gases.

use super::composition::{ZERO_CELSIUS, water_vapor_mole_fraction};
use super::{Air, LawFacts, SpeedLaw};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// `c = sqrt(gamma R T / M)` with gamma and M of the mixture.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct IdealGas;

/// Molar gas constant \[J/(mol K)\], SI brochure 9th edition (exact).
const GAS_CONSTANT: f64 = 8.314_462_618_153_24;
/// Molar mass of dry air with 0.04 % CO2 \[kg/mol\], CIPM-2007 (Picard et al. 2008) eq. (3).
const DRY_AIR: f64 = 28.965_46e-3;
/// Molar mass of water \[kg/mol\], CIPM-2007.
const WATER: f64 = 18.015_28e-3;
/// Molar heat capacity at constant pressure over R: diatomic gas 7/2, water vapor 4 (rigid rotor).
const HEAT_CAPACITY: (f64, f64) = (3.5, 4.0);

impl SpeedLaw for IdealGas {
    const FACTS: LawFacts = LawFacts {
        id: "ideal_gas",
        sentence: "Mixture of ideal gases with rigid molecules.",
        formula: "c = sqrt(gamma R T / M)",
        source: "molar masses: Picard et al. 2008, doi:10.1088/0026-1394/45/2/004",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
        ],
        domain: "-20..60 degC",
    };

    #[inline(always)]
    fn speed<S: Scalar>(&self, air: &Air<S>) -> S {
        let water = water_vapor_mole_fraction(air);
        let capacity = water.mul_add(
            S::constant(HEAT_CAPACITY.1 - HEAT_CAPACITY.0),
            S::constant(HEAT_CAPACITY.0),
        );
        let gamma = capacity / (capacity - S::constant(1.0));
        let molar_mass = water.mul_add(S::constant(WATER - DRY_AIR), S::constant(DRY_AIR));
        let kelvin = air.temperature + S::constant(ZERO_CELSIUS);
        (gamma * S::constant(GAS_CONSTANT) * kelvin / molar_mass).sqrt()
    }
}

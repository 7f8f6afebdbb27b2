//! Moist air as a mixture of ideal gases of rigid molecules.

use super::composition::{GAS_CONSTANT, ZERO_CELSIUS, co2_excess, molar_mass};
use super::domain::MOIST_AIR;
use super::{Air, LawFacts, SpeedLaw};
use crate::conditions::Quantity;
use crate::scalar::Scalar;

/// `c = sqrt(gamma R T / M)` with gamma and M of the mixture.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct IdealGas;

/// Molar heat capacity at constant pressure over R of a rigid diatomic gas: 7/2.
const DIATOMIC: f64 = 3.5;
/// The same of a rigid bent molecule, water vapor: 4.
const WATER: f64 = 4.0;

impl SpeedLaw for IdealGas {
    const FACTS: LawFacts = LawFacts {
        id: "ideal_gas",
        sentence: "Mixture of ideal gases with rigid molecules, as textbooks have it.",
        formula: "c = sqrt(gamma R T / M), gamma = (7 + xw) / (5 + xw)",
        source: "Bohn 1988, J. Audio Eng. Soc. 36, 223 (gamma); Picard et al. 2008, \
                 doi:10.1088/0026-1394/45/2/004 (molar masses)",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
            Quantity::Co2MoleFraction,
        ],
        domain: "-20..60 degC, 60..110 kPa; no real-gas term, no vibration",
        limits: MOIST_AIR,
    };

    #[inline(always)]
    fn at_composition<S: Scalar>(&self, air: &Air<S>, water: S) -> S {
        let capacity = water.mul_add(S::constant(WATER - DIATOMIC), S::constant(DIATOMIC));
        let mass = molar_mass(water, co2_excess(air));
        let kelvin = air.temperature + S::constant(ZERO_CELSIUS);
        let scaled = capacity * S::constant(GAS_CONSTANT) * kelvin;
        (scaled / ((capacity - S::constant(1.0)) * mass)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditions::Conditions;

    #[test]
    fn dry_air_at_zero_celsius_by_hand() {
        // sqrt(1.4 * 8.31446261815324 * 273.15 / 0.02896546), by another tool
        let air = Air::recorded(&Conditions::at(0.0));
        assert!((IdealGas.speed(&air) - 331.315_304_546_301_1).abs() < 1e-10);
    }
}

//! Cramer's equation for moist air with carbon dioxide.

use super::domain::{Limits, MOIST_AIR};
use super::{Air, LawFacts, SpeedLaw};
use crate::conditions::Quantity;
use crate::scalar::{Scalar, polynomial};

/// Cramer 1993, eq. (15) with Table III.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Cramer;

impl SpeedLaw for Cramer {
    const FACTS: LawFacts = LawFacts {
        id: "cramer",
        sentence: "Zero-frequency speed of sound in moist air with CO2, 300 ppm in its stated box.",
        formula: "c = a0 + a1 t + a2 t^2 + (a3 + a4 t + a5 t^2) xw + (a6 + a7 t + a8 t^2) p \
                  + (a9 + a10 t + a11 t^2) xc + a12 xw^2 + a13 p^2 + a14 xc^2 + a15 xw p xc",
        source: "Cramer 1993, J. Acoust. Soc. Am. 93, 2510, doi:10.1121/1.405827",
        reads: &[
            Quantity::Temperature,
            Quantity::RelativeHumidity,
            Quantity::Pressure,
            Quantity::Co2MoleFraction,
        ],
        domain: "stated 0..30 degC, 75..102 kPa, xw <= 0.06, xc <= 0.01; measured to hold its 300 ppm \
                 over -20..60 degC, 60..110 kPa as long as xw <= 0.06",
        limits: Limits {
            water_vapor_mole_fraction: (0.0, 0.06),
            ..MOIST_AIR
        },
    };

    #[inline(always)]
    fn at_composition<S: Scalar>(&self, air: &Air<S>, xw: S) -> S {
        let (t, p, xc) = (air.temperature, air.pressure, air.co2_mole_fraction);
        let dry = polynomial(t, [331.5024, 0.603_055, -0.000_528]);
        let water = polynomial(t, [51.471_935, 0.149_587_4, -0.000_782]);
        let pressure = polynomial(t, [-1.82e-7, 3.73e-8, -2.93e-10]);
        let carbon_dioxide = polynomial(t, [-85.209_31, -0.228_525, 5.91e-5]);
        let water = S::constant(-2.835_149).mul_add(xw, water);
        let water = (S::constant(0.000_486) * p).mul_add(xc, water);
        let pressure = S::constant(-2.15e-13).mul_add(p, pressure);
        let carbon_dioxide = S::constant(29.179_762).mul_add(xc, carbon_dioxide);
        let moist = water.mul_add(xw, dry);
        carbon_dioxide.mul_add(xc, pressure.mul_add(p, moist))
    }
}

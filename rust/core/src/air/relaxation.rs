//! Vibrational relaxation of oxygen and nitrogen, which absorbs sound and disperses it.
//!
//! ISO 9613-1:1993, section 6: valid for -20..50 degC, 0.05..5 % water, below 200 kPa and for
//! frequency over pressure of 4e-4..10 Hz/Pa.

use super::Air;
use super::composition::ZERO_CELSIUS;
use crate::scalar::{Scalar, polynomial};

/// Reference pressure \[Pa\], section 4.1.
pub(super) const REFERENCE_PRESSURE: f64 = 101_325.0;
/// Reference temperature 20 degC \[K\], section 4.1.
const REFERENCE_TEMPERATURE: f64 = 293.15;
/// Triple point of water \[K\], annex B.
const TRIPLE_POINT: f64 = 273.16;

/// The two relaxations of air at one frequency.
pub(super) struct Relaxations<S> {
    /// Oxygen.
    pub oxygen: Relaxation<S>,
    /// Nitrogen.
    pub nitrogen: Relaxation<S>,
    /// Square root of the temperature over the reference temperature \[1\].
    pub root: S,
}

/// One relaxation.
pub(super) struct Relaxation<S> {
    /// Relaxation frequency \[Hz\].
    pub frequency: S,
    /// Its part of the absorption over the square of the frequency \[Np s^2/m\].
    pub strength: S,
}

impl<S: Scalar> Relaxations<S> {
    /// Equations (3) to (5) and (B.1) to (B.3).
    #[inline(always)]
    pub(super) fn new(air: &Air<S>, frequency: S) -> Self {
        let one = S::constant(1.0);
        let kelvin = air.temperature + S::constant(ZERO_CELSIUS);
        let ratio = kelvin * S::constant(1.0 / REFERENCE_TEMPERATURE);
        let pressure = air.pressure * S::constant(1.0 / REFERENCE_PRESSURE);
        let root = ratio.sqrt();
        let water = water_percent(air.relative_humidity, kelvin, pressure);

        let wet = water * (S::constant(0.02) + water) / (S::constant(0.391) + water);
        let oxygen = pressure * S::constant(4.04e4).mul_add(wet, S::constant(24.0));
        // (T/T0)^(-1/3)
        let cube = (S::constant(-1.0 / 3.0) * ln_near_one(ratio)).exp();
        let collisions = (S::constant(-4.170) * (cube - one)).exp();
        let nitrogen =
            pressure / root * (S::constant(280.0) * water).mul_add(collisions, S::constant(9.0));

        let spread = one / (ratio * ratio * root); // (T/T0)^(-5/2)
        let inverse = one / kelvin;
        let common = [frequency, spread, inverse];
        Self {
            oxygen: Relaxation::new(oxygen, 0.012_75, 2_239.1, common),
            nitrogen: Relaxation::new(nitrogen, 0.106_8, 3_352.0, common),
            root,
        }
    }
}

impl<S: Scalar> Relaxation<S> {
    /// A term of equation (5), of its relaxation frequency, weight and characteristic temperature;
    /// `common` is the frequency, (T/T0)^(-5/2) and 1/T.
    #[inline(always)]
    fn new(relaxing: S, weight: f64, temperature: f64, common: [S; 3]) -> Self {
        let [frequency, spread, inverse] = common;
        let excited = S::constant(weight) * (S::constant(-temperature) * inverse).exp();
        let width = relaxing + frequency * frequency / relaxing;
        Self {
            frequency: relaxing,
            strength: spread * excited / width,
        }
    }
}

/// Molar concentration of water vapor \[%\], annex B with its own saturation pressure.
#[inline(always)]
fn water_percent<S: Scalar>(relative_humidity: S, kelvin: S, pressure: S) -> S {
    let ln_ratio = ln_near_one(S::constant(TRIPLE_POINT) / kelvin);
    let power = (S::constant(1.261) * ln_ratio).exp();
    let decades = S::constant(-6.834_6).mul_add(power, S::constant(4.615_1));
    let saturated = (S::constant(core::f64::consts::LN_10) * decades).exp();
    S::constant(100.0) * relative_humidity * saturated / pressure
}

/// Natural logarithm for ratios near one, branch-free: 2 atanh((x - 1) / (x + 1)) as a series.
///
/// Truncated below 1e-17 for 0.7 <= x <= 1.43, which is -82..146 degC in the ratios above.
#[inline(always)]
fn ln_near_one<S: Scalar>(x: S) -> S {
    const SERIES: [f64; 11] = [
        2.0,
        2.0 / 3.0,
        2.0 / 5.0,
        2.0 / 7.0,
        2.0 / 9.0,
        2.0 / 11.0,
        2.0 / 13.0,
        2.0 / 15.0,
        2.0 / 17.0,
        2.0 / 19.0,
        2.0 / 21.0,
    ];
    let z = (x - S::constant(1.0)) / (x + S::constant(1.0));
    z * polynomial(z * z, SERIES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithm_near_one() {
        for percent in 70..=143 {
            let x = f64::from(percent) / 100.0;
            assert!((ln_near_one(x) - x.ln()).abs() < 4e-16, "{x}");
        }
    }
}

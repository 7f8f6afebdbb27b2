//! Absorption of sound by air, ISO 9613-1:1993.

use super::Air;
use super::relaxation::{REFERENCE_PRESSURE, Relaxations};
use crate::scalar::Scalar;

/// Decibels in a neper, as rounded in the standard's equation (5).
const DECIBEL_PER_NEPER: f64 = 8.686;
/// Classical and rotational absorption at reference conditions, over frequency squared
/// \[Np s^2/m\], equation (5).
const CLASSICAL: f64 = 1.84e-11;

/// Attenuation coefficient of a pure tone \[dB/m\] at a frequency \[Hz\], equations (3) to (5).
#[inline(always)]
pub fn absorption<S: Scalar>(air: &Air<S>, frequency: S) -> S {
    let relaxations = Relaxations::new(air, frequency);
    let thinner = S::constant(CLASSICAL * REFERENCE_PRESSURE) / air.pressure;
    let relaxing = relaxations.oxygen.strength + relaxations.nitrogen.strength;
    let sum = thinner.mul_add(relaxations.root, relaxing);
    S::constant(DECIBEL_PER_NEPER) * frequency * frequency * sum
}

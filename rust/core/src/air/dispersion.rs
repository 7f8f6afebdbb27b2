//! Dispersion: sound above the relaxation frequencies is faster than the zero-frequency laws say.

use super::Air;
use super::relaxation::Relaxations;
use crate::scalar::Scalar;

/// Speed of sound at a frequency \[m/s\], from the speed at zero frequency \[m/s\].
///
/// IEC 61094-2:2009, F.3: `1/c = 1/c0 - sum alpha / (2 pi f_r)` over the relaxations of oxygen and
/// nitrogen, with attenuations alpha \[Np/m\] and relaxation frequencies of ISO 9613-1. Exactly
/// `speed` at frequency zero.
#[inline(always)]
pub fn dispersed<S: Scalar>(speed: S, air: &Air<S>, frequency: S) -> S {
    let relaxations = Relaxations::new(air, frequency);
    let (oxygen, nitrogen) = (relaxations.oxygen, relaxations.nitrogen);
    let sum = oxygen.strength / oxygen.frequency + nitrogen.strength / nitrogen.frequency;
    let slowness = frequency * frequency * S::constant(0.5 * core::f64::consts::FRAC_1_PI) * sum;
    speed / (S::constant(1.0) - speed * slowness)
}

//! Density of noise: normal, or with the heavier tails of Student's t.
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use crate::numeric::{PACK, Pack, on_widest};
use core::f64::consts::PI;

/// Student's t of so many degrees of freedom; normal where they are infinite.
#[derive(Clone, Copy, Debug)]
pub struct NoiseDensity {
    freedom: f64,
    constant: f64,
}

impl NoiseDensity {
    /// Of so many degrees of freedom.
    #[must_use]
    pub fn of(freedom: f64) -> Self {
        let constant = if freedom.is_infinite() {
            -0.5 * (2.0 * PI).ln()
        } else {
            let half = 0.5 * freedom;
            libm::lgamma(half + 0.5) - libm::lgamma(half) - 0.5 * (freedom * PI).ln()
        };
        Self { freedom, constant }
    }

    on_widest! {
        /// Log density at each of some numbers, of scale one.
        log_densities log_densities_avx2 log_densities_avx512 densities (values: &[f64]) -> Vec<f64>
    }

    #[inline(always)]
    fn densities(&mut self, values: &[f64]) -> Vec<f64> {
        let mut found = Vec::with_capacity(values.len() + PACK);
        for some in values.chunks(PACK) {
            let mut lane = Pack::all(0.0);
            lane.0[..some.len()].copy_from_slice(some);
            found.extend(self.log_density(lane * lane).0);
        }
        found.truncate(values.len());
        found
    }

    /// Log density where numbers have these squares.
    #[inline(always)]
    pub(super) fn log_density(&self, square: Pack) -> Pack {
        let constant = Pack::all(self.constant);
        if self.freedom.is_infinite() {
            return constant - Pack::all(0.5) * square;
        }
        let widened = Pack::all(1.0) + square / Pack::all(self.freedom);
        constant - Pack::all(0.5 * (self.freedom + 1.0)) * widened.ln()
    }

    /// How much numbers of these squares count beside a normal one of the same scale.
    #[inline(always)]
    pub(super) fn weight(&self, square: Pack) -> Pack {
        if self.freedom.is_infinite() {
            return Pack::all(1.0);
        }
        Pack::all(self.freedom + 1.0) / (Pack::all(self.freedom) + square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_by_hand() {
        // of one degree of freedom: 1 / (pi (1 + x^2)); normal: exp(-x^2 / 2) / sqrt(2 pi)
        let values = [0.0, 0.5, -3.0];
        let cauchy = NoiseDensity::of(1.0).log_densities(&values);
        let normal = NoiseDensity::of(f64::INFINITY).log_densities(&values);
        for ((x, cauchy), normal) in values.into_iter().zip(cauchy).zip(normal) {
            assert!((cauchy + (PI * (1.0 + x * x)).ln()).abs() < 1e-14);
            assert!((normal + 0.5 * (x * x + (2.0 * PI).ln())).abs() < 1e-14);
        }
    }
}

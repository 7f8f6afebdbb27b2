//! Density of noise: normal, or with the heavier tails of Student's t.
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use crate::numeric::{PACK, Pack, on_widest};
use core::f64::consts::PI;

/// Of the fixed point for a scale.
const ROUNDS: usize = 8;
/// Added to a scale, so that numbers that are all zero have one.
const SMALLEST: f64 = 1e-12;

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

    on_widest! {
        /// Scale of greatest likelihood of some numbers, but no smaller than the `least`; the log density there.
        fitted fitted_avx2 fitted_avx512 fit (values: &[f64], least: f64) -> (f64, f64)
    }

    #[inline(always)]
    fn fit(&mut self, values: &[f64], least: f64) -> (f64, f64) {
        let count = values.len() as f64;
        let mut squares = vec![Pack::all(0.0); values.len().div_ceil(PACK)];
        for (pack, some) in squares.iter_mut().zip(values.chunks(PACK)) {
            pack.0[..some.len()].copy_from_slice(some);
            *pack = *pack * *pack;
        }
        let mut scale = (sum(&squares, |x| x) / count).sqrt() + SMALLEST;
        let rounds = if self.freedom.is_finite() { ROUNDS } else { 0 };
        for _ in 0..rounds {
            let over = Pack::all(1.0 / (scale * scale));
            scale = (sum(&squares, |x| self.weight(x * over) * x) / count).sqrt() + SMALLEST;
        }
        let scale = scale.max(least);
        let over = Pack::all(1.0 / (scale * scale));
        let more = (squares.len() * PACK) as f64 - count; // numbers that are not there
        let log = sum(&squares, |x| self.log_density(x * over)) - more * self.constant;
        (scale, log - count * scale.ln())
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

#[inline(always)]
fn sum(squares: &[Pack], of: impl Fn(Pack) -> Pack) -> f64 {
    let (mut total, mut at) = (Pack::all(0.0), 0);
    while at < squares.len() {
        total = total + of(squares[at]);
        at += 1;
    }
    total.0.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_of_a_normal_is_the_root_of_the_mean_square() {
        let (scale, log) = NoiseDensity::of(f64::INFINITY).fitted(&[3.0, -4.0, 0.0], 0.0);
        assert!((scale - (25.0_f64 / 3.0).sqrt()).abs() < 1e-11);
        let right = -1.5 * ((2.0 * PI).ln() + 1.0) - 3.0 * scale.ln();
        assert!((log - right).abs() < 1e-10);
        assert_eq!(NoiseDensity::of(4.0).fitted(&[0.1; 9], 7.0).0, 7.0);
    }

    #[test]
    fn the_scale_of_heavy_tails_is_where_the_likelihood_is_flat() {
        let values: Vec<f64> = (1..40)
            .map(|k| (f64::from(k) * 0.05 - 1.0).sinh())
            .collect();
        let mut density = NoiseDensity::of(8.0);
        let (scale, log) = density.fitted(&values, 0.0);
        let at = |scale: f64, density: &mut NoiseDensity| -> f64 {
            let unit: Vec<f64> = values.iter().map(|x| x / scale).collect();
            density.log_densities(&unit).iter().sum::<f64>() - 39.0 * scale.ln()
        };
        assert!((at(scale, &mut density) - log).abs() < 1e-10);
        for other in [0.98 * scale, 1.02 * scale] {
            assert!(at(other, &mut density) < log);
        }
    }

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

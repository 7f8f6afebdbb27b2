//! Mean and covariance over the parts of a mixture, several noises at a time.
#![allow(unsafe_code)]
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::fit::HypothesisFit;
use super::system::System;
use crate::numeric::{Pack, on_widest};

/// Sums over parts, by their shares; coefficients count from those of the first part.
pub(super) struct Moments {
    share: Pack,
    variance: Pack,
    origin: Vec<Pack>,
    off: Vec<Pack>,
    mean: Vec<Pack>,
    /// Lower triangle.
    square: Vec<Pack>,
}

impl Moments {
    pub fn new(order: usize) -> Self {
        let none = Pack::all(0.0);
        Self {
            share: none,
            variance: none,
            origin: Vec::new(),
            off: vec![none; order],
            mean: vec![none; order],
            square: vec![none; order * order],
        }
    }

    on_widest! {
        /// Adds the parts of several noises; a share of zero counts for nothing.
        add add_avx2 add_avx512 added (share: &Pack, variance: &Pack, system: &System, inverse: &[Pack]) -> ()
    }

    #[inline(always)]
    fn added(&mut self, share: &Pack, variance: &Pack, system: &System, inverse: &[Pack]) {
        let order = self.mean.len();
        if self.origin.is_empty() {
            let first = |i| Pack::all(system.coefficient(i).0[0]);
            self.origin.extend((0..order).map(first));
        }
        self.share = self.share + *share;
        self.variance = self.variance + *share * *variance;
        for i in 0..order {
            let off = system.coefficient(i) - self.origin[i];
            self.off[i] = off;
            self.mean[i] = self.mean[i] + *share * off;
            for j in 0..=i {
                let spread = *variance * inverse[i * order + j] + off * self.off[j];
                self.square[i * order + j] = self.square[i * order + j] + *share * spread;
            }
        }
    }

    pub fn into(self, result: &mut HypothesisFit) {
        let (order, share) = (self.mean.len(), total(&self.share));
        let off: Vec<f64> = self.mean.iter().map(|sum| total(sum) / share).collect();
        result.variance = total(&self.variance) / share;
        let origin = |i: usize| self.origin.get(i).map_or(f64::NAN, |origin| origin.0[0]);
        let each = off.iter().enumerate();
        result.mean = each.map(|(i, off)| origin(i) + off).collect();
        let (high, low) = (|at: usize| at / order, |at: usize| at % order);
        let place = |at: usize| high(at).max(low(at)) * order + high(at).min(low(at));
        result.covariance = (0..order * order)
            .map(|at| total(&self.square[place(at)]) / share - off[high(at)] * off[low(at)])
            .collect();
    }
}

fn total(lane: &Pack) -> f64 {
    lane.0.iter().sum()
}

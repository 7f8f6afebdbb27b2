//! Bounds of coefficients that cut off part of a prior.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::hypothesis::HypothesisColumns;
use crate::numeric::between;
use crate::numeric::tail;
use crate::numeric::{PACK, Pack};

/// Prior standard deviations; bounds beyond are as good as none: the widest prior has three, and
/// five of its standard deviations leave out 6e-7.
const FAR: f64 = 15.0;
/// Standard deviations beyond which a tail, 1e-17, is lost beside one: half the spacing of doubles
/// there is 1.1e-16.
const ALL: f64 = 8.5;

/// Bounds near enough to matter.
#[derive(Default)]
pub(super) struct Bounds {
    /// Coefficients that have such bounds.
    pub near: Vec<usize>,
    /// Bounds of each, and the log of the prior mass between them for each width.
    limits: Vec<((f64, f64), Vec<f64>)>,
}

impl Bounds {
    pub fn of(layout: &HypothesisColumns, widths: &[f64]) -> Self {
        let is_near = |bounds: &(f64, f64)| bounds.0.abs().min(bounds.1.abs()) <= FAR;
        let near = layout.bounds.iter().enumerate().filter(|(_, b)| is_near(b));
        let mut found = Self::default();
        for (i, &bounds) in near {
            let before = |width: &f64| between(bounds.0 / width, bounds.1 / width).ln();
            found.near.push(i);
            found
                .limits
                .push((bounds, widths.iter().map(before).collect()));
        }
        found
    }

    /// Log of posterior over prior mass within the bounds, of coefficients that have means and
    /// variances, each with one of the widths.
    #[inline(always)]
    pub fn within(
        &self,
        moments: impl Iterator<Item = (Pack, Pack)>,
        chosen: impl Fn(usize) -> usize,
    ) -> Pack {
        let (mut sum, mut all) = (Pack::all(0.0), Pack::all(1.0));
        for ((&i, (bounds, before)), (mean, variance)) in
            self.near.iter().zip(&self.limits).zip(moments)
        {
            let deviation = variance.max(Pack::all(f64::MIN_POSITIVE)).sqrt();
            let low = (Pack::all(bounds.0) - mean) / deviation;
            let high = (Pack::all(bounds.1) - mean) / deviation;
            if (0..PACK).any(|lane| low.0[lane] > -ALL || high.0[lane] < ALL) {
                let inside = mass(low, high).max(Pack::all(f64::MIN_POSITIVE));
                sum = sum + all.ln();
                all = inside;
            }
            sum = sum - Pack::all(before[chosen(i)]);
        }
        sum + all.ln()
    }
}

/// Probability that a standard normal number lies between `low` and `high`.
#[inline(always)]
fn mass(low: Pack, high: Pack) -> Pack {
    let (below, above) = (beyond(low), beyond(high));
    let mut found = Pack::all(1.0) - below - above;
    for lane in 0..PACK {
        if low.0[lane] > 0.0 {
            found.0[lane] = below.0[lane] - above.0[lane];
        } else if high.0[lane] < 0.0 {
            found.0[lane] = above.0[lane] - below.0[lane];
        }
    }
    found
}

/// Tails beyond some numbers; none where there is no bound.
#[inline(always)]
fn beyond(limit: Pack) -> Pack {
    if limit.0.iter().all(|x| x.is_infinite()) {
        return Pack::all(0.0);
    }
    limit.map(|x| tail(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_lane_by_lane() {
        let infinite = f64::INFINITY;
        let low = Pack([-1.0, 0.5, -3.0, -infinite, 10.0, -0.1, -infinite, -9.0]);
        let high = Pack([1.0, 2.0, -2.0, 1.5, infinite, infinite, infinite, -8.0]);
        let found = mass(low, high);
        for lane in 0..PACK {
            let right = between(low.0[lane], high.0[lane]);
            assert!((found.0[lane] / right - 1.0).abs() < 1e-9, "{lane}");
        }
    }
}

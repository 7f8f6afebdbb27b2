//! What one condition changes of the lines of a model: a delay, and a factor of their slope.

use super::tail::{delay_and_offset, ends};
use crate::reference::Line;

/// The lines of a model, seen along one condition.
#[derive(Debug)]
pub struct Delays {
    /// The place of the condition.
    pub(super) place: usize,
    /// The delay at each of its codes \[echo codes\].
    pub(super) delay: Vec<f64>,
    /// The most that the delay differs from those, where the other conditions vary \[unit\].
    pub(super) misfit: f64,
    /// The largest growth of the distance per echo code \[unit\].
    pub(super) slope: f64,
    /// The most that the condition changes a distance beside the delay \[unit\].
    growth: f64,
    /// The growth of the distance per echo code at each code, over that at the usual one.
    pub(super) ratio: Vec<f64>,
    /// The most that a distance differs from that ratio, where the other conditions vary \[unit\].
    pub(super) unlike: f64,
    /// The largest distance of all lines \[unit\], and what is taken off every one \[unit\].
    pub(super) far: f64,
    pub(super) offset: f64,
}

impl Delays {
    /// Of `lines`: for each code of the condition at `place` one at each of the same other conditions.
    #[must_use]
    pub fn of(place: usize, lines: &[Vec<Line>]) -> Self {
        let (_, offset) = delay_and_offset(&lines[lines.len() / 2]);
        let slopes = lines.iter().flatten().map(|line| line.slope);
        let slope = slopes.fold(0.0, f64::max);
        let mut misfit = 0.0_f64;
        let mut middle = |lines: &Vec<Line>| {
            let wanted = lines.iter().map(|line| (-line.start - offset) / line.slope);
            let (low, high) = ends(wanted);
            misfit = misfit.max((high - low) / 2.0 * slope);
            f64::midpoint(low, high)
        };
        let delay = lines.iter().map(&mut middle).collect();
        let usual = &lines[lines.len() / 2];
        let changes = lines.iter().flat_map(|lines| lines.iter().zip(usual));
        let changes = changes.map(|(line, usual)| {
            (line.slope - usual.slope).abs() * (line.reach.min(usual.reach)) as f64
        });
        let growth = changes.fold(0.0, f64::max);
        let far = lines.iter().flatten().map(Line::end).fold(0.0, f64::max);
        let mut unlike = 0.0_f64;
        let ratios = |lines: &Vec<Line>| {
            let ratio = lines
                .iter()
                .zip(usual)
                .map(|(line, usual)| line.slope / usual.slope);
            let (low, high) = ends(ratio);
            unlike = unlike.max((high - low) / 2.0 * far);
            f64::midpoint(low, high)
        };
        let ratio = lines.iter().map(ratios).collect();
        Self {
            place,
            delay,
            misfit,
            slope,
            growth,
            ratio,
            unlike,
            far,
            offset,
        }
    }

    /// Half of what the delay changes a distance between two codes of the condition \[unit\].
    #[must_use]
    pub fn change(&self) -> f64 {
        let (low, high) = self.ends();
        (high - low) / 2.0 * self.slope
    }

    /// The most that the condition changes a distance beside the delay \[unit\].
    #[must_use]
    pub fn growth(&self) -> f64 {
        self.growth
    }

    /// The error that a delay, and beside the humidity (`beside`) a factor, leave in any case \[unit\].
    #[must_use]
    pub fn left(&self, beside: bool) -> f64 {
        let unlike = if beside { self.unlike } else { 0.0 };
        self.misfit.max(unlike)
    }

    /// The least and the greatest delay \[echo codes\].
    pub(super) fn ends(&self) -> (f64, f64) {
        ends(self.delay.iter().copied())
    }
}

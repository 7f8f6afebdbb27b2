//! How probable the data are under one hypothesis, all sizes of its causes averaged.
//!
//! The coefficients have normal priors, in a mixture of three widths, cut off at their bounds; the
//! variance of the noise has Jeffreys's prior, and within the coefficients' prior it stands at its
//! estimate (a Laplace approximation). MacKay 1992, Neural Computation 4, 415,
//! doi:10.1162/neco.1992.4.3.415.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use super::cholesky::{backward, factor, forward, invert};
use super::hypothesis::Layout;
use super::normal::between;

/// Mixture of prior widths: nobody knows a magnitude well.
const WIDTHS: [f64; 3] = [1.0 / 3.0, 1.0, 3.0];
/// Part of a sum of squares that arithmetic leaves behind.
const ROUNDING: f64 = 1e-12;
/// Part of a column's square that whitening may leave in doubt: slow noise takes most of it away.
const WHITENED: f64 = 1e-9;
/// Prior standard deviations; bounds beyond are as good as none.
const FAR: f64 = 15.0;
/// What a narrower prior and a bound may add to the log evidence, a coefficient: `ln 9 + ln 2`.
const NARROWER: f64 = 2.9;
/// Log odds against the best noise of a hypothesis beyond which a noise does not matter to it.
const OUT_OF_THE_RACE: f64 = 12.0;
/// The same while searching, where a hundredth of a unit of log evidence decides nothing.
const BEHIND: f64 = 8.0;

/// Whitened products of the columns under each noise; the last column is what the base simulation
/// leaves unexplained.
#[derive(Clone, Debug)]
pub struct Stack {
    /// Noise by noise, each `width * width`, symmetric.
    pub products: Vec<f64>,
    /// What each noise adds to the log evidence of every hypothesis.
    pub log_weight: Vec<f64>,
    /// Number of columns.
    pub width: usize,
    /// Rows less unknown levels.
    pub degrees: f64,
    /// Variance below which no noise is believed.
    pub finest: f64,
}

impl Stack {
    /// The noises in `kept` alone.
    pub(super) fn only(&self, kept: &[bool]) -> Self {
        let area = self.width * self.width;
        let chosen = || (0..kept.len()).filter(|&noise| kept[noise]);
        Self {
            products: chosen()
                .flat_map(|noise| self.products[noise * area..(noise + 1) * area].iter())
                .copied()
                .collect(),
            log_weight: chosen().map(|noise| self.log_weight[noise]).collect(),
            ..*self
        }
    }
}

/// A hypothesis after the data.
#[derive(Clone, Debug, Default)]
pub struct Weighed {
    /// Without the hypothesis's prior, with an arbitrary constant common to all.
    pub log_evidence: f64,
    /// Coefficients of the free columns, in prior standard deviations.
    pub mean: Vec<f64>,
    /// Their covariance, row by row.
    pub covariance: Vec<f64>,
    /// Probability of each noise under this hypothesis.
    pub noise: Vec<f64>,
    /// Variance of the innovations.
    pub variance: f64,
}

/// One combination of a noise and widths of the priors.
struct Part {
    noise: usize,
    score: f64,
    variance: f64,
    /// In `Scales`' stores.
    first: usize,
}

/// Weighs hypotheses one after the other, with the memory of the last.
#[derive(Default)]
pub(super) struct Scales {
    /// Take the widest prior alone.
    one_width: bool,
    among: Vec<f64>,
    lower: Vec<f64>,
    along: Vec<f64>,
    solved: Vec<f64>,
    inverse: Vec<f64>,
    precision: Vec<f64>,
    widths: Vec<f64>,
    parts: Vec<Part>,
    means: Vec<f64>,
    covariances: Vec<f64>,
}

impl Scales {
    pub(super) fn new(one_width: bool) -> Self {
        Self {
            one_width,
            ..Self::default()
        }
    }

    /// Log evidence alone; minus infinity where it cannot reach `least`.
    pub(super) fn log_evidence(&mut self, stack: &Stack, layout: &Layout, least: f64) -> f64 {
        self.look(stack, layout);
        let best = self
            .parts
            .iter()
            .map(|part| part.score)
            .fold(f64::NEG_INFINITY, f64::max);
        let noises = (stack.log_weight.len() as f64).ln();
        if best + NARROWER * layout.free.len() as f64 + noises < least {
            return f64::NEG_INFINITY;
        }
        self.refine(stack, layout, false);
        log_sum(self.parts.iter().map(|part| part.score))
    }

    /// Probability of each noise under the hypothesis, with the widest priors.
    pub(super) fn noise(&mut self, stack: &Stack, layout: &Layout) -> Vec<f64> {
        self.look(stack, layout);
        let total = log_sum(self.parts.iter().map(|part| part.score));
        let mut noise = vec![0.0; stack.log_weight.len()];
        for part in &self.parts {
            noise[part.noise] += (part.score - total).exp();
        }
        noise
    }

    /// Everything that is to be known about a hypothesis.
    pub(super) fn weigh(&mut self, stack: &Stack, layout: &Layout) -> Weighed {
        self.look(stack, layout);
        self.refine(stack, layout, true);
        let order = layout.free.len();
        let total = log_sum(self.parts.iter().map(|part| part.score));
        let mut result = Weighed {
            log_evidence: total,
            mean: vec![0.0; order],
            covariance: vec![0.0; order * order],
            noise: vec![0.0; stack.log_weight.len()],
            variance: 0.0,
        };
        for part in &self.parts {
            let share = (part.score - total).exp();
            result.noise[part.noise] += share;
            result.variance += share * part.variance;
            for (sum, mean) in result
                .mean
                .iter_mut()
                .zip(&self.means[part.first * order..])
            {
                *sum += share * mean;
            }
        }
        for part in &self.parts {
            let share = (part.score - total).exp();
            let mean = &self.means[part.first * order..(part.first + 1) * order];
            let inverse = &self.covariances[part.first * order * order..];
            for i in 0..order {
                for j in 0..order {
                    let spread = (mean[i] - result.mean[i]) * (mean[j] - result.mean[j]);
                    let within = part.variance * inverse[i * order + j];
                    result.covariance[i * order + j] += share * (within + spread);
                }
            }
        }
        result
    }

    /// A quick look: every noise, with the widest prior alone and no bounds.
    fn look(&mut self, stack: &Stack, layout: &Layout) {
        self.parts.clear();
        self.widths.clear();
        self.widths.resize(layout.free.len(), WIDTHS[2]);
        for noise in 0..stack.log_weight.len() {
            let (square, least) = self.take(stack, layout, noise);
            let part = self.part(stack, noise, square, least, 0);
            self.parts.push(part);
        }
    }

    /// Every width and the bounds, for the noises that the quick look left in the race.
    fn refine(&mut self, stack: &Stack, layout: &Layout, whole: bool) {
        let order = layout.free.len();
        let best = self
            .parts
            .iter()
            .map(|part| part.score)
            .fold(f64::NEG_INFINITY, f64::max);
        let mut looked = core::mem::take(&mut self.parts);
        let far = if whole { OUT_OF_THE_RACE } else { BEHIND };
        looked.retain(|part| part.score > best - far);
        self.means.clear();
        self.covariances.clear();
        if order == 0 {
            self.parts = looked;
            return;
        }
        self.combine_widths(layout);
        let combinations = self.widths.len() / order;
        let even = (combinations as f64).ln();
        let bounded = layout.bounds.iter().any(is_near);
        let mut best = f64::NEG_INFINITY;
        for Part { noise, .. } in looked {
            let (square, least) = self.take(stack, layout, noise);
            for first in 0..combinations {
                let mut part = self.part(stack, noise, square, least, first * order);
                part.score -= even;
                if bounded {
                    backward(&self.lower, order, &mut self.solved);
                    part.score += self.within_bounds(layout, part.variance, first * order);
                }
                best = best.max(part.score);
                if whole && part.score > best - OUT_OF_THE_RACE {
                    if !bounded {
                        backward(&self.lower, order, &mut self.solved);
                    }
                    invert(&self.lower, order, &mut self.inverse);
                    part.first = self.means.len() / order;
                    self.means.extend(&self.solved);
                    self.covariances.extend(&self.inverse);
                } else if whole {
                    continue;
                }
                self.parts.push(part);
            }
        }
    }

    /// The products of one noise. Returns what the fixed columns leave of the square, and the
    /// variance that the best coefficients leave.
    fn take(&mut self, stack: &Stack, layout: &Layout, noise: usize) -> (f64, f64) {
        let width = stack.width;
        let products = &stack.products[noise * width * width..(noise + 1) * width * width];
        let rest = |column: usize| {
            let line = &products[column * width..(column + 1) * width];
            let taken: f64 = layout.offsets.iter().map(|&offset| line[offset]).sum();
            line[width - 1] - taken
        };
        self.along.clear();
        self.along
            .extend(layout.free.iter().map(|&column| rest(column)));
        self.among.clear();
        for &row in &layout.free {
            let line = &products[row * width..(row + 1) * width];
            self.among
                .extend(layout.free.iter().map(|&column| line[column]));
        }
        let taken: f64 = layout.offsets.iter().map(|&offset| rest(offset)).sum();
        let square = (rest(width - 1) - taken).max(stack.degrees * stack.finest);
        (
            square,
            self.least_squares(square, layout.free.len()) / stack.degrees,
        )
    }

    /// Sum of squares that the best coefficients leave, never less than rounding allows.
    fn least_squares(&mut self, square: f64, order: usize) -> f64 {
        let trace: f64 = (0..order).map(|i| self.among[i * order + i]).sum();
        self.lower.clone_from(&self.among);
        let ridge = WHITENED * trace + 1e-300;
        self.precision.clear();
        self.precision.resize(order, ridge);
        for i in 0..order {
            self.lower[i * order + i] += ridge;
        }
        factor(&mut self.lower, order, &self.precision);
        self.solved.clone_from(&self.along);
        forward(&self.lower, order, &mut self.solved);
        let explained: f64 = self.solved.iter().map(|x| x * x).sum();
        (square - explained).max(ROUNDING * square)
    }

    /// Factors the system of one noise and one combination of widths, from `widths[first]` on.
    fn part(&mut self, stack: &Stack, noise: usize, square: f64, least: f64, first: usize) -> Part {
        let order = self.along.len();
        self.lower.clone_from(&self.among);
        self.precision.clear();
        for i in 0..order {
            let width = self.widths[first + i];
            // data without noise would make any prior too wide for the arithmetic
            let precision = (least / (width * width)).max(WHITENED * self.among[i * order + i]);
            self.lower[i * order + i] += precision;
            self.precision.push(precision);
        }
        factor(&mut self.lower, order, &self.precision);
        self.solved.clone_from(&self.along);
        forward(&self.lower, order, &mut self.solved);
        let explained: f64 = self.solved.iter().map(|x| x * x).sum();
        let floor = (ROUNDING * square).max(stack.degrees * stack.finest);
        let left = (square - explained).max(floor);
        let log_det = self.log_determinant_ratio(order);
        Part {
            noise,
            score: stack.log_weight[noise] - 0.5 * (stack.degrees * left.ln() + log_det),
            variance: left / stack.degrees,
            first: 0,
        }
    }

    /// Log of posterior over prior mass within the bounds, coefficient by coefficient.
    fn within_bounds(&mut self, layout: &Layout, variance: f64, first: usize) -> f64 {
        let order = layout.free.len();
        let mut sum = 0.0;
        for (i, bounds) in layout
            .bounds
            .iter()
            .enumerate()
            .filter(|(_, bounds)| is_near(bounds))
        {
            self.inverse.clear();
            self.inverse.resize(order, 0.0);
            self.inverse[i] = 1.0;
            forward(&self.lower, order, &mut self.inverse);
            let diagonal: f64 = self.inverse.iter().map(|x| x * x).sum();
            let deviation = (variance * diagonal).max(f64::MIN_POSITIVE).sqrt();
            let (mean, width) = (self.solved[i], self.widths[first + i]);
            let inside = between((bounds.0 - mean) / deviation, (bounds.1 - mean) / deviation);
            let before = between(bounds.0 / width, bounds.1 / width);
            sum += (inside.max(f64::MIN_POSITIVE) / before).ln();
        }
        sum
    }

    /// `ln(det(L L') / det(diagonal of precisions))`, with as few logarithms as fit.
    fn log_determinant_ratio(&self, order: usize) -> f64 {
        let (mut sum, mut product) = (0.0, 1.0);
        for (i, precision) in self.precision.iter().enumerate() {
            let pivot = self.lower[i * order + i];
            product *= pivot * pivot / precision;
            if !(1e-200..1e200).contains(&product) {
                sum += product.ln();
                product = 1.0;
            }
        }
        sum + product.ln()
    }

    /// Every combination of widths, one width a cause, side by side.
    fn combine_widths(&mut self, layout: &Layout) {
        let choices = if self.one_width {
            &WIDTHS[2..]
        } else {
            &WIDTHS[..]
        };
        self.widths.clear();
        let causes = u32::try_from(layout.counts.len()).unwrap_or(u32::MAX);
        for mut code in 0..choices.len().pow(causes) {
            for &count in &layout.counts {
                let width = choices[code % choices.len()];
                self.widths.extend(core::iter::repeat_n(width, count));
                code /= choices.len();
            }
        }
    }
}

/// Whether bounds cut off part of the prior.
fn is_near(bounds: &(f64, f64)) -> bool {
    bounds.0.abs().min(bounds.1.abs()) <= FAR
}

/// `ln(sum(exp(x)))`.
pub(super) fn log_sum(scores: impl Iterator<Item = f64> + Clone) -> f64 {
    let top = scores.clone().fold(f64::NEG_INFINITY, f64::max);
    if top == f64::NEG_INFINITY {
        return top;
    }
    top + scores.map(|score| (score - top).exp()).sum::<f64>().ln()
}

//! What every form implements, and what it is given.

use crate::device::Device;
use crate::ir::{Builder, Value};
use crate::target::{Cost, Target};
use std::fmt::Debug;
use std::sync::OnceLock;

/// For each temperature: coefficients in powers of the second condition's code, and the error left \[unit\].
pub type Lines = Vec<(Vec<f64>, f64)>;

/// A function that proposes the candidates of one form for a [`Fit`].
pub type Propose = fn(&Fit<'_>) -> Vec<Box<dyn Form>>;

/// The speed factor that brings one echo code to its distance.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Echo code.
    pub echo: i64,
    /// The factor, in units of the last binary place of the format.
    pub factor: f64,
    /// Error of the distance there \[unit\], per unit of the factor.
    pub weight: f64,
}

/// The speed factors that a form approximates: one for each combination of conditions.
#[derive(Debug)]
pub struct Fit<'a> {
    /// The device.
    pub device: &'a Device,
    /// The combinations of conditions that the targets belong to.
    pub picked: Vec<usize>,
    /// Ideal speed factors, in units of the last binary place of the format.
    pub target: Vec<f64>,
    /// Error of the distance at the far end of the bounded domain \[unit\], per unit of `target`.
    pub weight: Vec<f64>,
    /// Samples of each combination of conditions where the distance bends; empty where one factor serves all echo codes.
    pub samples: Vec<Vec<Sample>>,
    /// The error to stay below \[unit\].
    pub bound: f64,
    /// Largest tables allowed, together [byte].
    pub maximum_table: usize,
    /// The core that runs it.
    pub core: Target,
    /// Polynomials in the second condition, by degree; each is computed at its first use.
    pub lines: [OnceLock<Lines>; DEGREES],
}

/// Number of degrees of [`Fit::lines`]: 0 to 3, the highest that a form asks for (`grid`).
const DEGREES: usize = 4;

impl Fit<'_> {
    /// The largest error that factors `given` would cause \[unit\].
    #[must_use]
    pub fn error(&self, given: &[i64]) -> f64 {
        let errors = given.iter().zip(&self.target).zip(&self.weight);
        errors.fold(0.0, |worst, ((given, target), weight)| {
            ((*given as f64 - target) * weight).abs().max(worst)
        })
    }
}

/// A way to get the speed factor from the condition codes.
pub trait Form: Debug + Send + Sync {
    /// Its name in reports.
    fn name(&self) -> &'static str;

    /// Its description in words.
    fn describe(&self) -> String;

    /// The integers that define it, for the report.
    fn parameters(&self) -> serde_json::Value;

    /// The error \[unit\] that no rounding of this form can undercut.
    fn floor(&self) -> f64;

    /// The error \[unit\] that one rounded part leaves if the other parts are ideal: the whole form can hardly have less.
    /// Candidates with the same part share this result.
    fn least(&self, _fit: &Fit<'_>) -> f64 {
        self.floor()
    }

    /// The error \[unit\] that it has where the errors of its parts add up.
    fn likely(&self, fit: &Fit<'_>) -> f64 {
        self.least(fit)
    }

    /// The error \[unit\] after refining, before the distance is rounded, if it is known.
    fn reached(&self) -> Option<f64> {
        None
    }

    /// Its cost, if it is known without building a program.
    fn estimate(&self) -> Option<Cost> {
        None
    }

    /// Add its steps to a program; the value is the speed factor, never negative.
    fn build(&self, builder: &mut Builder<'_>) -> Value;

    /// Round its constants jointly, so that the largest error is as small as the form allows.
    fn refine(&mut self, fit: &Fit<'_>);

    /// A copy.
    fn duplicate(&self) -> Box<dyn Form>;
}

/// The speed factors that `form` gives at every combination of conditions.
#[must_use]
pub fn factors(form: &dyn Form, fit: &Fit<'_>) -> Vec<i64> {
    let mut builder = Builder::over(fit.device, fit.core.least_bits, fit.picked.clone());
    let value = form.build(&mut builder);
    builder.per_row(value).to_vec()
}

/// Most exchanges of [`center`]. Set by hand; the loop ends earlier once the constant repeats.
const EXCHANGES: usize = 12;

/// The constant that leaves the least error beside `settled`: where the two worst errors, weighted, are opposite.
pub(super) fn center(fit: &Fit<'_>, settled: &[f64]) -> i64 {
    let mut constant = fit.target[0] - settled[0];
    for _ in 0..EXCHANGES {
        let (mut low, mut high) = ((f64::INFINITY, 0), (f64::NEG_INFINITY, 0));
        for (index, settled) in settled.iter().enumerate() {
            let error = (fit.target[index] - settled - constant) * fit.weight[index];
            if error < low.0 {
                low = (error, index);
            }
            if error > high.0 {
                high = (error, index);
            }
        }
        let rest = |index: usize| fit.target[index] - settled[index];
        let (a, b) = (fit.weight[low.1], fit.weight[high.1]);
        let next = a.mul_add(rest(low.1), b * rest(high.1)) / (a + b);
        if !next.is_finite() || next == constant {
            break;
        }
        constant = next;
    }
    constant.round() as i64
}

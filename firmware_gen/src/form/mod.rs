//! Forms: how the speed factor of each combination of conditions is stored or computed. One form, one file.
//!
//! A form proposes candidates for a [`Fit`], each of which builds the same steps into any [`Builder`]. A new form is a
//! new file and one line in [`FORMS`].

mod additive;
mod factored;
mod full_table;
mod interpolated_table;
mod polynomial;
mod segments;
mod square;
mod tail;

pub use additive::NAME as ADDITIVE;
pub use tail::Tail;

use crate::device::Device;
use crate::ir::{Builder, Value};
use crate::minimax::{Points, minimax};
use crate::target::Target;
use std::fmt::Debug;

/// What a form must follow: the speed factor at every combination of conditions.
#[derive(Debug)]
pub struct Fit<'a> {
    /// The device.
    pub device: &'a Device,
    /// The combinations of conditions that the targets belong to.
    pub picked: Vec<usize>,
    /// Ideal speed factors, in units of the last binary place of the format.
    pub target: Vec<f64>,
    /// Error of the distance at the far end of the bounded domain [um], per unit of `target`.
    pub weight: Vec<f64>,
    /// The error to stay below [um].
    pub bound: f64,
    /// Where it is to run.
    pub core: Target,
}

impl Fit<'_> {
    /// The largest error that factors `given` would cause [um].
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

    /// What it is, in words.
    fn describe(&self) -> String;

    /// The integers that define it, for the report.
    fn parameters(&self) -> serde_json::Value;

    /// The error [um] that no rounding of this form can undercut.
    fn floor(&self) -> f64;

    /// Add its steps to a program; the value is the speed factor, never negative.
    fn build(&self, builder: &mut Builder<'_>) -> Value;

    /// Round its constants jointly, so that the largest error is as small as the form allows.
    fn refine(&mut self, fit: &Fit<'_>);

    /// The same once more.
    fn duplicate(&self) -> Box<dyn Form>;
}

type Propose = fn(&Fit<'_>) -> Vec<Box<dyn Form>>;

/// Every form with its name. To add one, write its file and add its line.
pub const FORMS: &[(&str, Propose)] = &[
    (polynomial::NAME, polynomial::propose),
    (interpolated_table::NAME, interpolated_table::propose),
    (segments::NAME, segments::propose),
    (square::NAME, square::propose),
    (factored::NAME, factored::propose),
    (additive::NAME, additive::propose),
    (full_table::NAME, full_table::propose),
];

/// The speed factors that `form` gives at every combination of conditions.
#[must_use]
pub fn factors(form: &dyn Form, fit: &Fit<'_>) -> Vec<i64> {
    let mut builder = Builder::over(fit.device, fit.core.least_bits, fit.picked.clone());
    let value = form.build(&mut builder);
    builder.per_row(value).to_vec()
}

/// The temperature code counted from the coldest code that the function accepts.
fn warmth(builder: &mut Builder<'_>) -> Value {
    let axis = &builder.device().conditions[0];
    let (lowest, note) = (
        axis.codes.minimum,
        format!(
            "codes above {} {}",
            axis.value(axis.codes.minimum),
            axis.unit
        ),
    );
    let code = builder.condition(0);
    if lowest == 0 {
        return code;
    }
    let offset = builder.constant(lowest.abs());
    let value = if lowest < 0 {
        builder.add(code, offset)
    } else {
        builder.subtract(code, offset)
    };
    let prefix = builder.set_prefix(""); // shared by all that reads the temperature
    let value = builder.name(value, "warmth", note);
    builder.set_prefix(prefix);
    value
}

/// The constant that leaves the least error beside `settled`.
pub(crate) fn center(fit: &Fit<'_>, settled: &[f64]) -> i64 {
    let rests: Vec<f64> = fit
        .target
        .iter()
        .zip(settled)
        .map(|(target, settled)| target - settled)
        .collect();
    let x: Vec<f64> = (0..rests.len()).map(|u| u as f64).collect();
    let (constant, _) = minimax(
        Points {
            x: &x,
            y: &rests,
            weight: &fit.weight,
        },
        0,
    );
    constant[0].round() as i64
}

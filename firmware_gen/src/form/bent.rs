//! A speed factor that falls or rises as the echo time grows: `A(T) - B(T) * (echo >> step)`, or `+`, where A and B are forms of the
//! temperature. It follows distances that bend, such as those of an echo that is detected later where it is fainter.
//!
//! The high bits of the echo code are constant over `2^step` codes: there the distance is a straight line, which the proof
//! needs.

use super::contract::{Fit, Form, Sample, factors};
use super::temperature::FORMS;
use crate::ir::{Builder, Value};
use crate::minimax::{Points, minimax};
use crate::target::Cost;
use std::sync::Arc;

/// Name of the form.
pub const NAME: &str = "bent";

/// Bits of the echo code that are left out: a byte, or fewer, so that the steps of the distance are smaller. Set by hand.
const STEPS: [u32; 2] = [8, 6];
/// Largest step of the distance, as a share of its growth per echo code: beyond 1 the output would fall. Set by hand.
const STEP: f64 = 0.9;
/// Where no bend of degree 2 meets the bound, forms are tried within this many times what it leaves, so that the best can be
/// reported. Set by hand.
const BEYOND: f64 = 1.5;
/// Most bits of the fall of the factor. Set by hand: on 8 bits its product with the high byte of the echo is one step.
const BITS: f64 = 8.0;
/// Share of `x^2` over 0..1 that the best multiple of `x` leaves: `3 - 2 sqrt(2)`, since `a = 2 sqrt(2) - 2` makes the error
/// at `a / 2` and at 1 opposite.
const LEFT: f64 = 0.171_572_875_253_81;

/// A factor and its fall.
#[derive(Debug)]
struct Bent {
    base: Box<dyn Form>,
    fall: Arc<Fall>,
}

/// The fall of the factor, rounded, and what it leaves to the base.
#[derive(Debug)]
struct Fall {
    form: Box<dyn Form>,
    /// Bits of the echo code that are left out.
    step: u32,
    /// Binary places of the product.
    bits: u32,
    /// Whether the factor rises instead.
    rises: bool,
    /// Ideal factors of the base.
    target: Vec<f64>,
    /// The error that the ideal base leaves \[unit\].
    rest: f64,
    /// What the form costs alone.
    cost: Cost,
    /// The error to stay below \[unit\].
    bound: f64,
}

/// Every pair of forms that could stay within the bound.
pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    if fit.samples.is_empty() {
        return Vec::new();
    }
    let mut found = STEPS.into_iter().map(|step| falls(fit, step));
    // Where bytes are cheap, smaller steps only serve where the larger ones are too large.
    let falls: Vec<Fall> = if fit.core.byte_shifts {
        found.find(|falls| !falls.is_empty()).unwrap_or_default()
    } else {
        found.flatten().collect()
    };
    let with = |fall: Fall| {
        let fall = Arc::new(fall);
        let base = fall.base(fit);
        let joined = |base| {
            let fall = Arc::clone(&fall);
            Box::new(Bent { base, fall }) as Box<dyn Form>
        };
        forms(&base).map(joined).collect::<Vec<_>>()
    };
    falls.into_iter().flat_map(with).collect()
}

/// Forms of the fall, rounded.
fn falls(fit: &Fit<'_>, step: u32) -> Vec<Fall> {
    let lines = fit.samples.iter().map(|row| {
        let (line, left) = row_minimax(row, 1, |sample| sample.factor);
        (-line[1] * f64::from(step).exp2(), left)
    });
    let (mut ideal, left): (Vec<f64>, Vec<f64>) = lines.unzip();
    let rises = ideal.iter().sum::<f64>() < 0.0;
    if rises {
        ideal.iter_mut().for_each(|fall| *fall = -*fall);
    }
    let (most, left) = (largest(&ideal), largest(&left));
    let steps = ideal.iter().zip(&fit.samples).map(|(fall, row)| {
        let last = row.last();
        last.map_or(0.0, |sample| {
            fall * sample.echo as f64 / sample.factor.max(1.0)
        })
    });
    if most <= 0.0 || steps.fold(0.0, f64::max) > STEP {
        return Vec::new();
    }
    let bound = fit.bound.max(BEYOND * left);
    let natural = (BITS - most.log2()).floor().clamp(0.0, 24.0) as u32;
    let mut places = vec![natural];
    if fit.core.byte_shifts && natural != 8 {
        places.push(8);
    }
    let rounded = |bits: u32| {
        let unit = f64::from(bits).exp2();
        let weight = |row: &Vec<Sample>| {
            let last = row
                .last()
                .map_or(0.0, |sample| sample.weight * (sample.echo >> step) as f64);
            LEFT * last / unit
        };
        let part = Fit {
            target: ideal.iter().map(|fall| fall.max(0.0) * unit).collect(),
            weight: fit.samples.iter().map(weight).collect(),
            ..plain(fit, bound - left)
        };
        let found = forms(&part).filter_map(|mut form| {
            form.refine(&part);
            Fall::new(form, (step, bits, rises), &part, fit, bound)
        });
        found.collect::<Vec<_>>()
    };
    front(places.into_iter().flat_map(rounded).collect())
}

impl Fall {
    /// `None` if even an ideal base would leave more than the bound.
    fn new(
        form: Box<dyn Form>,
        (step, bits, rises): (u32, u32, bool),
        part: &Fit<'_>,
        fit: &Fit<'_>,
        bound: f64,
    ) -> Option<Self> {
        let given = factors(form.as_ref(), part);
        let rows = given.iter().zip(&fit.samples).map(|(fall, row)| {
            let sign = if rises { -1.0 } else { 1.0 };
            let less = |echo: i64| sign * ((fall * (echo >> step)) >> bits) as f64;
            let (target, left) = row_minimax(row, 0, |sample| sample.factor + less(sample.echo));
            (target[0], left)
        });
        let (target, left): (Vec<f64>, Vec<f64>) = rows.unzip();
        let rest = largest(&left);
        if rest >= bound {
            return None;
        }
        Some(Self {
            cost: cost(form.as_ref(), part)?,
            form,
            step,
            bits,
            rises,
            target,
            rest,
            bound,
        })
    }

    /// What the base must follow.
    fn base<'a>(&self, fit: &Fit<'a>) -> Fit<'a> {
        Fit {
            target: self.target.clone(),
            ..plain(fit, self.bound - self.rest)
        }
    }
}

/// A fit of one factor for all echo codes.
fn plain<'a>(fit: &Fit<'a>, bound: f64) -> Fit<'a> {
    Fit {
        device: fit.device,
        picked: fit.picked.clone(),
        target: fit.target.clone(),
        weight: fit.weight.clone(),
        samples: Vec::new(),
        bound,
        maximum_table: fit.maximum_table,
        core: fit.core,
        lines: Default::default(),
    }
}

/// The polynomial in the echo code that follows a row best, and the error that it leaves \[unit\].
fn row_minimax(row: &[Sample], degree: usize, y: impl Fn(&Sample) -> f64) -> (Vec<f64>, f64) {
    let column = |of: &dyn Fn(&Sample) -> f64| row.iter().map(of).collect::<Vec<_>>();
    let (x, weight) = (
        column(&|sample| sample.echo as f64),
        column(&|sample| sample.weight),
    );
    let points = Points {
        x: &x,
        y: &column(&y),
        weight: &weight,
    };
    minimax(points, degree)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// The forms of the temperature that could stay within the bound.
fn forms<'b>(fit: &'b Fit<'_>) -> impl Iterator<Item = Box<dyn Form>> + 'b {
    let made = FORMS.iter().flat_map(|(_, propose)| propose(fit));
    made.filter(|form| form.floor() <= fit.bound)
}

/// What a form costs alone; `None` if its tables are larger than allowed.
fn cost(form: &dyn Form, fit: &Fit<'_>) -> Option<Cost> {
    let mut builder = Builder::over(fit.device, fit.core.least_bits, fit.picked.clone());
    let value = form.build(&mut builder);
    let program = builder.finish(value)?;
    let allowed = program.table_bytes() <= fit.maximum_table;
    allowed.then(|| fit.core.cost(&program))
}

/// The Pareto front in size, time and error.
fn front(all: Vec<Fall>) -> Vec<Fall> {
    let key = |fall: &Fall| (fall.cost.size, fall.cost.time, fall.rest);
    let keys: Vec<_> = all.iter().map(key).collect();
    let dominated = |fall: &Fall| {
        let (size, time, rest) = key(fall);
        let no_worse = |other: &(u64, u64, f64)| {
            other.0 <= size && other.1 <= time && other.2 <= rest && *other != (size, time, rest)
        };
        keys.iter().any(no_worse)
    };
    all.into_iter().filter(|fall| !dominated(fall)).collect()
}

impl Form for Bent {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        format!(
            "{} {} the high bits of the echo code times ({})",
            self.base.describe(),
            if self.fall.rises { "plus" } else { "minus" },
            self.fall.form.describe()
        )
    }

    fn parameters(&self) -> serde_json::Value {
        let part = |form: &dyn Form| serde_json::json!({ "name": form.name(), "parameters": form.parameters() });
        serde_json::json!({
            "base": part(self.base.as_ref()),
            "fall": part(self.fall.form.as_ref()),
            "echo_bits_left_out": self.fall.step,
            "fall_bits": self.fall.bits,
            "rises": self.fall.rises,
        })
    }

    fn floor(&self) -> f64 {
        self.base.floor().max(self.fall.rest)
    }

    fn likely(&self, fit: &Fit<'_>) -> f64 {
        self.fall.rest + self.base.least(&self.fall.base(fit))
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let Fall {
            step, bits, rises, ..
        } = *self.fall;
        let what = if rises { "rise" } else { "fall" };
        let before = builder.set_prefix("bend_");
        let fall = self.fall.form.build(builder);
        let note = format!(
            "{what} of speed per {} echo codes [2^-{bits} units of speed]",
            1 << step
        );
        let fall = builder.name(fall, what, note);
        let echo = builder.echo();
        let high = builder.shift_right(echo, step);
        let product = builder.multiply(high, fall);
        let part = builder.shift_right(product, bits);
        let part = builder.name(
            part,
            "part",
            format!("{what} up to this echo time [units of speed]"),
        );
        builder.set_prefix("near_");
        let base = self.base.build(builder);
        builder.set_prefix(before);
        if rises {
            builder.add(base, part)
        } else {
            builder.subtract(base, part)
        }
    }

    fn refine(&mut self, fit: &Fit<'_>) {
        self.base.refine(&self.fall.base(fit));
    }

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(Self {
            base: self.base.duplicate(),
            fall: Arc::clone(&self.fall),
        })
    }
}

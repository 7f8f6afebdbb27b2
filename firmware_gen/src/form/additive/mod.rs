//! Two conditions: `A(T) + h * B(T)`, or `A(T) + h * (B(T) + h * C(T))`, where A, B and C are forms of the temperature alone.

mod fitting;

use super::adapted;
use super::contract::{Fit, Form};
use super::plane::Plane;
use super::steps::{floor_shift, second_index};
use super::temperature::FORMS;
use crate::device::Axis;
use crate::ir::{Builder, Value};
use crate::target::Cost;
use std::sync::{Arc, OnceLock};

/// Name of the form.
pub const NAME: &str = "additive";

/// Binary places that the product with the second condition loses, if that has 8 bits: whole bytes first. Set by hand.
const SHIFTS: [u32; 2] = [8, 11];
/// The usual second condition in words.
const HUMIDITY: &str = "humidity";
/// Bits of a second condition that the places above suit.
const USUAL: u32 = 8;
/// A form dominates another although its error is larger, if the difference is at most this share of the bound. Set by hand.
const NEAR: f64 = 0.05;
/// Binary places that the square of the second condition loses first: one byte, so that the shift moves whole bytes.
const SQUARE_SHIFTS: [u32; 1] = [8];

/// The places for the second condition of this device: each of its bits beyond the usual ones needs one more.
fn places(usual: &[u32], fit: &Fit<'_>) -> Vec<u32> {
    let codes = fit.device.conditions[1].len();
    let more = codes.next_power_of_two().ilog2().saturating_sub(USUAL);
    usual.iter().map(|places| places + more).collect()
}

/// Forms of the temperature, and how they are joined by the second condition.
#[derive(Debug)]
struct Additive {
    base: Box<dyn Form>,
    slope: Box<dyn Form>,
    /// Binary places of `slope`.
    bits: u32,
    /// The form of the square, and its binary places beyond those of `slope`.
    bend: Option<(Box<dyn Form>, u32)>,
    floor: f64,
    /// The second condition in words.
    second: String,
    /// What the forms cost alone, together.
    cost: Cost,
    /// The error that refining left \[unit\].
    reached: Option<f64>,
    /// What is known of its parts, which other candidates have, too.
    base_part: Arc<Base>,
    growth_part: Arc<Growth>,
}

/// A form at the least humidity, where it stands alone.
#[derive(Debug)]
struct Base {
    form: Box<dyn Form>,
    cost: Cost,
    /// The error that it leaves there, rounded \[unit\].
    least: OnceLock<f64>,
}

/// What humidity adds.
#[derive(Debug)]
struct Growth {
    slope: Box<dyn Form>,
    bits: u32,
    bend: Option<(Box<dyn Form>, u32)>,
    cost: Cost,
    /// Its forms fitted beside an ideal base.
    settled: OnceLock<Settled>,
}

/// Forms of a [`Growth`] with their constants, and the error that they leave beside whatever base \[unit\].
#[derive(Debug)]
struct Settled {
    slope: Box<dyn Form>,
    bend: Option<(Box<dyn Form>, u32)>,
    least: f64,
}

/// What the code of a condition is called in words.
pub(super) fn words(axis: &Axis) -> String {
    axis.word().replace('_', " ")
}

/// Every pair of forms that could stay within the bound.
pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    let plane = Plane::new(fit);
    let mut found: Vec<Box<dyn Form>> = Vec::new();
    for degree in [1, 2] {
        let lines = plane.lines(degree);
        let floor = plane.residual(lines);
        if floor >= fit.bound {
            continue;
        }
        let bases: Vec<Arc<Base>> = forms(&plane.ideal(lines, 0, 0))
            .into_iter()
            .map(Base::new)
            .collect();
        let kept = if fit.core.byte_shifts {
            1
        } else {
            SHIFTS.len()
        };
        for bits in places(&SHIFTS[..kept], fit) {
            let slopes = forms(&plane.ideal(lines, 1, bits));
            let bends: Vec<Option<(Priced, u32)>> = if degree == 1 {
                vec![None]
            } else {
                let of = |more: &u32| {
                    let found = forms(&plane.ideal(lines, 2, bits + more)).into_iter();
                    found.map(|form| Some((form, *more))).collect::<Vec<_>>()
                };
                places(&SQUARE_SHIFTS, fit).iter().flat_map(of).collect()
            };
            for bend in &bends {
                for slope in &slopes {
                    let growth = Arc::new(Growth::new(slope, bend.as_ref(), bits));
                    let second = words(&fit.device.conditions[1]);
                    let joined =
                        |base| Box::new(Additive::join(base, &growth, floor, &second)) as _;
                    found.extend(bases.iter().map(joined));
                }
            }
        }
    }
    found
}

/// A form and what it costs alone.
type Priced = (Cost, Box<dyn Form>);

/// The Pareto front, in size, time and error, of the forms of the temperature that follow `fit` within its bound.
fn forms(fit: &Fit<'_>) -> Vec<Priced> {
    // Beside a second form an adapted polynomial lacks registers: measured on AVR, 14 bytes more than a square of squares.
    let usual = FORMS.iter().filter(|(name, _)| *name != adapted::NAME);
    let made = usual.flat_map(|(_, propose)| propose(fit));
    let costed = made
        .filter(|form| form.floor() <= fit.bound)
        .filter_map(|form| Some((cost(form.as_ref(), fit)?, form)));
    let all: Vec<Priced> = costed.collect();
    let dominated = |(cost, form): &Priced| {
        all.iter().any(|(other, better)| {
            // With a margin of a fifth: refining changes the constants, and with them the cost. Equal costs do not dominate.
            let no_worse = 5 * other.size <= 4 * cost.size && other.time <= cost.time
                || 5 * other.time <= 4 * cost.time && other.size <= cost.size;
            other != cost && no_worse && better.floor() <= NEAR.mul_add(fit.bound, form.floor())
        })
    };
    let kept = all.iter().filter(|candidate| !dominated(candidate));
    kept.map(|(cost, form)| (*cost, form.duplicate())).collect()
}

/// A form in words, with its article.
fn one(form: &dyn Form) -> String {
    let words = form.describe();
    if words.starts_with("one ") {
        words
    } else {
        format!("a {words}")
    }
}

/// The cost of a form alone; `None` if its tables are larger than allowed, so that it cannot dominate one that is.
fn cost(form: &dyn Form, fit: &Fit<'_>) -> Option<Cost> {
    let mut builder = Builder::over(fit.device, fit.core.least_bits, fit.picked.clone());
    let value = form.build(&mut builder);
    let program = builder.finish(value)?;
    let allowed = program.table_bytes() <= fit.maximum_table;
    allowed.then(|| fit.core.cost(&program))
}

impl Base {
    fn new((cost, form): Priced) -> Arc<Self> {
        Arc::new(Self {
            form,
            cost,
            least: OnceLock::new(),
        })
    }
}

impl Growth {
    fn new(slope: &Priced, bend: Option<&(Priced, u32)>, bits: u32) -> Self {
        let more = bend.map_or_else(Cost::default, |((cost, _), _)| *cost);
        Self {
            slope: slope.1.duplicate(),
            bits,
            bend: bend.map(|((_, form), more)| (form.duplicate(), *more)),
            cost: slope.0 + more,
            settled: OnceLock::new(),
        }
    }
}

/// A copy of a form and its binary places.
fn duplicate_bend(bend: Option<&(Box<dyn Form>, u32)>) -> Option<(Box<dyn Form>, u32)> {
    bend.map(|(form, bits)| (form.duplicate(), *bits))
}

impl Additive {
    fn join(base: &Arc<Base>, growth: &Arc<Growth>, floor: f64, second: &str) -> Self {
        Self {
            base: base.form.duplicate(),
            slope: growth.slope.duplicate(),
            bits: growth.bits,
            bend: duplicate_bend(growth.bend.as_ref()),
            floor,
            second: second.to_owned(),
            cost: base.cost + growth.cost,
            reached: None,
            base_part: Arc::clone(base),
            growth_part: Arc::clone(growth),
        }
    }

    fn copy(&self) -> Self {
        Self {
            base: self.base.duplicate(),
            slope: self.slope.duplicate(),
            bits: self.bits,
            bend: duplicate_bend(self.bend.as_ref()),
            floor: self.floor,
            second: self.second.clone(),
            cost: self.cost,
            reached: self.reached,
            base_part: Arc::clone(&self.base_part),
            growth_part: Arc::clone(&self.growth_part),
        }
    }
}

impl Form for Additive {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        let bend = self.bend.as_ref().map_or(String::new(), |(form, _)| {
            format!(" plus its square times {}", one(form.as_ref()))
        });
        format!(
            "{} plus the {} code times {}{bend}",
            self.base.describe(),
            self.second,
            one(self.slope.as_ref())
        )
    }

    fn parameters(&self) -> serde_json::Value {
        let part = |form: &dyn Form| serde_json::json!({ "name": form.name(), "parameters": form.parameters() });
        serde_json::json!({
            "base": part(self.base.as_ref()),
            "slope": part(self.slope.as_ref()),
            "slope_bits": self.bits,
            "bend": self.bend.as_ref().map(|(form, _)| part(form.as_ref())),
            "bend_bits": self.bend.as_ref().map(|(_, bits)| bits),
        })
    }

    fn floor(&self) -> f64 {
        self.floor
    }

    fn least(&self, fit: &Fit<'_>) -> f64 {
        let plane = Plane::new(fit);
        let base = self.base_part.least(&plane);
        if base > fit.bound {
            return base;
        }
        base.max(self.growth_part.settled(&plane).least)
    }

    fn likely(&self, fit: &Fit<'_>) -> f64 {
        let plane = Plane::new(fit);
        self.base_part.least(&plane) + self.growth_part.settled(&plane).least
    }

    fn reached(&self) -> Option<f64> {
        self.reached
    }

    fn estimate(&self) -> Option<Cost> {
        Some(self.cost)
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let humidity = second_index(builder);
        let second = &self.second;
        let [square, growth, rest] = if second == HUMIDITY {
            ["humidity_square_", "humidity_", "dry_"]
        } else {
            ["further_square_", "further_", "first_"]
        };
        let bend = self.bend.as_ref().map(|(form, more)| {
            let before = builder.set_prefix(square);
            let factor = form.build(builder);
            let product = builder.multiply(humidity, factor);
            let value = floor_shift(builder, product, *more);
            let value = builder.name(
                value,
                "part",
                format!(
                    "contribution of the squared {second} index to the change per {second} code"
                ),
            );
            builder.set_prefix(before);
            value
        });
        let before = builder.set_prefix(growth);
        let slope = self.slope.build(builder);
        let slope = bend.map_or(slope, |bend| builder.add(slope, bend));
        let note = format!(
            "change of speed per {second} code [2^-{} units of speed]",
            self.bits
        );
        let slope = builder.name(slope, "growth", note);
        let product = builder.multiply(humidity, slope);
        let part = floor_shift(builder, product, self.bits);
        let note = format!("contribution of the {second} [units of speed]");
        let part = builder.name(part, "part", note);
        builder.set_prefix(rest);
        let base = self.base.build(builder);
        builder.set_prefix(before);
        builder.add(base, part)
    }

    fn refine(&mut self, fit: &Fit<'_>) {
        self.settle(&Plane::new(fit));
    }

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(self.copy())
    }
}

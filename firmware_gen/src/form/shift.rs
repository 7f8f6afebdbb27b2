//! A delay that one condition sets, such as that of a comparator whose threshold follows the supply. A form of this
//! condition gives it, and it is taken off the echo code before any other step. Beside the humidity a further input can
//! also set a factor of the speed.

use super::additive::words;
use super::contract::{Fit, Form, factors};
use super::delays::Delays;
use super::temperature::FORMS;
use crate::device::{Axis, Device};
use crate::ir::{Builder, Value, told};
use crate::reference::Line;
use crate::target::{Prefer, Target};
use crate::types::{IntegerType, Range};
use std::sync::Arc;

/// What the form gives, in words.
const GIVES: &str = "delay";
/// What a factor of the speed is called.
const GAIN: &str = "factor";
/// One, in units of the last binary place of such a factor: a shift by two bytes.
const UNIT: f64 = 65_536.0;
/// Binary places of the delay that are tried. Set by hand: with one place 32,767 us still fit 16 bits, with four the
/// rounding of a code of 1 us is 0.005 mm.
const PLACES: [u32; 3] = [0, 1, 4];
/// Largest share of the bound that the delay may take; if that is not possible, the smallest share is taken. Set by hand.
const SHARE: f64 = 0.5;

/// What the forms are chosen by.
#[derive(Clone, Copy)]
pub struct Choice<'a> {
    /// The device.
    pub device: &'a Device,
    /// The bound \[unit\].
    pub bound: f64,
    /// Largest table \[byte\].
    pub maximum_table: usize,
    /// The core that runs it.
    pub core: Target,
    /// What to save.
    pub prefer: Prefer,
}

/// A natural number for each code of a condition.
#[derive(Clone, Debug)]
struct Part {
    place: usize,
    form: Arc<dyn Form>,
    /// What the form gives for each code.
    values: Vec<i64>,
    /// The error that it leaves \[unit\].
    rest: f64,
}

impl Part {
    /// Every form of the condition at `place` for `target`, each with an error of `weight` \[unit\], and `misfit` \[unit\]
    /// on top, the cheapest first.
    fn all(
        choice: Choice<'_>,
        place: usize,
        (target, weight, misfit): (Vec<f64>, f64, f64),
    ) -> Vec<Self> {
        let alone = Device {
            conditions: vec![choice.device.conditions[place].clone()],
            ..choice.device.clone()
        };
        let fit = Fit {
            device: &alone,
            picked: (0..alone.rows()).collect(),
            target,
            weight: vec![weight; alone.rows()],
            samples: Vec::new(),
            bound: SHARE * choice.bound,
            maximum_table: choice.maximum_table,
            core: choice.core,
            lines: Default::default(),
        };
        let made = FORMS.iter().flat_map(|(_, propose)| propose(&fit));
        let part = |mut form: Box<dyn Form>| {
            form.refine(&fit);
            let mut builder = Builder::new(&alone, choice.core.least_bits);
            let value = form.build(&mut builder);
            let cost = choice.core.cost(&builder.finish(value)?);
            let values = factors(form.as_ref(), &fit);
            let rest = fit.error(&values) + misfit;
            let form = form.into();
            let part = Self {
                place,
                form,
                values,
                rest,
            };
            Some((choice.prefer.key(cost), part))
        };
        let mut found: Vec<_> = made.filter_map(part).collect();
        found.sort_by_key(|(key, _)| *key);
        found.into_iter().map(|(_, part)| part).collect()
    }

    fn axis<'a>(&self, device: &'a Device) -> &'a Axis {
        &device.conditions[self.place]
    }

    /// In words: what the condition sets, and the form of what it `gives`.
    fn describe(&self, device: &Device, gives: &str) -> String {
        let axis = self.axis(device);
        format!(
            "a {gives} by the {}: {}, {:.4} mm of the error at most",
            words(axis),
            told(&self.form.describe(), axis, gives),
            (self.rest * device.output.lsb * 1e7).ceil() / 1e4,
        )
    }

    fn parameters(&self, device: &Device) -> serde_json::Value {
        serde_json::json!({
            "condition": self.axis(device).quantity,
            "error_share_m": self.rest * device.output.lsb,
            "name": self.form.name(),
            "parameters": self.form.parameters(),
        })
    }

    fn build(
        &self,
        builder: &mut Builder<'_>,
        (prefix, gives): (&'static str, &'static str),
    ) -> Value {
        let prefix = builder.set_prefix(prefix);
        let before = builder.set_axis((self.place, Some(gives)));
        let value = self.form.build(builder);
        builder.set_axis(before);
        builder.set_prefix(prefix);
        value
    }
}

/// A factor of the speed that a further input sets beside the humidity, rounded: `(speed * factor) >> 16`.
#[derive(Clone, Debug)]
pub struct Gain {
    part: Part,
    /// By what the lines at the usual code are multiplied, so that no factor is above 1.
    most: f64,
    /// What is taken off the distance of every line \[unit\].
    offset: f64,
}

impl Gain {
    /// The cheapest form that leaves enough of the bound; else the most exact.
    #[must_use]
    pub fn of(delays: &Delays, choice: Choice<'_>) -> Option<Self> {
        let most = delays.ratio.iter().copied().fold(0.0, f64::max) * (1.0 + UNIT.recip());
        let target = delays.ratio.iter().map(|ratio| ratio / most * UNIT);
        let weight = delays.far * most / UNIT;
        let mut all = Part::all(
            choice,
            delays.place,
            (target.collect(), weight, delays.unlike),
        );
        all.retain(|part| {
            part.values
                .iter()
                .all(|value| (1..UNIT as i64).contains(value))
        });
        let enough = all
            .iter()
            .position(|part| part.rest <= SHARE * choice.bound);
        let best = || {
            let rests = all.iter().enumerate();
            let least = rests.min_by(|(_, a), (_, b)| a.rest.total_cmp(&b.rest));
            least.map(|(index, _)| index)
        };
        let part = all.swap_remove(enough.or_else(best)?);
        let offset = delays.offset;
        Some(Self { part, most, offset })
    }

    /// The error that it leaves \[unit\].
    #[must_use]
    pub fn rest(&self) -> f64 {
        self.part.rest
    }

    /// A line at the usual code, as the one that the factors are taken of.
    #[must_use]
    pub fn line(&self, line: &Line) -> Line {
        let times = |distance: f64| (distance + self.offset).mul_add(self.most, -self.offset);
        Line {
            slope: line.slope * self.most,
            start: times(line.start),
            middle: times(line.middle),
            ..*line
        }
    }

    /// Add its steps to a program: the speed factor of all conditions.
    pub fn build(&self, builder: &mut Builder<'_>, speed: Value) -> Value {
        let words = words(self.part.axis(builder.device()));
        let value = self.part.build(builder, ("gain_", GAIN));
        let value = builder.name(value, "gain", format!("{GAIN} by the {words} [2^-16]"));
        let product = builder.multiply(speed, value);
        builder.shift_right(product, UNIT.log2() as u32)
    }

    /// In words.
    #[must_use]
    pub fn describe(&self, device: &Device) -> String {
        self.part.describe(device, GAIN)
    }

    /// The integers that define it, for the report.
    #[must_use]
    pub fn parameters(&self, device: &Device) -> serde_json::Value {
        self.part.parameters(device)
    }
}

/// The delay of each code of a condition, rounded.
#[derive(Clone, Debug)]
pub struct Shift {
    part: Part,
    /// Its binary places.
    bits: u32,
}

impl Shift {
    /// The cheapest form for each number of binary places that leaves enough of the bound; if there is none, the most
    /// exact of all.
    #[must_use]
    pub fn propose(delays: &Delays, choice: Choice<'_>) -> Vec<Self> {
        // Forms give natural numbers; what is left of the delay is the same for all.
        let least = match delays.ends().0 {
            low if low >= 1.0 => 0.0,
            low => low.floor() - 1.0,
        };
        let (mut able, mut all) = (Vec::new(), Vec::new());
        for bits in PLACES {
            let unit = f64::from(bits).exp2();
            let target = delays.delay.iter().map(|one| (one - least) * unit);
            let weight = delays.slope / unit;
            let found = Part::all(
                choice,
                delays.place,
                (target.collect(), weight, delays.misfit),
            );
            let enough = found.iter().find(|part| part.rest <= SHARE * choice.bound);
            able.extend(enough.map(|part| Self {
                part: part.clone(),
                bits,
            }));
            all.extend(found.into_iter().map(|part| Self { part, bits }));
        }
        if able.is_empty() {
            all.sort_by(|a, b| a.rest().total_cmp(&b.rest()));
            all.truncate(1);
            return all;
        }
        able
    }

    /// The error that it leaves \[unit\].
    #[must_use]
    pub fn rest(&self) -> f64 {
        self.part.rest
    }

    /// In words.
    #[must_use]
    pub fn describe(&self, device: &Device) -> String {
        self.part.describe(device, GIVES)
    }

    /// The integers that define it, for the report.
    #[must_use]
    pub fn parameters(&self, device: &Device) -> serde_json::Value {
        let mut parameters = self.part.parameters(device);
        parameters["bits"] = self.bits.into();
        parameters
    }

    /// The echo codes that are left, as an axis.
    #[must_use]
    pub fn echo(&self, echo: &Axis) -> Axis {
        let ends = |(low, high): (i64, i64), one: &i64| (low.min(*one), high.max(*one));
        let (low, high) = self.part.values.iter().fold((i64::MAX, i64::MIN), ends);
        let codes = Range {
            minimum: (echo.codes.minimum << self.bits) - high,
            maximum: (echo.codes.maximum << self.bits) - low,
        };
        Axis {
            codes,
            lsb: echo.lsb / f64::from(self.bits).exp2(),
            ty: IntegerType::holding(codes, echo.ty.bits()),
            ..echo.clone()
        }
    }

    /// A line over the echo codes that are left, at step `step` of the condition.
    #[must_use]
    pub fn line(&self, line: &Line, step: usize) -> Line {
        let (value, unit) = (self.part.values[step], f64::from(self.bits).exp2());
        let left = |echo: i64| (echo << self.bits) - value;
        let slope = line.slope / unit;
        let (first, reach) = (left(line.first), left(line.reach));
        let middle = left(i64::midpoint(line.first, line.reach));
        Line {
            first,
            slope,
            start: slope.mul_add(value as f64, line.start),
            middle: slope.mul_add((i64::midpoint(first, reach) - middle) as f64, line.middle),
            reach,
            bounded: line.bounded,
        }
    }

    /// Add its steps to a program: what comes next reads the echo code that is left.
    pub fn build(&self, builder: &mut Builder<'_>) {
        let words = words(self.part.axis(builder.device()));
        let unit = match self.bits {
            0 => "[echo codes]".into(),
            bits => format!("[2^-{bits} echo codes]"),
        };
        let value = self.part.build(builder, ("delay_", GIVES));
        let value = builder.name(value, "delay", format!("delay by the {words} {unit}"));
        let echo = builder.echo();
        let scale = builder.constant(1 << self.bits);
        let echo = if self.bits == 0 {
            echo
        } else {
            builder.multiply(echo, scale)
        };
        let left = builder.subtract(echo, value);
        let note = format!("echo time without the delay by the {words} {unit}");
        let left = builder.name(left, "time", note);
        builder.set_echo(left);
    }
}

//! A product of two straight lines in the temperature code: a parabola with one product or one shift fewer than
//! Horner's rule.
//!
//! With `u` counted from the coldest code, `speed = base + ((x * y) >> shift)`, `x = steep * u` and
//! `y = far - flat * u`. The curvature `steep * flat` is a whole number, and a coarse one where `shift` is 16. Either the
//! high byte of `x`, which costs nothing to get, makes it finer, `y = far - flat * u + lean * (x >> 8)`, or `steep` has
//! eight binary places, and `x` is the middle of its product with `u`.

use super::contract::{Fit, Form, center};
use super::steps::{INDEX_STARTS, plus, temperature_index_from};
use crate::ir::{Builder, Value};
use crate::minimax::{Points, minimax};

/// Name of the form.
pub(super) const NAME: &str = "factored";

/// Points of a minimax fit. Set by hand: a parabola needs four; the integers are chosen on all codes afterwards.
const POINTS: usize = 128;
/// The search for `far` covers this many integers on either side of its ideal value. Set by hand: the search time grows
/// with it.
const REACH: i64 = 4;
/// Binary places of the first line's factor, if it has any: one byte, so that the shift moves whole bytes.
const PLACES: u32 = 8;
/// The search for that factor covers this many integers on either side. Set by hand.
const FINE_REACH: i64 = 24;
/// Other starts of the index are tried if the error is at most this many times the bound. Set by hand.
const NEAR: f64 = 1.5;
/// Largest factor of the second line that is tried if the first line must fit 16 bits. Set by hand.
const FLATTEST: i64 = 4;
/// Bits of a 32-bit product that may be used: a tenth of a bit is left for the rounding of the constants.
const PRODUCT_BITS: f64 = 31.9;
/// Most binary places of `flat * u` on cores that shift by any number of places. Set by hand.
const MOST_PLACES: i32 = 24;

/// `base + sign * ((steep * u * (far - bent * (flat * u - lean * (steep * u >> 8)))) >> shift)`.
#[derive(Clone, Debug)]
struct Factored {
    /// The code that `u` is counted from lies so far below the coldest.
    before: i64,
    base: i64,
    far: i64,
    steep: i64,
    /// Binary places of `steep`.
    places: u32,
    flat: i64,
    lean: i64,
    /// Whether the second line falls.
    falls: bool,
    /// Whether the speed factor grows with the temperature.
    grows: bool,
    shift: u32,
    floor: f64,
}

/// Some of the codes of a fit, with their targets and weights.
struct Sample {
    codes: Vec<f64>,
    target: Vec<f64>,
    weight: Vec<f64>,
}

impl Sample {
    fn of(fit: &Fit<'_>) -> Self {
        let last = fit.target.len() - 1;
        let count = POINTS.min(last + 1);
        let picked: Vec<usize> = (0..count).map(|k| k * last / (count - 1)).collect();
        let take = |values: &[f64]| picked.iter().map(|index| values[*index]).collect();
        Self {
            codes: picked.iter().map(|index| *index as f64).collect(),
            target: take(&fit.target),
            weight: take(&fit.weight),
        }
    }

    /// Coefficients of the best polynomial beside `settled`, and the error that it leaves \[unit\].
    fn solve(&self, settled: impl Fn(f64) -> f64, degree: usize) -> (Vec<f64>, f64) {
        let rest = |(code, target): (&f64, &f64)| target - settled(*code);
        let y: Vec<f64> = self.codes.iter().zip(&self.target).map(rest).collect();
        let points = Points {
            x: &self.codes,
            y: &y,
            weight: &self.weight,
        };
        minimax(points, degree)
    }
}

pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    if fit.target.len() < 4 {
        return Vec::new();
    }
    let sample = Sample::of(fit);
    let (ideal, _) = sample.solve(|_| 0.0, 2);
    let last = (fit.target.len() - 1) as f64;
    let (slope, bend) = (ideal[1], ideal[2]);
    let end = bend.mul_add(last, slope);
    if slope == 0.0 || slope * end <= 0.0 {
        return Vec::new(); // the second line would change its sign
    }
    let (grows, falls) = (slope > 0.0, slope * bend < 0.0);
    let blank = |(steep, places, flat, lean), shift| Factored {
        before: 0,
        base: 0,
        far: 0,
        steep,
        places,
        flat,
        lean,
        falls,
        grows,
        shift,
        floor: 0.0,
    };
    let formats: Vec<Factored> = if fit.core.least_bits < 32 {
        byte_formats(bend.abs() * 65_536.0, last, falls)
            .into_iter()
            .map(|format| blank(format, 16))
            .collect()
    } else {
        vec![word_format(bend, slope.abs().max(end.abs()) * last, blank)]
    };
    let useful = formats
        .into_iter()
        .filter(|form| form.steep * form.flat > 0);
    useful
        .filter_map(|form| Some(Box::new(form.fitted(fit, &sample)?) as _))
        .collect()
}

/// One line as it is, and the other with as many places as the product of both, at most `largest`, leaves room for.
fn word_format(
    bend: f64,
    largest: f64,
    blank: impl Fn((i64, u32, i64, i64), u32) -> Factored,
) -> Factored {
    let shift = (PRODUCT_BITS - largest.log2()).floor() as i32;
    let shift = shift.clamp(0, MOST_PLACES) as u32;
    let flat = (bend.abs() * f64::from(shift).exp2()).round() as i64;
    blank((1, 0, flat, 0), shift)
}

/// Numbers `(steep, its places, flat, lean)` whose curvature is next to `wanted`, and whose first line fits 16 bits.
fn byte_formats(wanted: f64, last: f64, falls: bool) -> Vec<(i64, u32, i64, i64)> {
    let sign = if falls { 1.0 } else { -1.0 };
    let most = (65_535.0 / last).floor() as i64;
    let mut found = Vec::new();
    let leans: [i64; 3] = [0, 1, -1];
    let shapes = leans
        .into_iter()
        .flat_map(|lean| (1..=FLATTEST).map(move |flat| (flat, lean)));
    for (flat, lean) in shapes.chain([(1, 2)]) {
        let curvature = |steep: &i64| {
            let steep = *steep as f64;
            steep * (flat as f64 - sign * lean as f64 * steep / 256.0)
        };
        let off = |steep: &i64| (curvature(steep) - wanted).abs();
        let best = (1..=most).min_by(|a, b| off(a).total_cmp(&off(b)));
        // Twice the high byte must still be a byte.
        let fits = |steep: &i64| lean.abs() < 2 || *steep as f64 * last < 32_768.0;
        found.extend(best.filter(fits).map(|steep| (steep, 0, flat, lean)));
    }
    let fine = (wanted * f64::from(PLACES).exp2()).round();
    if fine < 65_536.0 && fine * last < 16_777_216.0 {
        found.push((fine as i64, PLACES, 1, 0));
    }
    found
}

impl Factored {
    /// The first line.
    fn first(&self, u: i64) -> i64 {
        (self.steep * u) >> self.places
    }

    /// The second line without `far`, falling or rising.
    fn flat(&self, u: i64) -> i64 {
        let sign = if self.falls { -1 } else { 1 };
        sign * self.flat * u + self.lean * (self.first(u) >> 8)
    }

    /// What stands on top of `base` at the code `u`.
    fn part(&self, u: i64) -> i64 {
        let part = (self.first(u) * (self.far + self.flat(u))) >> self.shift;
        if self.grows { part } else { -part }
    }

    /// The high byte of the first line, once or twice.
    fn leaning(&self, builder: &mut Builder<'_>, steep: Value) -> Value {
        let high = builder.shift_right(steep, 8);
        let high = builder.name(
            high,
            "correction",
            "high byte of first_line; it refines the curvature",
        );
        if self.lean.abs() < 2 {
            return high;
        }
        let twice = builder.add(high, high);
        builder.name(twice, "correction_twice", "2 * correction")
    }

    /// The largest error \[unit\], the base set to what suits the lines best.
    fn settle(&mut self, fit: &Fit<'_>) -> f64 {
        let codes = self.before..self.before + fit.target.len() as i64;
        let parts: Vec<i64> = codes.map(|u| self.part(u)).collect();
        let settled: Vec<f64> = parts.iter().map(|part| *part as f64).collect();
        self.base = center(fit, &settled);
        let given: Vec<i64> = parts.iter().map(|part| part + self.base).collect();
        fit.error(&given)
    }

    /// The slope and the base that leave the least error, not rounded jointly yet; `None` if the lines leave their domain.
    fn fitted(mut self, fit: &Fit<'_>, sample: &Sample) -> Option<Self> {
        let unit = f64::from(self.shift).exp2();
        let sign = if self.grows { 1.0 } else { -1.0 };
        let steep = self.steep as f64 / f64::from(self.places).exp2();
        let bend = |u: f64| sign * steep * u * self.flat(u as i64) as f64 / unit;
        let (line, floor) = sample.solve(bend, 1);
        self.far = (sign * line[1] * unit / steep).round() as i64;
        self.base = line[0].round() as i64;
        // The steps of the high byte are no straight line; they are no error that another rounding would not have.
        self.floor = if self.lean == 0 { floor } else { 0.0 };
        let last = fit.target.len() as i64 - 1;
        let natural = |u: i64| self.far + self.flat(u) >= 0;
        (natural(0) && natural(last)).then_some(self)
    }
}

impl Form for Factored {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        "product of two straight lines in the temperature code".into()
    }

    fn parameters(&self) -> serde_json::Value {
        serde_json::json!({
            "before": self.before, "base": self.base, "far": self.far, "steep": self.steep, "steep_places": self.places, "flat": self.flat,
            "lean": self.lean,
            "falls": self.falls, "grows": self.grows, "shift": self.shift,
        })
    }

    fn floor(&self) -> f64 {
        self.floor
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let u = temperature_index_from(builder, self.before);
        let mut steep = times(builder, u, self.steep);
        if self.places > 0 {
            steep = builder.shift_right(steep, self.places);
        }
        let steep = builder.name(steep, "first_line", "linear in the temperature index");
        let flat = times(builder, u, self.flat);
        let far = builder.constant(self.far);
        let mut line = if self.falls {
            builder.subtract(far, flat)
        } else {
            builder.add(flat, far)
        };
        if self.lean != 0 {
            let lean = self.leaning(builder, steep);
            line = if self.lean > 0 {
                builder.add(line, lean)
            } else {
                builder.subtract(line, lean)
            };
        }
        let line = builder.name(line, "second_line", "linear in the temperature index");
        let product = builder.multiply(steep, line);
        let part = builder.shift_right(product, self.shift);
        if self.grows {
            return plus(builder, part, self.base);
        }
        let base = builder.constant(self.base);
        builder.subtract(base, part)
    }

    fn refine(&mut self, fit: &Fit<'_>) {
        let (far, steep) = (self.far, self.steep);
        // Without binary places another factor of the first line is another curvature.
        let reach = if self.places > 0 { FINE_REACH } else { 0 };
        let mut best = (f64::INFINITY, self.clone());
        let sign = if self.falls { 1 } else { -1 };
        for before in 0..INDEX_STARTS {
            for steep in (steep - reach).max(1)..=steep + reach {
                // The product of both is the slope at the coldest code.
                let middle = (far * self.steep + steep / 2) / steep;
                let middle = middle + 2 * sign * self.flat * before;
                for far in middle - REACH..=middle + REACH {
                    let mut trial = Self {
                        before,
                        far,
                        steep,
                        ..self.clone()
                    };
                    let error = trial.settle(fit);
                    if error < best.0 {
                        best = (error, trial);
                    }
                }
            }
            // Another start costs nothing, but takes its time.
            if best.0 <= fit.bound || best.0 > NEAR * fit.bound {
                break;
            }
        }
        *self = best.1;
    }

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(self.clone())
    }
}

fn times(builder: &mut Builder<'_>, value: Value, factor: i64) -> Value {
    if factor == 1 {
        return value;
    }
    let factor = builder.constant(factor);
    builder.multiply(value, factor)
}

//! A polynomial of degree 4 or 5 with adapted coefficients (Knuth 1962, Commun. ACM 5, 595): two products for degree 4 and
//! three for degree 5, where Horner's rule needs four and five.
//!
//! With `x = multiplier * u` and `u` counted from the coldest code, `y = b + x * (x + a)` is a parabola, and
//! `c + y * (y + x + d)` is of degree 4. Every number is natural and of 16 bits, every product loses its lower 16 bits.

mod fitting;

use super::contract::{Fit, Form, center};
use super::steps::temperature_index_from;
use crate::ir::{Builder, Value};
use fitting::{SHAPES, shapes, solve};

/// Name of the form.
pub(super) const NAME: &str = "adapted";

/// Binary places that a product loses: two bytes, so that no bits are shifted.
const BITS: u32 = 16;

/// `constant + sign * value`.
#[derive(Clone, Copy, Debug)]
struct Signed {
    constant: i64,
    sign: i64,
}

impl Signed {
    const fn opposite(self) -> Self {
        Self {
            constant: -self.constant,
            sign: -self.sign,
        }
    }

    const fn of(self, value: i64) -> i64 {
        self.constant + self.sign * value
    }

    fn build(self, builder: &mut Builder<'_>, value: Value) -> Value {
        sum(builder, self.constant, &[(self.sign, value)])
    }
}

/// `constant` plus multiples of values, what is subtracted last.
fn sum(builder: &mut Builder<'_>, constant: i64, terms: &[(i64, Value)]) -> Value {
    let mut parts: Vec<(bool, Value)> = Vec::new();
    for (factor, value) in terms {
        let mut value = *value;
        if factor.abs() != 1 {
            let factor = builder.constant(factor.abs());
            value = builder.multiply(value, factor);
        }
        parts.push((*factor > 0, value));
    }
    if constant != 0 {
        parts.push((constant > 0, builder.constant(constant.abs())));
    }
    parts.sort_by_key(|(added, _)| !added);
    let mut parts = parts.into_iter();
    let mut sum = match parts.next() {
        Some((true, first)) => first,
        Some((false, first)) => {
            let zero = builder.constant(0);
            builder.subtract(zero, first)
        }
        None => builder.constant(0),
    };
    for (added, part) in parts {
        sum = if added {
            builder.add(sum, part)
        } else {
            builder.subtract(sum, part)
        };
    }
    sum
}

/// A polynomial.
#[derive(Clone, Debug)]
struct Adapted {
    /// The code that `u` is counted from lies so far below the coldest.
    before: i64,
    multiplier: i64,
    /// `x + a`, or `a - x`.
    line: Signed,
    /// `y`.
    parabola: Signed,
    /// The constant, and the factors of `y` and `x`, of the second factor.
    second: (i64, i64, i64),
    /// The value of degree 4.
    quartic: Signed,
    /// The constant of degree 5, whose `x` has the value of degree 4 for a factor.
    base: Option<Signed>,
    floor: f64,
}

pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    let codes = fit.target.len();
    if fit.core.least_bits >= 32 || codes < 8 {
        return Vec::new();
    }
    let mut found: Vec<Box<dyn Form>> = Vec::new();
    for degree in [4, 5] {
        let (ideal, _) = solve(fit, degree, 0.0);
        let made = shapes(fit, degree, ideal[degree]).into_iter();
        found.extend(made.take(1).map(|(_, form)| Box::new(form) as _));
    }
    found
}

impl Adapted {
    /// The same with its signs turned so that its numbers are natural in the middle of the codes.
    fn turned(mut self, middle: i64) -> Self {
        if self.steps(middle)[1] < 0 {
            self.line = self.line.opposite();
            self.parabola.sign = -self.parabola.sign;
        }
        if self.steps(middle)[2] < 0 {
            self.parabola = self.parabola.opposite();
            self.second.1 = -self.second.1;
            self.quartic.sign = -self.quartic.sign;
        }
        if self.steps(middle)[3] < 0 {
            let (constant, twice, slant) = self.second;
            self.second = (-constant, -twice, -slant);
            self.quartic.sign = -self.quartic.sign;
        }
        self
    }

    /// Whether every number is natural and of 16 bits.
    fn is_natural(&self, last: i64) -> bool {
        (0..=last).all(|u| {
            self.steps(u)
                .iter()
                .all(|value| (0..=65_535).contains(value))
        })
    }

    /// `x`, the line, the parabola, the second factor, the quartic.
    fn steps(&self, u: i64) -> [i64; 5] {
        let x = self.multiplier * (u + self.before);
        let line = self.line.of(x);
        let y = self.parabola.of((x * line) >> BITS);
        let (constant, twice, slant) = self.second;
        let second = constant + twice * y + slant * x;
        [x, line, y, second, self.quartic.of((y * second) >> BITS)]
    }

    fn at(&self, u: i64) -> i64 {
        let [x, .., quartic] = self.steps(u);
        self.base
            .map_or(quartic, |base| base.of((x * quartic) >> BITS))
    }

    /// The largest error \[unit\], the last constant set to what suits the others best.
    fn settle(&mut self, fit: &Fit<'_>) -> f64 {
        let codes = 0..fit.target.len() as i64;
        self.set_last(0);
        let parts: Vec<i64> = codes.map(|u| self.at(u)).collect();
        let settled: Vec<f64> = parts.iter().map(|part| *part as f64).collect();
        let constant = center(fit, &settled);
        self.set_last(constant);
        let given: Vec<i64> = parts.iter().map(|part| part + constant).collect();
        fit.error(&given)
    }

    const fn degree(&self) -> usize {
        if self.base.is_some() { 5 } else { 4 }
    }

    fn set_last(&mut self, constant: i64) {
        match &mut self.base {
            Some(base) => base.constant = constant,
            None => self.quartic.constant = constant,
        }
    }

    /// Every constant but the last.
    fn change(&mut self, by: [i64; 4]) {
        self.line.constant += by[0];
        self.parabola.constant += by[1];
        self.second.0 += by[2];
        self.quartic.constant += by[3];
    }
}

impl Form for Adapted {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        format!(
            "polynomial of degree {} in the temperature code, with adapted coefficients",
            self.degree()
        )
    }

    fn parameters(&self) -> serde_json::Value {
        let pair = |signed: Signed| (signed.sign, signed.constant);
        serde_json::json!({
            "before": self.before, "multiplier": self.multiplier, "line": pair(self.line), "parabola": pair(self.parabola),
            "second_factor": self.second, "quartic": pair(self.quartic), "base": self.base.map(pair), "shift": BITS,
        })
    }

    fn floor(&self) -> f64 {
        self.floor
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let u = temperature_index_from(builder, self.before);
        let multiplier = builder.constant(self.multiplier);
        let x = builder.multiply(u, multiplier);
        let x = builder.name(x, "scaled", "temperature index, scaled");
        let line = self.line.build(builder, x);
        let product = builder.multiply(x, line);
        let high = builder.shift_right(product, BITS);
        let y = self.parabola.build(builder, high);
        let y = builder.name(y, "parabola", "of degree 2 in the temperature index");
        let (constant, twice, slant) = self.second;
        let second = sum(builder, constant, &[(twice, y), (slant, x)]);
        let second = builder.name(
            second,
            "second_factor",
            "of degree 2 in the temperature index",
        );
        let product = builder.multiply(y, second);
        let high = builder.shift_right(product, BITS);
        let quartic = self.quartic.build(builder, high);
        let Some(base) = self.base else {
            return quartic;
        };
        let quartic = builder.name(quartic, "slope", "of degree 4 in the temperature index");
        let product = builder.multiply(x, quartic);
        let high = builder.shift_right(product, BITS);
        base.build(builder, high)
    }

    fn refine(&mut self, fit: &Fit<'_>) {
        let (ideal, _) = solve(fit, self.degree(), 0.0);
        let made = shapes(fit, self.degree(), ideal[self.degree()]);
        // A shift by several places is a loop where only bytes move: 13 cycles more than a product with 15 (AVR).
        let is_loop = |made: &&(f64, Self)| {
            fit.core.byte_shifts && (made.1.multiplier as u64).is_power_of_two()
        };
        let straight = made.iter().filter(|made| !is_loop(made)).take(SHAPES);
        let looped = made.iter().filter(is_loop).take(SHAPES);
        let mut best = (self.settle(fit), self.clone());
        for (_, start) in straight.chain(looped) {
            let found = start.improved(fit);
            if found.0 < best.0 {
                best = found;
            }
            if best.0 <= fit.bound {
                break;
            }
        }
        *self = best.1;
    }

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(self.clone())
    }
}

//! A polynomial of degree 4 or 5 with adapted coefficients (Knuth 1962, Commun. ACM 5, 595): two products for degree 4 and
//! three for degree 5, where Horner's rule needs four and five.
//!
//! With `x = multiplier * u` and `u` counted from the coldest code, `y = b + x * (x + a)` is a parabola, and
//! `c + y * (y + x + d)` is of degree 4. Every number is natural and of 16 bits, every product loses its lower 16 bits.

mod constants;
mod fitting;

use super::contract::{Fit, Form};
use super::steps::temperature_index_from;
use crate::ir::{Builder, Value};
use constants::{Adapted, BITS, Signed};
use fitting::{SHAPES, shapes, solve};

/// Name of the form.
pub(super) const NAME: &str = "adapted";

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

impl Signed {
    fn build(self, builder: &mut Builder<'_>, value: Value) -> Value {
        sum(builder, self.constant, &[(self.sign, value)])
    }
}

//! A polynomial of degree 4 or 5 with adapted coefficients (Knuth 1962, Commun. ACM 5, 595): two products for degree 4 and
//! three for degree 5, where Horner's rule needs four and five.
//!
//! With `x = multiplier * u` and `u` counted from the coldest code, `y = b + x * (x + a)` is a parabola, and
//! `c + y * (y + x + d)` is of degree 4. Every number is natural and of 16 bits, every product loses its lower 16 bits.

use super::contract::{Fit, Form, center};
use super::steps::{INDEX_STARTS as BEFORE, temperature_index_from};
use crate::ir::{Builder, Value};
use crate::minimax::{Points, minimax};

/// Name of the form.
pub(super) const NAME: &str = "adapted";

/// Points of a minimax fit. Set by hand: the integers are chosen on all codes afterwards.
const POINTS: usize = 96;
/// Binary places that a product loses: two bytes, so that no bits are shifted.
const BITS: u32 = 16;
/// Shapes of a degree that are refined. Set by hand.
const SHAPES: usize = 12;
/// Descents from constants that are changed at random, and the most that each is changed by. Set by hand.
const RESTARTS: usize = 6;
const AWAY: i64 = 24;
/// They are tried if the error is at most this many times the bound. Set by hand.
const NEAR: f64 = 1.4;
/// Steps of the descent over integers. Set by hand.
const STEPS: [i64; 3] = [16, 4, 1];
/// Most rounds with each step. Set by hand; a round without an improvement ends the step.
const ROUNDS: usize = 30;
/// Share of the error of the best polynomial with this leading coefficient that no rounding undercuts. Set by hand.
const SURE: f64 = 0.9;

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

/// Coefficients in powers of the code, the leading one fixed, and the error that they leave \[unit\].
fn solve(fit: &Fit<'_>, degree: usize, leading: f64) -> (Vec<f64>, f64) {
    let last = fit.target.len() - 1;
    let count = POINTS.min(last + 1);
    let picked: Vec<usize> = (0..count).map(|k| k * last / (count - 1)).collect();
    let span = last as f64;
    let x: Vec<f64> = picked.iter().map(|u| *u as f64 / span).collect();
    let settled = |u: usize| leading * (u as f64).powi(degree as i32);
    let y: Vec<f64> = picked
        .iter()
        .map(|u| fit.target[*u] - settled(*u))
        .collect();
    let weight: Vec<f64> = picked.iter().map(|u| fit.weight[*u]).collect();
    let free = if leading == 0.0 { degree } else { degree - 1 };
    let (mut found, error) = minimax(
        Points {
            x: &x,
            y: &y,
            weight: &weight,
        },
        free,
    );
    let mut scale = 1.0;
    for coefficient in &mut found {
        *coefficient /= scale;
        scale *= span;
    }
    if leading != 0.0 {
        found.push(leading);
    }
    (found, error)
}

/// Coefficients of the same polynomial in a variable that is larger by `more`.
fn moved(found: &[f64], more: f64) -> Vec<f64> {
    let mut moved = found.to_vec();
    for least in 0..moved.len() {
        for k in (least..moved.len() - 1).rev() {
            moved[k] = more.mul_add(-moved[k + 1], moved[k]);
        }
    }
    moved
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

/// The polynomials of a degree whose leading coefficient is near `leading`, with their errors as they are rounded
/// \[unit\], the least first.
fn shapes(fit: &Fit<'_>, degree: usize, leading: f64) -> Vec<(f64, Adapted)> {
    let last = fit.target.len() as i64 - 1;
    let unit = f64::from(BITS).exp2();
    let mut made = Vec::new();
    for twice in [1, 2] {
        let power = leading.abs() * unit.powi(degree as i32 - 1) / twice as f64;
        let ideal = power.powf((degree as f64).recip());
        for multiplier in [ideal.floor(), ideal.ceil()] {
            // A shift by several places is a loop where only bytes move: 13 cycles more than a product with 15 (AVR).
            let looped = fit.core.byte_shifts && (multiplier as u64).is_power_of_two();
            if multiplier < 1.0 || multiplier * (last + BEFORE) as f64 > 65_535.0 || looped {
                continue;
            }
            let fixed = leading.signum() * twice as f64 * multiplier.powi(degree as i32)
                / unit.powi(degree as i32 - 1);
            let (found, floor) = solve(fit, degree, fixed);
            if floor > fit.bound {
                continue;
            }
            for (slant, before) in [-2, -1, 1, 2]
                .into_iter()
                .flat_map(|slant| (0..BEFORE).map(move |before| (slant, before)))
            {
                let found = moved(&found, before as f64);
                let form = Adapted::of(&found, multiplier, (twice, slant), floor);
                let form = form.map(|form| Adapted { before, ..form });
                let form = form.map(|form| form.turned(last / 2));
                let form = form.filter(|form| form.is_natural(last));
                made.extend(form.map(|mut form| (form.settle(fit), form)));
            }
        }
    }
    made.sort_by(|a, b| a.0.total_cmp(&b.0));
    made
}

impl Adapted {
    /// The constants of the polynomial with these coefficients in powers of the code, where the second factor holds
    /// `y` and `x` so many times.
    fn of(found: &[f64], multiplier: f64, (twice, slant): (i64, i64), floor: f64) -> Option<Self> {
        let unit = f64::from(BITS).exp2();
        let in_x = |k: usize| found[k] / multiplier.powi(k as i32);
        let base = (found.len() == 6).then(|| in_x(0));
        let power = |k: usize| {
            if base.is_some() {
                in_x(k + 1) * unit
            } else {
                in_x(k)
            }
        };
        let (k, j) = (twice as f64, slant as f64);
        let sign = power(4).signum();
        // y = b + (x^2 + a x) / unit; c + sign * y * (d + k y + j x) / unit.
        let a = 0.5 * (power(3) * sign * unit - j / unit) * unit * unit / k;
        let (square, straight) = (power(2) * sign * unit, power(1) * sign * unit);
        let bent = k * a * a / unit / unit + j * a / unit;
        let b = (a.mul_add(-square, straight) + a * bent) / j;
        let d = (square - bent - 2.0 * k * b / unit) * unit;
        let c = (-sign * b).mul_add(k.mul_add(b, d) / unit, power(0));
        let round = |value: f64| value.abs().lt(&1e9).then(|| value.round() as i64);
        let (a, b, c, d) = (round(a)?, round(b)?, round(c)?, round(d)?);
        let sign = sign as i64;
        let form = Self {
            before: 0,
            multiplier: multiplier as i64,
            line: Signed {
                constant: a,
                sign: 1,
            },
            parabola: Signed {
                constant: b,
                sign: 1,
            },
            second: (d, twice, slant),
            quartic: Signed { constant: c, sign },
            base: base.map(|base| Signed {
                constant: base.round() as i64,
                sign: 1,
            }),
            floor: SURE * floor,
        };
        Some(form)
    }

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

    /// The best constants that are found from these, until the bound is met, and their error \[unit\].
    fn improved(&self, fit: &Fit<'_>) -> (f64, Self) {
        let moves = self.moves();
        let mut best = self.descended(fit, &moves);
        let mut draw = 1_u64;
        for _ in 0..RESTARTS {
            if best.0 <= fit.bound || best.0 > NEAR * fit.bound {
                break;
            }
            let mut other = best.1.clone();
            let mut by = [0; 4];
            for by in by.iter_mut().take(self.degree() - 1) {
                draw = draw.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                *by = (draw >> 33) as i64 % (2 * AWAY + 1) - AWAY;
            }
            other.change(by);
            let found = other.descended(fit, &moves);
            if found.0 < best.0 {
                best = found;
            }
        }
        best
    }

    /// Changes of one constant, and of two.
    fn moves(&self) -> Vec<[i64; 4]> {
        let mut moves: Vec<[i64; 4]> = Vec::new();
        for one in 0..self.degree() - 1 {
            let mut single = [0; 4];
            single[one] = 1;
            moves.push(single);
            for other in 0..one {
                for way in [1, -1] {
                    let mut pair = single;
                    pair[other] = way;
                    moves.push(pair);
                }
            }
        }
        moves
    }

    /// The constants to which single steps lead that each leave less error, and that error \[unit\].
    fn descended(&self, fit: &Fit<'_>, moves: &[[i64; 4]]) -> (f64, Self) {
        let last = fit.target.len() as i64 - 1;
        let mut best = (self.clone().settle(fit), self.clone());
        if !self.is_natural(last) {
            best.0 = f64::INFINITY;
        }
        for step in STEPS {
            for _ in 0..ROUNDS {
                let before = best.0;
                for by in moves {
                    for way in [step, -step] {
                        let mut trial = best.1.clone();
                        trial.change(by.map(|by| by * way));
                        let error = trial.settle(fit);
                        if error < best.0 && trial.is_natural(last) {
                            best = (error, trial);
                        }
                    }
                }
                if best.0 == before {
                    break;
                }
            }
        }
        best
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
        let mut made = shapes(fit, self.degree(), ideal[self.degree()]);
        made.truncate(SHAPES);
        let mut best = (self.settle(fit), self.clone());
        for start in made {
            let found = start.1.improved(fit);
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

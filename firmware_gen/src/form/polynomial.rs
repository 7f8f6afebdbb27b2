//! A polynomial in the temperature code, evaluated by Horner's rule in integers.
//!
//! Stage `k` holds `w_k = c_k + ((u * w_(k+1)) >> s_(k+1))` with `places_k` binary places more than the speed factor;
//! the constants are chosen one after the other from the top, each by a minimax fit to what is left once those above
//! it are rounded and their products cut off, so the roundings make up for each other.

use super::tail::plus;
use super::{Fit, Form, warmth};
use crate::ir::{Builder, Value};
use crate::minimax::{Points, minimax};

/// Highest degree that is proposed.
const DEGREES: usize = 5;
/// Points of a minimax fit: enough to see every bulge of a polynomial of this degree.
const POINTS: usize = 256;
/// Names of the stages in C.
const NAMES: [&str; DEGREES + 1] = ["speed", "slope", "bend", "third", "fourth", "fifth"];

/// An integer polynomial.
#[derive(Clone, Debug)]
struct Polynomial {
    /// Constants `c_0 ..= c_degree`.
    coefficients: Vec<i64>,
    /// Binary places of each stage beyond those of the speed factor; never falling.
    places: Vec<u32>,
    floor: f64,
}

/// The sum so far: a number, or a value that may stand for its opposite so that it is never negative.
#[derive(Clone, Copy, Debug)]
enum Inner {
    Number(i64),
    Signed { value: Value, negated: bool },
}

/// Name of the form.
pub(super) const NAME: &str = "polynomial";

pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    let codes = fit.target.len();
    let mut forms: Vec<Box<dyn Form>> = Vec::new();
    for degree in (0..=DEGREES).filter(|degree| *degree == 0 || degree + 2 <= codes) {
        let ideal = Remaining::new(fit, &vec![0; codes], 0, 0).solve(degree);
        for constant_bits in [16, 31] {
            let places = places(&ideal.0, codes, constant_bits);
            let round =
                |(coefficient, places): (&f64, &u32)| (coefficient * exp2(*places)).round() as i64;
            let coefficients = ideal.0.iter().zip(&places).map(round).collect();
            forms.push(Box::new(Polynomial {
                coefficients,
                places,
                floor: ideal.1,
            }));
            if degree == 0 {
                break;
            }
        }
    }
    forms
}

/// As many binary places for each stage as products of 31 bits and stages of `constant_bits` allow.
fn places(ideal: &[f64], codes: usize, constant_bits: i32) -> Vec<u32> {
    let mut places = vec![0_u32];
    for stage in 1..ideal.len() {
        let inner = |u: f64| {
            ideal[stage..]
                .iter()
                .rev()
                .fold(0.0_f64, |sum, c| sum.mul_add(u, *c))
        };
        let largest = (0..=32)
            .map(|k| inner(k as f64 * codes as f64 / 32.0).abs())
            .fold(0.0_f64, f64::max);
        let product = (31.0 - (largest * codes as f64).log2()).floor();
        let constant = (f64::from(constant_bits) - largest.log2()).floor();
        let fewest = f64::from(places[stage - 1]);
        places.push(product.min(constant).clamp(fewest, fewest + 24.0) as u32);
    }
    places
}

fn exp2(places: u32) -> f64 {
    f64::from(places).exp2()
}

/// What is left to fit once the stages above `degree` are settled.
struct Remaining<'a> {
    fit: &'a Fit<'a>,
    /// Settled part of the factor at each code.
    settled: Vec<f64>,
}
impl<'a> Remaining<'a> {
    /// `cut` holds the cut-off product that enters stage `stage`, at each code.
    fn new(fit: &'a Fit<'a>, cut: &[i64], stage: usize, places: u32) -> Self {
        let power =
            |(u, cut): (usize, &i64)| (u as f64).powi(stage as i32) * *cut as f64 / exp2(places);
        Self {
            fit,
            settled: cut.iter().enumerate().map(power).collect(),
        }
    }

    /// Coefficients in powers of the code, and the error that they leave [um].
    fn solve(&self, degree: usize) -> (Vec<f64>, f64) {
        let codes = self.settled.len();
        let span = (codes - 1).max(1);
        let count = codes.min(POINTS);
        let picked: Vec<usize> = (0..count).map(|k| k * span / (count - 1).max(1)).collect();
        let x: Vec<f64> = picked.iter().map(|&u| u as f64 / span as f64).collect();
        let y: Vec<f64> = picked
            .iter()
            .map(|&u| self.fit.target[u] - self.settled[u])
            .collect();
        let weight: Vec<f64> = picked.iter().map(|&u| self.fit.weight[u]).collect();
        let (mut coefficients, error) = minimax(
            Points {
                x: &x,
                y: &y,
                weight: &weight,
            },
            degree,
        );
        let mut scale = 1.0;
        for coefficient in &mut coefficients {
            *coefficient /= scale;
            scale *= span as f64;
        }
        (coefficients, error)
    }
}

impl Polynomial {
    fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// The product of the code and `inner`, cut off to the places of `stage`: what enters that stage.
    fn cut(&self, builder: &mut Builder<'_>, u: Value, inner: Inner, stage: usize) -> (Inner, i64) {
        let bits = self.places[stage + 1] - self.places[stage];
        let (factor, negated) = match inner {
            Inner::Number(number) => (builder.constant(number.abs()), number < 0),
            Inner::Signed { value, negated } => (value, negated),
        };
        let product = builder.multiply(u, factor);
        let lowest = builder.range(product).minimum;
        // Only natural numbers are shifted: a product of either sign is lifted, and the next constant takes it back.
        let lift = if lowest < 0 { 1 + (-lowest >> bits) } else { 0 };
        let lifted = plus(builder, product, lift << bits);
        let value = builder.shift_right(lifted, bits);
        (Inner::Signed { value, negated }, lift)
    }

    /// Stage `stage` from what enters it.
    fn stage(&self, builder: &mut Builder<'_>, entering: (Inner, i64), stage: usize) -> Inner {
        let (Inner::Signed { value, negated }, lift) = entering else {
            return entering.0;
        };
        let constant = self.coefficients[stage] + if negated { lift } else { -lift };
        let (sum, flipped) = match (negated, constant) {
            (_, 0) => (value, negated),
            (false, 1..) | (true, ..0) => (plus(builder, value, constant.abs()), negated),
            _ => {
                // A difference: written the way round that is not negative, if there is one.
                let constant = builder.constant(constant.abs());
                let mark = builder.mark();
                let rest = builder.subtract(constant, value);
                if builder.range(rest).maximum <= 0 {
                    builder.rewind(mark);
                    (builder.subtract(value, constant), negated)
                } else {
                    (rest, !negated)
                }
            }
        };
        let sign = if flipped { ", its sign left out" } else { "" };
        let note = format!("2^-{} of the last place of speed{sign}", self.places[stage]);
        Inner::Signed {
            value: builder.name(sum, NAMES[stage], note),
            negated: flipped,
        }
    }

    /// The factors of `search` at this depth: settle `stage` given all above it, then go on below.
    fn descend(
        &mut self,
        search: &mut Search<'_, '_>,
        u: Value,
        inner: Option<Inner>,
        stage: usize,
    ) {
        let mark = search.builder.mark();
        let entering = inner.map(|inner| self.cut(&mut search.builder, u, inner, stage));
        let codes = search.fit.target.len();
        let cut = match entering {
            Some((Inner::Signed { value, negated }, lift)) => {
                let sign = if negated { -1 } else { 1 };
                search
                    .builder
                    .per_row(value)
                    .iter()
                    .map(|cut| sign * (cut - lift))
                    .collect()
            }
            _ => vec![0; codes],
        };
        let remaining = Remaining::new(search.fit, &cut, stage, self.places[stage]);
        if stage == 0 {
            self.coefficients[0] = center(search.fit, &remaining.settled);
            let factors: Vec<i64> = cut.iter().map(|cut| cut + self.coefficients[0]).collect();
            let error = search.fit.error(&factors);
            if error < search.best.0 {
                search.best = (error, self.coefficients.clone());
            }
        } else {
            let ideal = (remaining.solve(stage).0[stage] * exp2(self.places[stage])).round() as i64;
            let reach = if inner.is_none() { 2 } else { 1 };
            for coefficient in ideal - reach..=ideal + reach {
                self.coefficients[stage] = coefficient;
                let here = search.builder.mark();
                let next = match entering {
                    Some(entering) => self.stage(&mut search.builder, entering, stage),
                    None => Inner::Number(coefficient),
                };
                self.descend(search, u, Some(next), stage - 1);
                search.builder.rewind(here);
            }
        }
        search.builder.rewind(mark);
    }
}

/// A search for the constants that together leave the least error.
struct Search<'a, 'b> {
    fit: &'a Fit<'a>,
    builder: Builder<'b>,
    best: (f64, Vec<i64>),
}

/// The constant that leaves the least error beside `settled`.
fn center(fit: &Fit<'_>, settled: &[f64]) -> i64 {
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

impl Form for Polynomial {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        match self.degree() {
            0 => "one speed factor for all temperatures".into(),
            degree => format!("polynomial of degree {degree} in the temperature code"),
        }
    }

    fn parameters(&self) -> serde_json::Value {
        serde_json::json!({ "degree": self.degree(), "coefficients": self.coefficients, "binary_places": self.places })
    }

    fn floor(&self) -> f64 {
        self.floor
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let degree = self.degree();
        if degree == 0 {
            return builder.constant(self.coefficients[0]);
        }
        let u = warmth(builder);
        let mut inner = Inner::Number(self.coefficients[degree]);
        for stage in (0..degree).rev() {
            let entering = self.cut(builder, u, inner, stage);
            inner = self.stage(builder, entering, stage);
        }
        match inner {
            Inner::Signed {
                value,
                negated: false,
            } => value,
            Inner::Signed {
                value,
                negated: true,
            } => {
                // No speed is negative: the range says so, and the candidate is dropped for it.
                let zero = builder.constant(0);
                builder.subtract(zero, value)
            }
            Inner::Number(number) => builder.constant(number),
        }
    }

    fn refine(&mut self, fit: &Fit<'_>) {
        let mut builder = Builder::new(fit.device, fit.least_bits);
        let u = warmth(&mut builder);
        let start = fit.error(&super::factors(self, fit));
        let mut search = Search {
            fit,
            builder,
            best: (start, self.coefficients.clone()),
        };
        self.descend(&mut search, u, None, self.degree());
        self.coefficients = search.best.1;
    }
}

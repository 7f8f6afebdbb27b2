//! A polynomial in the temperature code, evaluated by Horner's rule in integers.
//!
//! Stage `k` holds `w_k = c_k + ((u * w_(k+1)) >> s_(k+1))` with `places_k` binary places more than the speed factor;
//! the constants are chosen one after the other from the top, each by a minimax fit to what is left once those above
//! it are rounded and their products cut off, so the roundings make up for each other.

mod fitting;

use super::contract::{Fit, Form, center};
use super::steps::{plus, temperature_index};
use crate::ir::{Builder, Value};
use fitting::{Inner, Remaining, Search, exp2};

/// Highest degree that is proposed. Set by hand.
const DEGREES: usize = 5;
/// Names of the stages in C.
const NAMES: [&str; DEGREES + 1] = [
    "speed",
    "slope",
    "curvature",
    "third_order",
    "fourth_order",
    "fifth_order",
];

/// An integer polynomial.
#[derive(Clone, Debug)]
struct Polynomial {
    /// Constants `c_0 ..= c_degree`.
    coefficients: Vec<i64>,
    /// Binary places of each stage beyond those of the speed factor; never falling.
    places: Vec<u32>,
    /// The code is multiplied by this power of two, so that the products are shifted by whole bytes.
    spread: u32,
    floor: f64,
}

/// Name of the form.
pub(super) const NAME: &str = "polynomial";

pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    let codes = fit.target.len();
    let mut forms: Vec<Box<dyn Form>> = Vec::new();
    for degree in (0..=DEGREES).filter(|degree| *degree == 0 || degree + 2 <= codes) {
        let mut formats: Vec<(u32, i32, u32)> = vec![(0, 16, 1), (0, 31, 1)];
        if fit.core.byte_shifts {
            // As far as the code still fits 16 bits.
            formats.extend((0..=(codes as u32).leading_zeros() - 16).map(|spread| (spread, 16, 8)));
        }
        formats.truncate(if degree == 0 { 1 } else { usize::MAX });
        let format = |(spread, bits, grain)| Polynomial::rounded(fit, degree, spread, bits, grain);
        forms.extend(formats.into_iter().filter_map(format));
    }
    forms
}

/// As many binary places for each stage as products of 31 bits and stages of `constant_bits` allow, in steps of `grain`.
fn places(ideal: &[f64], codes: usize, constant_bits: i32, grain: u32) -> Vec<u32> {
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
        let added = product.min(constant).clamp(fewest, fewest + 24.0) as u32 - places[stage - 1];
        places.push(places[stage - 1] + added / grain * grain);
    }
    places
}

impl Polynomial {
    /// The ideal coefficients rounded one by one; `None` where the code is spread in vain.
    fn rounded(
        fit: &Fit<'_>,
        degree: usize,
        spread: u32,
        constant_bits: i32,
        grain: u32,
    ) -> Option<Box<dyn Form>> {
        let codes = fit.target.len();
        let ideal = Remaining::new(fit, &vec![0; codes], 0, 0, spread).solve(degree);
        let places = places(&ideal.0, codes << spread, constant_bits, grain);
        let round =
            |(coefficient, places): (&f64, &u32)| (coefficient * exp2(*places)).round() as i64;
        let coefficients: Vec<i64> = ideal.0.iter().zip(&places).map(round).collect();
        let useful = grain == 1
            || !coefficients.contains(&0) && places.windows(2).all(|pair| pair[0] < pair[1]);
        useful.then(|| {
            Box::new(Self {
                coefficients,
                places,
                spread,
                floor: ideal.1,
            }) as _
        })
    }

    /// Settle `stage` given all above it, then go on below.
    fn descend(
        &mut self,
        search: &mut Search<'_, '_>,
        u: Value,
        inner: Option<Inner>,
        stage: usize,
    ) {
        let mark = search.builder.mark();
        let entering = inner.map(|inner| self.cut(&mut search.builder, u, inner, stage));
        let cut = search.values(entering);
        let remaining = Remaining::new(search.fit, &cut, stage, self.places[stage], self.spread);
        if stage == 0 {
            self.coefficients[0] = center(search.fit, &remaining.settled);
            search.consider(&cut, &self.coefficients);
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
    /// The code counted from the coldest, spread.
    fn argument(&self, builder: &mut Builder<'_>) -> Value {
        let u = temperature_index(builder);
        if self.spread == 0 {
            return u;
        }
        let unit = builder.constant(1 << self.spread);
        let spread = builder.multiply(u, unit);
        builder.name(
            spread,
            "spread",
            "temperature index, scaled so that products are shifted by whole bytes",
        )
    }

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
        let sign = if flipped { ", sign inverted" } else { "" };
        let note = format!(
            "step of Horner's rule [2^-{} units of speed]{sign}",
            self.places[stage]
        );
        Inner::Signed {
            value: builder.name(sum, NAMES[stage], note),
            negated: flipped,
        }
    }
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
        serde_json::json!({ "degree": self.degree(), "coefficients": self.coefficients, "binary_places": self.places, "spread": self.spread })
    }

    fn floor(&self) -> f64 {
        self.floor
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let degree = self.degree();
        if degree == 0 {
            return builder.constant(self.coefficients[0]);
        }
        let u = self.argument(builder);
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
        let mut builder = Builder::new(fit.device, fit.core.least_bits);
        let u = self.argument(&mut builder);
        let start = fit.error(&super::contract::factors(self, fit));
        let mut search = Search {
            fit,
            builder,
            best: (start, self.coefficients.clone()),
        };
        self.descend(&mut search, u, None, self.degree());
        self.coefficients = search.best.1;
    }

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(self.clone())
    }
}

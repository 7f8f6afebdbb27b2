//! The constants of an adapted polynomial, and its value in integers.

use crate::form::contract::{Fit, center};

/// Binary places that a product loses: two bytes, so that no bits are shifted.
pub(super) const BITS: u32 = 16;
/// `constant + sign * value`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Signed {
    pub(super) constant: i64,
    pub(super) sign: i64,
}

impl Signed {
    pub(super) const fn opposite(self) -> Self {
        Self {
            constant: -self.constant,
            sign: -self.sign,
        }
    }

    pub(super) const fn of(self, value: i64) -> i64 {
        self.constant + self.sign * value
    }
}

/// A polynomial.
#[derive(Clone, Debug)]
pub(super) struct Adapted {
    /// The code that `u` is counted from lies so far below the coldest.
    pub(super) before: i64,
    pub(super) multiplier: i64,
    /// `x + a`, or `a - x`.
    pub(super) line: Signed,
    /// `y`.
    pub(super) parabola: Signed,
    /// The constant, and the factors of `y` and `x`, of the second factor.
    pub(super) second: (i64, i64, i64),
    /// The value of degree 4.
    pub(super) quartic: Signed,
    /// The constant of degree 5, whose `x` has the value of degree 4 for a factor.
    pub(super) base: Option<Signed>,
    pub(super) floor: f64,
}

impl Adapted {
    /// The same with its signs turned so that its numbers are natural in the middle of the codes.
    pub(super) fn turned(mut self, middle: i64) -> Self {
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
    pub(super) fn is_natural(&self, last: i64) -> bool {
        (0..=last).all(|u| {
            self.steps(u)
                .iter()
                .all(|value| (0..=65_535).contains(value))
        })
    }

    /// `x`, the line, the parabola, the second factor, the quartic.
    pub(super) fn steps(&self, u: i64) -> [i64; 5] {
        let x = self.multiplier * (u + self.before);
        let line = self.line.of(x);
        let y = self.parabola.of((x * line) >> BITS);
        let (constant, twice, slant) = self.second;
        let second = constant + twice * y + slant * x;
        [x, line, y, second, self.quartic.of((y * second) >> BITS)]
    }

    pub(super) fn at(&self, u: i64) -> i64 {
        let [x, .., quartic] = self.steps(u);
        self.base
            .map_or(quartic, |base| base.of((x * quartic) >> BITS))
    }

    /// The largest error \[unit\], the last constant set to what suits the others best.
    pub(super) fn settle(&mut self, fit: &Fit<'_>) -> f64 {
        let codes = 0..fit.target.len() as i64;
        self.set_last(0);
        let parts: Vec<i64> = codes.map(|u| self.at(u)).collect();
        let settled: Vec<f64> = parts.iter().map(|part| *part as f64).collect();
        let constant = center(fit, &settled);
        self.set_last(constant);
        let given: Vec<i64> = parts.iter().map(|part| part + constant).collect();
        fit.error(&given)
    }

    pub(super) const fn degree(&self) -> usize {
        if self.base.is_some() { 5 } else { 4 }
    }

    pub(super) fn set_last(&mut self, constant: i64) {
        match &mut self.base {
            Some(base) => base.constant = constant,
            None => self.quartic.constant = constant,
        }
    }

    /// Every constant but the last.
    pub(super) fn change(&mut self, by: [i64; 4]) {
        self.line.constant += by[0];
        self.parabola.constant += by[1];
        self.second.0 += by[2];
        self.quartic.constant += by[3];
    }
}

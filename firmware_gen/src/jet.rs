//! Bounds of a function of the distance over an interval of distances: of its value, its slope and its curvature.
//!
//! A model that is evaluated with them is bounded between two distances. The ends are computed in `f64` without directed
//! rounding: their error of about 1e-15 is for the reader to allow for.

use core::ops::{Add, Div, Mul, Neg, Sub};
use echocal_core::scalar::{Rows, Scalar};

/// A closed interval; infinite, or not a number, where nothing is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    const ZERO: Self = Self::point(0.0);
    const ONE: Self = Self::point(1.0);
    const ALL: Self = Self {
        low: f64::NEG_INFINITY,
        high: f64::INFINITY,
    };

    const fn point(value: f64) -> Self {
        Self {
            low: value,
            high: value,
        }
    }

    /// The largest magnitude inside.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        // A maximum of `f64` would leave out what is not a number.
        if self.low.is_nan() || self.high.is_nan() {
            f64::INFINITY
        } else {
            self.low.abs().max(self.high.abs())
        }
    }

    /// The least interval that holds all `values`; everything, if one of them is not a number.
    fn hull(values: impl IntoIterator<Item = f64>) -> Self {
        let mut hull = Self {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        };
        for value in values {
            if value.is_nan() {
                return Self::ALL;
            }
            hull.low = hull.low.min(value);
            hull.high = hull.high.max(value);
        }
        hull
    }

    fn or(self, other: Self) -> Self {
        Self::hull([self.low, self.high, other.low, other.high])
    }

    /// A function that never falls, of each end.
    fn rising(self, function: impl Fn(f64) -> f64) -> Self {
        Self::hull([function(self.low), function(self.high)])
    }

    fn square(self) -> Self {
        let ends = Self::hull([self.low * self.low, self.high * self.high]);
        let crosses = self.low < 0.0 && self.high > 0.0;
        let low = if crosses { 0.0 } else { ends.low };
        Self { low, ..ends }
    }

    fn inverse(self) -> Self {
        if self.low > 0.0 || self.high < 0.0 {
            Self::hull([self.low.recip(), self.high.recip()])
        } else {
            Self::ALL
        }
    }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::hull([self.low + other.low, self.high + other.high])
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if self == Self::ZERO || other == Self::ZERO {
            return Self::ZERO; // also beside what is unbounded: the factor is exact
        }
        Self::hull([
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ])
    }
}

/// Value, slope and curvature over an interval of distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// The value.
    pub value: Interval,
    /// The first derivative; where there is none, the slopes on both sides.
    pub slope: Interval,
    /// The second derivative; unbounded where there is none.
    pub bend: Interval,
}

impl Jet {
    /// The distance itself, anywhere between two.
    #[must_use]
    pub const fn between(near: f64, far: f64) -> Self {
        Self {
            value: Interval {
                low: near,
                high: far,
            },
            slope: Interval::ONE,
            bend: Interval::ZERO,
        }
    }

    fn fixed(value: f64) -> Self {
        Self {
            value: Interval::hull([value]),
            slope: Interval::ZERO,
            bend: Interval::ZERO,
        }
    }

    /// A function with these values and derivatives at the values of `self`.
    fn chain(self, value: Interval, first: Interval, second: Interval) -> Self {
        Self {
            value,
            slope: first * self.slope,
            bend: second * self.slope.square() + first * self.bend,
        }
    }

    fn inverse(self) -> Self {
        let inverse = self.value.inverse();
        let square = inverse.square();
        let twice = Interval::point(2.0) * square * inverse;
        self.chain(inverse, -square, twice)
    }

    /// One of two, not known which: `joined` where they meet wherever one takes over from the other.
    fn either(self, other: Self, joined: bool) -> Self {
        if self == other {
            return self;
        }
        let slope = self.slope.or(other.slope);
        Self {
            value: self.value.or(other.value),
            slope: if joined { slope } else { Interval::ALL },
            bend: Interval::ALL,
        }
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
            bend: self.bend + other.bend,
        }
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            slope: -self.slope,
            bend: -self.bend,
        }
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let twice = Interval::point(2.0) * self.slope * other.slope;
        Self {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
            bend: self.bend * other.value + twice + self.value * other.bend,
        }
    }
}

impl Div for Jet {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl)] // the inverse has the derivatives
    fn div(self, other: Self) -> Self {
        self * other.inverse()
    }
}

impl Scalar for Jet {
    fn constant(value: f64) -> Self {
        Self::fixed(value)
    }

    #[allow(clippy::suboptimal_flops)] // the bounds allow for a rounding more
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    fn sqrt(self) -> Self {
        let root = self.value.rising(f64::sqrt);
        let slope = (Interval::point(2.0) * root).inverse();
        let bend = -(Interval::point(2.0) * root * self.value).inverse() * Interval::point(0.5);
        self.chain(root, slope, bend)
    }

    fn exp(self) -> Self {
        let power = self.value.rising(Scalar::exp);
        self.chain(power, power, power)
    }

    fn abs(self) -> Self {
        self.max(-self)
    }

    fn select(condition: Self, chosen: Self, other: Self) -> Self {
        if condition.value.low >= 0.0 {
            chosen
        } else if condition.value.high < 0.0 {
            other
        } else {
            chosen.either(other, false)
        }
    }

    fn min(self, other: Self) -> Self {
        -(-self).max(-other)
    }

    fn max(self, other: Self) -> Self {
        let value = Interval::hull([
            self.value.low.max(other.value.low),
            self.value.high.max(other.value.high),
        ]);
        if self.value.low >= other.value.high {
            self
        } else if other.value.low >= self.value.high {
            other
        } else {
            Self {
                value,
                ..self.either(other, true)
            }
        }
    }
}

impl Rows for Jet {
    fn all_non_negative(self) -> bool {
        self.value.low >= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A function that uses every operation.
    fn all<S: Scalar>(x: S) -> S {
        let c = S::constant;
        let bent = x.mul_add(x, c(0.3)).sqrt() * (c(-0.2) * x).exp();
        let quotient = (x + c(1.0)) / (x * x + c(2.0));
        bent - quotient.min(c(0.4)) + (x - c(1.7)).abs().max(c(0.1) * x)
    }

    proptest! {
        /// Values lie inside, chords within the slopes, and the middle within what the curvature allows of its chord.
        #[test]
        fn what_is_inside_stays_inside(near in 0.0_f64..3.0, width in 1e-6_f64..1.0, at in 0.0_f64..1.0, on in 0.0_f64..1.0) {
            let jet = all(Jet::between(near, near + width));
            let (a, b) = (width.mul_add(at, near), width.mul_add(on, near));
            let slack = 1e-13;
            prop_assert!(jet.value.low - slack <= all(a) && all(a) <= jet.value.high + slack);
            let rise = all(b) - all(a);
            let [least, most] = [jet.slope.low * (b - a), jet.slope.high * (b - a)];
            prop_assert!(least.min(most) - slack <= rise && rise <= least.max(most) + slack);
            let sag = (all(f64::midpoint(a, b)) - f64::midpoint(all(a), all(b))).abs();
            prop_assert!(sag <= jet.bend.magnitude() * (b - a).powi(2) / 8.0 + slack);
        }
    }

    #[test]
    fn a_kink_has_slopes_and_a_jump_has_none() {
        let x = Jet::between(-1.0, 2.0);
        assert_eq!(
            x.abs().slope,
            Interval {
                low: -1.0,
                high: 1.0
            }
        );
        assert_eq!(x.abs().bend, Interval::ALL);
        let jump = Jet::select(x, Jet::fixed(1.0), Jet::fixed(0.0));
        assert_eq!(jump.slope, Interval::ALL);
        assert_eq!(
            jump.value,
            Interval {
                low: 0.0,
                high: 1.0
            }
        );
        assert!(Jet::fixed(1.0).div(x).bend.magnitude().is_infinite());
    }
}

//! Numbers of the form `constant + slope * distance`. A model that is evaluated with them shows whether its echo time is a
//! straight line in the distance. If it is one, the result is that line.

use core::ops::{Add, Div, Mul, Neg, Sub};
use echocal_core::scalar::{Rows, Scalar};

/// `constant + slope * distance`; the slope is NaN once an operation has left the straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// Value at distance 0.
    pub constant: f64,
    /// Growth with the distance.
    pub slope: f64,
}

impl Affine {
    /// The distance itself.
    pub const DISTANCE: Self = Self {
        constant: 0.0,
        slope: 1.0,
    };

    /// A number that does not depend on the distance.
    #[must_use]
    pub const fn fixed(constant: f64) -> Self {
        Self {
            constant,
            slope: 0.0,
        }
    }

    fn is_fixed(self) -> bool {
        self.slope == 0.0
    }

    /// A function that bends: only of a fixed number is the result still known.
    fn bent(self, function: impl Fn(f64) -> f64) -> Self {
        let slope = if self.is_fixed() { 0.0 } else { f64::NAN };
        Self {
            constant: function(self.constant),
            slope,
        }
    }
}

impl Add for Affine {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            constant: self.constant + other.constant,
            slope: self.slope + other.slope,
        }
    }
}

impl Neg for Affine {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            constant: -self.constant,
            slope: -self.slope,
        }
    }
}

impl Sub for Affine {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Affine {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let slope = match (self.is_fixed(), other.is_fixed()) {
            (true, true) => 0.0,
            (true, false) => self.constant * other.slope,
            (false, true) => self.slope * other.constant,
            (false, false) => f64::NAN,
        };
        Self {
            constant: self.constant * other.constant,
            slope,
        }
    }
}

impl Div for Affine {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let slope = match (self.is_fixed(), other.is_fixed()) {
            (true, true) => 0.0,
            (false, true) => self.slope / other.constant,
            (_, false) => f64::NAN,
        };
        Self {
            constant: self.constant / other.constant,
            slope,
        }
    }
}

impl Scalar for Affine {
    fn constant(value: f64) -> Self {
        Self::fixed(value)
    }

    fn mul_add(self, factor: Self, term: Self) -> Self {
        let constant = self.constant.mul_add(factor.constant, term.constant);
        Self {
            constant,
            slope: (self * factor + term).slope,
        }
    }

    fn sqrt(self) -> Self {
        self.bent(f64::sqrt)
    }

    fn exp(self) -> Self {
        self.bent(Scalar::exp)
    }

    fn abs(self) -> Self {
        self.bent(f64::abs)
    }

    fn select(condition: Self, chosen: Self, other: Self) -> Self {
        let picked = if condition.constant >= 0.0 {
            chosen
        } else {
            other
        };
        if condition.is_fixed() || chosen == other {
            picked
        } else {
            Self {
                slope: f64::NAN,
                ..picked
            }
        }
    }
}

impl Rows for Affine {
    fn all_non_negative(self) -> bool {
        self.is_fixed() && self.constant >= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use echocal_core::chain::Stage;
    use echocal_core::{Conditions, Law, Model, Quantity};

    fn line(model: &Model, temperature: f64) -> Affine {
        let at = Conditions::at(temperature);
        let at = Conditions::new(Quantity::ALL.map(|facts| Affine::fixed(at.get(facts.quantity))));
        let parameters: Vec<_> = model.parameters().into_iter().map(Affine::fixed).collect();
        model
            .simulate_to(Stage::Timer, Affine::DISTANCE, &at, &parameters)
            .time
    }

    #[test]
    fn a_model_with_delay_and_offset_is_the_line_that_the_model_computes() {
        let model = Model::new(Law::parse("cramer").unwrap())
            .with("fixed_delay", &[("delay", 31e-6)])
            .and_then(|model| model.with("zero_error", &[("offset", -4e-3)]))
            .unwrap();
        let line = line(&model, 23.0);
        for distance in [0.0, 0.3, 4.0] {
            let time = model.time_of_flight(distance, &Conditions::at(23.0));
            assert!((line.slope.mul_add(distance, line.constant) - time).abs() < 1e-16);
        }
    }

    #[test]
    fn what_bends_is_no_line() {
        let d = Affine::DISTANCE;
        let two = Affine::fixed(2.0);
        for bent in [
            d * d,
            two / d,
            d.sqrt(),
            d.exp(),
            d.abs(),
            Affine::select(d, two, d),
            d.mul_add(d, two),
        ] {
            assert!(bent.slope.is_nan(), "{bent:?}");
            assert!((bent * two + two).slope.is_nan(), "once bent, always bent");
        }
        assert_eq!(Affine::select(two, d, two), d);
        assert_eq!(
            two.mul_add(d, two),
            Affine {
                constant: 2.0,
                slope: 2.0
            }
        );
    }
}

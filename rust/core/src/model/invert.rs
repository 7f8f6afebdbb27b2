//! From what a device recorded back to the distance.

use super::{Model, constants};
use crate::air::{Air, LawOfRows};
use crate::chain::Stage;
use crate::conditions::Conditions;
use crate::dual::Dual;
use crate::echo;
use crate::scalar::Scalar;

impl Model {
    /// The true distance \[m\] of an indication \[m\]: the inverse of [`Model::indicate`].
    ///
    /// NaN where there is none.
    #[must_use]
    pub fn correct(&self, indication: f64, recorded: &Conditions<f64>) -> f64 {
        self.invert(Stage::Indication, indication, indication, recorded)
    }

    /// The true distance \[m\] of a recorded echo time \[s\]: the inverse of
    /// [`Model::time_of_flight`].
    ///
    /// NaN where there is none.
    #[must_use]
    pub fn distance(&self, time: f64, recorded: &Conditions<f64>) -> f64 {
        let speed = if self.is_straight() {
            SOME_SPEED
        } else {
            self.law().speed_of_rows(&Air::recorded(recorded))
        };
        let guess = echo::distance(time, speed);
        self.invert(Stage::Timer, time, guess, recorded)
    }

    /// Whether its echo time and its indication are straight lines over the distance in any air: then one
    /// step of Newton's method arrives, from anywhere, and there is nothing left for a second one but rounding.
    pub(crate) fn is_straight(&self) -> bool {
        !self.terms().iter().any(|term| term.facts().bends)
    }

    /// The distance \[m\] at which a stage ends with `target`, by Newton's method on the exact
    /// derivative to the distance; NaN where it does not settle.
    fn invert(&self, last: Stage, target: f64, guess: f64, recorded: &Conditions<f64>) -> f64 {
        let recorded = constants(recorded);
        let parameters: Vec<_> = self.parameters().into_iter().map(Dual::constant).collect();
        let (mut distance, mut settled) = (guess, -1.0);
        for _ in 0..ENOUGH {
            let chain = self.simulate_to(last, Dual::variable(distance, 0), &recorded, &parameters);
            let reached = match last {
                Stage::Timer => chain.time,
                _ => chain.indication,
            };
            if self.is_straight() {
                return arrive(target, reached, distance);
            }
            (distance, settled) = approach(target, reached, distance, settled);
            if settled >= 0.0 {
                return distance;
            }
            if distance.is_nan() {
                break; // no step leads away from there
            }
        }
        f64::NAN
    }
}

/// A speed of sound \[m/s\] for the first guess at a straight line, which needs none that fits: in air of -40..60
/// degC this one is within 12 %, so the step to the distance is short, and what it is rounded by small.
pub(crate) const SOME_SPEED: f64 = 343.0;

/// Newton steps within which a row settles, or never.
pub(crate) const ENOUGH: usize = 20;

/// What is missing to the target \[m\], as far as the derivative tells.
#[inline(always)]
fn missing<S: Scalar>(target: S, reached: Dual<1, S>) -> S {
    (target - reached.value) / reached.derivatives[0]
}

/// The one step of a straight line: the distance, NaN where that is no finite number.
#[inline(always)]
pub(crate) fn arrive<S: Scalar>(target: S, reached: Dual<1, S>, distance: S) -> S {
    let found = distance + missing(target, reached);
    let finite = S::constant(f64::MAX) - found.abs();
    S::select(finite, found, S::constant(f64::NAN))
}

/// One step of Newton's method: the next distance, and whether it has settled (`>= 0`).
///
/// A row that has settled stays as it is.
#[inline(always)]
pub(crate) fn approach<S: Scalar>(
    target: S,
    reached: Dual<1, S>,
    distance: S,
    settled: S,
) -> (S, S) {
    const SETTLED: f64 = 1e-15; // relative; in meters below 1 m
    // To add -0 leaves any number as it is, and 0 too. A choice between the two distances would do the same, but
    // where both lie in one memory the compiler makes a store under a mask of it: many times slower (AVX2 on Zen 4).
    let step = S::select(settled, S::constant(-0.0), missing(target, reached));
    let next = distance + step;
    let tolerance = S::constant(SETTLED) * next.abs().max(S::constant(1.0));
    (next, tolerance - step.abs())
}

#[cfg(test)]
mod tests {
    use crate::{Conditions, Law, Model};

    /// The formulas give numbers there, and the batch kernels a distance.
    #[test]
    fn a_distance_at_absolute_zero_is_that_of_the_simulation() {
        let model = Model::new(Law::parse("cramer").unwrap());
        let at = Conditions::at(-273.15);
        let distance = model.distance(0.01, &at);
        assert!((model.time_of_flight(distance, &at) - 0.01).abs() < 1e-17);
        assert!((model.correct(1.5, &at) - 1.5).abs() < 1e-15);
    }

    #[test]
    fn what_has_no_distance_is_nan() {
        let model = Model::new(Law::parse("linear").unwrap());
        assert!(model.correct(f64::NAN, &Conditions::at(20.0)).is_nan());
        assert!(model.correct(f64::INFINITY, &Conditions::at(20.0)).is_nan());
        assert!(model.correct(1.0, &Conditions::at(f64::NAN)).is_nan());
        let silent = model
            .with("fixed_speed", &[("weight", 1.0), ("speed", 343.0)])
            .unwrap();
        assert_eq!(silent.correct(0.0, &Conditions::at(20.0)), 0.0);
    }
}

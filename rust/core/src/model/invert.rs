//! From what a device recorded back to the distance.

use super::{Model, constants};
use crate::air::Air;
use crate::chain::Stage;
use crate::conditions::Conditions;
use crate::dual::Dual;
use crate::echo;
use crate::scalar::{Rows, Scalar};

/// What a device gave, for one row or several.
#[derive(Clone, Copy)]
pub(crate) enum DeviceOutput<S> {
    /// What it indicated \[m\].
    Indication(S),
    /// Its echo time \[s\].
    Time(S),
}

impl Model {
    /// The true distance \[m\] of an indication \[m\]: the inverse of [`Model::indicate`].
    ///
    /// NaN where there is none.
    #[must_use]
    pub fn correct(&self, indication: f64, recorded: &Conditions<f64>) -> f64 {
        self.invert_row(DeviceOutput::Indication(indication), recorded)
    }

    /// The true distance \[m\] of a recorded echo time \[s\]: the inverse of
    /// [`Model::time_of_flight`].
    ///
    /// NaN where there is none.
    #[must_use]
    pub fn distance(&self, time: f64, recorded: &Conditions<f64>) -> f64 {
        self.invert_row(DeviceOutput::Time(time), recorded)
    }

    /// [`Model::invert`] for one row, compiled once.
    #[inline(never)]
    fn invert_row(&self, given: DeviceOutput<f64>, recorded: &Conditions<f64>) -> f64 {
        self.invert(given, recorded, &self.parameters())
    }

    /// The true distance \[m\], by Newton's method on the exact derivative to the distance; NaN where
    /// it does not settle.
    ///
    /// A row that has settled stays as it is while its neighbors go on, so that no row depends on
    /// which rows it is computed with. One function for both sides, since each copy holds all
    /// effects.
    #[inline(always)]
    pub(crate) fn invert<S: Rows>(
        &self,
        given: DeviceOutput<S>,
        recorded: &Conditions<S>,
        parameters: &[S],
    ) -> S {
        let (last, target, guess) = match given {
            DeviceOutput::Indication(indication) => (Stage::Indication, indication, indication),
            DeviceOutput::Time(time) => {
                let speed = self.law().speed(&Air::recorded(recorded));
                (Stage::Timer, time, echo::distance(time, speed))
            }
        };
        let recorded = constants(recorded);
        let mut fixed = Vec::with_capacity(parameters.len());
        for &parameter in parameters {
            fixed.push(Dual::<1, S>::fixed(parameter));
        }
        let mut distance = guess;
        let mut settled = S::constant(-1.0);
        for _ in 0..ENOUGH {
            let chain = self.simulate_to(last, Dual::variable(distance, 0), &recorded, &fixed);
            let reached = match last {
                Stage::Timer => chain.time,
                _ => chain.indication,
            };
            (distance, settled) = approach(target, reached, distance, settled);
            if settled.all_non_negative() {
                break;
            }
        }
        S::select(settled, distance, S::constant(f64::NAN))
    }
}

/// Newton steps within which a row settles, or never: affine chains settle in two.
pub(crate) const ENOUGH: usize = 20;

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
    let step = (target - reached.value) / reached.derivatives[0];
    let next = distance + step;
    let tolerance = S::constant(SETTLED) * next.abs().max(S::constant(1.0));
    (
        S::select(settled, distance, next),
        S::select(settled, settled, tolerance - step.abs()),
    )
}

#[cfg(test)]
mod tests {
    use crate::{Conditions, Law, Model};

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

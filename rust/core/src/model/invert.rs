//! From what a device recorded back to the distance.

use super::{Model, constants};
use crate::air::Air;
use crate::chain::{Chain, Stage};
use crate::conditions::Conditions;
use crate::dual::Dual;
use crate::scalar::Scalar;

impl Model {
    /// The true distance \[m\] of an indication \[m\]: the inverse of [`Model::indicate`].
    ///
    /// NaN where there is none.
    #[must_use]
    pub fn correct(&self, indication: f64, recorded: &Conditions<f64>) -> f64 {
        let output = |chain: &Chain<_>| chain.indication;
        self.invert(indication, indication, recorded, Stage::Indication, output)
    }

    /// The true distance \[m\] of a recorded echo time \[s\]: the inverse of
    /// [`Model::time_of_flight`].
    ///
    /// NaN where there is none.
    #[must_use]
    pub fn distance(&self, time: f64, recorded: &Conditions<f64>) -> f64 {
        let guess = 0.5 * time * self.law().speed(&Air::recorded(recorded));
        self.invert(time, guess, recorded, Stage::Timer, |chain| chain.time)
    }

    /// Newton's method on the exact derivative to the distance; NaN where it does not settle.
    fn invert(
        &self,
        target: f64,
        guess: f64,
        recorded: &Conditions<f64>,
        last: Stage,
        output: impl Fn(&Chain<Dual<1>>) -> Dual<1>,
    ) -> f64 {
        const ENOUGH: usize = 20; // affine chains settle in two
        const SETTLED: f64 = 1e-15; // relative; in meters below 1 m
        let parameters: Vec<_> = self.parameters().into_iter().map(Dual::constant).collect();
        let recorded = constants(recorded);
        let mut distance = guess;
        for _ in 0..ENOUGH {
            let variable = Dual::variable(distance, 0);
            let chain = self.simulate_to(last, variable, &recorded, &parameters);
            let reached = output(&chain);
            let step = (target - reached.value) / reached.derivatives[0];
            if !step.is_finite() {
                break;
            }
            distance += step;
            if step.abs() <= SETTLED * distance.abs().max(1.0) {
                return distance;
            }
        }
        f64::NAN
    }
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

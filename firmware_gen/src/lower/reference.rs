//! A lowered model as the reference: a straight line if the formulas prove that it is one, otherwise Newton's method.

use super::Lowered;
use crate::affine::Affine;
use crate::device::{Axis, rows, values};
use crate::reference::{Reference, Shape};
use echocal_core::chain::Stage;
use echocal_core::dual::Dual;
use echocal_core::scalar::Rows;
use echocal_core::{Conditions, Quantity};

/// Newton's method stops at a step of this \[m\]: a millionth of the finest output unit, 1 um.
const SETTLED: f64 = 1e-12;
/// Combinations of conditions between two questions whether to go on: some milliseconds.
const BETWEEN: usize = 16_384;
/// Most Newton steps. Set by hand: a chain that is affine in the distance needs one, and convergence is quadratic.
const STEPS_ALLOWED: usize = 20;

impl Reference for Lowered {
    fn distances(&self, conditions: &[f64], time_of_flight: &[f64], distance: &mut [f64]) {
        let at = self.at(conditions);
        if let Some((slope, start)) = self.line(&at) {
            let pairs = distance.iter_mut().zip(time_of_flight);
            // No fused multiplication: where the core has none it is a call, and it would buy 1e-16 of the distance.
            #[allow(clippy::suboptimal_flops)]
            pairs.for_each(|(distance, time)| *distance = slope * *time + start);
        } else {
            self.invert(&at, time_of_flight, distance);
        }
    }

    fn shape(&self, conditions: &[f64]) -> Shape<'_> {
        let at = self.at(conditions);
        match self.line(&at) {
            Some((slope, start)) if slope >= 0.0 => Shape::Line { slope, start },
            Some(_) => Shape::Unknown,
            None => Shape::Curve(Box::new(move |distance| self.time(distance, &at))),
        }
    }
}

impl Lowered {
    /// The distance as slope [m/s] and start [m], if the formulas prove that it is a straight line for all echo times:
    /// it is inverted once for the whole row.
    fn line(&self, at: &Conditions<f64>) -> Option<(f64, f64)> {
        let line = self.time(Affine::DISTANCE, at);
        let (slope, start) = (line.slope.recip(), -line.constant / line.slope);
        (slope.is_finite() && slope != 0.0 && start.is_finite()).then_some((slope, start))
    }

    /// The least and the greatest echo time \[s\] at each of `distances` \[m\], over all codes of the conditions.
    /// `go_on` is asked now and then; `None` if it said no.
    pub fn echo_times(
        &self,
        conditions: &[Axis],
        distances: &[f64],
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<Vec<(f64, f64)>> {
        let mut ends = vec![(f64::INFINITY, f64::NEG_INFINITY); distances.len()];
        for row in 0..rows(conditions) {
            if row % BETWEEN == BETWEEN - 1 && !go_on() {
                return None;
            }
            let at = self.at(&values(conditions, row));
            for ((least, greatest), distance) in ends.iter_mut().zip(distances) {
                let time = self.time(*distance, &at);
                (*least, *greatest) = (least.min(time), greatest.max(time));
            }
        }
        Some(ends)
    }

    /// The echo time at a distance, in any number type.
    pub(super) fn time<S: Rows>(&self, distance: S, at: &Conditions<f64>) -> S {
        let at = Conditions::new(Quantity::ALL.map(|facts| S::constant(at.get(facts.quantity))));
        let parameters: Vec<S> = self.parameters.iter().copied().map(S::constant).collect();
        self.model
            .simulate_to(Stage::Timer, distance, &at, &parameters)
            .time
    }

    /// Newton's method for each echo time, from the solution and the slope of the one before.
    fn invert(&self, at: &Conditions<f64>, time_of_flight: &[f64], distance: &mut [f64]) {
        let (mut solution, mut slope, mut last) = (0.0_f64, 171.5_f64, 0.0_f64);
        for (time, distance) in time_of_flight.iter().zip(distance) {
            let mut guess = slope.mul_add(*time - last, solution);
            let settled = (0..STEPS_ALLOWED).any(|_| {
                let reached = self.time(Dual::<1>::variable(guess, 0), at);
                slope = reached.derivatives[0].recip();
                let step = (*time - reached.value) * slope;
                guess += step;
                step.abs() <= SETTLED
            });
            *distance = if settled { guess } else { f64::NAN };
            (solution, last) = (guess, *time);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::Device;
    use crate::lower::{lower, lower_without_echo};
    use crate::output::Output;
    use echocal_core::{Law, Model};

    /// The slow way, which serves models that bend, gives what the straight line gives, and what the core gives.
    #[test]
    fn newton_and_the_line_agree() {
        let temperature = Axis::temperature(1.0, -20.0, 60.0, 0.0).unwrap();
        let device = Device {
            echo: Axis::echo(1.0, 0.0, 30_000.0).unwrap(),
            conditions: vec![temperature],
            output: Output::MICROMETERS,
        };
        let model = Model::new(Law::parse("cramer").unwrap())
            .with("fixed_delay", &[("delay", 31e-6)])
            .and_then(|model| model.with("zero_error", &[("offset", -4e-3)]))
            .unwrap();
        let lowered = lower(&model, &device, &Conditions::at(20.0), &[], 4.0).unwrap();
        let times: Vec<f64> = (0..300).map(|code| f64::from(code) * 1e-4).collect();
        let (mut line, mut newton) = (vec![0.0; 300], vec![0.0; 300]);
        for temperature in [-20.0, 17.0, 60.0] {
            let at = lowered.at(&[temperature]);
            lowered.distances(&[temperature], &times, &mut line);
            lowered.invert(&at, &times, &mut newton);
            for (index, time) in times.iter().enumerate() {
                assert!((line[index] - newton[index]).abs() < 1e-12);
                assert!((line[index] - model.distance(*time, &at)).abs() < 1e-12);
            }
        }
    }
    /// The echo comes soonest where it is warm and damp, latest where it is cold and dry; who says stop gets nothing.
    #[test]
    fn echo_times_are_those_of_the_ends_and_can_be_stopped() {
        let conditions = [
            Axis::temperature(0.0625, -20.0, 60.0, 0.0).unwrap(),
            Axis::humidity(0.01, 0.0, 1.0, 0.0).unwrap(),
        ];
        let (model, at) = (
            Model::new(Law::parse("cramer").unwrap()),
            Conditions::at(20.0),
        );
        let lowered = lower_without_echo(&model, &conditions, &at, &[], 4.0).unwrap();
        let mut asked = 0;
        let mut count = |go_on: bool| {
            lowered.echo_times(&conditions, &[0.02, 4.0], &mut || {
                asked += 1;
                go_on
            })
        };
        let times = count(true).unwrap();
        let expected = |distance, at: [f64; 2]| lowered.time(distance, &lowered.at(&at));
        assert_eq!(times[0].0, expected(0.02, [60.0, 1.0]));
        assert_eq!(times[1].1, expected(4.0, [-20.0, 0.0]));
        assert_eq!(count(false), None);
        assert_eq!(asked, rows(&conditions) / BETWEEN + 1);
    }
}

//! The median of the last measurements, and a gate for outliers: the twin of the C function that may be written beside the
//! calibrated one.

use crate::error::Error;
use crate::output::Output;
use crate::types::IntegerType;
use serde::Serialize;

/// Windows that are offered. Their middle is one measurement, and a status of 8 bits counts them.
pub const WINDOWS: [usize; 3] = [3, 5, 7];

/// Status where too few of the last measurements gave a distance, and none of them was refused. Counted from the end of
/// the type, so that the statuses of the calibrated function can become more.
pub const TOO_FEW: u8 = 254;
/// Status where too few of the last distances lie within the gate about their median.
pub const OUTLIERS: u8 = 255;

/// What stands for no distance: the output of the calibrated function for codes that it does not accept.
pub const OUT_OF_RANGE: i32 = i32::MIN;

/// A median filter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Filter {
    /// Measurements that it looks at.
    pub window: usize,
    /// Largest distance \[unit\] from the median at which a distance still supports it; `None`: any.
    pub gate: Option<u32>,
}

/// What the caller keeps between two calls. As in C, a new one is all zeros.
#[derive(Clone, Debug, Default)]
pub struct State {
    measurements: Vec<Option<i32>>,
    refused: u8,
}

impl Filter {
    /// A filter of `window` measurements, with a gate \[m\].
    ///
    /// # Errors
    /// If there is no such window, or the gate is less than one unit of the output, or more than it holds, or if the
    /// output is no `int32_t`.
    pub fn new(window: usize, gate: Option<f64>, output: &Output) -> Result<Self, Error> {
        if !WINDOWS.contains(&window) {
            return Err(Error::Request(format!(
                "a median of {window} measurements is not offered; choose 3, 5 or 7"
            )));
        }
        if output.ty != IntegerType::I32 {
            return Err(Error::Request(format!(
                "the median filter takes distances of 32 bits, and {} has 16: choose the output type int32, or no filter",
                output.unit
            )));
        }
        let units = |gate: f64| {
            let units = gate.mul_add(output.per_meter, 1e-6).floor(); // 0.3 m are 300 mm, not 299
            let largest = f64::from(i32::MAX);
            if (1.0..=largest).contains(&units) {
                return Ok(units as u32);
            }
            Err(Error::Request(format!(
                "the gate is {} mm: give at least {} mm, one unit of the output, and at most {} mm",
                (gate * 1e12).round() / 1e9,
                output.lsb * 1e3,
                largest * output.lsb * 1e3
            )))
        };
        let gate = gate.map(units).transpose()?;
        Ok(Self { window, gate })
    }

    /// How many of the window must agree: more than half.
    #[must_use]
    pub fn majority(&self) -> usize {
        self.window / 2 + 1
    }

    /// Take one measurement: a distance, and the status of `status`. Gives the median, or why there is none.
    ///
    /// Where an even number of distances has two in the middle, the median is the lower one: it is always an output of
    /// the calibrated function, and its error is bounded as theirs is.
    pub fn update(&self, state: &mut State, distance: i32, status: u8) -> (i32, u8) {
        let heard = status == 0 && distance != OUT_OF_RANGE;
        if !heard {
            state.refused = status;
        }
        state.measurements.push(heard.then_some(distance));
        if state.measurements.len() > self.window {
            state.measurements.remove(0);
        }
        let mut distances: Vec<i32> = state.measurements.iter().copied().flatten().collect();
        if distances.len() < self.majority() {
            let why = if state.refused == 0 {
                TOO_FEW
            } else {
                state.refused
            };
            return (OUT_OF_RANGE, why);
        }
        distances.sort_unstable();
        let median = distances[(distances.len() - 1) / 2];
        let near = |distance: &&i32| {
            self.gate
                .is_none_or(|gate| distance.abs_diff(median) <= gate)
        };
        if distances.iter().filter(near).count() < self.majority() {
            return (OUT_OF_RANGE, OUTLIERS);
        }
        (median, 0)
    }

    /// The outputs and statuses of measurements in order, from a new state.
    pub fn run(&self, measurements: impl IntoIterator<Item = (i32, u8)>) -> Vec<(i32, u8)> {
        let mut state = State::default();
        let each = measurements.into_iter();
        each.map(|(distance, status)| self.update(&mut state, distance, status))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Filter, OUT_OF_RANGE, OUTLIERS, State, TOO_FEW, WINDOWS};
    use crate::output::Output;

    fn filter(window: usize, gate: Option<f64>) -> Filter {
        Filter::new(window, gate, &Output::MICROMETERS).unwrap()
    }

    /// Of k distances, (k - 1) / 2 may be wrong by any amount: the output is not outside the right ones. Every order of a
    /// window, with every number of missing and of wrong ones, wrong ones on either side.
    #[test]
    fn a_minority_of_wrong_distances_does_not_move_it_out_of_the_right_ones() {
        for window in WINDOWS {
            let filter = filter(window, None);
            let choices = [
                None,
                Some(i32::MIN + 1),
                Some(10),
                Some(20),
                Some(30),
                Some(i32::MAX),
            ];
            for mut code in 0..choices.len().pow(window as u32) {
                let mut state = State::default();
                let (mut kept, mut wrong, mut last) = (Vec::new(), 0, (0, 0));
                for _ in 0..window {
                    let choice = choices[code % choices.len()];
                    code /= choices.len();
                    kept.extend(choice.filter(|d| (10..=30).contains(d)));
                    wrong += usize::from(choice.is_some_and(|d| !(10..=30).contains(&d)));
                    let status = u8::from(choice.is_none());
                    last = filter.update(&mut state, choice.unwrap_or(OUT_OF_RANGE), status);
                }
                let heard = kept.len() + wrong;
                assert_eq!(last.1 == 0, heard > window / 2);
                if last.1 == 0 && wrong <= (heard - 1) / 2 {
                    let (low, high) = (kept.iter().min().unwrap(), kept.iter().max().unwrap());
                    assert!((low..=high).contains(&&last.0));
                }
            }
        }
    }

    #[test]
    fn it_says_why_there_is_no_distance() {
        let found = filter(3, Some(0.3)).run([
            (1_000_000, 0),
            (1_010_000, 0),
            (OUT_OF_RANGE, 1), // no echo: two distances are left
            (OUT_OF_RANGE, 3), // one is left
            (1_000_000, 0),
            (2_000_000, 0), // half a meter and more from the lower one
            (2_000_000, 0),
            (2_300_000, 0), // just within the gate
            (2_300_001, 0),
        ]);
        let expected = [
            (OUT_OF_RANGE, TOO_FEW),
            (1_000_000, 0),
            (1_000_000, 0),
            (OUT_OF_RANGE, 3),
            (OUT_OF_RANGE, 3),
            (OUT_OF_RANGE, OUTLIERS),
            (2_000_000, 0),
            (2_000_000, 0),
            (2_300_000, 0),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_gate_is_a_whole_number_of_units() {
        let millimeters = Output::parse("mm").unwrap();
        let gate = |gate| Filter::new(5, Some(gate), &millimeters).map(|filter| filter.gate);
        assert_eq!(gate(0.3).unwrap(), Some(300));
        for wrong in [0.0, -1.0, 0.9e-3, f64::NAN, 3e6] {
            let said = gate(wrong).unwrap_err().to_string();
            assert!(said.contains("at least 1 mm"), "{said}");
        }
        assert!(Filter::new(4, None, &millimeters).is_err());
    }
}

//! What the device measures: integer codes, and the quantity each code stands for.

use crate::error::Error;
use crate::output::Output;
use serde::Serialize;

pub use crate::axis::Axis;
use crate::axis::SLACK;

/// Without an echo an SRF04 ends its pulse after "about 36 ms" (documentation of its maker), an HC-SR04 after 38 ms (data
/// sheet). A pulse longer than this \[us\], 2.8 % less as `echocal.time_outs` has it, and than the accepted ones, is no echo.
const TIME_OUT: f64 = 35_000.0;

/// What `status` returns: whether the codes are accepted, or why not. A text in words for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The function gives a distance.
    Ok,
    /// An echo code of 0, or a time-out.
    NoEcho,
    /// The echo code is below the accepted ones.
    TooNear,
    /// The echo code is above the accepted ones.
    TooFar,
    /// The temperature code is not accepted.
    TemperatureOutOfRange,
    /// The humidity code is not accepted.
    HumidityOutOfRange,
    /// The code of the further input is not accepted.
    FurtherOutOfRange,
}

impl Status {
    /// Every status, in the order of its number.
    pub const ALL: [Self; 7] = [
        Self::Ok,
        Self::NoEcho,
        Self::TooNear,
        Self::TooFar,
        Self::TemperatureOutOfRange,
        Self::HumidityOutOfRange,
        Self::FurtherOutOfRange,
    ];

    /// Its name in words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::NoEcho => "no echo",
            Self::TooNear => "too near",
            Self::TooFar => "too far",
            Self::TemperatureOutOfRange => "temperature out of range",
            Self::HumidityOutOfRange => "humidity out of range",
            Self::FurtherOutOfRange => "further input out of range",
        }
    }

    /// Its name as an identifier of C and of Python.
    #[must_use]
    pub fn identifier(self) -> String {
        self.words().to_uppercase().replace(' ', "_")
    }
}

/// The inputs of the generated function: the echo time first, then the conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Device {
    /// The echo time.
    pub echo: Axis,
    /// The conditions that the device measures; each combination of their codes is one row of the proof.
    pub conditions: Vec<Axis>,
    /// What the function returns.
    pub output: Output,
}

impl Device {
    /// All inputs, the echo time first.
    pub fn axes(&self) -> impl Iterator<Item = &Axis> {
        std::iter::once(&self.echo).chain(&self.conditions)
    }

    /// The statuses that it can have, in the order of their numbers.
    #[must_use]
    pub fn statuses(&self) -> &'static [Status] {
        let without = Status::ALL.len() - 1;
        &Status::ALL[..without + usize::from(self.further().is_some())]
    }

    /// The place among the conditions of the further input: neither the temperature nor the humidity.
    #[must_use]
    pub fn further(&self) -> Option<usize> {
        let usual = ["temperature", "relative_humidity"];
        let conditions = &mut self.conditions.iter();
        conditions.position(|axis| !usual.contains(&axis.quantity.as_str()))
    }

    /// The first echo code that is a time-out, if there is one.
    #[must_use]
    pub fn time_out(&self) -> Option<i64> {
        let longest = (TIME_OUT * 1e-6 / self.echo.lsb + SLACK).floor() as i64;
        let code = longest.max(self.echo.codes.maximum) + 1;
        self.echo.ty.range().contains(code).then_some(code)
    }

    /// Whether the codes are accepted, or the first reason why not, in the order of the arguments.
    #[must_use]
    pub fn status(&self, inputs: &[i64]) -> Status {
        let refused = |(axis, code): &(&Axis, &i64)| !axis.codes.contains(**code);
        let Some((axis, code)) = self.axes().zip(inputs).find(refused) else {
            return Status::Ok;
        };
        match axis.quantity.as_str() {
            "temperature" => Status::TemperatureOutOfRange,
            "relative_humidity" => Status::HumidityOutOfRange,
            quantity if quantity != self.echo.quantity => Status::FurtherOutOfRange,
            _ if *code <= 0 || self.time_out().is_some_and(|first| *code >= first) => {
                Status::NoEcho
            }
            _ if *code < axis.codes.minimum => Status::TooNear,
            _ => Status::TooFar,
        }
    }

    /// How many combinations of condition codes there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        rows(&self.conditions)
    }

    /// How many inputs the function accepts in all.
    #[must_use]
    pub fn inputs(&self) -> u64 {
        self.rows() as u64 * self.echo.len() as u64
    }

    /// Condition codes of row `row`, the last condition running fastest.
    #[must_use]
    pub fn codes(&self, row: usize) -> Vec<i64> {
        codes(&self.conditions, row)
    }

    /// The row of the steps of all conditions, counted from the first of each.
    #[must_use]
    pub fn row(&self, steps: &[usize]) -> usize {
        let pairs = self.conditions.iter().zip(steps);
        pairs.fold(0, |row, (axis, step)| row * axis.len() + step)
    }

    /// Rows that stand for all while forms are chosen: every code of the first condition, and about `columns` of the
    /// combinations of the others, the first and the last among them, those with the lowest index first.
    #[must_use]
    pub fn thinned(&self, columns: usize) -> Vec<usize> {
        let first = self.conditions.first().map_or(1, Axis::len);
        let wide = self.rows() / first;
        let kept = wide.min(columns.max(2));
        let falling = self.conditions.get(1).is_some_and(Axis::falls);
        let column = |k: usize| {
            let rising = if kept < 2 {
                0
            } else {
                k * (wide - 1) / (kept - 1)
            };
            if falling { wide - 1 - rising } else { rising }
        };
        let row = |index: usize| (0..kept).map(move |k| index * wide + column(k));
        (0..first).flat_map(row).collect()
    }

    /// Conditions that have more than one code, the first counted in any case.
    #[must_use]
    pub fn varied(&self) -> usize {
        1 + self
            .conditions
            .iter()
            .skip(1)
            .filter(|axis| axis.len() > 1)
            .count()
    }

    /// Condition values of row `row`, in the units of their axes.
    #[must_use]
    pub fn values(&self, row: usize) -> Vec<f64> {
        values(&self.conditions, row)
    }
}

/// Most combinations of condition codes. The search and the proof took 13 us for each, on one core of two: 26 s.
const MOST_ROWS: usize = 2_000_000;

/// Check that the combinations of conditions can be proven in half a minute of processor time.
///
/// # Errors
/// If there are too many.
pub fn check_rows(conditions: &[Axis]) -> Result<(), Error> {
    let found = rows(conditions);
    if found <= MOST_ROWS {
        return Ok(());
    }
    let counts: Vec<String> = conditions
        .iter()
        .map(|axis| {
            format!(
                "{} of {} in steps of {}",
                axis.len(),
                axis.name,
                axis.with_unit(axis.resolution())
            )
        })
        .collect();
    let bits = found.div_ceil(MOST_ROWS).next_power_of_two().ilog2();
    Err(Error::Codes(format!(
        "{} are {found} combinations, and this version proves up to {MOST_ROWS}, for half a minute: let the function drop \
         {bits} bits of them together (temperature shift, humidity shift), or accept a smaller range",
        counts.join(" times "),
    )))
}

/// How many combinations of the codes of some conditions there are.
pub(crate) fn rows(conditions: &[Axis]) -> usize {
    conditions.iter().map(Axis::len).product()
}

/// Codes of row `row`, the last condition running fastest.
fn codes(conditions: &[Axis], row: usize) -> Vec<i64> {
    let mut rest = row;
    let mut codes: Vec<i64> = Vec::with_capacity(conditions.len());
    for axis in conditions.iter().rev() {
        codes.push(axis.code(rest % axis.len()));
        rest /= axis.len();
    }
    codes.reverse();
    codes
}

/// Values of row `row`, in the units of the axes.
pub(crate) fn values(conditions: &[Axis], row: usize) -> Vec<f64> {
    let pairs = conditions.iter().zip(codes(conditions, row));
    pairs.map(|(axis, code)| axis.value(code)).collect()
}

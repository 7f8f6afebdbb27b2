//! What the device measures: integer codes, and the quantity each code stands for.

use crate::error::Error;
use crate::output::Output;
use crate::types::{IntegerType, Range};
use serde::Serialize;

/// One argument of the generated function: an integer code and the quantity it stands for, `value = zero + lsb * code`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// Name of the C parameter.
    pub name: String,
    /// Influence quantity of the model that the code carries.
    pub quantity: String,
    /// Unit of `lsb` and `zero`, as the unit contract names it.
    pub unit: String,
    /// Value of one code.
    pub lsb: f64,
    /// Value at code 0.
    pub zero: f64,
    /// Codes that the function accepts.
    pub codes: Range,
    /// Type of the C parameter.
    #[serde(rename = "type")]
    pub ty: IntegerType,
}

/// Tolerance of the ends of a range \[codes\]. 0.1 degC is no binary fraction, and -20 degC must still be code -200: the
/// rounding error of such a quotient is below 1e-10 codes.
const SLACK: f64 = 1e-9;

impl Axis {
    /// Echo times of `shortest` to `longest` \[us\], in ticks of `lsb` \[us\].
    ///
    /// # Errors
    /// If the tick is not positive, the longest time is not 1 ..= 65535 ticks, or the shortest is below 0 or leaves no
    /// two codes.
    pub fn echo(lsb: f64, shortest: f64, longest: f64) -> Result<Self, Error> {
        if !(lsb.is_finite() && lsb > 0.0) {
            return Err(Error::Codes(format!(
                "echo LSB {lsb} us is no tick of a timer: give a positive number [us]"
            )));
        }
        let last = (longest / lsb + SLACK).floor();
        if !(1.0..=65_535.0).contains(&last) {
            let code = if lsb == 1.0 {
                String::new()
            } else {
                format!(" is code {last} of LSB {lsb} us: it")
            };
            return Err(Error::Codes(format!(
                "echo max {longest} us{code} is outside 1 .. 65535, what a uint16_t holds"
            )));
        }
        let first = (shortest / lsb - SLACK).ceil() + 0.0; // no -0 in a message
        // Not a number, and it is refused too: every comparison with one is false.
        if !(0.0 <= first && first < last) {
            return Err(Error::Codes(format!(
                "echo times {shortest} .. {longest} us of LSB {lsb} us are codes {first} .. {last}: give an echo min of 0 or more, below the echo max"
            )));
        }
        let name = if lsb == 1.0 { "echo_us" } else { "echo_code" };
        Ok(Self {
            name: name.into(),
            quantity: "time_of_flight".into(),
            unit: "s".into(),
            lsb: lsb * 1e-6,
            zero: 0.0,
            codes: Range {
                minimum: first as i64,
                maximum: last as i64,
            },
            ty: IntegerType::U16,
        })
    }

    /// Air temperatures from `low` to `high` [degC] in steps of `lsb` [degC], code 0 standing for `zero` [degC]; of a
    /// thermometer whose codes fall as it gets warmer, `lsb` is negative.
    ///
    /// # Errors
    /// If the range is empty, not finite, or needs codes outside both `int16_t` and `uint16_t`.
    pub fn temperature(lsb: f64, low: f64, high: f64, zero: f64) -> Result<Self, Error> {
        let finite = [lsb, low, high, zero].iter().all(|value| value.is_finite());
        if !finite || lsb == 0.0 || low > high {
            return Err(Error::Codes(format!(
                "temperature {low}:{high} degC with LSB {lsb} degC is not a range of codes: give low <= high and an LSB other than 0"
            )));
        }
        let (start, end) = if lsb > 0.0 { (low, high) } else { (high, low) };
        let first = ((start - zero) / lsb - SLACK).ceil() + 0.0; // no -0 in a message
        let last = ((end - zero) / lsb + SLACK).floor();
        let ty = holding(first, last);
        let held = ty.range();
        if first < held.minimum as f64 || last > held.maximum as f64 {
            return Err(Error::Codes(format!(
                "temperature {low}:{high} degC with LSB {lsb} degC needs codes {first} .. {last}, and {} holds {} .. {}: use a coarser LSB",
                ty.c_name(),
                held.minimum,
                held.maximum
            )));
        }
        if first > last {
            return Err(Error::Codes(format!(
                "temperature {low}:{high} degC holds no code of LSB {lsb} degC"
            )));
        }
        let codes = Range {
            minimum: first as i64,
            maximum: last as i64,
        };
        Ok(Self {
            name: "temperature_code".into(),
            quantity: "temperature".into(),
            unit: "degC".into(),
            lsb,
            zero,
            codes,
            ty,
        })
    }

    /// Relative humidities from `low` to `high` in steps of `lsb` \[1\], code 0 standing for `zero` \[1\].
    ///
    /// # Errors
    /// If the range is empty, leaves 0 .. 1, or needs codes outside `uint8_t`.
    pub fn humidity(lsb: f64, low: f64, high: f64, zero: f64) -> Result<Self, Error> {
        let inside = lsb > 0.0 && 0.0 <= low && low <= high && high <= 1.0 && zero.is_finite();
        if !inside {
            return Err(Error::Codes(format!(
                "relative humidity {low}:{high} with LSB {lsb} is not a range of codes: give 0 <= low <= high <= 1 and LSB > 0"
            )));
        }
        let codes = Range {
            minimum: ((low - zero) / lsb - SLACK).ceil() as i64,
            maximum: ((high - zero) / lsb + SLACK).floor() as i64,
        };
        if codes.minimum > codes.maximum {
            return Err(Error::Codes(format!(
                "relative humidity {low}:{high} holds no code of LSB {lsb}"
            )));
        }
        if codes.minimum < 0 || codes.maximum > 255 {
            return Err(Error::Codes(format!(
                "relative humidity {low}:{high} with LSB {lsb} needs codes {} .. {}, a uint8_t holds 0 .. 255: change the LSB",
                codes.minimum, codes.maximum
            )));
        }
        Ok(Self {
            name: "humidity_code".into(),
            quantity: "relative_humidity".into(),
            unit: "1".into(),
            lsb,
            zero,
            codes,
            ty: IntegerType::U8,
        })
    }

    /// The quantity at `code`, in `unit`.
    #[must_use]
    pub fn value(&self, code: i64) -> f64 {
        self.lsb.mul_add(code as f64, self.zero)
    }

    /// The time \[us\] at `code`, of an axis in seconds, to 1e-6 us: 50 us are 50, not 49.99999999999999.
    #[must_use]
    pub fn us(&self, code: i64) -> f64 {
        (self.value(code) * 1e12).round() / 1e6
    }

    /// A value of the quantity in words; a number without a unit is only a number.
    #[must_use]
    pub fn with_unit(&self, value: f64) -> String {
        match self.unit.as_ref() {
            "1" => value.to_string(),
            unit => format!("{value} {unit}"),
        }
    }

    /// How many codes the function accepts.
    #[must_use]
    pub fn len(&self) -> usize {
        (self.codes.maximum - self.codes.minimum + 1) as usize
    }

    /// Never: an axis holds at least one code.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }
}

/// The type of codes: signed, unless they need the unsigned one.
fn holding(first: f64, last: f64) -> IntegerType {
    if first >= 0.0 && last > 32_767.0 {
        IntegerType::U16
    } else {
        IntegerType::I16
    }
}

/// Without an echo an SRF04 ends its pulse after "about 36 ms" (documentation of its maker), an HC-SR04 after 38 ms (data
/// sheet). A pulse longer than this \[us\], 2.8 % less as `echocal.echoes` has it, and than the accepted ones, is no echo.
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
}

impl Status {
    /// Every status, in the order of its number.
    pub const ALL: [Self; 6] = [
        Self::Ok,
        Self::NoEcho,
        Self::TooNear,
        Self::TooFar,
        Self::TemperatureOutOfRange,
        Self::HumidityOutOfRange,
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

    /// Rows that stand for all while forms are chosen: every code of the first condition, and about `columns` of the
    /// combinations of the others, the first and the last among them.
    #[must_use]
    pub fn thinned(&self, columns: usize) -> Vec<usize> {
        let first = self.conditions.first().map_or(1, Axis::len);
        let wide = self.rows() / first;
        let kept = wide.min(columns.max(2));
        let column = |k: usize| {
            if kept < 2 {
                0
            } else {
                k * (wide - 1) / (kept - 1)
            }
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

/// How many combinations of the codes of some conditions there are.
pub(crate) fn rows(conditions: &[Axis]) -> usize {
    conditions.iter().map(Axis::len).product()
}

/// Codes of row `row`, the last condition running fastest.
fn codes(conditions: &[Axis], row: usize) -> Vec<i64> {
    let mut rest = row;
    let mut codes: Vec<i64> = Vec::with_capacity(conditions.len());
    for axis in conditions.iter().rev() {
        codes.push(axis.codes.minimum + (rest % axis.len()) as i64);
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

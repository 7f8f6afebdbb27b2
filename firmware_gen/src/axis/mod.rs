//! One argument of the generated function: an integer code, and the quantity that it stands for.

mod codes;

use crate::error::Error;
use crate::types::{IntegerType, Range};
use codes::{HUMIDITY, Kind, MOST_DROPPED, TEMPERATURE, parameter_type};
use echocal_core::Quantity;
use serde::Serialize;

pub use codes::Codes;
pub(crate) use codes::SLACK;

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
    /// Bits that the function drops. All codes of a step of 2^`shift` give the same output.
    #[serde(skip_serializing_if = "is_zero")]
    pub shift: u32,
    /// Where the codes are no multiple of a step, such as those of a thermistor.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub curve: Option<Curve>,
    /// Type of the C parameter.
    #[serde(rename = "type")]
    pub ty: IntegerType,
}

/// A value for each code: `lsb` of the axis is the largest step between two of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Values of the accepted codes, which rise or fall throughout.
    pub values: Vec<f64>,
    /// How they follow from the codes, in words.
    pub scale: String,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde passes a reference
fn is_zero(shift: &u32) -> bool {
    *shift == 0
}

impl Axis {
    /// Echo times of `shortest` to `longest` \[us\], in ticks of `lsb` \[us\] of a timer of 16 bits.
    ///
    /// # Errors
    /// As for [`Axis::timer`].
    pub fn echo(lsb: f64, shortest: f64, longest: f64) -> Result<Self, Error> {
        Self::timer(lsb, shortest, longest, 16)
    }

    /// Echo times of `shortest` to `longest` \[us\], in ticks of `lsb` \[us\] of a timer of `bits` bits: 16 or 32.
    ///
    /// # Errors
    /// If the tick is not positive, the timer is none of these, the longest time is not 1 or more of its ticks, or the
    /// shortest is below 0 or leaves no two codes.
    pub fn timer(lsb: f64, shortest: f64, longest: f64, bits: u32) -> Result<Self, Error> {
        if !(lsb.is_finite() && lsb > 0.0) {
            return Err(Error::Codes(format!(
                "echo LSB {lsb} us is no tick of a timer: give a positive number [us]"
            )));
        }
        let (ty, most, more) = match bits {
            16 => (
                IntegerType::U16,
                65_535.0,
                ": of a timer of 32 bits, state its bits",
            ),
            32 => (IntegerType::U32, MOST_TICKS, ": take a coarser tick"),
            _ => {
                return Err(Error::Codes(format!(
                    "a timer of {bits} bits: this version has 16 and 32"
                )));
            }
        };
        let last = (longest / lsb + SLACK).floor();
        if !(1.0..=most).contains(&last) {
            let code = if lsb == 1.0 {
                String::new()
            } else {
                format!(" is code {last} of LSB {lsb} us: it")
            };
            let holds = if bits == 16 {
                "what a uint16_t holds"
            } else {
                "what is proven in a minute"
            };
            return Err(Error::Codes(format!(
                "echo max {longest} us{code} is outside 1 .. {most}, {holds}{more}"
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
            shift: 0,
            curve: None,
            ty,
        })
    }

    /// Air temperatures \[degC\] of the codes from `first` on, in `words`.
    ///
    /// # Errors
    /// If there are none, if they neither rise nor fall throughout, or if a code is outside `uint16_t`.
    pub fn thermistor(first: i64, values: Vec<f64>, words: String) -> Result<Self, Error> {
        let ty = IntegerType::U16;
        let codes = Range {
            minimum: first,
            maximum: first.saturating_add(values.len() as i64 - 1),
        };
        let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let one_way = steps.iter().all(|step| *step > 0.0) || steps.iter().all(|step| *step < 0.0);
        if values.is_empty() || !one_way || !ty.range().covers(codes) {
            return Err(Error::Codes(format!(
                "{words}: {} temperatures of codes from {first} on are no scale: give one or more, which rise or fall throughout, of codes 0 .. 65535",
                values.len()
            )));
        }
        let lsb = steps.iter().fold(
            0.0_f64,
            |most, step| if step.abs() > most.abs() { *step } else { most },
        );
        Ok(Self {
            name: TEMPERATURE.name.into_owned(),
            quantity: TEMPERATURE.quantity.into(),
            unit: TEMPERATURE.unit.into(),
            lsb,
            zero: 0.0,
            codes,
            shift: 0,
            curve: Some(Curve {
                values,
                scale: words,
            }),
            ty,
        })
    }

    /// Air temperatures \[degC\], no bit of the codes dropped.
    ///
    /// # Errors
    /// As for [`Axis::of`].
    pub fn temperature(lsb: f64, low: f64, high: f64, zero: f64) -> Result<Self, Error> {
        Self::condition(&TEMPERATURE, Codes::new(lsb, low, high, zero))
    }

    /// Relative humidities \[1\], no bit of the codes dropped.
    ///
    /// # Errors
    /// As for [`Axis::of`].
    pub fn humidity(lsb: f64, low: f64, high: f64, zero: f64) -> Result<Self, Error> {
        Self::condition(&HUMIDITY, Codes::new(lsb, low, high, zero))
    }

    /// The codes of a quantity.
    ///
    /// # Errors
    /// If no device has codes of it, or if the range is empty, not finite, not possible, or needs codes that no type of
    /// the parameter holds.
    pub fn of(quantity: &str, codes: Codes) -> Result<Self, Error> {
        let kind = Kind::of(quantity).ok_or_else(|| {
            let known = Quantity::ALL.map(|facts| facts.name).join(", ");
            Error::Codes(format!(
                "no device has codes of {quantity}; this version has those of {known}"
            ))
        })?;
        Self::condition(&kind, codes)
    }

    fn condition(kind: &Kind, asked: Codes) -> Result<Self, Error> {
        let Codes {
            lsb,
            low,
            high,
            zero,
            shift,
        } = asked;
        let what = format!("{} {low}:{high} {} with LSB {lsb}", kind.words, kind.told);
        let (least, most) = kind.possible;
        let finite = [lsb, low, high, zero].iter().all(|value| value.is_finite());
        if !finite || lsb == 0.0 || low > high || low < least || high > most {
            let ends = if least.is_finite() {
                format!("{least} <= low <= high <= {most}")
            } else {
                "low <= high".into()
            };
            return Err(Error::Codes(format!(
                "{what} is not a range of codes: give {ends} and an LSB other than 0"
            )));
        }
        if shift > MOST_DROPPED {
            return Err(Error::Codes(format!(
                "{what}: {shift} bits cannot be dropped; give a shift of 0 .. {MOST_DROPPED}"
            )));
        }
        let (first, last) = asked.between(low, high);
        let ty = parameter_type(kind, asked, (first, last)).ok_or_else(|| {
            let types = kind.types.iter().filter(|ty| shift == 0 || !ty.is_signed());
            let held = types.map(|ty| {
                let Range { minimum, maximum } = ty.range();
                format!("{} holds {minimum} .. {maximum}", ty.c_name())
            });
            let held = held.collect::<Vec<_>>().join(", ");
            let way_out = if shift > 0 && first < 0.0 {
                format!(
                    "codes below 0 drop no bits: give a shift of 0 instead of {shift}, a range without codes below 0, or \
                     add a constant to the codes and give the value of code 0 that they then have"
                )
            } else {
                "use a coarser LSB, or another value of code 0".into()
            };
            Error::Codes(format!(
                "{what} needs codes {first} .. {last}, and {held}: {way_out}"
            ))
        })?;
        // Whole steps: all codes of one are accepted, or none.
        let step = 1_i64 << shift;
        let first = (first as i64 + step - 1).div_euclid(step);
        let last = (last as i64 + 1).div_euclid(step) - 1;
        if first > last {
            let dropped = match shift {
                0 => String::new(),
                _ => format!(" of which {shift} bits are dropped"),
            };
            return Err(Error::Codes(format!("{what} holds no code{dropped}")));
        }
        Ok(Self {
            name: kind.name.clone().into_owned(),
            quantity: kind.quantity.into(),
            unit: kind.unit.into(),
            lsb,
            zero,
            codes: Range {
                minimum: first * step,
                maximum: last * step + step - 1,
            },
            shift,
            curve: None,
            ty,
        })
    }

    /// The quantity at `code`, in `unit`: that of the middle of its step, where bits are dropped.
    #[must_use]
    pub fn value(&self, code: i64) -> f64 {
        if let Some(curve) = &self.curve {
            let place = usize::try_from(code - self.codes.minimum).ok();
            return place
                .and_then(|place| curve.values.get(place))
                .copied()
                .unwrap_or(f64::NAN);
        }
        let step = 1_i64 << self.shift;
        let middle = (code & -step) as f64 + (step - 1) as f64 / 2.0;
        self.lsb.mul_add(middle, self.zero)
    }

    /// Width of a step of the quantity: of one code, or of those that the function takes for one.
    #[must_use]
    pub fn resolution(&self) -> f64 {
        self.lsb.abs() * f64::from(self.shift).exp2()
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

    /// The steps that the function tells apart: codes without the bits that it drops.
    #[must_use]
    pub fn steps(&self) -> Range {
        Range {
            minimum: self.codes.minimum >> self.shift,
            maximum: self.codes.maximum >> self.shift,
        }
    }

    /// The first code of step `place`, counted from the first that is accepted.
    #[must_use]
    pub fn code(&self, place: usize) -> i64 {
        (self.steps().minimum + place as i64) << self.shift
    }

    /// Its name without its end, as names in a program begin.
    #[must_use]
    pub fn word(&self) -> &str {
        self.name.trim_end_matches("_code")
    }

    /// Whether the codes fall as the quantity rises.
    #[must_use]
    pub fn falls(&self) -> bool {
        self.lsb < 0.0
    }

    /// The steps between `code` and the one with the least value: never negative, and rising with the quantity.
    #[must_use]
    pub fn index(&self, code: i64) -> i64 {
        let steps = self.steps();
        if self.falls() {
            steps.maximum - (code >> self.shift)
        } else {
            (code >> self.shift) - steps.minimum
        }
    }

    /// How many codes the function tells apart.
    #[must_use]
    pub fn len(&self) -> usize {
        let steps = self.steps();
        (steps.maximum - steps.minimum + 1) as usize
    }

    /// Never: an axis holds at least one code.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }
}

/// Most ticks of a timer of 32 bits. The hash over all outputs is computed in the time of a logarithm, a brute-force row in
/// proportion: 2^24 ticks of 4 ns are 67 ms.
const MOST_TICKS: f64 = 16_777_215.0;

//! What the function returns: whole numbers of a unit of length.

use crate::error::Error;
use crate::types::{IntegerType, Range};
use serde::Serialize;

/// The unit of the output, and its type.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Output {
    /// Its name on the command line.
    pub unit: &'static str,
    /// What the name of the function ends with, and the unit in texts; where they differ from the name.
    #[serde(skip_serializing_if = "str::is_empty")]
    suffix: &'static str,
    #[serde(skip_serializing_if = "str::is_empty")]
    text: &'static str,
    /// One of it \[m\].
    pub lsb: f64,
    /// How many make a meter.
    #[serde(skip)]
    pub per_meter: f64,
    /// The type of the function.
    #[serde(rename = "type", skip_serializing_if = "is_usual")]
    pub ty: IntegerType,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // serde passes a reference
fn is_usual(ty: &IntegerType) -> bool {
    *ty == IntegerType::I32
}

const fn of(
    unit: &'static str,
    suffix: &'static str,
    text: &'static str,
    lsb: f64,
    per_meter: f64,
) -> Output {
    Output {
        unit,
        suffix,
        text,
        lsb,
        per_meter,
        ty: IntegerType::I32,
    }
}

/// A binary fixed-point number of meters, with so many fractional bits, in its own type.
const fn q(
    unit: &'static str,
    suffix: &'static str,
    text: &'static str,
    bits: u32,
    ty: IntegerType,
) -> Output {
    let per_meter = (1_u32 << bits) as f64;
    Output {
        ty,
        ..of(unit, suffix, text, 1.0 / per_meter, per_meter)
    }
}

/// An inch \[m\], exactly.
const INCH: f64 = 0.0254;

/// Every unit that is offered. To add one, add its line.
pub const OUTPUTS: [Output; 11] = [
    Output::MICROMETERS,
    of("0.1mm", "0_1mm", "0.1 mm", 1e-4, 1e4),
    of("mm", "", "", 1e-3, 1e3),
    of("cm", "", "", 1e-2, 1e2),
    of("0.01in", "0_01in", "0.01 in", 0.01 * INCH, 100.0 / INCH),
    of("in", "", "", INCH, 1.0 / INCH),
    q("Q16.16", "q16_16", "2^-16 m", 16, IntegerType::I32),
    q("Q8.24", "q8_24", "2^-24 m", 24, IntegerType::I32),
    q("Q8.8", "q8_8", "2^-8 m", 8, IntegerType::I16),
    q("Q4.12", "q4_12", "2^-12 m", 12, IntegerType::I16),
    q("Q3.13", "q3_13", "2^-13 m", 13, IntegerType::I16),
];

impl Output {
    /// The unit unless another is asked for.
    pub const MICROMETERS: Self = of("um", "", "", 1e-6, 1e6);

    /// The unit of this name.
    ///
    /// # Errors
    /// If there is none.
    pub fn parse(unit: &str) -> Result<Self, Error> {
        let found = OUTPUTS.into_iter().find(|output| output.unit == unit);
        found.ok_or_else(|| {
            let known = OUTPUTS.map(|output| output.unit).join(", ");
            Error::Request(format!(
                "unknown output unit '{unit}'; this version has {known}"
            ))
        })
    }

    /// The same unit in the type of this name; `None`: in its own.
    ///
    /// # Errors
    /// If a function returns no such type.
    pub fn typed(self, name: Option<&str>) -> Result<Self, Error> {
        let ty = match name {
            None => self.ty,
            Some("int32") => IntegerType::I32,
            Some("int16") => IntegerType::I16,
            Some(other) => {
                return Err(Error::Request(format!(
                    "unknown output type '{other}'; this version has int32, int16"
                )));
            }
        };
        Ok(Self { ty, ..self })
    }

    /// What the name of the function ends with.
    #[must_use]
    pub const fn suffix(&self) -> &'static str {
        if self.suffix.is_empty() {
            self.unit
        } else {
            self.suffix
        }
    }

    /// The unit in texts.
    #[must_use]
    pub const fn text(&self) -> &'static str {
        if self.text.is_empty() {
            self.unit
        } else {
            self.text
        }
    }

    /// The output for codes that the function does not accept: the least number of its type.
    #[must_use]
    pub const fn out_of_range(&self) -> i32 {
        self.ty.range().minimum as i32
    }

    /// Every number that can be a distance.
    #[must_use]
    pub const fn distances(&self) -> Range {
        let Range { minimum, maximum } = self.ty.range();
        Range {
            minimum: minimum + 1,
            maximum,
        }
    }

    /// Whether the rounding to whole units matters. Micrometers are finer than every sensor, and are rounded down.
    #[must_use]
    pub fn is_coarse(&self) -> bool {
        self.lsb != Self::MICROMETERS.lsb
    }
}

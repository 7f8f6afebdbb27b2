//! The codes of a condition as they are asked for, and what is particular to each quantity.

use crate::types::IntegerType;
use echocal_core::Quantity;
use std::borrow::Cow;

/// The codes of a condition, as they are asked for: LSB, ends and value of code 0 in the unit of the quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Codes {
    /// Value of one code; negative where the codes fall as the quantity rises.
    pub lsb: f64,
    /// Least value that is accepted.
    pub low: f64,
    /// Largest value that is accepted.
    pub high: f64,
    /// Value at code 0.
    pub zero: f64,
    /// Bits that the function drops.
    pub shift: u32,
}

impl Codes {
    /// Codes of which no bit is dropped.
    #[must_use]
    pub const fn new(lsb: f64, low: f64, high: f64, zero: f64) -> Self {
        Self {
            lsb,
            low,
            high,
            zero,
            shift: 0,
        }
    }

    /// The first and the last code between two values.
    pub(super) fn between(self, low: f64, high: f64) -> (f64, f64) {
        let (start, end) = if self.lsb > 0.0 {
            (low, high)
        } else {
            (high, low)
        };
        let first = ((start - self.zero) / self.lsb - SLACK).ceil() + 0.0; // no -0 in a message
        (first, ((end - self.zero) / self.lsb + SLACK).floor())
    }
}

/// Tolerance of the ends of a range \[codes\]. 0.1 degC is no binary fraction, and -20 degC must still be code -200: the
/// rounding error of such a quotient is below 1e-10 codes.
pub(crate) const SLACK: f64 = 1e-9;

/// Most bits that the function can drop: those of a code of 32 bits, less 8 that are left.
pub(super) const MOST_DROPPED: u32 = 24;

/// What is particular to the codes of one quantity.
pub(super) struct Kind {
    pub(super) name: Cow<'static, str>,
    pub(super) quantity: &'static str,
    pub(super) words: Cow<'static, str>,
    pub(super) unit: &'static str,
    /// Its unit in messages; a fraction is given as a number of this unit.
    pub(super) told: &'static str,
    /// Values that can be asked for.
    pub(super) possible: (f64, f64),
    /// Values that a sensor may have a code for, whatever is accepted: the type of the parameter holds these codes if the
    /// function drops bits, or if `wide`.
    pub(super) usual: (f64, f64),
    pub(super) wide: bool,
    /// Types of the parameter, the preferred first.
    pub(super) types: &'static [IntegerType],
}

pub(super) const TEMPERATURE: Kind = Kind {
    name: Cow::Borrowed("temperature_code"),
    quantity: "temperature",
    words: Cow::Borrowed("temperature"),
    unit: "degC",
    told: "degC",
    possible: (f64::NEG_INFINITY, f64::INFINITY),
    usual: (-40.0, 125.0),
    wide: false,
    types: &[IntegerType::I16, IntegerType::U16, IntegerType::U32],
};

pub(super) const HUMIDITY: Kind = Kind {
    name: Cow::Borrowed("humidity_code"),
    quantity: "relative_humidity",
    words: Cow::Borrowed("relative humidity"),
    unit: "1",
    told: "(1 is 100 %)",
    possible: (0.0, 1.0),
    usual: (0.0, 1.0),
    wide: true,
    types: &[
        IntegerType::U8,
        IntegerType::U16,
        IntegerType::I16,
        IntegerType::U32,
    ],
};

impl Kind {
    /// What is particular to the codes of a quantity; `None` if there is no such quantity.
    pub(super) fn of(quantity: &str) -> Option<Self> {
        let facts = Quantity::find(quantity)?.facts();
        Some(match facts.quantity {
            Quantity::Temperature => TEMPERATURE,
            Quantity::RelativeHumidity => HUMIDITY,
            _ => Self {
                name: format!("{}_code", facts.name).into(),
                quantity: facts.name,
                words: facts.name.replace('_', " ").into(),
                unit: facts.unit,
                told: facts.unit,
                possible: (f64::NEG_INFINITY, f64::INFINITY),
                usual: facts.field,
                wide: false,
                types: &[IntegerType::U16, IntegerType::I16, IntegerType::U32],
            },
        })
    }
}

/// The first type that holds the codes, those between the ends of the usual range included where a code outside could
/// otherwise wrap to an accepted one.
pub(super) fn parameter_type(
    kind: &Kind,
    asked: Codes,
    (first, last): (f64, f64),
) -> Option<IntegerType> {
    let dropped = asked.shift > 0;
    let holding = |first: f64, last: f64| {
        let mut types = kind.types.iter().filter(|ty| !(dropped && ty.is_signed()));
        let fits = |ty: &&IntegerType| {
            let held = ty.range();
            first >= held.minimum as f64 && last <= held.maximum as f64
        };
        types.find(fits).copied()
    };
    let (low, high) = kind.usual;
    let usual = asked.between(low.min(asked.low), high.max(asked.high));
    let wide = (dropped || kind.wide).then(|| holding(usual.0, usual.1));
    wide.flatten().or_else(|| holding(first, last))
}

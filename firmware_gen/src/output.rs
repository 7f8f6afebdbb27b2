//! What the function returns: whole numbers of a unit of length.

use crate::error::Error;
use serde::Serialize;

/// The unit of the output.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Output {
    /// Its symbol, which ends the name of the function.
    pub unit: &'static str,
    /// One of it \[m\].
    pub lsb: f64,
    /// How many make a meter.
    #[serde(skip)]
    pub per_meter: f64,
}

/// Output for codes that the function does not accept: `INT32_MIN`.
pub const OUT_OF_RANGE: i32 = i32::MIN;

/// Every unit that is offered, the finest first.
pub const OUTPUTS: [Output; 3] = [
    Output::MICROMETERS,
    Output {
        unit: "mm",
        lsb: 1e-3,
        per_meter: 1e3,
    },
    Output {
        unit: "cm",
        lsb: 1e-2,
        per_meter: 1e2,
    },
];

impl Output {
    /// The unit unless another is asked for.
    pub const MICROMETERS: Self = Self {
        unit: "um",
        lsb: 1e-6,
        per_meter: 1e6,
    };

    /// The unit of this symbol.
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

    /// Whether the rounding to whole units matters. Micrometers are finer than every sensor, and are rounded down.
    #[must_use]
    pub fn is_coarse(&self) -> bool {
        *self != Self::MICROMETERS
    }
}

//! The state of the air.

use crate::conditions::{Conditions, Quantity};
use crate::scalar::Scalar;

/// The state of the air that a law reads.
#[derive(Clone, Copy, Debug)]
pub struct Air<S> {
    /// Temperature \[degC\].
    pub temperature: S,
    /// Relative humidity over liquid water \[1\].
    pub relative_humidity: S,
    /// Pressure \[Pa\].
    pub pressure: S,
    /// CO2 mole fraction \[1\].
    pub co2_mole_fraction: S,
}

impl<S: Scalar> Air<S> {
    /// The air as recorded.
    #[inline(always)]
    pub fn recorded(conditions: &Conditions<S>) -> Self {
        Self {
            temperature: conditions.get(Quantity::Temperature),
            relative_humidity: conditions.get(Quantity::RelativeHumidity),
            pressure: conditions.get(Quantity::Pressure),
            co2_mole_fraction: conditions.get(Quantity::Co2MoleFraction),
        }
    }

    /// The same air without water.
    #[inline(always)]
    #[must_use]
    pub fn dry(self) -> Self {
        Self {
            relative_humidity: S::constant(0.0),
            ..self
        }
    }
}

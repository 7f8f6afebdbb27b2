//! Where a law holds, as numbers; leaving it is reported, never clamped.

use super::composition::water_vapor_mole_fraction;
use super::{Air, Law};

/// Closed ranges in which a law holds to its stated accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Temperature \[degC\].
    pub temperature: (f64, f64),
    /// Relative humidity \[1\].
    pub relative_humidity: (f64, f64),
    /// Pressure \[Pa\].
    pub pressure: (f64, f64),
    /// CO2 mole fraction \[1\].
    pub co2_mole_fraction: (f64, f64),
    /// Mole fraction of water vapor \[1\], which temperature, humidity and pressure give together.
    pub water_vapor_mole_fraction: (f64, f64),
}

/// The air that ultrasonic sensors meet outdoors, the box in which the laws were measured.
pub const MOIST_AIR: Limits = Limits {
    temperature: (-20.0, 60.0),
    relative_humidity: (0.0, 1.0),
    pressure: (60e3, 110e3),
    co2_mole_fraction: (0.0, 0.01),
    water_vapor_mole_fraction: (0.0, 1.0),
};

/// No limit at all, for the quantities that a law does not read.
pub const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Why a row lies outside the domain of a law: a code for a mask as long as the input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Departure {
    /// Inside.
    None = 0,
    /// Temperature out of range, or not a number.
    Temperature = 1,
    /// Relative humidity out of range, or not a number.
    RelativeHumidity = 2,
    /// Pressure out of range, or not a number.
    Pressure = 3,
    /// CO2 mole fraction out of range, or not a number.
    Co2MoleFraction = 4,
    /// Too much water vapor for the law, each single quantity being in range.
    WaterVaporMoleFraction = 5,
}

impl Departure {
    /// All departures, in the order of their codes.
    pub const ALL: [Self; 6] = [
        Self::None,
        Self::Temperature,
        Self::RelativeHumidity,
        Self::Pressure,
        Self::Co2MoleFraction,
        Self::WaterVaporMoleFraction,
    ];

    /// The quantity in question; empty for [`Departure::None`].
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Temperature => "temperature",
            Self::RelativeHumidity => "relative_humidity",
            Self::Pressure => "pressure",
            Self::Co2MoleFraction => "co2_mole_fraction",
            Self::WaterVaporMoleFraction => "water_vapor_mole_fraction",
        }
    }

    /// Range and unit that the law states for the quantity in question.
    #[must_use]
    pub fn limit(self, limits: &Limits) -> ((f64, f64), &'static str) {
        match self {
            Self::None => (ANY, ""),
            Self::Temperature => (limits.temperature, "degC"),
            Self::RelativeHumidity => (limits.relative_humidity, "1"),
            Self::Pressure => (limits.pressure, "Pa"),
            Self::Co2MoleFraction => (limits.co2_mole_fraction, "1"),
            Self::WaterVaporMoleFraction => (limits.water_vapor_mole_fraction, "1"),
        }
    }

    /// The value of the quantity in question.
    #[must_use]
    pub fn value(self, air: &Air<f64>) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Temperature => air.temperature,
            Self::RelativeHumidity => air.relative_humidity,
            Self::Pressure => air.pressure,
            Self::Co2MoleFraction => air.co2_mole_fraction,
            Self::WaterVaporMoleFraction => water_vapor_mole_fraction(air),
        }
    }
}

impl Law {
    /// The first reason why the air lies outside the law's domain.
    #[must_use]
    pub fn departure(&self, air: &Air<f64>) -> Departure {
        let limits = self.facts().limits;
        let outside = |departure: &Departure| {
            let (low, high) = departure.limit(&limits).0;
            // a bound at infinity says that the law does not read the quantity: NaN is fine there
            let value = departure.value(air);
            !(low..=high).contains(&value) && (low, high) != ANY
        };
        let found = Departure::ALL.into_iter().find(outside);
        found.unwrap_or(Departure::None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditions::{Conditions, Quantity};

    fn departure(law: &str, temperature: f64, humidity: f64) -> Departure {
        let at = Conditions::at(temperature).with(Quantity::RelativeHumidity, humidity);
        Law::parse(law).unwrap().departure(&Air::recorded(&at))
    }

    #[test]
    fn cramer_is_guarded_by_the_water_in_the_air() {
        assert_eq!(departure("cramer", 36.0, 1.0), Departure::None);
        assert_eq!(
            departure("cramer", 37.0, 1.0),
            Departure::WaterVaporMoleFraction
        );
        assert_eq!(departure("virial", 60.0, 1.0), Departure::None);
        assert_eq!(departure("virial", 61.0, 1.0), Departure::Temperature);
    }

    #[test]
    fn what_is_not_a_number_is_not_inside() {
        assert_eq!(departure("cramer", f64::NAN, 0.5), Departure::Temperature);
        assert_eq!(
            departure("cramer", 20.0, f64::NAN),
            Departure::RelativeHumidity
        );
        assert_eq!(departure("linear", 20.0, f64::NAN), Departure::None);
    }

    #[test]
    fn codes_are_positions() {
        for (code, departure) in Departure::ALL.into_iter().enumerate() {
            assert_eq!(departure as usize, code);
        }
    }
}

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
    /// Frequency over pressure \[Hz/Pa\].
    pub frequency_over_pressure: (f64, f64),
}

/// No limit at all, for what a law does not read.
pub const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Limits of a law that reads nothing; a base to state others from.
pub const UNLIMITED: Limits = Limits {
    temperature: ANY,
    relative_humidity: ANY,
    pressure: ANY,
    co2_mole_fraction: ANY,
    water_vapor_mole_fraction: ANY,
    frequency_over_pressure: ANY,
};

/// The air that ultrasonic sensors meet outdoors, the box in which the laws were measured.
pub const MOIST_AIR: Limits = Limits {
    temperature: (-20.0, 60.0),
    relative_humidity: (0.0, 1.0),
    pressure: (60e3, 110e3),
    co2_mole_fraction: (0.0, 0.01),
    ..UNLIMITED
};

/// Absorption and dispersion to 20 % of themselves, ISO 9613-1:1993, 7.1 and 7.2 (to 10 % for 0.05 %
/// to 5 % of water). The lower bound on the water says that dry air relaxes ill-known.
pub const RELAXATION: Limits = Limits {
    temperature: (-20.0, 50.0),
    relative_humidity: (0.0, 1.0),
    pressure: (0.0, 200e3),
    water_vapor_mole_fraction: (5e-5, 1.0),
    frequency_over_pressure: (4e-4, 10.0),
    ..UNLIMITED
};

/// Why a row lies outside a domain: a code for a mask as long as the input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Departure {
    /// Inside.
    None = 0,
    /// Something that the law reads is not a number.
    NotANumber = 1,
    /// Temperature out of range.
    Temperature = 2,
    /// Relative humidity out of range.
    RelativeHumidity = 3,
    /// Pressure out of range.
    Pressure = 4,
    /// CO2 mole fraction out of range.
    Co2MoleFraction = 5,
    /// Too much or too little water vapor, each single quantity being in range.
    WaterVaporMoleFraction = 6,
    /// Frequency over pressure out of range.
    FrequencyOverPressure = 7,
}

impl Departure {
    /// What lies outside, in the order of the codes.
    pub const NAMES: [&'static str; 8] = [
        "",
        "not_a_number",
        "temperature",
        "relative_humidity",
        "pressure",
        "co2_mole_fraction",
        "water_vapor_mole_fraction",
        "frequency_over_pressure",
    ];
}

/// A departure with both sides of the comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finding {
    /// What lies outside.
    pub departure: Departure,
    /// Its value.
    pub value: f64,
    /// The range it should lie in.
    pub range: (f64, f64),
    /// The unit of both.
    pub unit: &'static str,
}

impl Limits {
    /// The first reason why air and frequency \[Hz\] lie outside, with both sides.
    #[must_use]
    pub fn examine(&self, air: &Air<f64>, frequency: f64) -> Option<Finding> {
        use Departure as D;
        let water = || water_vapor_mole_fraction(air);
        let ratio = || frequency / air.pressure;
        type Check<'a> = (Departure, (f64, f64), &'static str, &'a dyn Fn() -> f64);
        let checks: [Check; 6] = [
            (D::Temperature, self.temperature, "degC", &|| {
                air.temperature
            }),
            (D::RelativeHumidity, self.relative_humidity, "1", &|| {
                air.relative_humidity
            }),
            (D::Pressure, self.pressure, "Pa", &|| air.pressure),
            (D::Co2MoleFraction, self.co2_mole_fraction, "1", &|| {
                air.co2_mole_fraction
            }),
            (
                D::WaterVaporMoleFraction,
                self.water_vapor_mole_fraction,
                "1",
                &water,
            ),
            (
                D::FrequencyOverPressure,
                self.frequency_over_pressure,
                "Hz/Pa",
                &ratio,
            ),
        ];
        for (departure, range, unit, value) in checks {
            if range == ANY {
                continue; // not read
            }
            let value = value();
            if !(range.0..=range.1).contains(&value) {
                let departure = if value.is_nan() {
                    D::NotANumber
                } else {
                    departure
                };
                return Some(Finding {
                    departure,
                    value,
                    range,
                    unit,
                });
            }
        }
        None
    }
}

impl Law {
    /// Where this law holds; a fixed speed reads nothing and has no limits.
    #[must_use]
    pub fn limits(&self) -> Limits {
        match self {
            Self::Linear(law) if law.slope == 0.0 => UNLIMITED,
            law => law.facts().limits,
        }
    }

    /// The first reason why air lies outside the law's domain or, at a frequency above zero, outside
    /// that of the dispersion.
    #[must_use]
    pub fn examine(&self, air: &Air<f64>, frequency: f64) -> Option<Finding> {
        let found = self.limits().examine(air, frequency);
        let disperses = frequency != 0.0;
        found.or_else(|| {
            disperses
                .then(|| RELAXATION.examine(air, frequency))
                .flatten()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conditions::{Conditions, Quantity};

    fn departure(law: &str, temperature: f64, humidity: f64, frequency: f64) -> Departure {
        let at = Conditions::at(temperature).with(Quantity::RelativeHumidity, humidity);
        let found = Law::parse(law)
            .unwrap()
            .examine(&Air::recorded(&at), frequency);
        found.map_or(Departure::None, |finding| finding.departure)
    }

    #[test]
    fn cramer_is_guarded_by_the_water_in_the_air() {
        assert_eq!(departure("cramer", 36.0, 1.0, 0.0), Departure::None);
        assert_eq!(
            departure("cramer", 37.0, 1.0, 0.0),
            Departure::WaterVaporMoleFraction
        );
        assert_eq!(departure("virial", 60.0, 1.0, 0.0), Departure::None);
        assert_eq!(departure("virial", 61.0, 1.0, 0.0), Departure::Temperature);
    }

    #[test]
    fn dispersion_has_its_own_domain() {
        assert_eq!(departure("virial", 55.0, 0.5, 40e3), Departure::Temperature);
        assert_eq!(departure("virial", 20.0, 0.5, 40e3), Departure::None);
        assert_eq!(
            departure("virial", 20.0, 0.0, 40e3),
            Departure::WaterVaporMoleFraction
        );
        assert_eq!(
            departure("virial", 20.0, 0.5, 2e6),
            Departure::FrequencyOverPressure
        );
    }

    #[test]
    fn what_is_not_a_number_is_not_inside() {
        assert_eq!(
            departure("cramer", f64::NAN, 0.5, 0.0),
            Departure::NotANumber
        );
        assert_eq!(
            departure("cramer", 20.0, f64::NAN, 0.0),
            Departure::NotANumber
        );
        assert_eq!(departure("linear", 20.0, f64::NAN, 0.0), Departure::None);
        assert_eq!(departure("343", f64::NAN, f64::NAN, 0.0), Departure::None);
    }
}

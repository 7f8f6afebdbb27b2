//! Influence quantities: what a row of a table tells about the circumstances of an echo.

use core::f64::consts::PI;

/// Name, unit and default of an influence quantity.
#[derive(Clone, Copy, Debug)]
pub struct QuantityFacts {
    /// The quantity.
    pub quantity: Quantity,
    /// Its name in Python and in model files.
    pub name: &'static str,
    /// Its SI unit (or degC, 1).
    pub unit: &'static str,
    /// The value assumed where nothing was recorded; `None`: must be given where it is read.
    pub default: Option<f64>,
    /// What a table must hold for it to be derived row by row; `None`: it is recorded itself.
    pub derived_from: Option<&'static str>,
    /// Range in the field \[unit\]; a firmware states the error of not measuring it over this range. Set by hand:
    /// pressures from 2,000 m altitude to a high, CO2 from outdoor air to a crowded room, a supply of 5 V +- 10 %.
    pub field: (f64, f64),
    /// The quantity that `field` is counted from; `None`: `field` is absolute.
    pub field_from: Option<Quantity>,
}

/// Makes the enum and the table of facts of one list, so that neither can lack an entry of the other.
macro_rules! quantities {
    ($($(#[$documentation:meta])* $id:ident: $kind:ident($($fact:expr),*),)*) => {
        /// An influence quantity (VIM 2.52) that laws and effects may read.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(usize)]
        pub enum Quantity {
            $($(#[$documentation])* $id,)*
        }

        impl Quantity {
            /// How many quantities there are.
            pub const COUNT: usize = [$(Self::$id),*].len();

            /// All quantities, in the order of [`Conditions`].
            pub const ALL: [QuantityFacts; Self::COUNT] = [$($kind(Self::$id, $($fact),*)),*];
        }
    };
}

// One entry per quantity: name, unit, then
//   recorded: the default and the range in the field
//   derived:  what a table must hold, and the range in the field
// What people call it, its columns and its units stand in python/echocal/quantities/table.py.
quantities! {
    /// Recorded air temperature \[degC\].
    Temperature: recorded("temperature", "degC", None, (-20.0, 60.0)),
    /// Recorded relative humidity over liquid water \[1\].
    RelativeHumidity: recorded("relative_humidity", "1", Some(0.0), (0.0, 1.0)),
    /// Recorded air pressure \[Pa\].
    Pressure: recorded("pressure", "Pa", Some(101_325.0), (80e3, 106e3)),
    /// CO2 mole fraction \[1\].
    Co2MoleFraction: recorded("co2_mole_fraction", "1", Some(4e-4), (3e-4, 2e-3)),
    /// Time since the first row \[s\].
    ElapsedTime: recorded("elapsed_time", "s", None, (0.0, 86_400.0)),
    /// Supply voltage of the sensor \[V\].
    SupplyVoltage: recorded("supply_voltage", "V", None, (4.5, 5.5)),
    /// Angle of incidence on the target \[rad\].
    Angle: recorded("angle", "rad", None, (0.0, 0.26)),
    /// Wind speed \[m/s\].
    WindSpeed: recorded("wind_speed", "m/s", None, (0.0, 10.0)),
    /// Irradiance on the thermometer's shield \[W/m^2\].
    Radiation: recorded("radiation", "W/m^2", None, (0.0, 1000.0)),
    /// Echo amplitude relative to full scale \[1\].
    Amplitude: recorded("amplitude", "1", None, (0.05, 1.0)),
    /// Rate of change of the recorded temperature \[K/s\].
    TemperatureRate: derived("temperature_rate", "K/s", "time and temperature", (-0.01, 0.01)),
    /// Temperature recorded one row later \[degC\].
    TemperatureLater1: later("temperature_later_1"),
    /// Temperature recorded two rows later \[degC\].
    TemperatureLater2: later("temperature_later_2"),
    /// Temperature recorded three rows later \[degC\].
    TemperatureLater3: later("temperature_later_3"),
    /// Temperature recorded four rows later \[degC\].
    TemperatureLater4: later("temperature_later_4"),
    /// Temperature recorded five rows later \[degC\].
    TemperatureLater5: later("temperature_later_5"),
    /// Rate of change of the irradiance \[W/(m^2 s)\].
    RadiationRate: derived("radiation_rate", "W/(m^2 s)", "time and radiation", (-0.5, 0.5)),
    /// Position of a row in its burst, 0 for the first \[1\].
    PositionInGroup: derived("position_in_group", "1", "group or order", (0.0, 10.0)),
    /// Hour angle of the local clock, 0 at noon \[rad\].
    HourAngle: derived("hour_angle", "rad", "times of day", (-PI, PI)),
    /// Temperature that a further thermometer of the table reads, for the air on the path \[degC\].
    SecondTemperature: derived("second_temperature", "degC", "a further thermometer", (-20.0, 60.0)),
    /// Temperature that a further thermometer of the table reads, for the ranger's own \[degC\].
    DeviceTemperature: derived("device_temperature", "degC", "a further thermometer", (-20.0, 60.0)),
    /// Quality number of an echo, as the ranger or its logger gives it \[1\].
    EchoQuality: recorded("echo_quality", "1", None, (150.0, 300.0)),
}

impl Quantity {
    /// Name, unit, default and range.
    #[must_use]
    pub fn facts(self) -> QuantityFacts {
        Self::ALL[self as usize]
    }

    /// The quantity of this name.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        let facts = Self::ALL.iter().find(|facts| facts.name == name)?;
        Some(facts.quantity)
    }
}

const fn recorded(
    quantity: Quantity,
    name: &'static str,
    unit: &'static str,
    default: Option<f64>,
    field: (f64, f64),
) -> QuantityFacts {
    QuantityFacts {
        quantity,
        name,
        unit,
        default,
        derived_from: None,
        field,
        field_from: None,
    }
}

const fn derived(
    quantity: Quantity,
    name: &'static str,
    unit: &'static str,
    from: &'static str,
    field: (f64, f64),
) -> QuantityFacts {
    QuantityFacts {
        derived_from: Some(from),
        ..recorded(quantity, name, unit, None, field)
    }
}

const fn later(quantity: Quantity, name: &'static str) -> QuantityFacts {
    QuantityFacts {
        field_from: Some(Quantity::Temperature),
        ..derived(quantity, name, "degC", "time and temperature", (-1.0, 1.0))
    }
}

/// The value of every influence quantity for one echo, as recorded.
#[derive(Clone, Copy, Debug)]
pub struct Conditions<S> {
    values: [S; Quantity::COUNT],
}

impl<S: Copy> Conditions<S> {
    /// Conditions with one value per quantity, in the order of [`Quantity::ALL`].
    #[inline(always)]
    pub fn new(values: [S; Quantity::COUNT]) -> Self {
        Self { values }
    }

    /// The recorded value of a quantity.
    #[inline(always)]
    pub fn get(&self, quantity: Quantity) -> S {
        self.values[quantity as usize]
    }

    /// The same conditions with one quantity replaced.
    #[inline(always)]
    #[must_use]
    pub fn with(mut self, quantity: Quantity, value: S) -> Self {
        self.values[quantity as usize] = value;
        self
    }
}

impl Conditions<f64> {
    /// Defaults, at this temperature \[degC\]; quantities without a default are NaN.
    #[must_use]
    pub fn at(temperature: f64) -> Self {
        let values = Quantity::ALL.map(|facts| facts.default.unwrap_or(f64::NAN));
        Self { values }.with(Quantity::Temperature, temperature)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enum() {
        for (index, facts) in Quantity::ALL.iter().enumerate() {
            assert_eq!(facts.quantity as usize, index, "{}", facts.name);
            assert_eq!(Quantity::find(facts.name), Some(facts.quantity));
        }
    }
}

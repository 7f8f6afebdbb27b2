//! Influence quantities: what a row of a table tells about the circumstances of an echo.

/// An influence quantity (VIM 2.52) that laws and effects may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(usize)]
pub enum Quantity {
    /// Recorded air temperature \[degC\].
    Temperature,
    /// Recorded relative humidity over liquid water \[1\].
    RelativeHumidity,
    /// Recorded air pressure \[Pa\].
    Pressure,
    /// CO2 mole fraction \[1\].
    Co2MoleFraction,
    /// Time since the first row \[s\].
    ElapsedTime,
    /// Supply voltage of the sensor \[V\].
    SupplyVoltage,
    /// Angle of incidence on the target \[rad\].
    Angle,
    /// Wind speed \[m/s\].
    WindSpeed,
    /// Irradiance on the thermometer's shield \[W/m^2\].
    Radiation,
    /// Echo amplitude relative to full scale \[1\].
    Amplitude,
    /// Rate of change of the recorded temperature \[K/s\].
    TemperatureRate,
    /// Temperature recorded one row later \[degC\].
    TemperatureLater1,
    /// Temperature recorded two rows later \[degC\].
    TemperatureLater2,
    /// Temperature recorded three rows later \[degC\].
    TemperatureLater3,
    /// Temperature recorded four rows later \[degC\].
    TemperatureLater4,
    /// Temperature recorded five rows later \[degC\].
    TemperatureLater5,
    /// Rate of change of the irradiance \[W/(m^2 s)\].
    RadiationRate,
    /// Position of a row in its burst, 0 for the first \[1\].
    PositionInGroup,
    /// Hour angle of the local clock, 0 at noon \[rad\].
    HourAngle,
}

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
}

impl Quantity {
    /// How many quantities there are.
    pub const COUNT: usize = 19;

    /// All quantities, in the order of [`Conditions`].
    pub const ALL: [QuantityFacts; Self::COUNT] = [
        facts(Self::Temperature, "temperature", "degC", None),
        facts(Self::RelativeHumidity, "relative_humidity", "1", Some(0.0)),
        facts(Self::Pressure, "pressure", "Pa", Some(101_325.0)),
        facts(Self::Co2MoleFraction, "co2_mole_fraction", "1", Some(4e-4)),
        facts(Self::ElapsedTime, "elapsed_time", "s", None),
        facts(Self::SupplyVoltage, "supply_voltage", "V", None),
        facts(Self::Angle, "angle", "rad", None),
        facts(Self::WindSpeed, "wind_speed", "m/s", None),
        facts(Self::Radiation, "radiation", "W/m^2", None),
        facts(Self::Amplitude, "amplitude", "1", None),
        derived(
            Self::TemperatureRate,
            "temperature_rate",
            "K/s",
            "time and temperature",
        ),
        later(Self::TemperatureLater1, "temperature_later_1"),
        later(Self::TemperatureLater2, "temperature_later_2"),
        later(Self::TemperatureLater3, "temperature_later_3"),
        later(Self::TemperatureLater4, "temperature_later_4"),
        later(Self::TemperatureLater5, "temperature_later_5"),
        derived(
            Self::RadiationRate,
            "radiation_rate",
            "W/(m^2 s)",
            "time and radiation",
        ),
        derived(
            Self::PositionInGroup,
            "position_in_group",
            "1",
            "group or order",
        ),
        derived(Self::HourAngle, "hour_angle", "rad", "times of day"),
    ];

    /// Name, unit and default.
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

const fn facts(
    quantity: Quantity,
    name: &'static str,
    unit: &'static str,
    default: Option<f64>,
) -> QuantityFacts {
    QuantityFacts {
        quantity,
        name,
        unit,
        default,
        derived_from: None,
    }
}

const fn derived(
    quantity: Quantity,
    name: &'static str,
    unit: &'static str,
    from: &'static str,
) -> QuantityFacts {
    QuantityFacts {
        derived_from: Some(from),
        ..facts(quantity, name, unit, None)
    }
}

const fn later(quantity: Quantity, name: &'static str) -> QuantityFacts {
    derived(quantity, name, "degC", "time and temperature")
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

//! Effects and conditions that a firmware leaves out, and the error that results.

use echocal_core::Quantity;
use std::fmt;

/// Range of each influence quantity in the field \[unit of the quantity\]. The error of not measuring it is stated
/// over this range. Set by hand: pressures from 2,000 m altitude to a high; CO2 from outdoor air to a crowded room; supply
/// 5 V +- 10 %; tilt to 15 degrees. Later temperatures are relative to the temperature.
pub(super) const FIELD: [(Quantity, f64, f64); Quantity::COUNT] = [
    (Quantity::Temperature, -20.0, 60.0),
    (Quantity::RelativeHumidity, 0.0, 1.0),
    (Quantity::Pressure, 80e3, 106e3),
    (Quantity::Co2MoleFraction, 3e-4, 2e-3),
    (Quantity::ElapsedTime, 0.0, 86_400.0),
    (Quantity::SupplyVoltage, 4.5, 5.5),
    (Quantity::Angle, 0.0, 0.26),
    (Quantity::WindSpeed, 0.0, 10.0),
    (Quantity::Radiation, 0.0, 1000.0),
    (Quantity::Amplitude, 0.05, 1.0),
    (Quantity::TemperatureRate, -0.01, 0.01),
    (Quantity::TemperatureLater1, -1.0, 1.0),
    (Quantity::TemperatureLater2, -1.0, 1.0),
    (Quantity::TemperatureLater3, -1.0, 1.0),
    (Quantity::TemperatureLater4, -1.0, 1.0),
    (Quantity::TemperatureLater5, -1.0, 1.0),
    (Quantity::RadiationRate, -0.5, 0.5),
    (Quantity::PositionInGroup, 0.0, 10.0),
    (
        Quantity::HourAngle,
        -core::f64::consts::PI,
        core::f64::consts::PI,
    ),
];

/// An effect or a condition that a firmware leaves out, and the error that results.
#[derive(Clone, Debug, PartialEq)]
pub struct Omission {
    /// The effect; `None` for the law itself.
    pub effect: Option<&'static str>,
    /// The quantity that the device does not measure.
    pub quantity: Option<Quantity>,
    /// The value assumed instead; `None`: the effect is left out.
    pub assumed: Option<f64>,
    /// The reason, if no device can compute the effect.
    pub reason: Option<&'static str>,
    /// Error that this leaves at the largest bounded distance, over the field range of the quantity \[m\].
    pub left: f64,
}

impl Omission {
    /// What the user can do about a refusal.
    #[must_use]
    pub fn remedy(&self) -> String {
        let accept = format!("accept it with --accept {}", self.effect.unwrap_or("law"));
        if self.quantity.is_some() {
            format!("give the device that input, or {accept}")
        } else {
            format!("leave it out of the model, or {accept}")
        }
    }
}

impl fmt::Display for Omission {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let left = self.left * 1e3;
        match (self.effect, self.quantity, self.reason) {
            (Some(effect), Some(quantity), _) => {
                let name = quantity.facts().name;
                let (_, low, high) = FIELD[quantity as usize];
                write!(
                    f,
                    "effect {effect} needs {name}, which the device does not measure: \
                     up to {left:.1} mm over {low} .. {high}"
                )
            }
            (Some(effect), None, reason) => {
                write!(
                    f,
                    "effect {effect} cannot be lowered ({}): up to {left:.1} mm",
                    reason.unwrap_or("no form for it")
                )
            }
            (None, Some(quantity), _) => {
                let facts = quantity.facts();
                let (_, low, high) = FIELD[quantity as usize];
                let assumed = self.assumed.unwrap_or(f64::NAN);
                let unit = if facts.unit == "1" {
                    String::new()
                } else {
                    format!(" {}", facts.unit)
                };
                write!(
                    f,
                    "{} {assumed}{unit}: up to {left:.1} mm if it is anywhere in {low} .. {high}{unit}",
                    facts.name
                )
            }
            (None, None, _) => Ok(()),
        }
    }
}

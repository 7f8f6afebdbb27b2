//! Effects and conditions that a firmware leaves out, and the error that results.

use echocal_core::Quantity;
use std::fmt;

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
                let facts = quantity.facts();
                let (name, (low, high)) = (facts.name, facts.field);
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
                let (low, high) = facts.field;
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

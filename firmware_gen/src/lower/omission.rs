//! Effects and conditions that a firmware leaves out, and the error that results.

use echocal_core::Quantity;
use serde_json::{Value, json};
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
    /// What an effect at the assumed value adds to that distance \[m\].
    pub added: f64,
}

/// A length \[m\] in mm to one place, rounded up: what is stated must hold.
fn up(length: f64) -> f64 {
    length.mul_add(1e4, -1e-9).ceil().abs() / 10.0
}

/// A number with its unit, which a pure number has not.
fn with_unit(value: impl fmt::Display, unit: &str) -> String {
    if unit == "1" {
        value.to_string()
    } else {
        format!("{value} {unit}")
    }
}

impl Omission {
    /// Effect, quantity, its assumed value, and the error that is left, for a report.
    #[must_use]
    pub fn to_json(&self) -> Value {
        json!({
            "effect": self.effect,
            "quantity": self.quantity.map(|quantity| quantity.facts().name),
            "assumed": self.assumed,
            "left_m": self.left,
        })
    }

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
        let left = up(self.left);
        match (self.effect, self.quantity, self.reason) {
            (Some(effect), Some(quantity), _) => {
                let facts = quantity.facts();
                let (name, (low, high)) = (facts.name, facts.field);
                let range = with_unit(format!("{low} .. {high}"), facts.unit);
                write!(
                    f,
                    "effect {effect} needs {name}, which the device does not measure: \
                     up to {left:.1} mm over {range}"
                )?;
                let Some(assumed) = self.assumed else {
                    return Ok(());
                };
                let (assumed, added) = (with_unit(assumed, facts.unit), self.added * 1e3);
                write!(
                    f,
                    "; computed for {name} {assumed}, it adds up to {added:+.1} mm"
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
                let assumed = with_unit(self.assumed.unwrap_or(f64::NAN), facts.unit);
                let range = with_unit(format!("{low} .. {high}"), facts.unit);
                write!(
                    f,
                    "{} {assumed}: up to {left:.1} mm if it is anywhere in {range}",
                    facts.name
                )
            }
            (None, None, _) => Ok(()),
        }
    }
}

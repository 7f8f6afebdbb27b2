//! What is known about an effect, as data.

use crate::chain::Stage;
use crate::conditions::Quantity;

/// One parameter of an effect.
#[derive(Clone, Copy, Debug)]
pub struct ParameterFacts {
    /// Name in Python and in model files.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// The value at which the effect is the identity.
    pub neutral: f64,
    /// Physical bounds, inclusive.
    pub bounds: (f64, f64),
    /// Typical magnitude of the deviation from neutral: one standard deviation of its prior.
    pub prior_scale: f64,
    /// The value, where theory or trade fixes it (a known correction has coefficient 1).
    pub known: &'static [f64],
}

/// Whether and how a microcontroller can compensate an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Firmware {
    /// Folded into the tables: it needs no input beyond echo time and the air's quantities.
    Folded,
    /// Needs this input, which the device must have.
    Needs(Quantity),
    /// Cannot be lowered, with the reason.
    Refused(&'static str),
}

/// What is known about an effect.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// Id, as in files and messages.
    pub id: &'static str,
    /// The stage of the measurement chain at which it acts.
    pub stage: Stage,
    /// One sentence for people.
    pub sentence: &'static str,
    /// The formula, in symbols.
    pub formula: &'static str,
    /// Source.
    pub source: &'static str,
    /// The influence quantities it reacts to besides the distance.
    pub reads: &'static [Quantity],
    /// Its parameters, in the order that `apply` takes them.
    pub parameters: &'static [ParameterFacts],
    /// A quantity it brings in: a law that reads that quantity already refuses the effect.
    pub supplies: Option<Quantity>,
    /// Where it holds, in words.
    pub domain: &'static str,
    /// Whether a microcontroller can compensate it.
    pub firmware: Firmware,
}

impl Facts {
    /// The position of the parameter of this name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p.name == name)
    }
}

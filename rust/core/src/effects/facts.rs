//! What is known about an effect, as data.

use crate::chain::Stage;
use crate::conditions::Quantity;

/// What a parameter does to its effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// How much: the effect is the identity where every size is neutral.
    Size,
    /// In what form: without meaning (and without derivative) while every size is neutral.
    Shape,
}

/// One parameter of an effect.
#[derive(Clone, Copy, Debug)]
pub struct ParameterFacts {
    /// Name in Python and in model files.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// Whether it is a size or a shape.
    pub role: Role,
    /// A size's value at which the effect is the identity; a shape's usual value.
    pub neutral: f64,
    /// Physical bounds, inclusive; the prior is cut off there.
    pub bounds: (f64, f64),
    /// Typical magnitude of the deviation from neutral: one standard deviation of its prior.
    pub prior_scale: f64,
    /// The values that theory or trade fix (a known correction has size 1); empty where none.
    pub known: &'static [f64],
    /// The values of a shape at which a search tries the effect, besides `known`.
    pub tried: Tried,
    /// How many times wider the tail of the prior is: 1 where it has none.
    pub tail: f64,
    /// The range of a quantity that `prior_scale` is meant for: for a table that spans more of it
    /// the scale is smaller in proportion, and the other way round.
    pub over: Option<(Quantity, f64)>,
    /// The quantity that it divides: in rows up to this value the effect is one thing, in all others
    /// another, wherever on either side the value lies.
    pub divides: Option<Quantity>,
}

impl ParameterFacts {
    /// A size in no unit, neutral at zero, with nothing special: what the facts of a parameter say
    /// unless they say otherwise.
    pub const USUAL: Self = Self {
        name: "",
        unit: "1",
        role: Role::Size,
        neutral: 0.0,
        bounds: (-1.0, 1.0),
        prior_scale: 1.0,
        known: &[],
        tried: Tried::Nothing,
        tail: 1.0,
        over: None,
        divides: None,
    };

    /// The size of a correction that physics knows: 1, with room for a free fit that finds otherwise.
    pub const COEFFICIENT: Self = Self {
        name: "coefficient",
        bounds: (-5.0, 5.0),
        known: &[1.0],
        ..Self::USUAL
    };
}

/// Quantiles that cut a table into eight parts; a search goes on between them.
pub(super) const EVENLY: &[f64] = &[0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875];

/// The values of a shape that a search tries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tried {
    /// None but the known ones, and the neighborhood of the usual value.
    Nothing,
    /// These.
    Values(&'static [f64]),
    /// These quantiles (0..1) of the distances of a table.
    DistanceQuantiles(&'static [f64]),
    /// These quantiles (0..1) of a quantity of a table.
    Quantiles(Quantity, &'static [f64]),
}

/// Whether and how a microcontroller can compensate an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Firmware {
    /// Folded into the tables: it needs no input beyond echo time and temperature.
    Folded,
    /// Needs this further input, which the device must have.
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
    /// The formula, in symbols; primed symbols are the values after the effect.
    pub formula: &'static str,
    /// Source.
    pub source: &'static str,
    /// The influence quantities that its change of the stage's variable reacts to.
    pub reads: &'static [Quantity],
    /// Quantities that must have been recorded for the effect to have a meaning.
    pub requires: &'static [Quantity],
    /// Quantities that must not have been recorded for the effect to have a meaning.
    pub excludes: &'static [Quantity],
    /// A quantity whose influence it adds: a law that reads that quantity refuses the effect.
    pub supplies: Option<Quantity>,
    /// Id of a law that its formula uses: the effect holds where that law holds.
    pub calls: Option<&'static str>,
    /// Ids of the only laws that it can extend; empty where it extends any.
    pub extends: &'static [&'static str],
    /// Its parameters, in the order that `apply` takes them.
    pub parameters: &'static [ParameterFacts],
    /// The quantities of the air that it changes, if it is an effect of the air.
    pub air: &'static [Quantity],
    /// Whether what it makes of the air, the speed or the firmware's speed depends on the distance.
    pub of_distance: bool,
    /// Whether it bends the line that the echo time is over the distance, or gives it an edge.
    pub bends: bool,
    /// Whether its formula has edges, where a derivative jumps.
    pub edges: bool,
    /// Whether another campaign meets it again: what grew or began in the course of one does not.
    pub recurs: bool,
    /// How probable it is before the data, beside a usual effect (1).
    pub prior: f64,
    /// Where it holds, in words.
    pub domain: &'static str,
    /// The measurement that confirms or refutes it.
    pub check: &'static str,
    /// Whether a microcontroller can compensate it.
    pub firmware: Firmware,
}

impl Facts {
    /// Facts of an effect that reads nothing, asks for nothing and fits into the tables: what facts
    /// say unless they say otherwise.
    pub const USUAL: Self = Self {
        id: "",
        stage: Stage::Air,
        sentence: "",
        formula: "",
        source: "",
        reads: &[],
        requires: &[],
        excludes: &[],
        supplies: None,
        calls: None,
        extends: &[],
        parameters: &[],
        air: &[Quantity::Temperature],
        of_distance: false,
        bends: false,
        edges: false,
        recurs: true,
        prior: 1.0,
        domain: "any distance and air",
        check: "",
        firmware: Firmware::Folded,
    };

    /// The position of the parameter of this name.
    #[must_use]
    pub fn parameter(&self, name: &str) -> Option<usize> {
        self.parameters.iter().position(|p| p.name == name)
    }

    /// The position of the parameter that divides a quantity, and the quantity.
    #[must_use]
    pub fn divides(&self) -> Option<(usize, Quantity)> {
        let mut each = self.parameters.iter().enumerate();
        each.find_map(|(position, p)| Some((position, p.divides?)))
    }

    /// The neutral values of all parameters.
    #[must_use]
    pub fn neutral(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.neutral).collect()
    }

    /// The quantity that one of two effects needs recorded and the other not: they exclude each
    /// other.
    #[must_use]
    pub fn contradiction(&self, other: &Self) -> Option<Quantity> {
        let clash = |a: &Self, b: &Self| {
            let mut required = a.requires.iter();
            required.find(|q| b.excludes.contains(q)).copied()
        };
        clash(self, other).or_else(|| clash(other, self))
    }
}

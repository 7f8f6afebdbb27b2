//! A model as the reference of a firmware. Conditions that the device does not measure are fixed at assumed values. An
//! effect that needs such a condition is refused by name, with the error that results from leaving it out.

mod omission;
mod reference;
mod resolution;

pub use omission::Omission;

use crate::device::{Axis, Device, rows, values};
use crate::error::Error;
use echocal_core::effects::{self, Firmware};
use echocal_core::model::Term;
use echocal_core::{Conditions, Model, Quantity};

/// Steps over the range of a quantity, and over that of the temperature. Set by hand: the effects are smooth.
const STEPS: usize = 16;

/// Distances at which an error is computed, as shares of the largest, but none nearer than accepted. Set by hand: most
/// errors are largest at one end.
const NEARER: [f64; 5] = [1.0, 0.5, 0.2, 0.05, 0.0];
/// The nearest, as a share of the largest, while echo times are not known.
const NEAREST: f64 = 0.05;

/// A model at the conditions that the device measures, the others frozen.
#[derive(Clone, Debug)]
pub struct Lowered {
    model: Model,
    parameters: Vec<f64>,
    frozen: Conditions<f64>,
    measured: Vec<Quantity>,
    /// What is left out, with what it costs.
    pub omissions: Vec<Omission>,
}

/// Lower `model` onto `device`; `frozen` holds the conditions assumed where nothing is measured, `accepted` the effects
/// that may be left out. Costs are stated at `distance` \[m\].
///
/// # Errors
/// [`Error::Refused`] if an effect needs what the device lacks and is not accepted.
pub fn lower(
    model: &Model,
    device: &Device,
    frozen: &Conditions<f64>,
    accepted: &[String],
    distance: f64,
) -> Result<Lowered, Error> {
    let range = Range {
        conditions: &device.conditions,
        shortest: Some(device.echo.value(device.echo.codes.minimum)),
        longest: device.echo.value(device.echo.codes.maximum),
        distance,
    };
    lower_within(model, &range, frozen, accepted)
}

/// [`lower`] onto a device whose echo times are not known yet: it accepts those of all distances.
///
/// # Errors
/// As for [`lower`].
pub fn lower_without_echo(
    model: &Model,
    conditions: &[Axis],
    frozen: &Conditions<f64>,
    accepted: &[String],
    distance: f64,
) -> Result<Lowered, Error> {
    let range = Range {
        conditions,
        shortest: None,
        longest: f64::INFINITY,
        distance,
    };
    lower_within(model, &range, frozen, accepted)
}

/// Where costs are stated.
struct Range<'a> {
    conditions: &'a [Axis],
    /// Echo times \[s\].
    shortest: Option<f64>,
    longest: f64,
    /// \[m\].
    distance: f64,
}

fn lower_within(
    model: &Model,
    range: &Range<'_>,
    frozen: &Conditions<f64>,
    accepted: &[String],
) -> Result<Lowered, Error> {
    let measured = measured(range.conditions)?;
    let base = Lowered::new(Model::new(model.law()), frozen, measured);
    let mut kept = base.clone();
    // At neutral parameters an effect does nothing, whatever it needs.
    for term in model.terms().iter().filter(|term| !is_neutral(term)) {
        let Some(lack) = lacking(term, &base.measured) else {
            base.refuse_unknown(term)?;
            kept.extend(term)?;
            continue;
        };
        let omission = base.omission(term, lack, range)?;
        if omission.assumed.is_some() {
            kept.extend(term)?;
        }
        if omission.left == 0.0 {
            continue; // at neutral parameters nothing is lost
        }
        if !accepted.iter().any(|id| id == term.facts().id) {
            let remedy = omission.remedy();
            return Err(Error::Refused(format!("{omission}; {remedy}")));
        }
        kept.omissions.push(omission);
    }
    kept.state_law(range);
    Ok(kept)
}

fn is_neutral(term: &Term) -> bool {
    let mut pairs = term.facts().parameters.iter().zip(&term.parameters);
    pairs.all(|(parameter, value)| parameter.neutral == *value)
}

/// The quantities that the device measures.
fn measured(conditions: &[Axis]) -> Result<Vec<Quantity>, Error> {
    let find = |axis: &Axis| {
        let unknown = || Error::Codes(format!("no influence quantity is called {}", axis.quantity));
        Quantity::find(&axis.quantity).ok_or_else(unknown)
    };
    conditions.iter().map(find).collect()
}

/// The quantity that an effect needs, or the reason that it gives.
type Lack = (Option<Quantity>, Option<&'static str>);

/// What keeps an effect off the device.
fn lacking(term: &Term, measured: &[Quantity]) -> Option<Lack> {
    match term.facts().firmware {
        Firmware::Folded => None,
        Firmware::Needs(quantity) if measured.contains(&quantity) => None,
        Firmware::Needs(quantity) => Some((Some(quantity), None)),
        Firmware::Refused(reason) => Some((None, Some(reason))),
    }
}

impl Lowered {
    fn new(model: Model, frozen: &Conditions<f64>, measured: Vec<Quantity>) -> Self {
        let parameters = model.parameters();
        Self {
            model,
            parameters,
            frozen: *frozen,
            measured,
            omissions: Vec::new(),
        }
    }

    fn extend(&mut self, term: &Term) -> Result<(), Error> {
        let facts = term.facts();
        let values = facts.parameters.iter().zip(&term.parameters);
        let values: Vec<_> = values
            .map(|(parameter, value)| (parameter.name, *value))
            .collect();
        let extended = self.model.clone().with(facts.id, &values);
        self.model = extended.map_err(|error| Error::Model(error.to_string()))?;
        self.parameters = self.model.parameters();
        Ok(())
    }

    fn at(&self, values: &[f64]) -> Conditions<f64> {
        let pairs = self.measured.iter().zip(values);
        pairs.fold(self.frozen, |at, (quantity, value)| {
            at.with(*quantity, *value)
        })
    }

    /// What leaving out an effect, or assuming what it needs, costs beside this model without it.
    fn omission(
        &self,
        term: &Term,
        (quantity, reason): Lack,
        range: &Range<'_>,
    ) -> Result<Omission, Error> {
        let unknown = self.unknown(term);
        let assumed = quantity
            .filter(|_| unknown.is_empty())
            .map(|quantity| self.frozen.get(quantity));
        let mut alone = self.clone();
        alone.extend(term)?;
        let settled = if assumed.is_some() {
            &alone.model
        } else {
            &self.model
        };
        Ok(Omission {
            effect: Some(term.facts().id),
            quantity,
            assumed,
            reason,
            left: alone.spread(settled, range, (quantity, &unknown)),
            added: assumed.map_or(0.0, |_| self.less(&alone.model, range)),
        })
    }

    /// How much less than the distance of a model this one's is at most, at the largest distance of the range \[m\].
    fn less(&self, other: &Model, range: &Range<'_>) -> f64 {
        let rows = (0..=STEPS).map(|step| (rows(range.conditions) - 1) * step / STEPS);
        let less = rows.map(|row| {
            let at = self.at(&values(range.conditions, row));
            let far = range.distance.min(other.distance(range.longest, &at));
            far - self.model.distance(other.time_of_flight(far, &at), &at)
        });
        less.fold(
            0.0,
            |most: f64, one| if one.abs() > most.abs() { one } else { most },
        )
    }

    /// Refuse an effect that reads more than the input that it needs.
    fn refuse_unknown(&self, term: &Term) -> Result<(), Error> {
        match (term.facts().firmware, self.unknown(term).first()) {
            (Firmware::Needs(_), Some(quantity)) => {
                let (effect, name) = (term.facts().id, quantity.facts().name);
                Err(Error::Refused(format!(
                    "effect {effect} also reads {name}, which the device does not measure and which has no usual value: assume \
                     one (--assume {name}=..., assume={{\"{name}\": ...}})"
                )))
            }
            _ => Ok(()),
        }
    }

    /// What an effect reads that is neither measured nor assumed.
    fn unknown(&self, term: &Term) -> Vec<Quantity> {
        let reads = term.facts().reads.iter().copied();
        let here = |quantity: &Quantity| {
            !self.measured.contains(quantity) && !self.frozen.get(*quantity).is_finite()
        };
        reads.filter(here).collect()
    }

    /// State what the law reads and the device does not measure.
    fn state_law(&mut self, range: &Range<'_>) {
        let reads = self.model.law().facts().reads;
        for quantity in reads
            .iter()
            .filter(|quantity| !self.measured.contains(quantity))
        {
            let left = self.spread(&self.model, range, (Some(*quantity), &[]));
            let (quantity, assumed) = (Some(*quantity), Some(self.frozen.get(*quantity)));
            self.omissions.push(Omission {
                effect: None,
                quantity,
                assumed,
                reason: None,
                left,
                added: 0.0,
            });
        }
    }

    /// How far this model's distance is from one in `range`, at the echo time of a `settled` model there, while
    /// `quantity` runs over the field, and with it what is `unknown`.
    fn spread(
        &self,
        settled: &Model,
        range: &Range<'_>,
        (quantity, unknown): (Option<Quantity>, &[Quantity]),
    ) -> f64 {
        let steps = |used: bool| 0..=if used { STEPS } else { 0 };
        let mut largest = 0.0_f64;
        for row in (0..=STEPS).map(|step| (rows(range.conditions) - 1) * step / STEPS) {
            for step in steps(!unknown.is_empty()) {
                let known = self.at(&values(range.conditions, row));
                let at = unknown
                    .iter()
                    .fold(known, |at, quantity| in_field(at, *quantity, step));
                let longest = settled.distance(range.longest, &at);
                // At most the distance of the longest accepted echo; `min` ignores one that is not a number.
                let most = range.distance.min(longest);
                let near = range
                    .shortest
                    .map_or(NEAREST * most, |time| settled.distance(time, &at));
                for far in NEARER.map(|share| (share * most).max(near)) {
                    let time = settled.time_of_flight(far, &at);
                    for step in steps(quantity.is_some()) {
                        let there = quantity.map_or(at, |quantity| in_field(at, quantity, step));
                        let error = (self.model.distance(time, &there) - far).abs();
                        // An error that cannot be computed counts as infinite.
                        largest = largest.max(if error.is_nan() { f64::INFINITY } else { error });
                    }
                }
            }
        }
        largest
    }
}

/// Conditions with one quantity at a step of its range in the field.
fn in_field(at: Conditions<f64>, quantity: Quantity, step: usize) -> Conditions<f64> {
    let facts = quantity.facts();
    let (low, high) = facts.field;
    let from = facts.field_from.map_or(0.0, |origin| at.get(origin));
    let value = (high - low).mul_add(step as f64 / STEPS as f64, low);
    at.with(quantity, from + value)
}

/// A model in words, a line for its law and one for each effect.
#[must_use]
pub fn describe(model: &Model) -> Vec<String> {
    let effect = |term: &echocal_core::model::Term| {
        let facts = effects::ALL[term.index];
        let values = facts.parameters.iter().zip(&term.parameters);
        let values = values.map(|(p, value)| format!("{} = {value} {}", p.name, p.unit));
        format!(
            "effect {}: {}",
            facts.id,
            values.collect::<Vec<_>>().join(", ")
        )
    };
    let law = format!("law {}", model.law().text());
    std::iter::once(law)
        .chain(model.terms().iter().map(effect))
        .collect()
}

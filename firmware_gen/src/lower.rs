//! A model as the reference of a firmware: what the device does not measure is frozen, and what cannot do without is
//! refused by name, with the error that leaving it out would cost.

use crate::affine::Affine;
use crate::device::Device;
use crate::error::Error;
use crate::reference::Reference;
use echocal_core::chain::Stage;
use echocal_core::dual::Dual;
use echocal_core::effects::{self, Firmware};
use echocal_core::scalar::Scalar;
use echocal_core::{Conditions, Model, Quantity};
use std::fmt;

/// Where an influence quantity can lie in the field; the cost of not measuring it is stated over this range.
const FIELD: [(Quantity, f64, f64); Quantity::COUNT] = [
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
];

/// Points at which a quantity, and the temperature, are tried.
const STEPS: usize = 16;

/// What a firmware leaves out, and what that costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Omission {
    /// The effect; `None` for the law itself.
    pub effect: Option<&'static str>,
    /// The quantity that the device does not measure.
    pub quantity: Option<Quantity>,
    /// The value assumed instead; `None`: the effect is left out.
    pub assumed: Option<f64>,
    /// Why, where the effect cannot be lowered on any device.
    pub reason: Option<&'static str>,
    /// Error that this leaves at the largest bounded distance, over the field range of the quantity \[m\].
    pub left: f64,
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

/// Lower `model` onto `device`; `frozen` holds the conditions assumed where nothing is measured.
///
/// # Errors
/// [`Error::Refused`] if an effect needs what the device lacks and is not among `accepted`.
pub fn lower(
    model: &Model,
    device: &Device,
    frozen: &Conditions<f64>,
    accepted: &[String],
    maximum_distance: f64,
) -> Result<Lowered, Error> {
    let find = |axis: &crate::device::Axis| {
        Quantity::find(&axis.quantity).ok_or_else(|| {
            Error::Codes(format!("no influence quantity is called {}", axis.quantity))
        })
    };
    let measured = device
        .conditions
        .iter()
        .map(find)
        .collect::<Result<Vec<_>, _>>()?;
    let mut omissions = Vec::new();
    let mut kept = Model::new(model.law());
    for term in model.terms() {
        let facts = effects::ALL[term.index];
        let parameters: Vec<_> = facts
            .parameters
            .iter()
            .zip(&term.parameters)
            .map(|(p, value)| (p.name, *value))
            .collect();
        let with = |base: &Model| {
            base.clone()
                .with(facts.id, &parameters)
                .map_err(|error| Error::Model(error.to_string()))
        };
        let lacks = match facts.firmware {
            Firmware::Folded => None,
            Firmware::Needs(quantity) if measured.contains(&quantity) => None,
            Firmware::Needs(quantity) => Some((Some(quantity), None)),
            Firmware::Refused(reason) => Some((None, Some(reason))),
        };
        let Some((quantity, reason)) = lacks else {
            kept = with(&kept)?;
            continue;
        };
        let assumed = quantity
            .map(|quantity| frozen.get(quantity))
            .filter(|value| value.is_finite());
        let alone = with(&Model::new(model.law()))?;
        let trial = Lowered::new(alone, frozen, &measured);
        let left = trial.spread(device, quantity, assumed, maximum_distance);
        if left == 0.0 {
            // Neutral, or the quantity does not matter: nothing is lost.
            if assumed.is_some() {
                kept = with(&kept)?;
            }
            continue;
        }
        omissions.push(Omission {
            effect: Some(facts.id),
            quantity,
            assumed,
            reason,
            left,
        });
        if assumed.is_some() {
            kept = with(&kept)?;
        }
    }
    if let Some(refused) = omissions.iter().find(|o| {
        o.effect
            .is_some_and(|id| !accepted.iter().any(|given| given == id))
    }) {
        return Err(Error::Refused(Box::new(refused.clone())));
    }
    let mut lowered = Lowered::new(kept, frozen, &measured);
    for quantity in model
        .law()
        .facts()
        .reads
        .iter()
        .filter(|quantity| !measured.contains(quantity))
    {
        let assumed = Some(frozen.get(*quantity));
        let left = lowered.spread(device, Some(*quantity), assumed, maximum_distance);
        omissions.push(Omission {
            effect: None,
            quantity: Some(*quantity),
            assumed,
            reason: None,
            left,
        });
    }
    lowered.omissions = omissions;
    Ok(lowered)
}

impl Lowered {
    fn new(model: Model, frozen: &Conditions<f64>, measured: &[Quantity]) -> Self {
        Self {
            parameters: model.parameters(),
            model,
            frozen: *frozen,
            measured: measured.to_vec(),
            omissions: Vec::new(),
        }
    }

    fn at(&self, values: &[f64]) -> Conditions<f64> {
        self.measured
            .iter()
            .zip(values)
            .fold(self.frozen, |at, (quantity, value)| {
                at.with(*quantity, *value)
            })
    }

    /// How far the distance moves as `quantity` runs over the field, or as the effect is left out.
    fn spread(
        &self,
        device: &Device,
        quantity: Option<Quantity>,
        assumed: Option<f64>,
        distance: f64,
    ) -> f64 {
        let bare = Model::new(self.model.law());
        let mut largest = 0.0_f64;
        for step in 0..=STEPS {
            let row = (device.rows() - 1) * step / STEPS;
            let at = self.at(&device.values(row));
            let settled = if assumed.is_some() {
                &self.model
            } else {
                &bare
            };
            let time = settled.time_of_flight(distance, &at);
            let Some(quantity) = quantity else {
                largest = largest.max((self.model.distance(time, &at) - distance).abs());
                continue;
            };
            let (_, low, high) = FIELD[quantity as usize];
            for step in 0..=STEPS {
                let value = (high - low).mul_add(step as f64 / STEPS as f64, low);
                largest = largest
                    .max((self.model.distance(time, &at.with(quantity, value)) - distance).abs());
            }
        }
        largest
    }
}

/// A Newton step below this is less than the twin's own unit by a factor of a million \[m\].
const SETTLED: f64 = 1e-12;
/// Steps allowed; a chain that is affine in the distance settles in one.
const STEPS_ALLOWED: usize = 20;

impl Reference for Lowered {
    fn distances(&self, conditions: &[f64], time_of_flight: &[f64], distance: &mut [f64]) {
        let at = self.at(conditions);
        let line = self.time(Affine::DISTANCE, &at);
        // Straight for every distance, as the formulas themselves prove: invert it once for the whole row.
        if line.slope.is_finite() && line.slope != 0.0 {
            let (slope, start) = (line.slope.recip(), -line.constant / line.slope);
            let pairs = distance.iter_mut().zip(time_of_flight);
            pairs.for_each(|(distance, time)| *distance = slope.mul_add(*time, start));
        } else {
            self.invert(&at, time_of_flight, distance);
        }
    }
}

impl Lowered {
    /// The echo time at a distance, in any number type.
    fn time<S: Scalar>(&self, distance: S, at: &Conditions<f64>) -> S {
        let at = Conditions::new(Quantity::ALL.map(|facts| S::constant(at.get(facts.quantity))));
        let parameters: Vec<S> = self.parameters.iter().copied().map(S::constant).collect();
        self.model
            .simulate_to(Stage::Timer, distance, &at, &parameters)
            .time
    }

    /// Newton's method for each echo time, from the solution and the slope of the one before.
    fn invert(&self, at: &Conditions<f64>, time_of_flight: &[f64], distance: &mut [f64]) {
        let (mut solution, mut slope, mut last) = (0.0_f64, 171.5_f64, 0.0_f64);
        for (time, distance) in time_of_flight.iter().zip(distance) {
            let mut guess = slope.mul_add(*time - last, solution);
            let settled = (0..STEPS_ALLOWED).any(|_| {
                let reached = self.time(Dual::<1>::variable(guess, 0), at);
                slope = reached.derivatives[0].recip();
                let step = (*time - reached.value) * slope;
                guess += step;
                step.abs() <= SETTLED
            });
            *distance = if settled { guess } else { f64::NAN };
            (solution, last) = (guess, *time);
        }
    }
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

//! Random measurements and models to try the effects on.

use echocal_core::chain::{Chain, Stage};
use echocal_core::conditions::QuantityFacts;
use echocal_core::effects::{self, Facts, ParameterFacts};
use echocal_core::{Conditions, Law, Model, Quantity};
use proptest::prelude::*;

/// Every law by name, and a speed that reads nothing.
pub fn laws() -> Vec<Law> {
    let mut names = Law::names();
    names.push("343");
    names.iter().map(|name| Law::parse(name).unwrap()).collect()
}

/// The range in which a quantity is tried: its range in the field, or a wider or narrower one where an
/// effect would otherwise react too seldom.
pub fn range(quantity: Quantity) -> (f64, f64) {
    match quantity {
        Quantity::RelativeHumidity => (0.05, 0.95),
        Quantity::Pressure => (60e3, 110e3),
        Quantity::Co2MoleFraction => (0.0, 0.01),
        Quantity::ElapsedTime => (0.0, 1e4),
        Quantity::SupplyVoltage => (3.0, 5.5),
        Quantity::Angle => (-0.5, 0.5),
        Quantity::WindSpeed => (0.0, 20.0),
        Quantity::TemperatureRate => (-0.05, 0.05),
        Quantity::RadiationRate => (-1.0, 1.0),
        Quantity::PositionInGroup => (0.0, 2.0),
        Quantity::HourAngle => (-3.0, 3.0),
        // far from the reference, 0.3 mm for each unit of it would be longer than the shortest paths
        Quantity::EchoQuality => (170.0, 190.0),
        _ => {
            let origin = quantity.facts().field_from.unwrap_or(quantity);
            origin.facts().field
        }
    }
}

/// A place in every quantity's range.
pub fn conditions() -> impl Strategy<Value = Conditions<f64>> {
    proptest::array::uniform::<_, { Quantity::COUNT }>(0.0..1.0_f64).prop_map(|unit| {
        Conditions::new(core::array::from_fn(|index| {
            between(range(Quantity::ALL[index].quantity), unit[index])
        }))
    })
}

/// A distance \[m\] in the reach of the sensors.
pub fn distance() -> impl Strategy<Value = f64> {
    0.02..10.0
}

/// As many numbers of 0..1 as all effects together have parameters.
pub fn units() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(0.0..1.0_f64, effects::ALL.len() * 4)
}

pub fn between((low, high): (f64, f64), unit: f64) -> f64 {
    low + (high - low) * unit
}

/// A value of a parameter within three scales of its prior and within its bounds.
pub fn value(parameter: &ParameterFacts, unit: f64) -> f64 {
    let reach = 3.0 * parameter.prior_scale;
    let low = parameter.bounds.0.max(parameter.neutral - reach);
    let high = parameter.bounds.1.min(parameter.neutral + reach);
    between((low, high), unit)
}

/// Values of all parameters of an effect.
pub fn values(facts: &Facts, units: &[f64]) -> Vec<f64> {
    let parameters = facts.parameters.iter();
    parameters.zip(units).map(|(p, &u)| value(p, u)).collect()
}

/// The model with the effect at these values; `None` where they do not fit together.
pub fn with(model: &Model, facts: &Facts, values: &[f64]) -> Option<Model> {
    let names = facts.parameters.iter().map(|p| p.name);
    let pairs: Vec<_> = names.zip(values.iter().copied()).collect();
    model.clone().with(facts.id, &pairs).ok()
}

/// A law with some effects at random values: those whose number is below one half.
pub fn random_model(law: Law, chosen: &[f64], units: &[f64]) -> Model {
    let mut model = Model::new(law);
    for (index, facts) in effects::ALL.iter().enumerate() {
        if chosen[index] < 0.5 {
            let values = values(facts, &units[4 * index..]);
            model = with(&model, facts, &values).unwrap_or(model);
        }
    }
    model
}

/// Whether the air of a model is air. Effects that each shift the temperature a little reach 130
/// degC together, where the vapour of humid air is more than all its gas and no speed is defined.
pub fn in_air_that_can_be(model: &Model, d: f64, at: &Conditions<f64>) -> bool {
    let air = model.simulate(d, at, &model.parameters()).air;
    (-80.0..=80.0).contains(&air.temperature)
}

/// The variables of the chain with the stage that sets each.
pub fn variables(chain: &Chain<f64>) -> [(Stage, f64); 9] {
    [
        (Stage::Air, chain.air.temperature),
        (Stage::Air, chain.air.relative_humidity),
        (Stage::Air, chain.air.pressure),
        (Stage::Air, chain.air.co2_mole_fraction),
        (Stage::Speed, chain.speed),
        (Stage::Path, chain.path),
        (Stage::Flight, chain.time),
        (Stage::Firmware, chain.firmware_speed),
        (Stage::Indication, chain.indication),
    ]
}

/// Whether an effect of the stage `acts` may change a variable that the stage `sets`.
pub fn owns(acts: Stage, sets: Stage) -> bool {
    let time = [Stage::Flight, Stage::Transducer, Stage::Timer];
    acts == sets || (sets == Stage::Flight && time.contains(&acts))
}

/// The variables bit for bit.
pub fn bits(chain: &Chain<f64>) -> [u64; 9] {
    variables(chain).map(|(_, value)| value.to_bits())
}

/// The quantities one by one.
pub fn quantities() -> impl Iterator<Item = Quantity> {
    Quantity::ALL
        .iter()
        .map(|facts: &QuantityFacts| facts.quantity)
}

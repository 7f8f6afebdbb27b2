//! The declared `reads` are exactly the quantities that an effect reacts to.

use crate::draws::{
    between, conditions, distance, owns, quantities, range, units, values, variables,
};
use echocal_core::chain::Chain;
use echocal_core::effects::{ALL, Facts, apply};
use echocal_core::{Conditions, Law, Model, Quantity};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

/// Smallest change, relative to what the effect does, that is a reaction and not rounding.
const REACTION: f64 = 1e-9;

/// The state that reaches the effect, with one quantity as recorded and in the air replaced.
fn replaced(mut chain: Chain<f64>, quantity: Quantity, value: f64) -> Chain<f64> {
    chain.recorded = chain.recorded.with(quantity, value);
    match quantity {
        Quantity::Temperature => chain.air.temperature = value,
        Quantity::RelativeHumidity => chain.air.relative_humidity = value,
        Quantity::Pressure => chain.air.pressure = value,
        Quantity::Co2MoleFraction => chain.air.co2_mole_fraction = value,
        _ => {}
    }
    chain
}

/// How much the effect changes each variable of its stage.
fn changes(index: usize, before: Chain<f64>, values: &[f64]) -> Vec<f64> {
    let mut after = before;
    apply(index, &mut after, values);
    let own = |&((stage, _), _): &((_, f64), (_, f64))| owns(ALL[index].stage, stage);
    let pairs = variables(&before).into_iter().zip(variables(&after));
    pairs.filter(own).map(|(old, new)| new.1 - old.1).collect()
}

/// The largest relative reaction of an effect to a quantity that takes another value.
fn reaction(
    index: usize,
    (distance, at, values): (f64, &Conditions<f64>, &[f64]),
    quantity: Quantity,
    value: f64,
) -> f64 {
    let base = Model::new(Law::parse("linear").unwrap());
    let here = base.simulate_to(ALL[index].stage, distance, at, &[]);
    let there = replaced(here, quantity, value);
    let (here, there) = (changes(index, here, values), changes(index, there, values));
    let pairs = here.iter().zip(&there);
    pairs.fold(0.0, |worst: f64, (a, b)| {
        let size = a.abs().max(b.abs());
        worst.max(if size > 0.0 {
            (a - b).abs() / size
        } else {
            0.0
        })
    })
}

fn reacts(facts: &Facts, index: usize, quantity: Quantity) -> (usize, usize) {
    const DRAWS: usize = 256;
    let mut runner = TestRunner::default();
    let strategy = (distance(), conditions(), units(), 0.0..1.0_f64);
    let reacted = (0..DRAWS).filter(|_| {
        let draw = strategy.new_tree(&mut runner).unwrap().current();
        let (d, at, drawn, unit) = draw;
        let values = values(facts, &drawn);
        let value = between(range(quantity), unit);
        reaction(index, (d, &at, &values), quantity, value) > REACTION
    });
    (reacted.count(), DRAWS)
}

#[test]
fn reads_are_exactly_what_an_effect_reacts_to() {
    for (index, facts) in ALL.iter().enumerate() {
        for quantity in quantities() {
            let (reacted, draws) = reacts(facts, index, quantity);
            let name = quantity.facts().name;
            if facts.reads.contains(&quantity) {
                // an effect that switches reacts where the switch lies between two values
                let often = if facts.edges { 16 } else { 2 };
                assert!(
                    often * reacted > draws,
                    "{} does not react to {name}",
                    facts.id
                );
            } else {
                assert_eq!(
                    reacted, 0,
                    "{} reacts to {name}: declare it in reads",
                    facts.id
                );
            }
        }
    }
}

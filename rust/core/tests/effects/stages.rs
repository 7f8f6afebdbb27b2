//! An effect changes the variable of its stage and nothing else, and never looks downstream.

use crate::draws::{
    conditions, distance, laws, owns, random_model, units, values, variables, with,
};
use echocal_core::air::Air;
use echocal_core::effects::{ALL, apply};
use echocal_core::{Model, Quantity};
use proptest::prelude::*;

/// The quantities of the air before and after.
fn of_the_air(before: &Air<f64>, after: &Air<f64>) -> [(Quantity, f64, f64); 4] {
    [
        (Quantity::Temperature, before.temperature, after.temperature),
        (
            Quantity::RelativeHumidity,
            before.relative_humidity,
            after.relative_humidity,
        ),
        (Quantity::Pressure, before.pressure, after.pressure),
        (
            Quantity::Co2MoleFraction,
            before.co2_mole_fraction,
            after.co2_mole_fraction,
        ),
    ]
}

proptest! {
    #[test]
    fn only_the_own_variable_changes(
        d in distance(),
        at in conditions(),
        drawn in units(),
    ) {
        for (index, facts) in ALL.iter().enumerate() {
            for law in laws() {
                // later variables are NaN here: looking at one would show in the result
                let before = Model::new(law).simulate_to(facts.stage, d, &at, &[]);
                let mut after = before;
                apply(index, &mut after, &values(facts, &drawn));
                for (old, new) in variables(&before).into_iter().zip(variables(&after)) {
                    let kept = old.1.to_bits() == new.1.to_bits();
                    let changed = owns(facts.stage, old.0) && new.1.is_finite();
                    prop_assert!(kept || changed, "{} changes {:?}", facts.id, old.0);
                }
                prop_assert_eq!(after.distance, d);
                for (quantity, old, new) in of_the_air(&before.air, &after.air) {
                    let kept = old.to_bits() == new.to_bits() || facts.air.contains(&quantity);
                    prop_assert!(kept, "{} changes {:?}", facts.id, quantity);
                }
            }
        }
    }

    #[test]
    fn terms_follow_the_chain_in_whatever_order_they_came(
        d in distance(),
        at in conditions(),
        chosen in units(),
        drawn in units(),
    ) {
        for law in laws() {
            let model = random_model(law, &chosen, &drawn);
            prop_assert!(model.terms().is_sorted_by_key(|term| term.facts().stage));
            let reversed = model.terms().iter().rev().fold(Model::new(law), |so_far, term| {
                with(&so_far, term.facts(), &term.parameters).unwrap()
            });
            prop_assert_eq!(&reversed, &model);
            let (one, other) = (reversed.indicate(d, &at), model.indicate(d, &at));
            // vapor beyond its share of the pressure has no speed of sound: NaN both times
            prop_assert!(one == other || one.is_nan() && other.is_nan(), "{one} and {other}");
        }
    }
}

//! At neutral sizes an effect is the identity, bit for bit, in whatever company.

use crate::draws::{bits, conditions, distance, laws, random_model, units, value, with};
use echocal_core::effects::{ALL, Facts, Role};
use proptest::prelude::*;

/// Neutral sizes with any shapes.
fn neutral(facts: &Facts, units: &[f64]) -> Vec<f64> {
    let parameters = facts.parameters.iter().zip(units);
    let either = parameters.map(|(p, &unit)| match p.role {
        Role::Size => p.neutral,
        Role::Shape => value(p, unit),
    });
    either.collect()
}

proptest! {
    #[test]
    fn neutral_is_the_identity(
        d in distance(),
        at in conditions(),
        chosen in units(),
        drawn in units(),
    ) {
        for law in laws() {
            let company = random_model(law, &chosen, &drawn);
            let expected = bits(&company.simulate(d, &at, &company.parameters()));
            for facts in ALL {
                let Some(model) = with(&company, facts, &neutral(facts, &chosen)) else {
                    continue; // there already, or excluded by another effect or the law
                };
                let chain = model.simulate(d, &at, &model.parameters());
                prop_assert_eq!(bits(&chain), expected, "{} on {}", facts.id, law.text());
            }
        }
    }
}

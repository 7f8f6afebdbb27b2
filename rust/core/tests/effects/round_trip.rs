//! Compensation undoes the simulation.

use crate::draws::{
    conditions, distance, in_air_that_can_be, laws, random_model, units, values, with,
};
use echocal_core::effects::ALL;
use echocal_core::{Conditions, Model};
use proptest::prelude::*;

const METERS: f64 = 1e-12;

fn comes_back(model: &Model, d: f64, at: &Conditions<f64>) -> Result<(), TestCaseError> {
    let corrected = model.correct(model.indicate(d, at), at);
    prop_assert!(
        (corrected - d).abs() <= METERS,
        "{:?}: {corrected}",
        model.terms()
    );
    let found = model.distance(model.time_of_flight(d, at), at);
    prop_assert!((found - d).abs() <= METERS, "{:?}: {found}", model.terms());
    Ok(())
}

proptest! {
    #[test]
    fn of_single_effects(d in distance(), at in conditions(), drawn in units()) {
        for law in laws() {
            for facts in ALL {
                let model = with(&Model::new(law), facts, &values(facts, &drawn));
                if let Some(model) = model.filter(|one| in_air_that_can_be(one, d, &at)) {
                    comes_back(&model, d, &at)?;
                }
            }
        }
    }

    #[test]
    fn of_combinations(
        d in distance(),
        at in conditions(),
        chosen in units(),
        drawn in units(),
    ) {
        for law in laws() {
            let model = random_model(law, &chosen, &drawn);
            if in_air_that_can_be(&model, d, &at) {
                comes_back(&model, d, &at)?;
            }
        }
    }
}

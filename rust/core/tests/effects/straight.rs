//! Where no effect bends it, the line over the distance is straight bit for bit: one step of Newton's method
//! inverts it.

use crate::draws::{between, laws, range, values, with};
use echocal_core::dual::Dual;
use echocal_core::effects::{ALL, Facts};
use echocal_core::{Conditions, Model, Quantity};

const DRAWS: usize = 20;
const DISTANCES: usize = 200;

/// Numbers of 0..1 that differ from draw to draw.
fn unit(draw: usize, place: usize) -> f64 {
    let golden = 0.618_033_988_749_895;
    ((1 + draw) as f64 * golden + place as f64 * golden * golden).fract()
}

/// The derivatives of the echo time and of the indication to the distance, at one, in bits.
fn slopes(model: &Model, distance: f64, recorded: &Conditions<f64>) -> [u64; 2] {
    let parameters: Vec<_> = model.parameters().into_iter().map(Dual::fixed).collect();
    let recorded = Conditions::new(Quantity::ALL.map(|q| Dual::fixed(recorded.get(q.quantity))));
    let chain = model.simulate(Dual::<1>::variable(distance, 0), &recorded, &parameters);
    [chain.time, chain.indication].map(|end| end.derivatives[0].to_bits())
}

/// Whether an effect with random values bends a line.
fn bends(facts: &Facts, draw: usize) -> bool {
    let drawn: Vec<f64> = (0..facts.parameters.len())
        .map(|place| unit(draw, place))
        .collect();
    let each = Quantity::ALL.iter().enumerate();
    let recorded = each.map(|(place, q)| between(range(q.quantity), unit(draw, 7 + place)));
    let recorded: Vec<f64> = recorded.collect();
    let recorded = Conditions::new(recorded.try_into().unwrap());
    laws().into_iter().any(|law| {
        let Some(model) = with(&Model::new(law), facts, &values(facts, &drawn)) else {
            return false;
        };
        let first = slopes(&model, 0.02, &recorded);
        let mut steps = (1..DISTANCES).map(|step| 0.02 + step as f64 * 0.05);
        steps.any(|distance| slopes(&model, distance, &recorded) != first)
    })
}

#[test]
fn what_bends_the_line_says_so() {
    for facts in ALL {
        let found = (0..DRAWS).any(|draw| bends(facts, draw));
        assert_eq!(found, facts.bends, "{}", facts.id);
    }
}

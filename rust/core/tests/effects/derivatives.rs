//! The dual derivative of the indication equals a difference of eighth order.

use crate::draws::{
    conditions, distance, in_air_that_can_be, laws, quantities, random_model, range, units, values,
    with,
};
use echocal_core::batch::jacobian;
use echocal_core::dual::Dual;
use echocal_core::effects::ALL;
use echocal_core::scalar::Rows;
use echocal_core::{Conditions, Model, Quantity};
use proptest::prelude::*;

/// What the indication is differentiated to.
#[derive(Clone, Copy, Debug)]
enum To {
    Distance,
    Parameter(usize),
    Quantity(Quantity),
}

/// Indication where one input is moved by `step`.
fn moved<S: Rows>(model: &Model, d: f64, at: &Conditions<f64>, to: To, step: S) -> S {
    let mut distance = S::constant(d);
    let values = model.parameters();
    let mut parameters: Vec<S> = values.into_iter().map(S::constant).collect();
    let mut recorded = Conditions::new(Quantity::ALL.map(|q| S::constant(at.get(q.quantity))));
    match to {
        To::Distance => distance = distance + step,
        To::Parameter(index) => parameters[index] = parameters[index] + step,
        To::Quantity(q) => recorded = recorded.with(q, recorded.get(q) + step),
    }
    model.simulate(distance, &recorded, &parameters).indication
}

/// Central difference of eighth order.
fn difference(f: impl Fn(f64) -> f64, h: f64) -> f64 {
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let pairs = (1..).map(f64::from).zip(weights);
    pairs.map(|(k, w)| w * (f(k * h) - f(-k * h))).sum::<f64>() / h
}

/// Of the widest step, until differences settle: a time constant may be far below its usual size.
const HALVINGS: u32 = 18;

/// Every input of a model with the step in which it is tried.
fn inputs(model: &Model, d: f64) -> Vec<(To, f64)> {
    let parameters = model
        .terms()
        .iter()
        .flat_map(|term| term.facts().parameters);
    let parameters = parameters.enumerate();
    let mut inputs = vec![(To::Distance, 0.1 * d)];
    inputs.extend(parameters.map(|(i, p)| (To::Parameter(i), 0.1 * p.prior_scale)));
    inputs.extend(quantities().map(|q| {
        let (low, high) = range(q);
        (To::Quantity(q), 0.01 * (high - low))
    }));
    inputs
}

/// A difference that two halvings of its step in a row no longer change, with what rounding leaves
/// open; `None` where the steps do not settle: beside an edge there is nothing to compare with. One
/// halving is not enough: two wide steps may be wrong by the same amount. A wide step may leave the
/// parameter's bounds, as a time constant below zero, where the indication overflows.
fn settled(f: impl Fn(f64) -> f64, size: f64, widest: f64) -> Option<(f64, f64)> {
    let rounding = |step: f64| 64.0 * f64::EPSILON * size / step;
    let mut before = difference(&f, widest);
    let mut quiet_before = false;
    (1..HALVINGS).find_map(|halvings| {
        let step = widest / f64::from(1 << halvings);
        let found = difference(&f, step);
        let off = (found - before).abs();
        let quiet = off.is_finite() && off <= 1e-9 * found.abs() + rounding(step);
        let settled = quiet && quiet_before;
        (before, quiet_before) = (found, quiet);
        settled.then(|| (found, rounding(step)))
    })
}

/// On an edge itself, where a central difference takes the mean of both sides: whether `exact` is
/// the slope of one of them.
fn one_sided(f: impl Fn(f64) -> f64, exact: f64, widest: f64) -> bool {
    let step = 1e-4 * widest;
    [step, -step]
        .iter()
        .any(|&h| ((f(h) - f(0.0)) / h - exact).abs() <= 1e-3 * exact.abs())
}

fn agree(model: &Model, d: f64, at: &Conditions<f64>) -> Result<(), TestCaseError> {
    let effects = model.terms().len().max(1) as f64; // each rounds once more
    let size = effects * model.indicate(d, at).abs();
    for (to, step) in inputs(model, d) {
        let exact = moved(model, d, at, to, Dual::<1>::variable(0.0, 0)).derivatives[0];
        let Some((found, rounding)) = settled(|x| moved(model, d, at, to, x), size, step) else {
            let edges = model.terms().iter().any(|t| t.facts().edges);
            prop_assert!(
                edges,
                "{:?} to {to:?}: differences never settle",
                model.terms()
            );
            continue;
        };
        let off = (found - exact).abs();
        let edges = model.terms().iter().any(|t| t.facts().edges);
        prop_assert!(
            off <= 1e-8 * exact.abs() + rounding
                || edges && one_sided(|x| moved(model, d, at, to, x), exact, step),
            "{:?} to {to:?}: exact {exact}, difference {found}",
            model.terms()
        );
    }
    Ok(())
}

proptest! {
    #[test]
    fn of_single_effects(d in distance(), at in conditions(), drawn in units()) {
        for law in laws() {
            for facts in ALL {
                let Some(model) = with(&Model::new(law), facts, &values(facts, &drawn)) else {
                    continue;
                };
                if in_air_that_can_be(&model, d, &at) {
                    agree(&model, d, &at)?;
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
                agree(&model, d, &at)?;
            }
        }
    }

    #[test]
    fn jacobian_is_the_distance_then_each_parameter(
        d in distance(),
        at in conditions(),
        chosen in units(),
        drawn in units(),
    ) {
        for law in laws() {
            let model = random_model(law, &chosen, &drawn);
            if !in_air_that_can_be(&model, d, &at) {
                continue;
            }
            let count = model.parameters().len();
            let each = core::iter::once(To::Distance).chain((0..count).map(To::Parameter));
            let expected = each.map(|to| {
                moved(&model, d, &at, to, Dual::<1>::variable(0.0, 0)).derivatives[0]
            });
            let inputs = core::iter::once(d).chain(Quantity::ALL.map(|q| at.get(q.quantity)));
            let columns: Vec<_> = inputs.map(|input| [input]).collect();
            let columns: Vec<_> = columns.iter().map(|column| &column[..]).collect();
            prop_assert_eq!(jacobian(&model, &columns, 1), expected.collect::<Vec<_>>());
        }
    }
}

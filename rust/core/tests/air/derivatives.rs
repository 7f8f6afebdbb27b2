//! Exact derivatives of every law to every input, against a central difference of eighth order.

use echocal_core::Law;
use echocal_core::air::{Air, LawFacts, absorption, dispersed};
use echocal_core::dual::Dual;
use echocal_core::scalar::Scalar;

const INPUTS: [&str; 5] = [
    "temperature",
    "relative_humidity",
    "pressure",
    "co2_mole_fraction",
    "frequency",
];
/// Steps, small against the scale on which the laws bend.
const STEPS: [f64; 5] = [0.4, 0.005, 500.0, 5e-5, 500.0];
const POINTS: [[f64; 5]; 6] = [
    [-20.0, 0.3, 101_325.0, 4e-4, 40e3],
    [0.0, 0.9, 85e3, 3e-3, 25e3],
    [20.0, 0.5, 101_325.0, 4e-4, 40e3],
    [35.0, 0.6, 70e3, 1e-3, 50e3],
    [48.0, 0.15, 105e3, 8e-3, 200e3],
    [60.0, 0.8, 62e3, 4e-4, 40e3],
];

fn air<S: Scalar>(inputs: &[S; 5]) -> Air<S> {
    Air {
        temperature: inputs[0],
        relative_humidity: inputs[1],
        pressure: inputs[2],
        co2_mole_fraction: inputs[3],
    }
}

/// Central difference of eighth order to one input.
fn difference(function: impl Fn(&[f64; 5]) -> f64, point: [f64; 5], index: usize) -> f64 {
    const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let at = |steps: f64| {
        let mut moved = point;
        moved[index] += steps * STEPS[index];
        function(&moved)
    };
    let pairs = (1_u8..).zip(WEIGHTS);
    let sum: f64 = pairs
        .map(|(k, weight)| weight * (at(f64::from(k)) - at(-f64::from(k))))
        .sum();
    sum / STEPS[index]
}

/// Compares `dual` with differences of `plain`; both are the same formula.
fn check(
    name: &str,
    reads: &[&str],
    plain: impl Fn(&[f64; 5]) -> f64,
    dual: impl Fn(&[Dual<5>; 5]) -> Dual<5>,
) {
    for (index, input) in INPUTS.iter().enumerate() {
        let mut sharp = 0;
        for point in POINTS {
            let exact = dual(&core::array::from_fn(|i| Dual::variable(point[i], i)));
            assert_eq!(exact.value, plain(&point), "{name} at {point:?}");
            let derivative = exact.derivatives[index];
            if !reads.contains(input) {
                assert_eq!(derivative, 0.0, "{name} must not read {input}");
                continue;
            }
            let expected = difference(&plain, point, index);
            // what rounding alone can do to the difference, beside the relative 1e-8 of the claim
            let rounding = 4.0 * f64::EPSILON * exact.value.abs() / STEPS[index];
            assert!(
                ((derivative - expected).abs() - rounding) <= 1e-8 * derivative.abs(),
                "{name}, {input} at {point:?}: {derivative} against {expected}"
            );
            sharp += usize::from(rounding < 1e-8 * derivative.abs());
        }
        assert!(
            !reads.contains(input) || sharp >= 2,
            "{name}, {input}: {sharp} sharp points"
        );
    }
}

fn reads(facts: &LawFacts) -> Vec<&'static str> {
    facts.reads.iter().map(|q| q.facts().name).collect()
}

#[test]
fn of_every_law_to_every_input() {
    for facts in Law::ALL {
        let law = Law::parse(facts.id).unwrap();
        check(
            facts.id,
            &reads(facts),
            |x| law.speed(&air(x)),
            |x| law.speed(&air(x)),
        );
        let mut reads = reads(facts);
        reads.extend(["temperature", "relative_humidity", "pressure", "frequency"]);
        check(
            &format!("{} at a frequency", facts.id),
            &reads,
            |x| law.speed_at_frequency(&air(x), x[4]),
            |x| law.speed_at_frequency(&air(x), x[4]),
        );
    }
}

#[test]
fn of_absorption_and_dispersion() {
    let reads = ["temperature", "relative_humidity", "pressure", "frequency"];
    check(
        "absorption",
        &reads,
        |x| absorption(&air(x), x[4]),
        |x| absorption(&air(x), x[4]),
    );
    check(
        "dispersion",
        &reads,
        |x| dispersed(340.0, &air(x), x[4]),
        |x| dispersed(Dual::constant(340.0), &air(x), x[4]),
    );
}

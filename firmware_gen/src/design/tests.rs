//! The floor of a candidate must lie below what it turns out to reach: above it, the search throws the candidate away.

use super::frame::frames;
use super::search::Search;
use super::{Error, Request};
use crate::device::{Axis, Device};
use crate::output::Output;
use crate::target::{Prefer, Target};

/// Rounding to a whole unit can bring an error back by as much, \[unit\].
const ROUNDED: f64 = 1.0;

/// Distances whose offset grows with the temperature: no offset and no delay serves them all.
fn leaning(conditions: &[f64], time: f64) -> f64 {
    let warm = conditions[0];
    (0.6f64.mul_add(warm, 331.4) / 2.0).mul_add(time, 2e-6 * warm * warm)
}

/// Prove every candidate for echo times from `shortest` \[us\] on; the pairs of floor and proven error \[unit\].
fn floors(shortest: f64, output: Output) -> Vec<(f64, f64)> {
    let device = Device {
        echo: Axis::echo(4.0, shortest, 12_000.0).unwrap(),
        conditions: vec![Axis::temperature(1.0, -20.0, 40.0, 0.0).unwrap()],
        output,
    };
    let request = Request {
        reference: &leaning,
        device: &device,
        maximum_error: 5e-3,
        maximum_distance: 1.9,
        maximum_table: 1024,
        widest: 64,
        target: Target::parse("c99").unwrap(),
        form: None,
        prefer: Prefer::parse("size").unwrap(),
        threads: 2,
    };
    let made = std::cell::OnceCell::new();
    let search = Search::new(request, |picked, lines| {
        Ok(made.get_or_init(|| frames(&request, picked, lines).unwrap()))
    });
    let search = search.unwrap();
    let mut found = Vec::new();
    for mut candidate in search.candidates() {
        let floor = candidate.floor();
        if !search.refine(&mut candidate) {
            continue;
        }
        match search.prove(&candidate, f64::INFINITY, &mut |_| true) {
            Ok((_, proof)) => found.push((floor, proof.bounded.error)),
            Err(Error::Proof(_)) => {}
            Err(error) => panic!("{error}"),
        }
    }
    found
}

#[test]
fn no_candidate_undercuts_its_floor() {
    // From echo code 0, from the echo of 20 mm, and from half the reach on.
    for shortest in [0.0, 108.0, 5_600.0] {
        let found = floors(shortest, Output::MICROMETERS);
        assert!(found.len() > 30, "{}", found.len());
        for (floor, proven) in &found {
            assert!(
                floor - ROUNDED <= *proven,
                "from {shortest} us: {floor} > {proven}"
            );
        }
        // Some come close: a floor of nothing would prove nothing.
        let close = |(floor, proven): &&(f64, f64)| *floor > 0.8 * proven && *proven < 4_000.0;
        let close = found.iter().filter(close).count();
        assert!(close > 0, "from {shortest} us");
    }
}

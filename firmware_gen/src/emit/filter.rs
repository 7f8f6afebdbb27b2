//! The files of the median filter: where they lie, and the golden sequence.

use crate::device::Status;
use crate::filter::{Filter, OUT_OF_RANGE};
use crate::output::Output;
use std::fmt::Write;

/// Measurements of the golden sequence. Set by hand: a file of some 5 kB.
const MEASUREMENTS: u32 = 256;
/// Factor and increment of the pseudo-random numbers: Numerical Recipes, 3rd ed., 7.1 (`ranqd1`).
const RANDOM: (u32, u32) = (1_664_525, 1_013_904_223);

/// Path and template of the filter's files: they lie beside those of the function, if the package holds its C.
pub(super) fn parts(parts: &[(&str, &str)]) -> Vec<(String, String)> {
    let beside = |text: &str| text.replace("echocal_correction", "echocal_filter");
    let ours = |template: &&(&str, &str)| template.1.starts_with("c/echocal_correction.");
    let parts = parts.iter().filter(ours);
    parts
        .map(|(path, template)| (beside(path), beside(template)))
        .collect()
}

/// Name and text of the golden sequence: measurements in order, from a new state, each with what the filter gives.
pub(super) fn golden(filter: &Filter, output: &Output, name: &str) -> (String, String) {
    let unit = output.suffix();
    let mut text = format!("distance_{unit},status,filtered_{unit},filter_status\n");
    let measurements = sequence(filter);
    for ((distance, status), (filtered, why)) in
        measurements.iter().zip(filter.run(measurements.clone()))
    {
        let _ = writeln!(text, "{distance},{status},{filtered},{why}");
    }
    (format!("{name}_filter_golden.csv"), text)
}

/// A target that moves in steps, with scatter, ties, outliers, both ends of the type, and runs of missing echoes.
fn sequence(filter: &Filter) -> Vec<(i32, u8)> {
    let gate = filter.gate.map_or(1_000, |gate| gate.min(1 << 27)) as i32;
    let (factor, increment) = RANDOM;
    let mut random = 1_u32;
    let mut next = |below: u32| {
        random = random.wrapping_mul(factor).wrapping_add(increment);
        (random >> 16) % below
    };
    let measurement = |index: u32| {
        let target = (index / 32) as i32 * gate; // a step of one gate each 32 measurements
        match next(12) {
            0 | 1 if (index / 16) % 2 == 1 => (OUT_OF_RANGE, Status::TooFar as u8),
            2..5 if (index / 16) % 2 == 1 => (OUT_OF_RANGE, Status::NoEcho as u8),
            0 => (i32::MAX, 0),
            1 => (i32::MIN + 1, 0),
            2 => (target + 2 * gate + 1, 0),
            3 => (target - gate, 0),
            4 => (target + gate + 1, 0),
            5..8 => (target, 0),
            _ => (target + next(gate as u32) as i32, 0),
        }
    };
    (0..MEASUREMENTS).map(measurement).collect()
}

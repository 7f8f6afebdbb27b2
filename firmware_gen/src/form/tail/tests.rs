//! What a tail leaves is what the best offset and factors leave.

use super::*;
use proptest::prelude::*;

fn line(first: i64, reach: i64, slope: f64, start: f64) -> Line {
    Line {
        first,
        slope,
        start,
        middle: 0.0,
        reach,
        bounded: true,
    }
}

fn tail(delay: i64) -> Tail {
    Tail {
        scale_bits: 8,
        time_bits: 0,
        delay,
        offset: 0.0,
        rounded: false,
        leading: false,
    }
}

/// Two lines 2000 apart at echo code 0: an offset halves that, the other factor takes a third of it over half the
/// reach, and all of it over a single code.
#[test]
fn the_rest_is_what_offset_and_factors_leave() {
    let rest = |first: i64, reach: i64, delay: i64| {
        let lines = [0.0, 2000.0].map(|start| line(first, reach, 170.0, start));
        tail(delay).rest(&lines)
    };
    for (first, delay, expected) in [
        (0, 0, 1000.0),
        (0, 31, 1000.0),
        (10_000, 0, 1000.0 / 3.0),
        (10_031, 31, 1000.0 / 3.0),
    ] {
        let reach = if first > 10_000 { 20_031 } else { 20_000 };
        let found = rest(first, reach, delay);
        assert!((found - expected).abs() < 1e-6, "{first} {delay}: {found}");
    }
    assert!(rest(19_999, 20_000, 0) < 0.03);
}

/// The largest error at the ends of the lines, each with the factor that is best beside `offset`.
fn least_error(lines: &[Line], delay: f64, offset: f64) -> f64 {
    let worst = lines.iter().map(|line| {
        let (a, b) = (line.first as f64 - delay, line.reach as f64 - delay);
        let error = line.wanted(delay) - offset;
        let turn = if a > 0.0 { -2.0 * error / (a + b) } else { 0.0 };
        turn.mul_add(a, error)
            .abs()
            .max(turn.mul_add(b, error).abs())
    });
    worst.fold(0.0, f64::max)
}

proptest! {
    /// The best of all offsets and factors leaves the rest, and no less.
    #[test]
    fn the_best_offset_and_factors_leave_the_rest(
        lines in prop::collection::vec((0_i64..20_000, 600_i64..20_000, 100.0..200.0, -3e3..3e3), 2..6),
        delay in 0_i64..500,
    ) {
        let lines: Vec<Line> = lines
            .into_iter()
            .map(|(first, more, slope, start)| line(first, first + more, slope, start))
            .collect();
        let rest = tail(delay).rest(&lines);
        let (low, high) = rests(&lines, delay, 0);
        let step = (high - low) / 1000.0;
        let offsets = (0..=1000).map(|k| step.mul_add(f64::from(k), low));
        let errors = offsets.map(|offset| least_error(&lines, delay as f64, offset));
        let least = errors.fold(f64::INFINITY, f64::min);
        prop_assert!(least >= rest - 1e-6, "{least} < {rest}");
        prop_assert!(least <= rest + step, "{least} > {rest}");
    }
}

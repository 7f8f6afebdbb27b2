//! Straight segments of 256 codes: the cell is the upper byte of the code, the place in it the lower one, and slopes are
//! bytes above a slope that all share. For cores that move bytes and cannot shift.

use super::contract::{Fit, Form};
use super::steps::temperature_index;
use crate::ir::{Builder, Value};

/// Segments of 256 codes, each with a start of 16 bits and a slope of 8 bits above a slope that all share.
#[derive(Clone, Debug)]
struct Segments {
    /// Speed factors per code that all segments share.
    steady: i64,
    /// Start and slope of each segment, the slope in 1/256 speed factor per code above `steady`.
    entries: Vec<(i64, i64)>,
    floor: f64,
}

/// Binary logarithm of the codes in a segment: the low byte of the code is the position in it.
const BITS: u32 = 8;
/// Codes in a segment.
const CODES: usize = 1 << BITS;
/// Slopes that are tried on either side of the chord's. Set by hand.
const REACH: i64 = 3;
/// Name of the form.
pub(super) const NAME: &str = "segments";

pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    let chords = fit.target.chunks(CODES).filter(|cell| cell.len() > 1);
    let slopes = chords.map(|cell| (cell[cell.len() - 1] - cell[0]) / (cell.len() - 1) as f64);
    let slopes: Vec<f64> = slopes.collect();
    let steady = slopes.iter().copied().fold(f64::INFINITY, f64::min).floor();
    let fits = |slope: &f64| ((slope - steady) * CODES as f64).round() < CODES as f64;
    let narrow = fit.target.iter().all(|factor| *factor < 65_000.0);
    if !fit.core.byte_shifts
        || fit.target.len() <= CODES
        || steady < 0.0
        || !narrow
        || !slopes.iter().all(fits)
    {
        return Vec::new();
    }
    let steady = steady as i64;
    let mut segments = Segments {
        steady,
        entries: Vec::new(),
        floor: 0.0,
    };
    segments.refine(fit);
    vec![Box::new(segments)]
}

impl Segments {
    /// The factors of one cell less its start.
    fn rise(&self, slope: i64, within: usize) -> i64 {
        let within = within as i64;
        within * self.steady + ((within * slope) >> BITS)
    }

    /// The start that suits a slope best over the codes from `first`, and the error that is left \[unit\].
    fn center(&self, fit: &Fit<'_>, first: usize, slope: i64) -> (f64, i64) {
        let last = (first + CODES).min(fit.target.len());
        let rests =
            (first..last).map(|code| fit.target[code] - self.rise(slope, code - first) as f64);
        let (low, high) = rests.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), rest| {
            (rest.min(low), rest.max(high))
        });
        let start = f64::midpoint(low, high).round();
        let weight = fit.weight[first..last].iter().copied().fold(0.0, f64::max);
        ((high - start).max(start - low) * weight, start as i64)
    }

    /// The best segment over the codes from `first`.
    fn segment(&self, fit: &Fit<'_>, first: usize) -> (i64, i64) {
        let last = (first + CODES).min(fit.target.len()) - 1;
        let chord = (fit.target[last] - fit.target[first]) / (last - first).max(1) as f64;
        let ideal = ((chord - self.steady as f64) * CODES as f64).round() as i64;
        let ideal = ideal.clamp(0, CODES as i64 - 1); // a cell of one code has no chord
        let slopes =
            (ideal - REACH..=ideal + REACH).filter(|slope| (0..CODES as i64).contains(slope));
        let best = slopes
            .map(|slope| (self.center(fit, first, slope), slope))
            .min_by(|a, b| a.0.0.total_cmp(&b.0.0));
        best.map_or((0, 0), |((_, start), slope)| (start, slope))
    }
}

impl Form for Segments {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        format!("{} straight segments of {CODES} codes", self.entries.len())
    }

    fn parameters(&self) -> serde_json::Value {
        serde_json::json!({ "steady": self.steady, "entries": self.entries })
    }

    fn floor(&self) -> f64 {
        self.floor
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let code = temperature_index(builder);
        let cell = builder.shift_right(code, BITS);
        let cell = builder.name(cell, "cell", "index of the segment");
        let within = builder.low_bits(code, BITS);
        let within = builder.name(within, "within", "position in the segment [codes]");
        let note = "speed factor of each segment, extrapolated to temperature index 0 with the common slope";
        // A start that would be negative there makes the candidate impossible, not wrong.
        let back =
            |(cell, (start, _)): (usize, &(i64, i64))| start - self.steady * (cell * CODES) as i64;
        let starts = self.entries.iter().enumerate().map(back).collect();
        let starts = builder.table("start", note.into(), starts);
        let note = "slope of each segment above the common slope [1/256 speed factor per code]";
        let slopes = self.entries.iter().map(|(_, slope)| *slope).collect();
        let slopes = builder.table("slope", note.into(), slopes);
        let start = builder.load(starts, cell);
        let slope = builder.load(slopes, cell);
        let product = builder.multiply(within, slope);
        let rise = builder.shift_right(product, BITS);
        let rise = builder.name(rise, "rise", "contribution of the segment's own slope");
        let base = builder.add(start, rise);
        let steady = builder.constant(self.steady);
        let steady = builder.multiply(code, steady);
        builder.add(base, steady)
    }

    fn refine(&mut self, fit: &Fit<'_>) {
        let starts = (0..fit.target.len()).step_by(CODES);
        self.entries = starts.map(|first| self.segment(fit, first)).collect();
    }

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(self.clone())
    }
}

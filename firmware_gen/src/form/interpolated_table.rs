//! A uniform table with a power of two of codes between entries, linear between them.

use super::contract::{Fit, Form};
use super::steps::{floor_shift, temperature_index};
use crate::ir::{Builder, Value};

/// A uniform table with linear interpolation.
#[derive(Clone, Debug)]
struct InterpolatedTable {
    /// Binary logarithm of the number of codes between entries.
    bits: u32,
    entries: Vec<i64>,
    floor: f64,
}

/// Most passes of the joint rounding over all entries; it stops earlier if nothing improves. Set by hand.
const PASSES: usize = 12;
/// Name of the form.
pub(super) const NAME: &str = "interpolated_table";

pub(super) fn propose(fit: &Fit<'_>) -> Vec<Box<dyn Form>> {
    let largest = usize::BITS - fit.target.len().leading_zeros();
    (1..largest)
        .map(|bits| Box::new(InterpolatedTable::new(fit, bits)) as _)
        .collect()
}

/// The target at `index`, continued in a straight line past its end.
fn extend(target: &[f64], index: usize) -> f64 {
    let last = target.len() - 1;
    if index <= last || last == 0 {
        return target[index.min(last)];
    }
    let slope = target[last] - target[last - 1];
    slope.mul_add((index - last) as f64, target[last])
}

/// The deviation of the target from the chord of a cell: the sum of its extremes, and half their difference \[unit\].
fn sag(fit: &Fit<'_>, entries: &[f64], left: usize, step: usize) -> (f64, f64) {
    let (mut low, mut high, mut weight) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for within in 0..step.min(fit.target.len() - left * step) {
        let share = within as f64 / step as f64;
        let chord = (entries[left + 1] - entries[left]).mul_add(share, entries[left]);
        let deviation = fit.target[left * step + within] - chord;
        (low, high) = (low.min(deviation), high.max(deviation));
        weight = weight.min(fit.weight[left * step + within]);
    }
    // No line does better over a convex cell than half its bulge; ends shared with neighbors only make it worse.
    (low + high, (high - low) / 2.0 * weight)
}

impl InterpolatedTable {
    /// Entries on the target, moved so that the middle and the ends of a cell share its bulge.
    fn new(fit: &Fit<'_>, bits: u32) -> Self {
        let step = 1_usize << bits;
        let count = (fit.target.len() - 1) / step + 2;
        let entries: Vec<f64> = (0..count)
            .map(|entry| extend(&fit.target, entry * step))
            .collect();
        let sags: Vec<(f64, f64)> = (0..count - 1)
            .map(|left| sag(fit, &entries, left, step))
            .collect();
        let shift = |entry: usize| {
            let cells = &sags[entry.saturating_sub(1)..(entry + 1).min(count - 1)];
            cells.iter().map(|(bulge, _)| bulge).sum::<f64>() / cells.len() as f64 / 2.0
        };
        let shifted = entries
            .iter()
            .enumerate()
            .map(|(k, entry)| (entry + shift(k)).round() as i64);
        let floor = sags
            .iter()
            .fold(0.0_f64, |worst, (_, spread)| worst.max(*spread));
        Self {
            bits,
            entries: shifted.collect(),
            floor,
        }
    }

    /// The largest error over the cells that touch entry `entry`.
    fn error_near(&self, fit: &Fit<'_>, entry: usize) -> f64 {
        let step = 1_usize << self.bits;
        let first = entry.saturating_sub(1) * step;
        let last = ((entry + 1) * step).min(fit.target.len());
        (first..last).fold(0.0, |worst, code| {
            let (cell, within) = (code >> self.bits, (code & (step - 1)) as i64);
            let rise = self.entries[cell + 1] - self.entries[cell];
            let factor = self.entries[cell] + ((within * rise) >> self.bits);
            ((factor as f64 - fit.target[code]) * fit.weight[code])
                .abs()
                .max(worst)
        })
    }
}

impl Form for InterpolatedTable {
    fn name(&self) -> &'static str {
        NAME
    }

    fn describe(&self) -> String {
        format!(
            "table of {} speed factors, {} codes apart, linear between them",
            self.entries.len(),
            1 << self.bits
        )
    }

    fn parameters(&self) -> serde_json::Value {
        serde_json::json!({ "step_bits": self.bits, "entries": self.entries })
    }

    fn floor(&self) -> f64 {
        self.floor
    }

    fn build(&self, builder: &mut Builder<'_>) -> Value {
        let code = temperature_index(builder);
        let note = format!("speed factor, one entry every {} codes", 1 << self.bits);
        let table = builder.table("speed", note, self.entries.clone());
        let cell = builder.shift_right(code, self.bits);
        let cell = builder.name(cell, "cell", "index of the table interval");
        let within = builder.low_bits(code, self.bits);
        let within = builder.name(within, "within", "position in the interval [codes]");
        let low = builder.load(table, cell);
        let low = builder.name(low, "low", "speed factor at the start of the interval");
        let one = builder.constant(1);
        let next = builder.add(cell, one);
        let high = builder.load(table, next);
        let rise = builder.subtract(high, low);
        let rise = builder.name(rise, "rise", "change of the speed factor over the interval");
        let product = builder.multiply(within, rise);
        let lift = floor_shift(builder, product, self.bits);
        builder.add(low, lift)
    }

    fn refine(&mut self, fit: &Fit<'_>) {
        for _ in 0..PASSES {
            let before = self.entries.clone();
            for entry in 0..self.entries.len() {
                let start = self.entries[entry];
                let mut best = (self.error_near(fit, entry), start);
                for given in [start - 2, start - 1, start + 1, start + 2] {
                    self.entries[entry] = given.max(0);
                    let error = self.error_near(fit, entry);
                    best = if error < best.0 {
                        (error, self.entries[entry])
                    } else {
                        best
                    };
                }
                self.entries[entry] = best.1;
            }
            if before == self.entries {
                return;
            }
        }
    }

    fn duplicate(&self) -> Box<dyn Form> {
        Box::new(self.clone())
    }
}

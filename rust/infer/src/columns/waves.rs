//! Waves of a column: sines and cosines of its multiples (docs/method/rows-and-candidates.md, after Eq. 2a).
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use echocal_core::batch::Line;

/// A column, its period, and the first row of a block.
type Key = (usize, f64, usize);

/// Phase of one block of a column, as sine and cosine of the fundamental.
pub(super) struct Waves {
    key: Option<Key>,
    sine: Line,
    cosine: Line,
}

impl Default for Waves {
    fn default() -> Self {
        let [sine, cosine] = [0.0, 1.0].map(Line::of);
        let key = None;
        Self { key, sine, cosine }
    }
}

impl Waves {
    /// Sine, or cosine, of a multiple of the phase.
    pub fn of(
        &mut self,
        key: Key,
        values: &[f64],
        (multiple, cosine): (usize, bool),
        into: &mut Line,
    ) {
        if self.key != Some(key) {
            let rows = self.sine.0.iter_mut().zip(&mut self.cosine.0);
            for ((sine, cosine), &value) in rows.zip(values) {
                (*sine, *cosine) = fundamental(value, key.1);
            }
            self.key = Some(key);
        }
        let rows = self.sine.0.iter().zip(&self.cosine.0);
        for (wave, (&sine, &one)) in into.0[..values.len()].iter_mut().zip(rows) {
            let found = multiplied((sine, one), multiple);
            *wave = if cosine { found.1 } else { found.0 };
        }
    }
}

/// Sine and cosine of a value's phase in its period.
fn fundamental(value: f64, period: f64) -> (f64, f64) {
    let turns = value / period;
    ((turns - turns.floor()) * core::f64::consts::TAU).sin_cos()
}

/// Sine and cosine of a multiple of a phase, by the addition theorem.
#[inline(always)]
fn multiplied((sine, cosine): (f64, f64), multiple: usize) -> (f64, f64) {
    let (mut s, mut c) = (sine, cosine);
    for _ in 1..multiple {
        (s, c) = (s * cosine + c * sine, c * cosine - s * sine);
    }
    (s, c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn multiples_of_a_phase() {
        let hours = [0.0, 3.0, 25.5, 47.0];
        let mut waves = Waves::default();
        for multiple in 1..4 {
            for (place, at) in [f64::sin, f64::cos].into_iter().enumerate() {
                let mut line = Line::of(0.0);
                waves.of((0, 24.0, 0), &hours, (multiple, place == 1), &mut line);
                for (found, hour) in line.0.iter().zip(hours) {
                    let phase = core::f64::consts::TAU * multiple as f64 * hour / 24.0;
                    assert!((found - at(phase)).abs() < 1e-14, "{multiple} {hour}");
                }
            }
        }
    }
}

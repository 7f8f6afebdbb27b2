//! Legendre polynomials of a column: docs/method/rows-and-candidates.md, Eq. 2a.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use echocal_core::batch::Line;

/// A column, the values that are scaled to -1 and 1, and the first row of a block.
type Key = (usize, (f64, f64), usize);

/// Polynomials of one block of a column, each from the two before it.
pub(super) struct Polynomials {
    key: Option<Key>,
    degree: usize,
    x: Line,
    before: Line,
    now: Line,
}

impl Default for Polynomials {
    fn default() -> Self {
        let [x, before, now] = [0.0, 0.0, 1.0].map(Line::of);
        Self {
            key: None,
            degree: 0,
            x,
            before,
            now,
        }
    }
}

impl Polynomials {
    /// Scaled values and the polynomial of a degree; ascending degrees cost one step each.
    #[inline(always)]
    pub fn of(&mut self, key: Key, values: &[f64], degree: usize) -> (&Line, &Line) {
        if self.key != Some(key) || degree < self.degree {
            *self = Self {
                key: Some(key),
                ..Self::default()
            };
            for (x, &value) in self.x.0.iter_mut().zip(values) {
                *x = scaled(value, key.1);
            }
        }
        while self.degree < degree {
            let factors = factors(self.degree);
            let rows = self.before.0.iter_mut().zip(&mut self.now.0);
            for ((before, now), &x) in rows.zip(&self.x.0) {
                (*before, *now) = (*now, next(factors, x, *now, *before));
            }
            self.degree += 1;
        }
        (&self.x, &self.now)
    }
}

/// Scaled values are cut off there: far ones must not bend a curve.
const CLIP: f64 = 1.5;

/// A value between two others as -1 to 1.
fn scaled(value: f64, (low, high): (f64, f64)) -> f64 {
    ((2.0 * value - low - high) / (high - low).max(1e-300)).clamp(-CLIP, CLIP)
}

/// What the polynomial of a degree, times x, and the one before are multiplied with, to give the next.
fn factors(degree: usize) -> (f64, f64) {
    let n = degree as f64;
    ((2.0 * n + 1.0) / (n + 1.0), n / (n + 1.0))
}

/// Bonnet's recursion.
#[inline(always)]
fn next((ahead, behind): (f64, f64), x: f64, now: f64, before: f64) -> f64 {
    ahead * x * now - behind * before
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_as_printed() {
        // Abramowitz & Stegun 1964, table 22.9
        let values = [0.7, 1.0, -0.3];
        let mut found = Polynomials::default();
        let key = (0, (-1.0, 1.0), 0);
        for (degree, expected) in [
            (3, (5.0 * 0.7_f64.powi(3) - 3.0 * 0.7) / 2.0),
            (
                5,
                (63.0 * 0.7_f64.powi(5) - 70.0 * 0.7_f64.powi(3) + 15.0 * 0.7) / 8.0,
            ),
            (2, (3.0 * 0.7_f64.powi(2) - 1.0) / 2.0),
        ] {
            let (x, polynomial) = found.of(key, &values, degree);
            assert!((x.0[0] - 0.7).abs() < 1e-15);
            assert!((polynomial.0[0] - expected).abs() < 1e-15);
            assert!((polynomial.0[1] - 1.0).abs() < 1e-15);
        }
        assert_eq!(scaled(9.0, (1.0, 5.0)), 1.5);
    }
}

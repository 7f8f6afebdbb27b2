//! Legendre polynomials of a column: docs/method/rows-and-candidates.md, Eq. 2a.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call
#![allow(clippy::needless_range_loop)] // plain loops over constant sizes stay in registers

use super::sampling::spread;
use echocal_core::batch::Line;

/// Rows whose polynomials go on at the same time, because each waits for its own last one: a vector of
/// AVX-512.
const ABREAST: usize = 8;

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

/// Sums of the polynomials up to a degree, and of their products with x, over rows in groups.
fn moments<const N: usize>(degrees: usize, rows: &[[f64; N]]) -> Vec<(f64, f64)> {
    let steps: Vec<_> = (0..degrees).map(factors).collect();
    let mut sums = vec![([0.0; N], [0.0; N]); degrees];
    for x in rows {
        let (mut before, mut now) = ([0.0; N], [1.0; N]);
        for ((p1, px), &factors) in sums.iter_mut().zip(&steps) {
            for i in 0..N {
                p1[i] += now[i];
                px[i] += now[i] * x[i];
                (before[i], now[i]) = (now[i], next(factors, x[i], now[i], before[i]));
            }
        }
    }
    let whole = |sums: ([f64; N], [f64; N])| (sums.0.iter().sum(), sums.1.iter().sum());
    sums.into_iter().map(whole).collect()
}

/// Straight lines, or means alone, that are nearest to the polynomials of some degrees over the
/// rows; of many rows, over some evenly spread.
pub fn legendre_lines(
    degrees: core::ops::Range<usize>,
    column: &[f64],
    between: (f64, f64),
    tilted: bool,
) -> Vec<(f64, f64)> {
    let values: Vec<f64> = spread(column).map(|value| scaled(value, between)).collect();
    let n = values.len() as f64;
    let (x1, x2) = (
        values.iter().sum::<f64>(),
        values.iter().map(|x| x * x).sum::<f64>(),
    );
    let (many, rest) = values.as_chunks::<ABREAST>();
    let mut sums = moments(degrees.end, many);
    for (sum, more) in sums
        .iter_mut()
        .zip(moments(degrees.end, rest.as_chunks::<1>().0))
    {
        *sum = (sum.0 + more.0, sum.1 + more.1);
    }
    let spread = n * x2 - x1 * x1;
    let line = |&(p1, px): &(f64, f64)| {
        let slope = if tilted && spread > 0.0 {
            (n * px - x1 * p1) / spread
        } else {
            0.0
        };
        ((p1 - slope * x1) / f64::max(n, 1.0), slope)
    };
    sums[degrees.start.min(degrees.end)..]
        .iter()
        .map(line)
        .collect()
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

    #[test]
    fn the_nearest_straight_line() {
        let even: Vec<f64> = (-500..=500).map(f64::from).collect();
        let between = (-500.0, 500.0);
        // 3/5 of x^3 is x: 5/2 3/5 - 3/2
        let (level, slope) = legendre_lines(3..4, &even, between, true)[0];
        assert!(level.abs() < 1e-12 && slope.abs() < 1e-2);
        let flat = legendre_lines(1..4, &even, between, false);
        assert!(flat.len() == 3 && flat.iter().all(|line| line.1 == 0.0));
    }
}

//! Basis functions of a column, not centered, for a few rows: docs/method/rows-and-candidates.md,
//! Eq. 2a without the means.
//!
//! The columns of a table have the same functions, made block by block where a pass needs them.

use super::legendre::polynomials;
use super::waves::waves;

/// Legendre polynomials of a column between two values, one per scale, from the first degree on; one
/// function after the other.
#[must_use]
pub fn legendre_values(values: &[f64], between: (f64, f64), scales: &[f64]) -> Vec<f64> {
    let mut found = vec![0.0; values.len() * scales.len()];
    for (row, &value) in values.iter().enumerate() {
        let own = polynomials(value, between).skip(1);
        for (degree, (scale, function)) in scales.iter().zip(own).enumerate() {
            found[degree * values.len() + row] = scale * function;
        }
    }
    found
}

/// Sine and cosine of multiples of a column's phase in its period, from the first on, one pair per
/// scale; one function after the other.
#[must_use]
pub fn wave_values(values: &[f64], period: f64, scales: &[f64]) -> Vec<f64> {
    let mut found = vec![0.0; 2 * values.len() * scales.len()];
    for (row, &value) in values.iter().enumerate() {
        for (multiple, (scale, (sine, cosine))) in
            scales.iter().zip(waves(value, period)).enumerate()
        {
            found[2 * multiple * values.len() + row] = scale * sine;
            found[(2 * multiple + 1) * values.len() + row] = scale * cosine;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_one_after_the_other() {
        let found = legendre_values(&[3.0, 9.0], (1.0, 5.0), &[2.0, 4.0]);
        // 3 is 0, and 9 is cut off at 1.5: P_1 = x, P_2 = (3 x^2 - 1) / 2
        assert_eq!(found, [0.0, 3.0, -2.0, 4.0 * 0.5 * (3.0 * 2.25 - 1.0)]);
    }

    #[test]
    fn waves_one_after_the_other() {
        let found = wave_values(&[3.0, 30.0], 24.0, &[1.0, 10.0]);
        let expected = |hour: f64, multiple: f64| {
            let phase = core::f64::consts::TAU * multiple * hour / 24.0;
            (phase.sin(), phase.cos())
        };
        for (row, hour) in [3.0, 30.0].into_iter().enumerate() {
            for (at, (multiple, scale)) in [(1.0, 1.0), (2.0, 10.0)].into_iter().enumerate() {
                let (sine, cosine) = expected(hour, multiple);
                assert!((found[4 * at + row] - scale * sine).abs() < 1e-13);
                assert!((found[4 * at + 2 + row] - scale * cosine).abs() < 1e-13);
            }
        }
    }
}

//! The normal distribution.

use core::f64::consts::FRAC_1_SQRT_2;

/// Probability that a standard normal number lies between `low` and `high`.
pub(crate) fn between(low: f64, high: f64) -> f64 {
    if low > 0.0 {
        return between(-high, -low); // both tails are small numbers there: nothing cancels
    }
    if low < -ALL && high > -0.5 {
        return below(high); // what is lost is less than rounding
    }
    below(high) - below(low)
}

/// Standard deviations beyond which the tail, 1e-17, is lost beside one: half the spacing of doubles
/// there is 1.1e-16.
const ALL: f64 = 8.5;

fn below(x: f64) -> f64 {
    if x > ALL {
        return 1.0;
    }
    0.5 * libm::erfc(-x * FRAC_1_SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::between;

    #[test]
    fn known_probabilities() {
        // Abramowitz & Stegun 1964, table 26.1
        assert!((between(-1.0, 1.0) - 0.682_689_492_137_086).abs() < 1e-15);
        assert!((between(f64::NEG_INFINITY, 1.5) - 0.933_192_798_731_142).abs() < 1e-15);
        let tail = between(10.0, f64::INFINITY);
        assert!((tail / 7.619_853_024_160_526e-24 - 1.0).abs() < 1e-12);
        assert_eq!(between(f64::NEG_INFINITY, f64::INFINITY), 1.0);
    }
}

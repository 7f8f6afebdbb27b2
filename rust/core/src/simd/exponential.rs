//! The exponential function without branches or tables, in single and double precision.
//!
//! `exp(x) = 2^n exp(r)` with `n` the integer nearest to `x / ln 2` and `|r| <= ln(2) / 2`. The
//! polynomials `1 + r + r^2 q(r)` are minimax in relative error, from a Remez exchange with 50
//! digits; the products are grouped in pairs (Estrin), which shortens the chain of dependent
//! operations. Results below twice the smallest normal number are flushed to zero.

use super::Float;
use core::f64::consts::LOG2_E;

/// Exponential in double precision, within 6e-16 relative.
#[inline(always)]
pub(crate) fn exp64<F: Float>(x: F) -> F {
    /// Minimax of degree 11: 7.7e-18 relative before rounding.
    const Q: [f64; 10] = [
        0.500_000_000_000_001,
        0.166_666_666_666_666_74,
        0.041_666_666_666_521_99,
        0.008_333_333_333_322_207,
        0.001_388_888_894_782_089_1,
        0.000_198_412_698_865_91,
        2.480_148_732_601_234_3e-5,
        2.755_724_233_668_041e-6,
        2.763_265_575_933_008_3e-7,
        2.511_004_989_583_968e-8,
    ];
    /// 1.5 * 2^52 + 1022: the sum's lowest bits become the exponent field of 2^(n - 1).
    const ROUND: f64 = 6_755_399_441_055_744.0 + 1022.0;
    /// ln 2 in two parts; n times the first is exact (fdlibm's split, 20 bits free).
    const LN2: (f64, f64) = (6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10);

    let k = F::constant;
    // Below, 2^(n - 1) is exactly zero; above, 2^1023 times 2 exp(r) overflows to infinity.
    let x = x.within(-708.3, 710.0);
    let rounded = x.mul_add(k(LOG2_E), k(ROUND));
    let n = rounded - k(ROUND);
    let r = n.mul_add(k(-LN2.1), n.mul_add(k(-LN2.0), x));
    let square = r * r;
    let fourth = square * square;
    let low = pair([Q[2], Q[3]], r).mul_add(square, pair([Q[0], Q[1]], r));
    let high = pair([Q[6], Q[7]], r).mul_add(square, pair([Q[4], Q[5]], r));
    let q = pair([Q[8], Q[9]], r)
        .mul_add(fourth, high)
        .mul_add(fourth, low);
    finish(rounded, q.mul_add(square, r))
}

/// Exponential in single precision, within 1.5e-7 relative.
#[inline(always)]
pub(crate) fn exp32<F: Float>(x: F) -> F {
    /// Minimax of degree 6: 3.1e-9 relative before rounding.
    const Q: [f64; 5] = [
        0.499_999_934_477_964_87,
        0.166_665_206_317_096_97,
        0.041_668_388_045_313_996,
        0.008_368_716_879_728_14,
        0.001_381_459_864_666_403_4,
    ];
    /// 1.5 * 2^23 + 126, as for double precision.
    const ROUND: f64 = 12_582_912.0 + 126.0;
    /// ln 2 in two parts; n times the first is exact (Cephes expf).
    const LN2: (f64, f64) = (0.693_359_375, -2.121_944_4e-4);

    let k = F::constant;
    let x = x.within(-87.3, 89.0);
    let rounded = x.mul_add(k(LOG2_E), k(ROUND));
    let n = rounded - k(ROUND);
    let r = n.mul_add(k(-LN2.1), n.mul_add(k(-LN2.0), x));
    let square = r * r;
    let q = k(Q[4])
        .mul_add(square, pair([Q[2], Q[3]], r))
        .mul_add(square, pair([Q[0], Q[1]], r));
    finish(rounded, q.mul_add(square, r))
}

/// `low + high r`.
#[inline(always)]
fn pair<F: Float>([low, high]: [f64; 2], r: F) -> F {
    F::constant(high).mul_add(r, F::constant(low))
}

/// `2^n (1 + rest)`, from twice `2^(n - 1)` so that n = 1024 does not overflow too early.
#[inline(always)]
fn finish<F: Float>(rounded: F, rest: F) -> F {
    let half = rounded.power_of_two();
    let half_result = rest.mul_add(half, half);
    half_result + half_result
}

macro_rules! float_of {
    ($float:ty, $bits:ty, $mantissa:literal) => {
        impl Float for $float {
            #[inline(always)]
            #[allow(clippy::cast_possible_truncation)]
            fn within(self, low: f64, high: f64) -> Self {
                let (low, high) = (low as $float, high as $float);
                let x = if self < low { low } else { self };
                if x > high { high } else { x }
            }
            #[inline(always)]
            fn power_of_two(self) -> Self {
                <$float>::from_bits(self.to_bits() << $mantissa)
            }
        }
    };
}

float_of!(f64, u64, 52);
float_of!(f32, u32, 23);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100_000))]

        /// The standard library's exp is the oracle: correctly rounded to 1.2e-16 at worst.
        #[test]
        fn double_is_within_six_in_ten_to_the_sixteenth(x in -707.0..709.7_f64) {
            prop_assert!((exp64(x) / x.exp() - 1.0).abs() <= 6e-16);
        }

        #[test]
        fn single_is_within_one_and_a_half_in_ten_to_the_seventh(x in -86.6..88.7_f32) {
            let exact = f64::from(x).exp();
            prop_assert!((f64::from(exp32(x)) / exact - 1.0).abs() <= 1.5e-7);
        }
    }

    #[test]
    fn edges() {
        assert!(exp64(f64::NAN).is_nan() && exp32(f32::NAN).is_nan());
        assert!(exp64(f64::from_bits(0x7ff8_0000_0000_0123)).is_nan());
        assert_eq!(exp64(f64::INFINITY), f64::INFINITY);
        assert_eq!(exp64(709.79), f64::INFINITY);
        assert!(exp64(709.78_f64).is_finite());
        assert_eq!(exp64(f64::NEG_INFINITY), 0.0);
        assert_eq!(exp64(0.0), 1.0);
        assert_eq!(exp32(f32::INFINITY), f32::INFINITY);
        assert!(exp32(88.72_f32).is_finite());
        assert_eq!(exp32(f32::NEG_INFINITY), 0.0);
        assert_eq!(exp32(0.0_f32), 1.0);
    }
}

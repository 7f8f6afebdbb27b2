//! Functions of one number without a branch: loops over several numbers become vector instructions.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

/// Natural logarithm of a normal positive number: fdlibm's `e_log.c` (Sun Microsystems 1993), whose
/// polynomial in `s = f / (2 + f)` is within 2^-58.45 for `1 + f` between the roots of 1/2 and 2.
#[inline(always)]
pub(crate) fn ln(x: f64) -> f64 {
    const LG: [f64; 7] = [
        6.666_666_666_666_735e-1,
        3.999_999_999_940_942e-1,
        2.857_142_874_366_239e-1,
        2.222_219_843_214_978_4e-1,
        1.818_357_216_161_805e-1,
        1.531_383_769_920_937_3e-1,
        1.479_819_860_511_658_6e-1,
    ];
    /// Bits of the root of 1/2: what lies above belongs to the next power of two.
    const ROOT: u64 = 0x3fe6_a09e_667f_3bcd;
    /// 2^52 as a float has its integer part in the lowest bits; less the bias of the exponent.
    const WHOLE: (u64, f64) = (0x4330_0000_0000_0000, 4_503_599_627_370_496.0 + 1023.0);
    let above = x.to_bits().wrapping_sub(ROOT).wrapping_add(1023 << 52);
    let power = f64::from_bits(above >> 52 | WHOLE.0) - WHOLE.1;
    let mantissa = f64::from_bits((above & ((1 << 52) - 1)).wrapping_add(ROOT));
    let f = mantissa - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let w = z * z;
    let even = w * (LG[1] + w * (LG[3] + w * LG[5]));
    let odd = z * (LG[0] + w * (LG[2] + w * (LG[4] + w * LG[6])));
    let half = 0.5 * f * f;
    power * LN2.0 - ((half - (s * (half + even + odd) + power * LN2.1)) - f)
}

/// ln 2 in two parts: a power of two times the first is exact.
const LN2: (f64, f64) = (6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10);

/// Exponential that saturates: positive and finite for every number, `exp(-700)` below -700 and
/// `exp(700)` above 700. fdlibm's `e_exp.c` (Sun Microsystems 1993), within 2^-59 before rounding.
///
/// The physics has another one, `exp64` of `echocal-core`, and the two differ in what they compute.
/// That one goes down to zero and up to infinity, and is made of fused operations, each of them a call
/// of some 3 ns on a processor without FMA. This one fuses nothing, so that it stays inline arithmetic
/// on every instruction set: a search takes one for each noise of each hypothesis. A weight that is
/// never zero keeps a quotient of weights a number.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    const P: [f64; 5] = [
        1.666_666_666_666_660_2e-1,
        -2.777_777_777_701_559_3e-3,
        6.613_756_321_437_934e-5,
        -1.653_390_220_546_525_2e-6,
        4.138_136_797_057_238_5e-8,
    ];
    /// 1.5 times 2^52: a sum's lowest bits are the nearest integer.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    let x = if x > -700.0 { x } else { -700.0 };
    let x = if x < 700.0 { x } else { 700.0 };
    let rounded = x * core::f64::consts::LOG2_E + ROUND;
    let power = rounded - ROUND;
    let (high, low) = (x - power * LN2.0, power * LN2.1);
    let r = high - low;
    let t = r * r;
    let c = r - t * (P[0] + t * (P[1] + t * (P[2] + t * (P[3] + t * P[4]))));
    let scale = f64::from_bits(rounded.to_bits().wrapping_add(1023) << 52);
    (1.0 - ((low - r * c / (2.0 - c)) - high)) * scale
}

/// Probability that a standard normal number is above `x`, which is not negative.
///
/// `exp(-x^2 / 2) t r(t)` with `t = 1 / (1 + x / 4)`, `r` a polynomial in `2 t - 1` from a
/// least-squares fit at 53 Chebyshev points: within 6e-11 relative (the form: Shepherd and Laframboise
/// 1981, Mathematics of Computation 36, 249, doi:10.1090/S0025-5718-1981-0595058-X).
#[inline(always)]
pub(crate) fn tail(x: f64) -> f64 {
    const R: [f64; 14] = [
        7.963_804_191_242_963e-7,
        -5.854_917_228_542_621e-8,
        -7.884_236_827_049_472e-6,
        -2.571_730_181_040_677e-7,
        5.712_943_207_490_035e-5,
        3.321_586_748_991_959e-5,
        -4.074_518_874_377_85e-4,
        -8.698_863_061_464_923e-4,
        1.884_995_760_885_293_3e-3,
        1.509_913_809_332_039_6e-2,
        4.663_046_913_650_7e-2,
        9.678_435_051_863_082e-2,
        1.519_741_603_716_209e-1,
        1.888_212_826_006_549_5e-1,
    ];
    let t = 1.0 / (1.0 + 0.25 * x);
    let s = 2.0 * t - 1.0;
    let r = R[1..].iter().fold(R[0], |sum, &next| sum * s + next);
    exp(-0.5 * x * x) * t * r
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithms() {
        let numbers = (0..200_000).map(|n| (f64::from(n) * 0.003_7 - 370.0).exp2());
        let near_one = (0..2000).map(|n| 1.0 + (f64::from(n) - 1000.0) * 1e-6);
        for x in numbers.chain(near_one).chain([f64::MIN_POSITIVE, f64::MAX]) {
            let (own, right) = (ln(x), x.ln());
            assert!(
                (own - right).abs() <= 2.0 * f64::EPSILON * right.abs(),
                "{x}"
            );
        }
    }

    #[test]
    fn exponentials() {
        for x in (-70_000..=70_000).map(|n| f64::from(n) * 0.01) {
            assert!((exp(x) / x.exp() - 1.0).abs() <= 3.0 * f64::EPSILON, "{x}");
        }
        assert_eq!(exp(f64::NEG_INFINITY), exp(-700.0));
        assert_eq!(exp(1e9), exp(700.0));
    }

    #[test]
    fn tails() {
        for x in (0..=3700).map(|n| f64::from(n) * 0.01) {
            let right = 0.5 * libm::erfc(x * core::f64::consts::FRAC_1_SQRT_2);
            assert!((tail(x) / right - 1.0).abs() < 1e-10, "{x}");
        }
        assert!(tail(f64::INFINITY) < 1e-300);
    }
}

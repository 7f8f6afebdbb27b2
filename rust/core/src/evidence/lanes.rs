//! Several numbers side by side: the same arithmetic for several noises at once.
#![allow(clippy::suboptimal_flops)] // without FMA every fused product is a call

use core::ops::{Add, Div, Mul, Sub};

/// Numbers side by side.
pub(super) const LANES: usize = 8;

/// One number for each of several noises; loops over them become vector instructions.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Lane(pub [f64; LANES]);

impl Lane {
    #[inline(always)]
    pub fn all(value: f64) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub fn map(self, with: impl Fn(f64) -> f64) -> Self {
        Self(core::array::from_fn(|lane| with(self.0[lane])))
    }

    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.both(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    /// Natural logarithm, within two units of the last place.
    #[inline(always)]
    pub fn ln(self) -> Self {
        if self.0.iter().all(|x| x.is_normal() && *x > 0.0) {
            self.map(ln)
        } else {
            self.map(f64::ln)
        }
    }

    #[inline(always)]
    fn both(self, other: Self, with: impl Fn(f64, f64) -> f64) -> Self {
        Self(core::array::from_fn(|lane| {
            with(self.0[lane], other.0[lane])
        }))
    }
}

/// Natural logarithm of a normal positive number, without a branch: fdlibm's `e_log.c` (Sun
/// Microsystems 1993), whose polynomial in `s = f / (2 + f)` is within 2^-58.45 for `1 + f` between
/// the roots of 1/2 and 2.
#[inline(always)]
fn ln(x: f64) -> f64 {
    const LG: [f64; 7] = [
        6.666_666_666_666_735e-1,
        3.999_999_999_940_942e-1,
        2.857_142_874_366_239e-1,
        2.222_219_843_214_978_4e-1,
        1.818_357_216_161_805e-1,
        1.531_383_769_920_937_3e-1,
        1.479_819_860_511_658_6e-1,
    ];
    const LN2: (f64, f64) = (6.931_471_803_691_238e-1, 1.908_214_929_270_587_7e-10);
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

macro_rules! lane_by_lane {
    ($($operator:ident $name:ident $sign:tt),*) => {$(
        impl $operator for Lane {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.both(other, |a, b| a $sign b)
            }
        }
    )*};
}

lane_by_lane!(Add add +, Sub sub -, Mul mul *, Div div /);

/// `from - a b`, in four sums at once: one alone would wait for itself.
#[inline(always)]
pub(super) fn less(from: Lane, a: &[Lane], b: &[Lane]) -> Lane {
    let mut sums = [Lane::all(0.0); 4];
    let (a, b) = (a.chunks_exact(4), b.chunks_exact(4));
    let mut rest = from;
    for (a, b) in a.remainder().iter().zip(b.remainder()) {
        rest = rest - *a * *b;
    }
    if a.len() == 0 {
        return rest;
    }
    for (a, b) in a.zip(b) {
        for (sum, (a, b)) in sums.iter_mut().zip(a.iter().zip(b)) {
            *sum = *sum + *a * *b;
        }
    }
    rest - ((sums[0] + sums[1]) + (sums[2] + sums[3]))
}

/// Lower triangle of matrices of `order`, row by row, factored in place from a row on, where those
/// before are factored already; see [`super::cholesky::factor`].
#[inline(always)]
pub(super) fn factor(matrix: &mut [Lane], order: usize, added: &[Lane], from: usize) {
    for i in from..order {
        for j in 0..=i {
            let (own, other) = (&matrix[i * order..][..j], &matrix[j * order..][..j]);
            let sum = less(matrix[i * order + j], own, other);
            matrix[i * order + j] = if i == j {
                sum.max(added[i]).sqrt()
            } else {
                sum / matrix[j * order + j]
            };
        }
    }
}

/// Solves `L x = b` in place, where `b` is zero before `first`.
#[inline(always)]
pub(super) fn forward(lower: &[Lane], order: usize, b: &mut [Lane], first: usize) {
    for i in first..order {
        let mut sum = b[i];
        for k in first..i {
            sum = sum - lower[i * order + k] * b[k];
        }
        b[i] = sum / lower[i * order + i];
    }
}

/// Solves `L' x = b` in place.
#[inline(always)]
pub(super) fn backward(lower: &[Lane], order: usize, b: &mut [Lane]) {
    for i in (0..order).rev() {
        let mut sum = b[i];
        for k in i + 1..order {
            sum = sum - lower[k * order + i] * b[k];
        }
        b[i] = sum / lower[i * order + i];
    }
}

/// `(L L')^-1`, both triangles, with memory for the inverse of `L`.
#[inline(always)]
pub(super) fn invert(lower: &[Lane], order: usize, unit: &mut [Lane], into: &mut [Lane]) {
    for column in 0..order {
        for i in column..order {
            let start = if i == column { 1.0 } else { 0.0 };
            let mut sum = Lane::all(start);
            for k in column..i {
                sum = sum - lower[i * order + k] * unit[column * order + k];
            }
            unit[column * order + i] = sum / lower[i * order + i];
        }
    }
    for i in 0..order {
        for j in 0..=i {
            let mut sum = Lane::all(0.0);
            for k in i..order {
                sum = sum + unit[i * order + k] * unit[j * order + k];
            }
            into[i * order + j] = sum;
            into[j * order + i] = sum;
        }
    }
}

/// Makes a method run with the widest registers that this machine has.
macro_rules! on_widest {
    ($(#[$doc:meta])* $name:ident $wide:ident $wider:ident $inner:ident ($($given:ident: $type:ty),*) -> $made:ty) => {
        $(#[$doc])*
        pub fn $name(&mut self, $($given: $type),*) -> $made {
            match crate::simd::active() {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the instruction set is available.
                crate::simd::InstructionSet::Avx512 => unsafe { self.$wider($($given),*) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                crate::simd::InstructionSet::Avx2 => unsafe { self.$wide($($given),*) },
                _ => self.$inner($($given),*),
            }
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2")]
        unsafe fn $wide(&mut self, $($given: $type),*) -> $made {
            self.$inner($($given),*)
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2")]
        unsafe fn $wider(&mut self, $($given: $type),*) -> $made {
            self.$inner($($given),*)
        }
    };
}

pub(super) use on_widest;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::cholesky;

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
        let odd = Lane([0.0, f64::INFINITY, f64::NAN, -1.0, 5e-324, 1.0, 2.0, 3.0]).ln();
        assert_eq!(odd.0[..2], [f64::NEG_INFINITY, f64::INFINITY]);
        assert!(odd.0[2].is_nan() && odd.0[3].is_nan());
        assert_eq!(odd.0[4..], [5e-324_f64, 1.0, 2.0, 3.0].map(f64::ln));
    }

    #[test]
    fn an_inverse_by_hand() {
        let mut matrix = [4.0, 0.0, 0.0, 2.0, 5.0, 0.0, 0.0, 1.0, 3.0].map(Lane::all);
        factor(&mut matrix, 3, &[Lane::all(0.0); 3], 0);
        let (mut unit, mut found) = ([Lane::all(0.0); 9], [Lane::all(0.0); 9]);
        invert(&matrix, 3, &mut unit, &mut found);
        let expected = [14.0, -6.0, 2.0, -6.0, 12.0, -4.0, 2.0, -4.0, 16.0].map(|x| x / 44.0);
        for (found, right) in found.iter().zip(expected) {
            assert!((found.0[3] - right).abs() < 1e-15);
        }
    }

    #[test]
    fn every_lane_as_by_itself() {
        let matrix = |lane: usize| [4.0 + lane as f64, 0.0, 0.0, 2.0, 5.0, 0.0, 0.0, 1.0, 3.0];
        let mut lanes: Vec<Lane> = (0..9)
            .map(|at| Lane(core::array::from_fn(|lane| matrix(lane)[at])))
            .collect();
        factor(&mut lanes, 3, &[Lane::all(0.0); 3], 0);
        let mut solved = [1.0, -2.0, 0.5].map(Lane::all);
        forward(&lanes, 3, &mut solved, 0);
        backward(&lanes, 3, &mut solved);
        for lane in 0..LANES {
            let (mut own, mut b) = (matrix(lane), [1.0, -2.0, 0.5]);
            cholesky::factor(&mut own, 3, &[0.0; 3]);
            cholesky::forward(&own, 3, &mut b);
            cholesky::backward(&own, 3, &mut b);
            assert_eq!(solved.map(|x| x.0[lane]), b);
        }
    }
}

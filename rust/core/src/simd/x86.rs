//! The vectors of x86-64: AVX2 with FMA, and AVX-512.
//!
//! A value of one of these types may only come into being on a processor that has the
//! instructions: the dispatch in [`crate::batch`] is the only place that makes them, inside
//! functions compiled with the matching `target_feature`, where everything here is inlined.
#![allow(unsafe_code)]

use super::{Float, Vector, exp32, exp64};
use crate::scalar::{Rows, Scalar};
use core::arch::x86_64::*;
use core::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! operators {
    ($name:ident: $($trait:ident $method:ident $intrinsic:ident),+) => {
        $(impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: the module's rule, the processor has the instruction.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        })+
    };
}

macro_rules! vector {
    (
        $(#[$doc:meta])* $name:ident($register:ty) of $width:literal $float:ident;
        $add:ident $sub:ident $mul:ident $div:ident $fma:ident $sqrt:ident $min:ident $max:ident
        $xor:ident $andnot:ident $splat:ident $load:ident $store:ident;
        exp $exp:ident; select($condition:ident, $chosen:ident, $other:ident) $select:block power($x:ident) $power:expr; all($y:ident) $all:expr
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name($register);

        operators!($name: Add add $add, Sub sub $sub, Mul mul $mul, Div div $div);

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: the module's rule.
                Self(unsafe { $xor(self.0, $splat(-0.0)) })
            }
        }

        impl Scalar for $name {
            #[inline(always)]
            #[allow(clippy::cast_possible_truncation)]
            fn constant(value: f64) -> Self {
                // SAFETY: the module's rule.
                Self(unsafe { $splat(value as $float) })
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                // SAFETY: the module's rule.
                Self(unsafe { $fma(self.0, factor.0, term.0) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: the module's rule.
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                // SAFETY: the module's rule.
                Self(unsafe { $andnot($splat(-0.0), self.0) })
            }
            #[inline(always)]
            fn select($condition: Self, $chosen: Self, $other: Self) -> Self {
                let ($condition, $chosen, $other) = ($condition.0, $chosen.0, $other.0);
                // SAFETY: the module's rule.
                Self(unsafe { $select })
            }
        }

        impl Float for $name {
            #[inline(always)]
            fn within(self, low: f64, high: f64) -> Self {
                let (low, high) = (Self::constant(low), Self::constant(high));
                // SAFETY: the module's rule. Where one operand is NaN the second is the result.
                Self(unsafe { $min(high.0, $max(low.0, self.0)) })
            }
            #[inline(always)]
            fn power_of_two(self) -> Self {
                let $x = self.0;
                // SAFETY: the module's rule.
                Self(unsafe { $power })
            }
        }

        impl Rows for $name {
            #[inline(always)]
            fn all_non_negative(self) -> bool {
                let $y = self.0;
                // SAFETY: the module's rule.
                unsafe { $all }
            }
        }

        impl Vector for $name {
            type Element = $float;
            const WIDTH: usize = $width;
            #[inline(always)]
            unsafe fn load(source: *const $float) -> Self {
                // SAFETY: the caller guarantees the elements, the module's rule the instruction.
                Self(unsafe { $load(source) })
            }
            #[inline(always)]
            unsafe fn store(self, target: *mut $float) {
                // SAFETY: the caller guarantees the elements, the module's rule the instruction.
                unsafe { $store(target, self.0) }
            }
        }
    };
}

vector!(
    /// Four doubles in an AVX2 register.
    F64x4(__m256d) of 4 f64;
    _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_fmadd_pd _mm256_sqrt_pd
    _mm256_min_pd _mm256_max_pd _mm256_xor_pd _mm256_andnot_pd _mm256_set1_pd _mm256_loadu_pd
    _mm256_storeu_pd;
    exp exp64;
    select(condition, chosen, other) {
        _mm256_blendv_pd(other, chosen, _mm256_cmp_pd::<_CMP_GE_OQ>(condition, _mm256_setzero_pd()))
    }
    power(x) _mm256_castsi256_pd(_mm256_slli_epi64::<52>(_mm256_castpd_si256(x)));
    all(x) _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_GE_OQ>(x, _mm256_setzero_pd())) == 0xf
);

vector!(
    /// Eight singles in an AVX2 register.
    F32x8(__m256) of 8 f32;
    _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_fmadd_ps _mm256_sqrt_ps
    _mm256_min_ps _mm256_max_ps _mm256_xor_ps _mm256_andnot_ps _mm256_set1_ps _mm256_loadu_ps
    _mm256_storeu_ps;
    exp exp32;
    select(condition, chosen, other) {
        _mm256_blendv_ps(other, chosen, _mm256_cmp_ps::<_CMP_GE_OQ>(condition, _mm256_setzero_ps()))
    }
    power(x) _mm256_castsi256_ps(_mm256_slli_epi32::<23>(_mm256_castps_si256(x)));
    all(x) _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_GE_OQ>(x, _mm256_setzero_ps())) == 0xff
);

vector!(
    /// Eight doubles in an AVX-512 register.
    F64x8(__m512d) of 8 f64;
    _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_fmadd_pd _mm512_sqrt_pd
    _mm512_min_pd _mm512_max_pd _mm512_xor_pd _mm512_andnot_pd _mm512_set1_pd _mm512_loadu_pd
    _mm512_storeu_pd;
    exp exp64;
    select(condition, chosen, other) {
        let mask = _mm512_cmp_pd_mask::<_CMP_GE_OQ>(condition, _mm512_setzero_pd());
        _mm512_mask_blend_pd(mask, other, chosen)
    }
    power(x) _mm512_castsi512_pd(_mm512_slli_epi64::<52>(_mm512_castpd_si512(x)));
    all(x) _mm512_cmp_pd_mask::<_CMP_GE_OQ>(x, _mm512_setzero_pd()) == 0xff
);

vector!(
    /// Sixteen singles in an AVX-512 register.
    F32x16(__m512) of 16 f32;
    _mm512_add_ps _mm512_sub_ps _mm512_mul_ps _mm512_div_ps _mm512_fmadd_ps _mm512_sqrt_ps
    _mm512_min_ps _mm512_max_ps _mm512_xor_ps _mm512_andnot_ps _mm512_set1_ps _mm512_loadu_ps
    _mm512_storeu_ps;
    exp exp32;
    select(condition, chosen, other) {
        let mask = _mm512_cmp_ps_mask::<_CMP_GE_OQ>(condition, _mm512_setzero_ps());
        _mm512_mask_blend_ps(mask, other, chosen)
    }
    power(x) _mm512_castsi512_ps(_mm512_slli_epi32::<23>(_mm512_castps_si512(x)));
    all(x) _mm512_cmp_ps_mask::<_CMP_GE_OQ>(x, _mm512_setzero_ps()) == 0xffff
);

/// Lines for columns: four rows of four numbers, the other way round.
#[inline(always)]
pub(crate) fn transposed([F64x4(a), F64x4(b), F64x4(c), F64x4(d)]: [F64x4; 4]) -> [F64x4; 4] {
    // SAFETY: the module's rule.
    unsafe {
        let (ab, cd) = (_mm256_unpacklo_pd(a, b), _mm256_unpacklo_pd(c, d));
        let (ba, dc) = (_mm256_unpackhi_pd(a, b), _mm256_unpackhi_pd(c, d));
        [
            F64x4(_mm256_permute2f128_pd::<0x20>(ab, cd)),
            F64x4(_mm256_permute2f128_pd::<0x20>(ba, dc)),
            F64x4(_mm256_permute2f128_pd::<0x31>(ab, cd)),
            F64x4(_mm256_permute2f128_pd::<0x31>(ba, dc)),
        ]
    }
}

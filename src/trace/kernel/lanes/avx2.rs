//! Registers of 128 and 256 bits, for processors with AVX2 and FMA.

use std::{
    arch::x86_64::*,
    ops::{Add, Div, Mul, Sub},
};

use super::{Cpu, Lanes, register};

macro_rules! avx2 {
    ($name:ident, $scalar:ty, $register:ty, $width:literal, $set:ident, $load:ident, $store:ident,
     $add:ident, $sub:ident, $mul:ident, $div:ident, $fmadd:ident, $fmsub:ident, $fnmadd:ident,
     $sqrt:ident, $cmp:ident, $and:ident, $blend:ident) => {
        register!(
            $name,
            $scalar,
            $register,
            $width,
            $set,
            $load,
            $store,
            $add,
            $sub,
            $mul,
            $div,
            $fmadd,
            $fmsub,
            $fnmadd,
            $register,
            {
                #[inline(always)]
                fn sqrt_pair(a: Self, b: Self) -> [Self; 2] {
                    [a.sqrt(), b.sqrt()]
                }
                #[inline(always)]
                fn sqrt(self) -> Self {
                    // SAFETY: a vector exists only where `Cpu` did.
                    Self(unsafe { $sqrt(self.0) })
                }
                #[inline(always)]
                fn less(self, b: Self) -> Self::Mask {
                    // SAFETY: a vector exists only where `Cpu` did.
                    unsafe { $cmp::<_CMP_LT_OQ>(self.0, b.0) }
                }
                #[inline(always)]
                fn less_equal(self, b: Self) -> Self::Mask {
                    // SAFETY: a vector exists only where `Cpu` did.
                    unsafe { $cmp::<_CMP_LE_OQ>(self.0, b.0) }
                }
                #[inline(always)]
                fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
                    // SAFETY: masks come from comparing vectors, which exist only where `Cpu` did.
                    unsafe { $and(a, b) }
                }
                #[inline(always)]
                fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                    // SAFETY: a vector exists only where `Cpu` did.
                    Self(unsafe { $blend(no.0, yes.0, mask) })
                }
                #[inline(always)]
                fn or_zero(self, mask: Self::Mask) -> Self {
                    // SAFETY: a vector exists only where `Cpu` did.
                    Self(unsafe { $and(self.0, mask) })
                }
            }
        );
    };
}

avx2!(
    F32x4,
    f32,
    __m128,
    4,
    _mm_set1_ps,
    _mm_loadu_ps,
    _mm_storeu_ps,
    _mm_add_ps,
    _mm_sub_ps,
    _mm_mul_ps,
    _mm_div_ps,
    _mm_fmadd_ps,
    _mm_fmsub_ps,
    _mm_fnmadd_ps,
    _mm_sqrt_ps,
    _mm_cmp_ps,
    _mm_and_ps,
    _mm_blendv_ps
);
avx2!(
    F32x8,
    f32,
    __m256,
    8,
    _mm256_set1_ps,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_fmadd_ps,
    _mm256_fmsub_ps,
    _mm256_fnmadd_ps,
    _mm256_sqrt_ps,
    _mm256_cmp_ps,
    _mm256_and_ps,
    _mm256_blendv_ps
);
avx2!(
    F64x4,
    f64,
    __m256d,
    4,
    _mm256_set1_pd,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_div_pd,
    _mm256_fmadd_pd,
    _mm256_fmsub_pd,
    _mm256_fnmadd_pd,
    _mm256_sqrt_pd,
    _mm256_cmp_pd,
    _mm256_and_pd,
    _mm256_blendv_pd
);

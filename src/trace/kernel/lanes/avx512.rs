//! Registers of 512 bits, for processors with AVX-512F.
//!
//! The divider takes a square root at a time while the multipliers wait, so of each pair of roots
//! one goes through the divider and the other is computed: r ≈ 1/√a from the processor's table,
//! Newton's iterations on √a and 1/(2√a) coupled (R. E. Goldschmidt; P. Markstein, *IA-64 and
//! Elementary Functions*, 2000, ch. 9), and a last step from the exact residual a - g², which rounds
//! correctly.

use std::{
    arch::x86_64::*,
    ops::{Add, Div, Mul, Sub},
};

use super::{Cpu, Lanes, register};

macro_rules! avx512 {
    ($name:ident, $scalar:ty, $register:ty, $width:literal, $mask:ty, $set:ident, $load:ident, $store:ident,
     $add:ident, $sub:ident, $mul:ident, $div:ident, $fmadd:ident, $fmsub:ident, $fnmadd:ident,
     $sqrt:ident, $cmp:ident, $blend:ident, $move:ident, $rsqrt:ident, $iterations:literal) => {
        register!($name, $scalar, $register, $width, $set, $load, $store,
            $add, $sub, $mul, $div, $fmadd, $fmsub, $fnmadd, $mask, {
            #[inline(always)]
            fn sqrt_pair(a: Self, b: Self) -> [Self; 2] {
                [a.computed_sqrt(), b.sqrt()]
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
                a & b
            }
            #[inline(always)]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                // SAFETY: a vector exists only where `Cpu` did.
                Self(unsafe { $blend(mask, no.0, yes.0) })
            }
            #[inline(always)]
            fn or_zero(self, mask: Self::Mask) -> Self {
                // SAFETY: a vector exists only where `Cpu` did.
                Self(unsafe { $move(mask, self.0) })
            }
        });

        impl $name {
            /// The square root by multiplications; NaN at 0 and infinity. Correctly rounded for
            /// numbers above [`super::Scalar::NO_SQUARE`] whose square does not overflow.
            #[inline(always)]
            fn computed_sqrt(self) -> Self {
                // SAFETY: a vector exists only where `Cpu` did.
                let (y, half) = unsafe { (Self($rsqrt(self.0)), Self($set(0.5))) };
                let mut g = self * y;
                let mut h = y * half;
                for _ in 0..$iterations {
                    let r = g.neg_mul_add(h, half);
                    g = g.mul_add(r, g);
                    h = h.mul_add(r, h);
                }
                let residual = g.neg_mul_add(g, self);
                residual.mul_add(h, g)
            }
        }
    };
}

avx512!(
    F32x16, f32, __m512, 16, __mmask16, _mm512_set1_ps, _mm512_loadu_ps, _mm512_storeu_ps, _mm512_add_ps,
    _mm512_sub_ps, _mm512_mul_ps, _mm512_div_ps, _mm512_fmadd_ps, _mm512_fmsub_ps, _mm512_fnmadd_ps,
    _mm512_sqrt_ps, _mm512_cmp_ps_mask, _mm512_mask_blend_ps, _mm512_maskz_mov_ps, _mm512_rsqrt14_ps, 1
);
avx512!(
    F64x8, f64, __m512d, 8, __mmask8, _mm512_set1_pd, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_add_pd,
    _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd, _mm512_fmadd_pd, _mm512_fmsub_pd, _mm512_fnmadd_pd,
    _mm512_sqrt_pd, _mm512_cmp_pd_mask, _mm512_mask_blend_pd, _mm512_maskz_mov_pd, _mm512_rsqrt14_pd, 2
);

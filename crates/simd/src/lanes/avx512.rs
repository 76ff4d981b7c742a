//! Vectors in registers of 512 bits, for processors with AVX-512F.
//!
//! In double precision, the divider takes longer for a pair of square roots than the multipliers take for all other
//! operations. One root of each pair is therefore computed by multiplications. They start from y ≈ 1/√a, which the
//! processor's table gives. Two coupled steps of Newton's iteration improve g ≈ √a and h ≈ 1/(2√a). A last step, from
//! the exact residual a - g², gives the correctly rounded root (P. Markstein, *IA-64 and Elementary Functions*, 2000,
//! ch. 9). In single precision a root takes the divider half as long, so this method would not be faster.

use std::{
    arch::x86_64::*,
    ops::{Add, Div, Mul, Sub},
};

use super::{
    Compiled, Cpu, Indexed, Lanes, LookUp, apart,
    avx2::{F32x8, pairs_of_8, up_to_of_8},
    double_precision, intrinsics,
    look_up::lookup_methods,
    methods, register, single_precision,
};

/// Implements masks that are integers with one bit per lane, and the absolute value.
macro_rules! bit_masks {
    ($mask:ident: select $blend:ident, or_zero $move:ident; abs $abs:ident;) => {
        type Mask = $mask;

        methods! {
            fn select(mask: $mask, yes: Self, no: Self) -> Self = Self($blend(mask, no.0, yes.0));
            fn or_zero(self, mask: $mask) -> Self = Self($move(mask, self.0));
            fn abs(self) -> Self = Self($abs(self.0));
        }
        #[inline(always)]
        fn both(a: $mask, b: $mask) -> $mask {
            a & b
        }
        #[inline(always)]
        fn bits(mask: $mask) -> u32 {
            mask.into()
        }
    };
}

register! {
    F32x16, 16 lanes of f32 in __m512:
    Add add _mm512_add_ps, Sub sub _mm512_sub_ps, Mul mul _mm512_mul_ps, Div div _mm512_div_ps
}

impl LookUp for F32x16 {
    lookup_methods! {
        __m512i: _mm512_castps_si512; add _mm512_add_epi32, up to up_to_of_16;
        pairs_of_16, numbers => Self(numbers)
    }
}

impl Lanes for F32x16 {
    const PREPARED_TOGETHER: bool = false;
    apart!("avx512f,avx2,fma");
    intrinsics! {
        16 lanes of f32: splat _mm512_set1_ps;
        load _mm512_loadu_ps, else from => _mm512_maskz_loadu_ps(!(u16::MAX << from.len()), from.as_ptr());
        store _mm512_storeu_ps,
            else to, lanes => _mm512_mask_storeu_ps(to.as_mut_ptr(), !(u16::MAX << to.len()), lanes);
        mul_add _mm512_fmadd_ps, mul_sub _mm512_fmsub_ps, neg_mul_add _mm512_fnmadd_ps;
        sqrt _mm512_sqrt_ps, trunc _mm512_roundscale_ps, larger _mm512_max_ps, smaller _mm512_min_ps,
            compare _mm512_cmp_ps_mask;
    }
    bit_masks! {
        __mmask16: select _mm512_mask_blend_ps, or_zero _mm512_maskz_mov_ps; abs _mm512_abs_ps;
    }
    single_precision! { whole _mm512_cvttps_epi32 }

    #[inline(always)]
    fn store_single_where(self, mask: Self::Mask, to: &mut [f32]) {
        let room = if to.len() >= 16 { u16::MAX } else { !(u16::MAX << to.len()) };
        // SAFETY: a vector exists only if a `Cpu` existed; no number beyond the slice is written.
        unsafe { _mm512_mask_storeu_ps(to.as_mut_ptr(), mask & room, self.0) };
    }
}

register! {
    F64x8, 8 lanes of f64 in __m512d:
    Add add _mm512_add_pd, Sub sub _mm512_sub_pd, Mul mul _mm512_mul_pd, Div div _mm512_div_pd
}

impl LookUp for F64x8 {
    lookup_methods! {
        __m256i: _mm256_castps_si256; add _mm256_add_epi32, up to up_to_of_8;
        pairs_of_8, numbers => Self(_mm512_cvtps_pd(numbers))
    }
}

impl Lanes for F64x8 {
    const PREPARED_TOGETHER: bool = false;
    apart!("avx512f,avx2,fma");
    intrinsics! {
        8 lanes of f64: splat _mm512_set1_pd;
        load _mm512_loadu_pd, else from => _mm512_maskz_loadu_pd(!(u8::MAX << from.len()), from.as_ptr());
        store _mm512_storeu_pd,
            else to, lanes => _mm512_mask_storeu_pd(to.as_mut_ptr(), !(u8::MAX << to.len()), lanes);
        mul_add _mm512_fmadd_pd, mul_sub _mm512_fmsub_pd, neg_mul_add _mm512_fnmadd_pd;
        sqrt _mm512_sqrt_pd, trunc _mm512_roundscale_pd, larger _mm512_max_pd, smaller _mm512_min_pd,
            compare _mm512_cmp_pd_mask;
    }
    bit_masks! {
        __mmask8: select _mm512_mask_blend_pd, or_zero _mm512_maskz_mov_pd; abs _mm512_abs_pd;
    }
    double_precision! { whole _mm512_cvttpd_epi32; F32x8 widened _mm512_cvtps_pd, rounded _mm512_cvtpd_ps }

    #[inline(always)]
    fn sqrt_pair(a: Self, b: Self) -> [Self; 2] {
        [a.sqrt(), b.computed_sqrt()]
    }
    #[inline(always)]
    fn store_single_where(self, mask: Self::Mask, to: &mut [f32]) {
        let room = if to.len() >= 8 { u8::MAX } else { !(u8::MAX << to.len()) };
        // SAFETY: a vector exists only if a `Cpu` existed; no number beyond the slice is written.
        unsafe {
            let single = _mm512_castps256_ps512(_mm512_cvtpd_ps(self.0));
            _mm512_mask_storeu_ps(to.as_mut_ptr(), (mask & room).into(), single);
        }
    }
}

/// Returns `STEP` (1 or 2) times each index, but at most `last`.
///
/// # Safety
/// The processor must have AVX-512F.
#[inline(always)]
unsafe fn up_to_of_16<const STEP: usize>(indices: __m512i, last: usize) -> __m512i {
    // SAFETY: the caller ensures that the processor has AVX-512F.
    unsafe {
        let indices = if STEP == 2 { _mm512_add_epi32(indices, indices) } else { indices };
        _mm512_min_epu32(indices, _mm512_set1_epi32(last as i32))
    }
}

/// Returns the two pairs that start at each of sixteen indices, transposed into four vectors.
///
/// # Safety
/// The processor must have AVX-512F, and two pairs must start at each index.
#[inline(always)]
unsafe fn pairs_of_16(table: *const [f32; 2], indices: __m512i) -> [__m512; 4] {
    // SAFETY: the caller ensures these conditions; a processor with AVX-512 has AVX2.
    unsafe {
        let [low, high] = [_mm512_castsi512_si256(indices), _mm512_extracti64x4_epi64::<1>(indices)];
        let [a, b, c, d] = pairs_of_8(table, low);
        let [e, f, g, h] = pairs_of_8(table, high);
        [joined(a, e), joined(b, f), joined(c, g), joined(d, h)]
    }
}

/// Joins two halves into one register.
///
/// # Safety
/// The processor must have AVX-512F.
#[inline(always)]
unsafe fn joined(low: __m256, high: __m256) -> __m512 {
    // SAFETY: the caller ensures that the processor has the instruction.
    unsafe {
        let low = _mm512_castps_pd(_mm512_castps256_ps512(low));
        _mm512_castpd_ps(_mm512_insertf64x4::<1>(low, _mm256_castps_pd(high)))
    }
}

impl F64x8 {
    /// Returns the square root, computed by multiplications; NaN for 0 and infinity. The root is correctly rounded for
    /// numbers above [`super::Scalar::NO_SQUARE`] and up to 2^500.
    #[inline(always)]
    fn computed_sqrt(self) -> Self {
        // SAFETY: a vector exists only if a `Cpu` existed.
        let (y, half) = unsafe { (Self(_mm512_rsqrt14_pd(self.0)), Self(_mm512_set1_pd(0.5))) };
        let mut g = self * y;
        let mut h = y * half;
        let mut iteration = 0;
        while iteration < 2 {
            let r = g.neg_mul_add(h, half);
            g = g.mul_add(r, g);
            h = h.mul_add(r, h);
            iteration += 1;
        }
        let residual = g.neg_mul_add(g, self);
        residual.mul_add(h, g)
    }
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::{
        SplitMix64,
        rand_core::{Rng, SeedableRng},
    };

    use super::*;

    #[test]
    fn the_computed_root_is_the_correctly_rounded_one() {
        if !std::is_x86_feature_detected!("avx512f") {
            return;
        }
        // SAFETY: the feature was detected above.
        let cpu: Cpu<F64x8> = unsafe { Cpu::assume() };
        let check = |numbers: [f64; 8]| {
            let mut roots = [0.0; 8];
            F64x8::load(cpu, &numbers).computed_sqrt().store(&mut roots);
            assert_eq!(roots, numbers.map(f64::sqrt), "{numbers:?}");
        };
        let mut random = SplitMix64::seed_from_u64(1);
        for _ in 0..200_000 {
            check(std::array::from_fn(|_| {
                let bits = random.next_u64();
                // A random mantissa, and an exponent from -255 to 0.
                f64::from_bits((bits >> 12) | ((768 + (bits & 255)) << 52))
            }));
        }
        // The hard cases: squares and their neighbours, and the neighbours of powers of two.
        for i in 1..100_000_u32 {
            let root = 1.0 + f64::from(i) * 1e-5;
            let square = root * root;
            let power = 2.0_f64.powi(-(i as i32 % 250));
            check([
                square,
                square.next_up(),
                square.next_down(),
                square.next_up().next_up(),
                power,
                power.next_up(),
                power.next_down(),
                root,
            ]);
        }
    }
}

//! Registers of 512 bits, for processors with AVX-512F.
//!
//! In double precision the divider takes longer over a pair of square roots than the multipliers over
//! everything else, so one of each pair is computed: r ≈ 1/√a from the processor's table, Newton's
//! iteration on √a and 1/(2√a) coupled, twice, and a last step from the exact residual a - g², which
//! rounds correctly (P. Markstein, *IA-64 and Elementary Functions*, 2000, ch. 9). In single
//! precision, where a division unit's root costs half as much, that does not pay.

use std::{
    arch::x86_64::*,
    ops::{Add, Div, Mul, Sub},
};

use super::{
    Compiled, Cpu, Lanes,
    avx2::{F32x8, pairs_of_8, places_of_8},
    register,
};

macro_rules! avx512 {
    ($name:ident, $scalar:ty, $register:ty, $width:literal, $mask:ty, $set:ident, $load:ident, $store:ident,
     $load_first:ident, $store_first:ident,
     $add:ident, $sub:ident, $mul:ident, $div:ident, $fmadd:ident, $fmsub:ident, $fnmadd:ident,
     $sqrt:ident, $cmp:ident, $blend:ident, $move:ident, $second:ident, $max:ident, $min:ident, $abs:ident,
     $round:ident, $places:ty, { $($single:item)* }) => {
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
            $mask,
            $places,
            "avx512f,avx2,fma",
            {
                #[inline(always)]
                fn sqrt_pair(a: Self, b: Self) -> [Self; 2] {
                    [a.sqrt(), b.$second()]
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
                #[inline(always)]
                fn abs(self) -> Self {
                    // SAFETY: a vector exists only where `Cpu` did.
                    Self(unsafe { $abs(self.0) })
                }
                #[inline(always)]
                fn trunc(self) -> Self {
                    // SAFETY: a vector exists only where `Cpu` did.
                    Self(unsafe { $round::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(self.0) })
                }
                #[inline(always)]
                fn larger(self, b: Self) -> Self {
                    // SAFETY: a vector exists only where `Cpu` did.
                    Self(unsafe { $max(self.0, b.0) })
                }
                #[inline(always)]
                fn smaller(self, b: Self) -> Self {
                    // SAFETY: a vector exists only where `Cpu` did.
                    Self(unsafe { $min(self.0, b.0) })
                }
                #[inline(always)]
                fn bits(mask: Self::Mask) -> u32 {
                    mask.into()
                }
                $($single)*
            }
        );

        impl $name {
            /// Fewer numbers than there are lanes, and zeros.
            ///
            /// # Safety
            /// The processor has AVX-512F.
            #[inline(always)]
            unsafe fn load_first(from: &[$scalar]) -> Self {
                // SAFETY: the instruction is there, and so are the numbers that the mask names.
                Self(unsafe { $load_first(!(<$mask>::MAX << from.len()), from.as_ptr()) })
            }

            /// As many numbers as there is room for, fewer than there are lanes.
            ///
            /// # Safety
            /// The processor has AVX-512F.
            #[inline(always)]
            unsafe fn store_first(self, to: &mut [$scalar]) {
                // SAFETY: the instruction is there, and so is the room that the mask names.
                unsafe { $store_first(to.as_mut_ptr(), !(<$mask>::MAX << to.len()), self.0) };
            }
        }
    };
}

avx512!(
    F32x16,
    f32,
    __m512,
    16,
    __mmask16,
    _mm512_set1_ps,
    _mm512_loadu_ps,
    _mm512_storeu_ps,
    _mm512_maskz_loadu_ps,
    _mm512_mask_storeu_ps,
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_div_ps,
    _mm512_fmadd_ps,
    _mm512_fmsub_ps,
    _mm512_fnmadd_ps,
    _mm512_sqrt_ps,
    _mm512_cmp_ps_mask,
    _mm512_mask_blend_ps,
    _mm512_maskz_mov_ps,
    sqrt,
    _mm512_max_ps,
    _mm512_min_ps,
    _mm512_abs_ps,
    _mm512_roundscale_ps,
    [[u32; 8]; 2],
    {
        #[inline(always)]
        fn load_single(cpu: Cpu<Self>, from: &[f32]) -> Self {
            Self::load(cpu, from)
        }
        #[inline(always)]
        fn store_single(self, to: &mut [f32]) {
            self.store(to);
        }
        #[inline(always)]
        fn store_single_where(self, mask: Self::Mask, to: &mut [f32]) {
            let room = if to.len() >= 16 { u16::MAX } else { !(u16::MAX << to.len()) };
            // SAFETY: a vector exists only where `Cpu` did; nothing is written but what there is room for.
            unsafe { _mm512_mask_storeu_ps(to.as_mut_ptr(), mask & room, self.0) };
        }
        #[inline(always)]
        fn places<const STEP: usize>(self, last: usize) -> Self::Places {
            // SAFETY: a vector exists only where `Cpu` did; what has AVX-512 has AVX2.
            unsafe {
                let all = _mm512_cvttps_epi32(self.0);
                let [low, high] = [_mm512_castsi512_si256(all), _mm512_extracti64x4_epi64::<1>(all)];
                [places_of_8::<STEP>(low, last), places_of_8::<STEP>(high, last)]
            }
        }
        #[inline(always)]
        unsafe fn pairs(table: *const [f32; 2], places: &Self::Places) -> [Self; 4] {
            // SAFETY: places are those of a vector, which exists only where `Cpu` did; and the caller's promise.
            unsafe {
                let ([a, b, c, d], [e, f, g, h]) =
                    (pairs_of_8(table, &places[0]), pairs_of_8(table, &places[1]));
                [Self(joined(a, e)), Self(joined(b, f)), Self(joined(c, g)), Self(joined(d, h))]
            }
        }
    }
);
avx512!(
    F64x8,
    f64,
    __m512d,
    8,
    __mmask8,
    _mm512_set1_pd,
    _mm512_loadu_pd,
    _mm512_storeu_pd,
    _mm512_maskz_loadu_pd,
    _mm512_mask_storeu_pd,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_div_pd,
    _mm512_fmadd_pd,
    _mm512_fmsub_pd,
    _mm512_fnmadd_pd,
    _mm512_sqrt_pd,
    _mm512_cmp_pd_mask,
    _mm512_mask_blend_pd,
    _mm512_maskz_mov_pd,
    computed_sqrt,
    _mm512_max_pd,
    _mm512_min_pd,
    _mm512_abs_pd,
    _mm512_roundscale_pd,
    [u32; 8],
    {
        #[inline(always)]
        fn load_single(_: Cpu<Self>, from: &[f32]) -> Self {
            // SAFETY: `Cpu` says that the processor has AVX-512F, and with it AVX2, which is what `F32x8` needs.
            let F32x8(numbers) = F32x8::load(unsafe { Cpu::assume() }, from);
            // SAFETY: as above.
            Self(unsafe { _mm512_cvtps_pd(numbers) })
        }
        #[inline(always)]
        fn store_single(self, to: &mut [f32]) {
            // SAFETY: a vector exists only where `Cpu` did.
            F32x8(unsafe { _mm512_cvtpd_ps(self.0) }).store(to);
        }
        #[inline(always)]
        fn store_single_where(self, mask: Self::Mask, to: &mut [f32]) {
            let room = if to.len() >= 8 { u8::MAX } else { !(u8::MAX << to.len()) };
            // SAFETY: a vector exists only where `Cpu` did; nothing is written but what there is room for.
            unsafe {
                let single = _mm512_castps256_ps512(_mm512_cvtpd_ps(self.0));
                _mm512_mask_storeu_ps(to.as_mut_ptr(), (mask & room).into(), single);
            }
        }
        #[inline(always)]
        fn places<const STEP: usize>(self, last: usize) -> Self::Places {
            // SAFETY: a vector exists only where `Cpu` did; what has AVX-512 has AVX2.
            unsafe { places_of_8::<STEP>(_mm512_cvttpd_epi32(self.0), last) }
        }
        #[inline(always)]
        unsafe fn pairs(table: *const [f32; 2], places: &Self::Places) -> [Self; 4] {
            // SAFETY: places are those of a vector, which exists only where `Cpu` did; and the caller's promise.
            let [a, b, c, d] = unsafe { pairs_of_8(table, places) };
            // SAFETY: as above.
            unsafe {
                [
                    Self(_mm512_cvtps_pd(a)),
                    Self(_mm512_cvtps_pd(b)),
                    Self(_mm512_cvtps_pd(c)),
                    Self(_mm512_cvtps_pd(d)),
                ]
            }
        }
    }
);

/// Two halves as one.
///
/// # Safety
/// The processor has AVX-512F.
#[inline(always)]
unsafe fn joined(low: __m256, high: __m256) -> __m512 {
    // SAFETY: the instruction is there.
    unsafe {
        let low = _mm512_castps_pd(_mm512_castps256_ps512(low));
        _mm512_castpd_ps(_mm512_insertf64x4::<1>(low, _mm256_castps_pd(high)))
    }
}

impl F64x8 {
    /// The square root by multiplications; NaN at 0 and infinity. Correctly rounded for numbers above
    /// [`super::Scalar::NO_SQUARE`] up to 2^500.
    #[inline(always)]
    fn computed_sqrt(self) -> Self {
        // SAFETY: a vector exists only where `Cpu` did.
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
        // SAFETY: just asked.
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
                // Mantissa at random, exponent from -255 to 0.
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

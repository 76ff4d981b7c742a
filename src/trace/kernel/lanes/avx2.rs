//! Registers of 128 and 256 bits, for processors with AVX2 and FMA: one intrinsic an operation, in macros over the
//! register's names.

use std::{
    arch::x86_64::*,
    ops::{Add, Div, Mul, Sub},
};

use super::{Compiled, Cpu, Lanes, register, store_bits};

macro_rules! avx2 {
    ($name:ident, $scalar:ty, $register:ty, $width:literal, $set:ident, $load:ident, $store:ident,
     $load_first:ident, $store_first:ident, $first:ident,
     $add:ident, $sub:ident, $mul:ident, $div:ident, $fmadd:ident, $fmsub:ident, $fnmadd:ident,
     $sqrt:ident, $cmp:ident, $and:ident, $blend:ident, $max:ident, $min:ident, $andnot:ident, $round:ident,
     $movemask:ident, $places:ty, { $($single:item)* }) => {
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
            $places,
            "avx2,fma",
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
                #[inline(always)]
                fn abs(self) -> Self {
                    // SAFETY: a vector exists only where `Cpu` did.
                    Self(unsafe { $andnot($set(-0.0), self.0) })
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
                    // SAFETY: masks come from comparing vectors, which exist only where `Cpu` did.
                    unsafe { $movemask(mask) as u32 }
                }
                #[inline(always)]
                fn store_single_where(self, mask: Self::Mask, to: &mut [f32]) {
                    let mut single = [0.0; $width];
                    self.store_single(&mut single);
                    store_bits(&single, Self::bits(mask), to);
                }
                $($single)*
            }
        );

        impl $name {
            /// Fewer numbers than there are lanes, and zeros.
            ///
            /// # Safety
            /// The processor has AVX2.
            #[inline(always)]
            unsafe fn load_first(from: &[$scalar]) -> Self {
                // SAFETY: the instructions are there, and so are the numbers that the mask names.
                Self(unsafe { $load_first(from.as_ptr(), $first(from.len())) })
            }

            /// As many numbers as there is room for, fewer than there are lanes.
            ///
            /// # Safety
            /// The processor has AVX2.
            #[inline(always)]
            unsafe fn store_first(self, to: &mut [$scalar]) {
                // SAFETY: the instructions are there, and so is the room that the mask names.
                unsafe { $store_first(to.as_mut_ptr(), $first(to.len()), self.0) };
            }
        }
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
    _mm_maskload_ps,
    _mm_maskstore_ps,
    first_of_4,
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
    _mm_blendv_ps,
    _mm_max_ps,
    _mm_min_ps,
    _mm_andnot_ps,
    _mm_round_ps,
    _mm_movemask_ps,
    [usize; 4],
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
        fn places<const STEP: usize>(self, last: usize) -> Self::Places {
            // SAFETY: a vector exists only where `Cpu` did.
            unsafe { places_of_4::<STEP>(_mm_cvttps_epi32(self.0), last) }
        }
        #[inline(always)]
        unsafe fn pairs(table: *const [f32; 2], places: &Self::Places) -> [Self; 4] {
            // SAFETY: places are those of a vector, which exists only where `Cpu` did; and the caller's promise.
            let [a, b, c, d] = unsafe { pairs_of_4(table, places) };
            [Self(a), Self(b), Self(c), Self(d)]
        }
    }
);
avx2!(
    F32x8,
    f32,
    __m256,
    8,
    _mm256_set1_ps,
    _mm256_loadu_ps,
    _mm256_storeu_ps,
    _mm256_maskload_ps,
    _mm256_maskstore_ps,
    first_of_8,
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
    _mm256_blendv_ps,
    _mm256_max_ps,
    _mm256_min_ps,
    _mm256_andnot_ps,
    _mm256_round_ps,
    _mm256_movemask_ps,
    [u32; 8],
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
        fn places<const STEP: usize>(self, last: usize) -> Self::Places {
            // SAFETY: a vector exists only where `Cpu` did.
            unsafe { places_of_8::<STEP>(_mm256_cvttps_epi32(self.0), last) }
        }
        #[inline(always)]
        unsafe fn pairs(table: *const [f32; 2], places: &Self::Places) -> [Self; 4] {
            // SAFETY: places are those of a vector, which exists only where `Cpu` did; and the caller's promise.
            let [a, b, c, d] = unsafe { pairs_of_8(table, places) };
            [Self(a), Self(b), Self(c), Self(d)]
        }
    }
);
avx2!(
    F64x4,
    f64,
    __m256d,
    4,
    _mm256_set1_pd,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_maskload_pd,
    _mm256_maskstore_pd,
    first_of_4_doubles,
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
    _mm256_blendv_pd,
    _mm256_max_pd,
    _mm256_min_pd,
    _mm256_andnot_pd,
    _mm256_round_pd,
    _mm256_movemask_pd,
    [usize; 4],
    {
        #[inline(always)]
        fn load_single(_: Cpu<Self>, from: &[f32]) -> Self {
            // SAFETY: `Cpu` says that the processor has AVX2, which is what `F32x4` needs.
            let F32x4(numbers) = F32x4::load(unsafe { Cpu::assume() }, from);
            // SAFETY: as above.
            Self(unsafe { _mm256_cvtps_pd(numbers) })
        }
        #[inline(always)]
        fn store_single(self, to: &mut [f32]) {
            // SAFETY: a vector exists only where `Cpu` did.
            F32x4(unsafe { _mm256_cvtpd_ps(self.0) }).store(to);
        }
        #[inline(always)]
        fn places<const STEP: usize>(self, last: usize) -> Self::Places {
            // SAFETY: a vector exists only where `Cpu` did.
            unsafe { places_of_4::<STEP>(_mm256_cvttpd_epi32(self.0), last) }
        }
        #[inline(always)]
        unsafe fn pairs(table: *const [f32; 2], places: &Self::Places) -> [Self; 4] {
            // SAFETY: places are those of a vector, which exists only where `Cpu` did; and the caller's promise.
            let [a, b, c, d] = unsafe { pairs_of_4(table, places) };
            // SAFETY: as above.
            unsafe {
                [
                    Self(_mm256_cvtps_pd(a)),
                    Self(_mm256_cvtps_pd(b)),
                    Self(_mm256_cvtps_pd(c)),
                    Self(_mm256_cvtps_pd(d)),
                ]
            }
        }
    }
);

/// Eight lanes of a mask that are set and eight that are not: from the place 8 - n on, n are.
const ONES_AND_ZEROS: [i32; 16] = [-1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0];

/// The mask of the first `n` lanes, n at most 4.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn first_of_4(n: usize) -> __m128i {
    // SAFETY: the instruction is there, and so are eight numbers from any place up to 8.
    unsafe { _mm_loadu_si128(ONES_AND_ZEROS[8 - n..].as_ptr().cast()) }
}

/// The mask of the first `n` lanes, n at most 8.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn first_of_8(n: usize) -> __m256i {
    // SAFETY: as in `first_of_4`.
    unsafe { _mm256_loadu_si256(ONES_AND_ZEROS[8 - n..].as_ptr().cast()) }
}

/// The mask of the first `n` lanes of double precision, n at most 4.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn first_of_4_doubles(n: usize) -> __m256i {
    // SAFETY: the caller's promise.
    unsafe { first_of_8(2 * n) }
}

/// `STEP` (1 or 2) times some places, up to a last one.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
unsafe fn places_of_4<const STEP: usize>(places: __m128i, last: usize) -> [usize; 4] {
    // SAFETY: the instructions are there.
    unsafe {
        let places = if STEP == 2 { _mm_add_epi32(places, places) } else { places };
        let places = _mm_min_epu32(places, _mm_set1_epi32(last as i32));
        [
            _mm_extract_epi32::<0>(places) as u32 as usize,
            _mm_extract_epi32::<1>(places) as u32 as usize,
            _mm_extract_epi32::<2>(places) as u32 as usize,
            _mm_extract_epi32::<3>(places) as u32 as usize,
        ]
    }
}

/// `STEP` (1 or 2) times some places, up to a last one, stored.
///
/// # Safety
/// The processor has AVX2.
#[inline(always)]
pub(super) unsafe fn places_of_8<const STEP: usize>(places: __m256i, last: usize) -> [u32; 8] {
    let mut stored = [0; 8];
    // SAFETY: the instructions are there, and the room.
    unsafe {
        let places = if STEP == 2 { _mm256_add_epi32(places, places) } else { places };
        let places = _mm256_min_epu32(places, _mm256_set1_epi32(last as i32));
        _mm256_storeu_si256(stored.as_mut_ptr().cast(), places);
    }
    stored
}

/// Two pairs at one of eight places. The place is loaded from where it is stored: what the compiler would make of it
/// instead, taking it out of its register, keeps the ports busy that shuffle.
///
/// # Safety
/// There are such pairs.
#[inline(always)]
unsafe fn pairs_at(table: *const [f32; 2], places: &[u32; 8], lane: usize) -> __m128 {
    // SAFETY: a reference to a number that there is; the caller's promise.
    unsafe {
        let place = (&raw const places[lane]).read_volatile() as usize;
        _mm_loadu_ps(table.add(place).cast())
    }
}

/// Two pairs at each of four places, transposed.
///
/// # Safety
/// The processor has AVX2, and there are such pairs.
#[inline(always)]
unsafe fn pairs_of_4(table: *const [f32; 2], places: &[usize; 4]) -> [__m128; 4] {
    // SAFETY: the caller's promise.
    unsafe {
        let [a, b, c, d] = *places;
        let (a, b) = (_mm_loadu_ps(table.add(a).cast()), _mm_loadu_ps(table.add(b).cast()));
        let (c, d) = (_mm_loadu_ps(table.add(c).cast()), _mm_loadu_ps(table.add(d).cast()));
        let (ab, cd) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
        let (ab_high, cd_high) = (_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
        [
            _mm_movelh_ps(ab, cd),
            _mm_movehl_ps(cd, ab),
            _mm_movelh_ps(ab_high, cd_high),
            _mm_movehl_ps(cd_high, ab_high),
        ]
    }
}

/// Two pairs at each of eight places, transposed.
///
/// # Safety
/// The processor has AVX2, and there are such pairs.
#[inline(always)]
pub(super) unsafe fn pairs_of_8(table: *const [f32; 2], places: &[u32; 8]) -> [__m256; 4] {
    // SAFETY: the caller's promise.
    unsafe {
        // Lanes that lie four apart side by side, so that transposing within 128 bits leaves them in order.
        macro_rules! rows {
            ($lane:literal) => {
                _mm256_insertf128_ps::<1>(
                    _mm256_castps128_ps256(pairs_at(table, places, $lane)),
                    pairs_at(table, places, $lane + 4),
                )
            };
        }
        let (a, b, c, d) = (rows!(0), rows!(1), rows!(2), rows!(3));
        let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
        let (ab_high, cd_high) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
        [
            _mm256_shuffle_ps::<0b01_00_01_00>(ab, cd),
            _mm256_shuffle_ps::<0b11_10_11_10>(ab, cd),
            _mm256_shuffle_ps::<0b01_00_01_00>(ab_high, cd_high),
            _mm256_shuffle_ps::<0b11_10_11_10>(ab_high, cd_high),
        ]
    }
}

//! Vectors in registers of 128 and 256 bits, for processors with AVX2 and FMA. Each vector type has a table of its
//! intrinsics.

use std::{
    arch::x86_64::*,
    ops::{Add, Div, Mul, Sub},
};

use super::{
    Compiled, Cpu, Indexed, Lanes, LookUp, apart, double_precision, intrinsics, look_up::lookup_methods,
    methods, register, single_precision, store_bits,
};

/// Implements masks that are registers, in which all bits of a true lane are set, and the absolute value, which uses a
/// mask of the sign bits.
macro_rules! register_masks {
    ($width:literal in $mask:ident: and $and:ident, select $blend:ident, bits $movemask:ident;
     abs $andnot:ident($sign:expr);) => {
        type Mask = $mask;

        methods! {
            fn both(a: $mask, b: $mask) -> $mask = $and(a, b);
            fn select(mask: $mask, yes: Self, no: Self) -> Self = Self($blend(no.0, yes.0, mask));
            fn or_zero(self, mask: $mask) -> Self = Self($and(self.0, mask));
            fn bits(mask: $mask) -> u32 = $movemask(mask) as u32;
            fn abs(self) -> Self = Self($andnot($sign, self.0));
        }
        #[inline(always)]
        fn store_single_where(self, mask: $mask, to: &mut [f32]) {
            let mut single = [0.0; $width];
            self.store_single(&mut single);
            store_bits(&single, Self::bits(mask), to);
        }
    };
}

register! {
    F32x4, 4 lanes of f32 in __m128:
    Add add _mm_add_ps, Sub sub _mm_sub_ps, Mul mul _mm_mul_ps, Div div _mm_div_ps
}

impl LookUp for F32x4 {
    lookup_methods! {
        __m128i: _mm_castps_si128; add _mm_add_epi32, up to up_to_of_4;
        pairs_of_4, numbers => Self(numbers)
    }
}

impl Lanes for F32x4 {
    const SHARED: bool = false;
    apart!("avx2,fma");
    intrinsics! {
        4 lanes of f32: splat _mm_set1_ps;
        load _mm_loadu_ps, else from => _mm_maskload_ps(from.as_ptr(), first_of_4(from.len()));
        store _mm_storeu_ps, else to, lanes => _mm_maskstore_ps(to.as_mut_ptr(), first_of_4(to.len()), lanes);
        mul_add _mm_fmadd_ps, mul_sub _mm_fmsub_ps, neg_mul_add _mm_fnmadd_ps;
        sqrt _mm_sqrt_ps, trunc _mm_round_ps, larger _mm_max_ps, smaller _mm_min_ps, compare _mm_cmp_ps;
    }
    register_masks! {
        4 in __m128: and _mm_and_ps, select _mm_blendv_ps, bits _mm_movemask_ps;
        abs _mm_andnot_ps(_mm_set1_ps(-0.0));
    }
    single_precision! { whole _mm_cvttps_epi32 }
}

register! {
    F32x8, 8 lanes of f32 in __m256:
    Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps
}

impl LookUp for F32x8 {
    lookup_methods! {
        __m256i: _mm256_castps_si256; add _mm256_add_epi32, up to up_to_of_8;
        pairs_of_8, numbers => Self(numbers)
    }
}

impl Lanes for F32x8 {
    apart!("avx2,fma");
    intrinsics! {
        8 lanes of f32: splat _mm256_set1_ps;
        load _mm256_loadu_ps, else from => _mm256_maskload_ps(from.as_ptr(), first_of_8(from.len()));
        store _mm256_storeu_ps,
            else to, lanes => _mm256_maskstore_ps(to.as_mut_ptr(), first_of_8(to.len()), lanes);
        mul_add _mm256_fmadd_ps, mul_sub _mm256_fmsub_ps, neg_mul_add _mm256_fnmadd_ps;
        sqrt _mm256_sqrt_ps, trunc _mm256_round_ps, larger _mm256_max_ps, smaller _mm256_min_ps,
            compare _mm256_cmp_ps;
    }
    register_masks! {
        8 in __m256: and _mm256_and_ps, select _mm256_blendv_ps, bits _mm256_movemask_ps;
        abs _mm256_andnot_ps(_mm256_set1_ps(-0.0));
    }
    single_precision! { whole _mm256_cvttps_epi32 }
}

register! {
    F64x4, 4 lanes of f64 in __m256d:
    Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd
}

impl LookUp for F64x4 {
    lookup_methods! {
        __m128i: _mm_castps_si128; add _mm_add_epi32, up to up_to_of_4;
        pairs_of_4, numbers => Self(_mm256_cvtps_pd(numbers))
    }
}

impl Lanes for F64x4 {
    apart!("avx2,fma");
    intrinsics! {
        4 lanes of f64: splat _mm256_set1_pd;
        load _mm256_loadu_pd, else from => _mm256_maskload_pd(from.as_ptr(), first_of_4_doubles(from.len()));
        store _mm256_storeu_pd,
            else to, lanes => _mm256_maskstore_pd(to.as_mut_ptr(), first_of_4_doubles(to.len()), lanes);
        mul_add _mm256_fmadd_pd, mul_sub _mm256_fmsub_pd, neg_mul_add _mm256_fnmadd_pd;
        sqrt _mm256_sqrt_pd, trunc _mm256_round_pd, larger _mm256_max_pd, smaller _mm256_min_pd,
            compare _mm256_cmp_pd;
    }
    register_masks! {
        4 in __m256d: and _mm256_and_pd, select _mm256_blendv_pd, bits _mm256_movemask_pd;
        abs _mm256_andnot_pd(_mm256_set1_pd(-0.0));
    }
    double_precision! { whole _mm256_cvttpd_epi32; F32x4 widened _mm256_cvtps_pd, rounded _mm256_cvtpd_ps }
}

/// Eight set lanes of a mask, then eight clear lanes; of the lanes from index 8 - n on, the first n are set.
const ONES_AND_ZEROS: [i32; 16] = [-1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0];

/// Returns the mask of the first `n` lanes, n at most 4.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn first_of_4(n: usize) -> __m128i {
    // SAFETY: the caller ensures that the processor has AVX2; from any index up to 8 on, the table has at least eight
    // numbers.
    unsafe { _mm_loadu_si128(ONES_AND_ZEROS[8 - n..].as_ptr().cast()) }
}

/// Returns the mask of the first `n` lanes, n at most 8.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn first_of_8(n: usize) -> __m256i {
    // SAFETY: as in `first_of_4`.
    unsafe { _mm256_loadu_si256(ONES_AND_ZEROS[8 - n..].as_ptr().cast()) }
}

/// Returns the mask of the first `n` lanes of double precision, n at most 4.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn first_of_4_doubles(n: usize) -> __m256i {
    // SAFETY: the caller ensures these conditions.
    unsafe { first_of_8(2 * n) }
}

/// Returns `STEP` (1 or 2) times each index, but at most `last`.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
unsafe fn up_to_of_4<const STEP: usize>(indices: __m128i, last: usize) -> __m128i {
    // SAFETY: the caller ensures that the processor has AVX2.
    unsafe {
        let indices = if STEP == 2 { _mm_add_epi32(indices, indices) } else { indices };
        _mm_min_epu32(indices, _mm_set1_epi32(last as i32))
    }
}

/// Returns `STEP` (1 or 2) times each index, but at most `last`.
///
/// # Safety
/// The processor must have AVX2.
#[inline(always)]
pub(super) unsafe fn up_to_of_8<const STEP: usize>(indices: __m256i, last: usize) -> __m256i {
    // SAFETY: the caller ensures that the processor has AVX2.
    unsafe {
        let indices = if STEP == 2 { _mm256_add_epi32(indices, indices) } else { indices };
        _mm256_min_epu32(indices, _mm256_set1_epi32(last as i32))
    }
}

/// Returns the two pairs that start at one of eight indices. The index is read back from memory: the compiler would
/// otherwise extract it from its register, which would occupy the execution ports for shuffles.
///
/// # Safety
/// Two pairs must start at the index.
#[inline(always)]
unsafe fn pairs_at(table: *const [f32; 2], indices: &[u32; 8], lane: usize) -> __m128 {
    // SAFETY: the reference is valid; the caller ensures the pairs.
    unsafe {
        let index = (&raw const indices[lane]).read_volatile() as usize;
        _mm_loadu_ps(table.add(index).cast())
    }
}

/// Returns the two pairs that start at each of four indices, transposed into four vectors.
///
/// # Safety
/// The processor must have AVX2, and two pairs must start at each index.
#[inline(always)]
unsafe fn pairs_of_4(table: *const [f32; 2], indices: __m128i) -> [__m128; 4] {
    // SAFETY: the caller ensures these conditions.
    unsafe {
        let a = _mm_extract_epi32::<0>(indices) as u32 as usize;
        let b = _mm_extract_epi32::<1>(indices) as u32 as usize;
        let c = _mm_extract_epi32::<2>(indices) as u32 as usize;
        let d = _mm_extract_epi32::<3>(indices) as u32 as usize;
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

/// Returns the two pairs that start at each of eight indices, transposed into four vectors.
///
/// # Safety
/// The processor must have AVX2, and two pairs must start at each index.
#[inline(always)]
pub(super) unsafe fn pairs_of_8(table: *const [f32; 2], indices: __m256i) -> [__m256; 4] {
    // SAFETY: the caller ensures these conditions.
    unsafe {
        let mut stored = [0; 8];
        _mm256_storeu_si256(stored.as_mut_ptr().cast(), indices);
        // Puts the pairs of two lanes that are four apart into one register, so that a transposition within each
        // 128-bit half leaves the lanes in order.
        macro_rules! rows {
            ($lane:literal) => {
                _mm256_insertf128_ps::<1>(
                    _mm256_castps128_ps256(pairs_at(table, &stored, $lane)),
                    pairs_at(table, &stored, $lane + 4),
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

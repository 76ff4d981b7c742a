//! The numbers in the lanes: operations of `f64` and `f32` that vectors need in addition to those of [`Real`].

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{_mm_cvttsd_si32, _mm_cvttss_si32, _mm_set_sd, _mm_set_ss};

use realistic_base::numeric::Real;

/// A number type that vectors are made of.
pub trait Scalar: Real + 'static {
    /// Largest square of n cos I that counts as 0: a ray this close to grazing incidence has no meaningful direction
    /// behind the surface. For larger squares, the square root is correctly rounded in every instance.
    const NO_SQUARE: Self;
    /// The smallest positive normal number.
    const LEAST: Self;
    /// Coefficients of cos(π/4 √z) in powers of z, for z in [0, 1]: the Chebyshev expansion, truncated where the
    /// remaining terms are smaller than the rounding error.
    const COS: &'static [Self];
    /// Coefficients of sin(π/4 √z)/√z, as in [`Scalar::COS`].
    const SIN: &'static [Self];
    /// Returns `self * b + c`, rounded once. This is an instruction if the processor has it and the caller is compiled
    /// for it, else a slow function with the same result.
    #[must_use]
    fn fused(self, b: Self, c: Self) -> Self;
    /// Rounds toward 0 to an integer.
    #[must_use]
    fn whole(self) -> Self;
    /// Returns the integer part of a number from 0 to 2^31; an arbitrary index for other numbers.
    fn index(self) -> usize;
    /// Returns two square roots, with the latency of one if the processor can compute both at once.
    fn sqrt_pair(a: Self, b: Self) -> [Self; 2];
}

/// Implements [`Scalar`], given the differences between `f64` and `f32`: the square that counts as 0, the two series,
/// the truncation to an index, and the pair of square roots.
macro_rules! scalar {
    ($type:ident, $no_square:expr, cos $cos:expr, sin $sin:expr, $truncate:ident($set:ident), [$a:ident, $b:ident] => $roots:expr) => {
        impl Scalar for $type {
            const NO_SQUARE: Self = $type::from_bits($no_square);
            const LEAST: Self = $type::MIN_POSITIVE;
            const COS: &'static [Self] = &$cos;
            const SIN: &'static [Self] = &$sin;

            #[inline(always)]
            fn fused(self, b: Self, c: Self) -> Self {
                self.mul_add(b, c)
            }

            #[inline(always)]
            fn whole(self) -> Self {
                self.trunc()
            }

            #[inline(always)]
            fn index(self) -> usize {
                // A conversion by `as` alone would add two comparisons to the latency of a look-up.
                #[cfg(target_arch = "x86_64")]
                // SAFETY: every x86-64 processor has SSE2.
                return unsafe { $truncate($set(self)) } as u32 as usize;
                #[cfg(not(target_arch = "x86_64"))]
                return self as u32 as usize;
            }

            #[inline(always)]
            fn sqrt_pair($a: Self, $b: Self) -> [Self; 2] {
                $roots
            }
        }
    };
}

// The squares that count as 0 are 2^-256 for `f64` and 2^-64 for `f32`.
scalar!(f64, (1023 - 256) << 52,
    cos [1.0,
        -0.308_425_137_534_042_45,
        0.015_854_344_243_815_42,
        -0.000_325_991_886_926_737_64,
        3.590_860_446_027_952e-6,
        -2.461_136_403_365_26e-8,
        1.150_051_202_821_734_1e-10,
        -3.858_189_007_341_668e-13,],
    sin [std::f64::consts::FRAC_PI_4,
        -0.080_745_512_188_280_54,
        0.002_490_394_570_188_844,
        -0.000_036_576_204_158_913_87,
        3.133_616_225_433_416e-7,
        -1.757_150_074_698_393_4e-9,
        6.877_360_573_166_326e-12,],
    _mm_cvttsd_si32(_mm_set_sd), [a, b] => sqrt_pair(a, b));
scalar!(f32, (127 - 64) << 23,
    cos [1.0, -0.308_425_14, 0.015_854_325, -0.000_325_938_6, 3.529_797e-6],
    sin [std::f32::consts::FRAC_PI_4, -0.080_745_436, 0.002_490_006_7, -0.000_035_954_29],
    _mm_cvttss_si32(_mm_set_ss), [a, b] => [a.sqrt(), b.sqrt()]);

/// Returns two square roots, by one instruction if the processor has such an instruction.
#[inline(always)]
fn sqrt_pair(a: f64, b: f64) -> [f64; 2] {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_mm_cvtsd_f64, _mm_set_pd, _mm_sqrt_pd, _mm_unpackhi_pd};
        // SAFETY: every x86-64 processor has SSE2.
        unsafe {
            let roots = _mm_sqrt_pd(_mm_set_pd(b, a));
            [_mm_cvtsd_f64(roots), _mm_cvtsd_f64(_mm_unpackhi_pd(roots, roots))]
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    [a.sqrt(), b.sqrt()]
}

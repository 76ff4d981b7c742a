//! The numbers in the lanes: operations of f64 and f32 beyond [`Real`] that the instances need.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{_mm_cvttsd_si32, _mm_cvttss_si32, _mm_set_sd, _mm_set_ss};

use realistic_base::numeric::Real;

/// A number type that vectors are made of.
pub trait Scalar: Real + 'static {
    /// Squares of n cos I up to this count as 0: a hit this close to grazing incidence has no meaningful direction,
    /// and above it every instance's square root is correctly rounded.
    const NO_SQUARE: Self;
    /// The smallest positive normal number.
    const LEAST: Self;
    /// cos(π/4 √z) in powers of z, z in [0, 1]: its Chebyshev expansion, truncated below rounding.
    const COS: &'static [Self];
    /// sin(π/4 √z)/√z.
    const SIN: &'static [Self];
    /// Returns `self * b + c`, rounded once: an instruction if the processor has it and the caller is compiled for
    /// it, else a slow but exact function.
    #[must_use]
    fn fused(self, b: Self, c: Self) -> Self;
    /// Rounds toward 0 to an integer.
    #[must_use]
    fn whole(self) -> Self;
    /// Returns the integer part of a number from 0 to 2^31; arbitrary for other numbers.
    fn index(self) -> usize;
    /// Returns two square roots, at the latency of one if the processor can.
    fn sqrt_pair(a: Self, b: Self) -> [Self; 2];
}

/// Implements the differences between f64 and f32: the square that counts as 0, truncation, and two square roots.
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
                // `as` would add two comparisons to the latency of the look-up.
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

// 2^-256 and 2^-64.
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

/// Returns two square roots by one instruction if the processor has one.
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

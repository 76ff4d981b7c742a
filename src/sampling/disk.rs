//! Maps a lens sample (u, v) in [0, 1]² to a point of the unit disk: Shirley and Chiu's concentric map, the polar one,
//! or rejection. It works in lanes of either precision, with series instead of sine and cosine, so that a single sample
//! has the same bits as in a batch.

use std::f64::consts::FRAC_2_PI;

use crate::trace::{
    Real,
    kernel::{Compiled, Cpu, KernelScalar, Lanes, OneLane, Portable, Scalar, Simd},
};

/// Mappings of lens samples (u, v) to the unit disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DiskMapping {
    /// Shirley and Chiu's concentric map ("A Low Distortion Map Between Disk and Square",
    /// *Journal of Graphics Tools* 2(3), 1997): keeps strata compact.
    #[default]
    Concentric,
    /// r = sqrt(u1), φ = 2π u2.
    Polar,
    /// The square [-1, 1]²; points outside the disk request another lens sample from the host.
    Rejection,
}

impl DiskMapping {
    /// Every mapping with its name in the parameter `disk`.
    pub const NAMES: [(&'static str, Self); 3] =
        [("concentric", Self::Concentric), ("polar", Self::Polar), ("rejection", Self::Rejection)];

    /// Returns the point of the unit disk for the lens sample (`u`, `v`), clamped to [0, 1]; `None` if
    /// [`DiskMapping::Rejection`] requests another lens sample.
    pub fn map(self, u: f64, v: f64) -> Option<[f64; 2]> {
        let mut point = [f64::NAN; 2];
        Simd::best().run(OnePoint { mapping: self, sample: [u, v], point: &mut point });
        let outside = self == Self::Rejection && point.iter().any(|x| x.is_nan());
        (!outside).then_some(point)
    }

    /// Returns the lens sample of the disk's middle.
    pub(crate) fn of_middle(self) -> [f32; 2] {
        match self {
            Self::Concentric | Self::Rejection => [0.5, 0.5],
            Self::Polar => [0.0, 0.0],
        }
    }

    /// Computes [`DiskMapping::map`] in lanes; NaN if another lens sample is requested.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn lanes<L: Lanes>(self, cpu: Cpu<L>, [u, v]: [L; 2]) -> [L; 2]
    where
        L::Scalar: Turns,
    {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        // This order keeps NaN.
        let (u, v) = (one.smaller(zero.larger(u)), one.smaller(zero.larger(v)));
        if self == Self::Polar {
            return polar(cpu, u, v);
        }
        let two = L::splat(cpu, L::Scalar::from_f64(2.0));
        let (a, b) = (u.mul_sub(two, one), v.mul_sub(two, one));
        if self == Self::Rejection {
            let inside = b.mul_add(b, a * a).less_equal(one);
            let nan = L::splat(cpu, L::Scalar::from_f64(f64::NAN));
            return [L::select(inside, a, nan), L::select(inside, b, nan)];
        }
        let (across, along) = (a * a, b * b);
        let (radius, other) = (across.larger(along), across.smaller(along));
        // Square of the radius, and of the angle from the nearer axis in eighths of a turn. At the centre any angle
        // will do.
        let square = other / radius.larger(L::splat(cpu, L::Scalar::LEAST));
        let [cos, sin] = cos_sin_over(cpu, square);
        // radius sin(π/4 other/radius) is `other` times sin(π/4 √z)/√z.
        let wide = along.less(across);
        [a * L::select(wide, cos, sin), b * L::select(wide, sin, cos)]
    }
}

/// Computes one point with the processor's own fused multiplications.
struct OnePoint<'a> {
    mapping: DiskMapping,
    sample: [f64; 2],
    point: &'a mut [f64; 2],
}

impl Compiled for OnePoint<'_> {
    #[inline(always)]
    fn run(self) {
        let [Portable([u]), Portable([v])] =
            self.mapping.lanes(OneLane::cpu(), [Portable([self.sample[0]]), Portable([self.sample[1]])]);
        *self.point = [u, v];
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn polar<L: Lanes>(cpu: Cpu<L>, u: L, v: L) -> [L; 2]
where
    L::Scalar: Turns,
{
    let quarters = v * L::splat(cpu, L::Scalar::from_f64(4.0));
    let nearest = (quarters + L::splat(cpu, L::Scalar::from_f64(0.5))).trunc();
    let rest = quarters - nearest;
    let [cos, sin] = turned(cpu, nearest, rest + rest);
    let radius = u.sqrt();
    [cos * radius, sin * radius]
}

/// Returns cosine and sine of angles, radians, of any size: within 2 units in the last place of 1 up to 1000 turns, and
/// always a point of the unit circle.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn cos_sin<L: Lanes>(cpu: Cpu<L>, angle: L) -> [L; 2]
where
    L::Scalar: Turns,
{
    let (zero, one, four) = (number(cpu, 0.0), number(cpu, 1.0), number(cpu, 4.0));
    let quarters = angle * number(cpu, FRAC_2_PI);
    let half = L::select(zero.less_equal(quarters), number(cpu, 0.5), number(cpu, -0.5));
    let nearest = (quarters + half).trunc();
    // The rest in eighths of a turn, with 4/π in two parts.
    let high = L::Scalar::from_f64(2.0 * FRAC_2_PI);
    let low = L::Scalar::from_f64(2.0 * FRAC_2_PI - high.to_f64());
    let rest = angle.mul_sub(L::splat(cpu, high), nearest + nearest);
    let rest = angle.mul_add(L::splat(cpu, low), rest);
    // This order keeps NaN.
    let rest = one.smaller((zero - one).larger(rest));
    let turns = (nearest * number(cpu, 0.25)).trunc();
    let nearest = turns.neg_mul_add(four, nearest);
    turned(cpu, L::select(zero.less_equal(nearest), nearest, nearest + four), rest)
}

/// Returns cosine and sine of `nearest` quarters of a turn, 0 to 4, plus `rest` eighths, in [-1, 1].
#[cfg_attr(not(debug_assertions), inline(always))]
fn turned<L: Lanes>(cpu: Cpu<L>, nearest: L, rest: L) -> [L; 2]
where
    L::Scalar: Turns,
{
    let [cos, sin] = cos_sin_over(cpu, rest * rest);
    let sin = rest * sin;
    let (one, half) = (number(cpu, 1.0), number(cpu, 0.5));
    let opposite = (nearest - number(cpu, 2.0)).abs();
    let odd = L::both(half.less(opposite), opposite.less(number(cpu, 1.5)));
    let left = L::both(half.less(nearest), nearest.less(number(cpu, 2.5)));
    let below = L::both(number(cpu, 1.5).less(nearest), nearest.less(number(cpu, 3.5)));
    let (x, y) = (L::select(odd, sin, cos), L::select(odd, cos, sin));
    let minus = number(cpu, -1.0);
    [x * L::select(left, minus, one), y * L::select(below, minus, one)]
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn number<L: Lanes>(cpu: Cpu<L>, number: f64) -> L {
    L::splat(cpu, L::Scalar::from_f64(number))
}

/// Scalars with series for angles in eighths of a turn.
pub(crate) trait Turns: KernelScalar + 'static {
    /// cos(π/4 √z) in powers of z, z in [0, 1]: its Chebyshev expansion, truncated below rounding.
    const COS: &'static [Self];
    /// sin(π/4 √z)/√z.
    const SIN: &'static [Self];
}

impl Turns for f64 {
    const COS: &'static [Self] = &[
        1.0,
        -0.308_425_137_534_042_45,
        0.015_854_344_243_815_42,
        -0.000_325_991_886_926_737_64,
        3.590_860_446_027_952e-6,
        -2.461_136_403_365_26e-8,
        1.150_051_202_821_734_1e-10,
        -3.858_189_007_341_668e-13,
    ];
    const SIN: &'static [Self] = &[
        std::f64::consts::FRAC_PI_4,
        -0.080_745_512_188_280_54,
        0.002_490_394_570_188_844,
        -0.000_036_576_204_158_913_87,
        3.133_616_225_433_416e-7,
        -1.757_150_074_698_393_4e-9,
        6.877_360_573_166_326e-12,
    ];
}

impl Turns for f32 {
    const COS: &'static [Self] = &[1.0, -0.308_425_14, 0.015_854_325, -0.000_325_938_6, 3.529_797e-6];
    const SIN: &'static [Self] =
        &[std::f32::consts::FRAC_PI_4, -0.080_745_436, 0.002_490_006_7, -0.000_035_954_29];
}

/// Returns cos(π/4 √z) and sin(π/4 √z)/√z for z in [0, 1].
#[cfg_attr(not(debug_assertions), inline(always))]
fn cos_sin_over<L: Lanes>(cpu: Cpu<L>, z: L) -> [L; 2]
where
    L::Scalar: Turns,
{
    let square = z * z;
    [series(cpu, z, square, L::Scalar::COS), series(cpu, z, square, L::Scalar::SIN)]
}

/// Evaluates a polynomial, even and odd powers side by side.
#[cfg_attr(not(debug_assertions), inline(always))]
fn series<L: Lanes>(cpu: Cpu<L>, z: L, square: L, coefficients: &[L::Scalar]) -> L {
    let mut k = coefficients.len() - 2;
    let (mut one, mut other) = (L::splat(cpu, coefficients[k + 1]), L::splat(cpu, coefficients[k]));
    while k > 0 {
        k -= 1;
        (one, other) = (other, one.mul_add(square, L::splat(cpu, coefficients[k])));
    }
    one.mul_add(z, other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_maps_are_the_same_in_both_precisions() {
        for mapping in [DiskMapping::Concentric, DiskMapping::Polar] {
            for i in 0..=40_u8 {
                for j in 0..=40_u8 {
                    let numbers = [i, j].map(|k| f32::from(k) / 40.0);
                    let single = mapping.lanes(OneLane::cpu(), numbers.map(|number| Portable([number])));
                    let [u, v] = numbers.map(f64::from);
                    let double = mapping.map(u, v).expect("never rejects");
                    for (Portable([single]), double) in single.iter().zip(double) {
                        assert!((f64::from(*single) - double).abs() < 2e-7, "{mapping:?} ({u}, {v})");
                    }
                }
            }
        }
    }

    #[test]
    fn cosines_and_sines_are_within_two_units_in_the_last_place() {
        let check = |angle: f32, most: f64| {
            let [Portable([cos]), Portable([sin])] = cos_sin(OneLane::cpu(), Portable([angle]));
            let (exact_sin, exact_cos) = f64::from(angle).sin_cos();
            for (got, exact) in [(cos, exact_cos), (sin, exact_sin)] {
                assert!(
                    (f64::from(got) - exact).abs() <= most * exact.abs().max(1e-7),
                    "{angle}: {got} {exact}"
                );
            }
        };
        for i in -30_000_i16..=30_000 {
            check(f32::from(i) / 4000.0, 2.0 * f64::from(f32::EPSILON));
        }
        // Near a zero of sine or cosine the last place is as small as the value: the error stays relative.
        for quarters in -8_i8..=8 {
            check(f32::from(quarters) * std::f32::consts::FRAC_PI_2, 4.0 * f64::from(f32::EPSILON));
        }
        for angle in [6000.0_f32, -6000.0, 1234.567, 3.4e7, -1e10, 3e38] {
            let [Portable([cos]), Portable([sin])] = cos_sin(OneLane::cpu(), Portable([angle]));
            assert!((cos * cos + sin * sin - 1.0).abs() < 1e-6, "{angle}: {cos} {sin}");
            if angle.abs() < 1e4 {
                let (exact_sin, exact_cos) = f64::from(angle).sin_cos();
                assert!(
                    (f64::from(cos) - exact_cos).abs() + (f64::from(sin) - exact_sin).abs() < 4e-7,
                    "{angle}"
                );
            }
        }
    }

    #[test]
    fn both_maps_keep_area_and_reach_the_rim() {
        for mapping in [DiskMapping::Concentric, DiskMapping::Polar] {
            let n = 200;
            let mut inner = 0;
            for i in 0..n {
                for j in 0..n {
                    let at = |k| (f64::from(k) + 0.5) / f64::from(n);
                    let [x, y] = mapping.map(at(i), at(j)).expect("never rejects");
                    let radius = x.hypot(y);
                    assert!(radius <= 1.0);
                    inner += i32::from(radius < 0.5);
                }
            }
            assert!((f64::from(inner) / f64::from(n * n) - 0.25).abs() < 2e-3, "{mapping:?}");
            for (u, v) in [(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.5)] {
                let [x, y] = mapping.map(u, v).expect("never rejects");
                assert!(x.hypot(y) <= 1.0 + f64::EPSILON, "{mapping:?} at ({u}, {v})");
            }
        }
    }

    #[test]
    fn the_concentric_map_is_the_published_one() {
        let close = |got: Option<[f64; 2]>, x: f64, y: f64| {
            let [gx, gy] = got.expect("never rejects");
            assert!((gx - x).abs() < 1e-15 && (gy - y).abs() < 1e-15, "({gx}, {gy})");
        };
        let map = |u, v| DiskMapping::Concentric.map(u, v);
        close(map(0.5, 0.5), 0.0, 0.0);
        close(map(1.0, 0.5), 1.0, 0.0);
        close(map(0.0, 0.5), -1.0, 0.0);
        close(map(0.5, 1.0), 0.0, 1.0);
        let half = 0.5_f64.sqrt();
        close(map(1.0, 1.0), half, half);
        close(map(0.0, 0.0), -half, -half);
    }

    #[test]
    fn rejection_asks_again_in_the_corners() {
        assert_eq!(DiskMapping::Rejection.map(0.0, 0.0), None);
        assert_eq!(DiskMapping::Rejection.map(0.5, 1.0), Some([0.0, 1.0]));
    }
}

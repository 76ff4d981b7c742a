//! From a lens sample (u, v) in [0, 1]² to a point of the unit disk: Shirley and Chiu's concentric map, the polar one,
//! or rejection. Over lanes of either precision, with series in the place of sine and cosine, so that one sample has the
//! bits of a batch's.

use crate::trace::{
    Real,
    kernel::{Compiled, Cpu, KernelScalar, Lanes, Portable, Scalar, Simd},
};

/// How lens samples (u, v) map to the unit disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DiskMapping {
    /// Shirley and Chiu's concentric map ("A Low Distortion Map Between Disk and Square",
    /// *Journal of Graphics Tools* 2(3), 1997): keeps strata compact.
    #[default]
    Concentric,
    /// r = sqrt(u1), φ = 2π u2.
    Polar,
    /// The square [-1, 1]²; points outside the disk ask the host to draw again.
    Rejection,
}

impl DiskMapping {
    /// Every mapping with the name that the parameter `disk` uses.
    pub const NAMES: [(&'static str, Self); 3] =
        [("concentric", Self::Concentric), ("polar", Self::Polar), ("rejection", Self::Rejection)];

    /// The point of the unit disk for the lens sample (`u`, `v`), which are taken into [0, 1] first;
    /// `None` where [`DiskMapping::Rejection`] asks for another lens sample.
    pub fn map(self, u: f64, v: f64) -> Option<[f64; 2]> {
        let mut point = [f64::NAN; 2];
        Simd::best().run(OnePoint { mapping: self, sample: [u, v], point: &mut point });
        let outside = self == Self::Rejection && point.iter().any(|x| x.is_nan());
        (!outside).then_some(point)
    }

    /// [`DiskMapping::map`] in lanes; NaN where a new lens sample is asked for.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn lanes<L: Lanes>(self, cpu: Cpu<L>, [u, v]: [L; 2]) -> [L; 2]
    where
        L::Scalar: Turns,
    {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        // In this order NaN stays what it is.
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
        // Squares, of the radius and of the angle from the nearer axis in eighths of a turn. In the middle any angle
        // will do.
        let square = other / radius.larger(L::splat(cpu, L::Scalar::LEAST));
        let [cos, sin] = cos_sin_over(cpu, square);
        // radius sin(π/4 other/radius) is other times what is left of the sine.
        let wide = along.less(across);
        [a * L::select(wide, cos, sin), b * L::select(wide, sin, cos)]
    }
}

/// One point by the processor's own fused multiplications.
struct OnePoint<'a> {
    mapping: DiskMapping,
    sample: [f64; 2],
    point: &'a mut [f64; 2],
}

impl Compiled for OnePoint<'_> {
    #[inline(always)]
    fn run(self) {
        let [Portable([u]), Portable([v])] =
            self.mapping.lanes(Portable::cpu(), [Portable([self.sample[0]]), Portable([self.sample[1]])]);
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
    let rest = rest + rest;
    let [cos, sin] = cos_sin_over(cpu, rest * rest);
    let sin = rest * sin;
    let opposite = (nearest - L::splat(cpu, L::Scalar::from_f64(2.0))).abs();
    let half = L::splat(cpu, L::Scalar::from_f64(0.5));
    let odd = L::both(half.less(opposite), opposite.less(L::splat(cpu, L::Scalar::from_f64(1.5))));
    let left = L::both(half.less(nearest), nearest.less(L::splat(cpu, L::Scalar::from_f64(2.5))));
    let below = L::both(
        L::splat(cpu, L::Scalar::from_f64(1.5)).less(nearest),
        nearest.less(L::splat(cpu, L::Scalar::from_f64(3.5))),
    );
    let (x, y) = (L::select(odd, sin, cos), L::select(odd, cos, sin));
    let radius = u.sqrt();
    let minus = L::splat(cpu, L::Scalar::ZERO) - radius;
    [x * L::select(left, minus, radius), y * L::select(below, minus, radius)]
}

/// Numbers with series for angles in eighths of a turn.
pub(crate) trait Turns: KernelScalar + 'static {
    /// cos(π/4 √z) in powers of z, z in [0, 1]: its Chebyshev expansion, cut where the rest is below the rounding.
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

/// cos(π/4 √z) and sin(π/4 √z)/√z for z in [0, 1].
#[cfg_attr(not(debug_assertions), inline(always))]
fn cos_sin_over<L: Lanes>(cpu: Cpu<L>, z: L) -> [L; 2]
where
    L::Scalar: Turns,
{
    let square = z * z;
    [series(cpu, z, square, L::Scalar::COS), series(cpu, z, square, L::Scalar::SIN)]
}

/// A polynomial, even and odd powers side by side.
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

/// [`DiskMapping::Concentric`] in single precision, sector by sector as pbrt-v1 computes it: the
/// stock cameras have its bits. `u` and `v` in [0, 1].
pub(crate) fn concentric_single(u: f32, v: f32) -> [f32; 2] {
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    // The angle in eighths of a turn, from 0 to 8.
    let (radius, eighths) = match (a >= -b, a > b) {
        (true, true) => (a, if b > 0.0 { b / a } else { 8.0 + b / a }),
        (true, false) => (b, 2.0 - a / b),
        (false, false) => (-a, 4.0 - b / -a),
        (false, true) => (-b, 6.0 + a / -b),
    };
    let angle = eighths * std::f32::consts::FRAC_PI_4;
    [radius * angle.cos(), radius * angle.sin()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_concentric_map_is_the_same_in_both_precisions() {
        for i in 0..=40_u8 {
            for j in 0..=40_u8 {
                let [u, v] = [i, j].map(|k| f32::from(k) / 40.0);
                let single = concentric_single(u, v);
                let double = DiskMapping::Concentric.map(u.into(), v.into()).expect("never rejects");
                for (single, double) in single.iter().zip(double) {
                    // An angle near a whole turn has steps of 5e-7.
                    assert!((f64::from(*single) - double).abs() < 1e-6, "({u}, {v})");
                }
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

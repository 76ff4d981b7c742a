//! Maps a lens sample (u, v) in [0, 1]² to a point of the unit disk, by Shirley and Chiu's concentric map, by
//! the polar map, or by rejection. The maps work in lanes of either precision and use series instead of sine
//! and cosine, so that a single sample gives the same bits as the same sample in a batch.

use realistic_optics::trace::Real;
use realistic_simd::{Compiled, Cpu, Lanes, OneLane, Portable, Scalar, Simd, cos_sin_over, turned};

/// Mappings of lens samples (u, v) to the unit disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DiskMapping {
    /// Shirley and Chiu's concentric map ("A Low Distortion Map Between Disk and Square",
    /// *Journal of Graphics Tools* 2(3), 1997), which keeps strata compact.
    #[default]
    Concentric,
    /// r = sqrt(u), φ = 2π v.
    Polar,
    /// The square [-1, 1]²; if the point lies outside the disk, the host is asked for another lens sample.
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

    /// Returns the lens sample that maps to the disk's centre.
    pub(crate) fn of_middle(self) -> [f32; 2] {
        match self {
            Self::Concentric | Self::Rejection => [0.5, 0.5],
            Self::Polar => [0.0, 0.0],
        }
    }

    /// Computes [`DiskMapping::map`] in lanes; NaN if another lens sample is requested.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes>(self, cpu: Cpu<L>, [u, v]: [L; 2]) -> [L; 2] {
        let (zero, one) = (L::splat(cpu, L::Scalar::ZERO), L::splat(cpu, L::Scalar::ONE));
        // With this order of operands, NaN stays NaN.
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
        // The squares of the radius, which is the larger coordinate, and of the other coordinate.
        let (radius, other) = (across.larger(along), across.smaller(along));
        // Square of the angle from the nearer axis, in units of an eighth of a turn; its value at the centre
        // does not matter.
        let square = other / radius.larger(L::splat(cpu, L::Scalar::LEAST));
        let [cos, sin] = cos_sin_over(cpu, square);
        // radius sin(π/4 other/radius) is `other` times sin(π/4 √z)/√z.
        let wide = along.less(across);
        [a * L::select(wide, cos, sin), b * L::select(wide, sin, cos)]
    }
}

/// Computes one point with the processor's own fused multiply-add instructions.
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
fn polar<L: Lanes>(cpu: Cpu<L>, u: L, v: L) -> [L; 2] {
    let quarters = v * L::splat(cpu, L::Scalar::from_f64(4.0));
    let nearest = (quarters + L::splat(cpu, L::Scalar::from_f64(0.5))).trunc();
    let rest = quarters - nearest;
    let [cos, sin] = turned(cpu, nearest, rest + rest);
    let radius = u.sqrt();
    [cos * radius, sin * radius]
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
    fn both_maps_keep_area_and_reach_the_edge() {
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
    fn rejection_requests_another_sample_in_the_corners() {
        assert_eq!(DiskMapping::Rejection.map(0.0, 0.0), None);
        assert_eq!(DiskMapping::Rejection.map(0.5, 1.0), Some([0.0, 1.0]));
    }
}

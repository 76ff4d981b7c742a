//! From two lens numbers in [0, 1] to a point of the unit disk.

use std::f64::consts::{FRAC_PI_4, TAU};

use crate::numeric::sin_cos_near_0;

/// How lens numbers map to the unit disk.
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

    /// The point of the unit disk for the numbers `u` and `v`, which are taken into [0, 1] first;
    /// `None` where [`DiskMapping::Rejection`] asks for new numbers.
    #[inline(always)]
    pub fn map(self, u: f64, v: f64) -> Option<[f64; 2]> {
        let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
        let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
        match self {
            Self::Concentric => Some(concentric(u, v)),
            Self::Polar => {
                let (radius, angle) = (u.sqrt(), TAU * v);
                Some([radius * angle.cos(), radius * angle.sin()])
            }
            Self::Rejection => (a * a + b * b <= 1.0).then_some([a, b]),
        }
    }
}

/// [`DiskMapping::Concentric`]; no branch, so that loops over it are vectorised.
#[inline(always)]
pub(super) fn concentric(u: f64, v: f64) -> [f64; 2] {
    let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
    let (a, b) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let wide = a.abs() > b.abs();
    let (radius, other) = if wide { (a, b) } else { (b, a) };
    // The angle from the nearer axis; in the middle any will do.
    let ratio = if radius == 0.0 { 0.0 } else { other / radius };
    let [sin, cos] = sin_cos_near_0(FRAC_PI_4 * ratio);
    let (x, y) = if wide { (cos, sin) } else { (sin, cos) };
    [radius * x, radius * y]
}

/// [`DiskMapping::Concentric`] in single precision, sector by sector as pbrt-v1 computes it: the
/// textbook cameras have its bits. `u` and `v` in [0, 1].
pub(super) fn concentric_single(u: f32, v: f32) -> [f32; 2] {
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

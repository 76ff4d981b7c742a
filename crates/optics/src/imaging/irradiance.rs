//! Film irradiance for unit radiance, by brute force: E(x') = ∫ cos⁴θ' d(slope)² over the rays that get through (Kolb,
//! Mitchell and Hanrahan 1995, eq. 2, with dA''/Z² = d(slope)²).

use std::f64::consts::PI;

use crate::{
    lens::{cos4, film_ray, pupil::SlopeDisk},
    trace::{Path, Real},
};
use realistic_base::numeric::{edge, gauss_legendre};

/// Returns the irradiance on the axis for a film at `film`, exact except for rounding. Seen from the axis the pupil is
/// a disk or annuli, whose edges are found along one radius, up to a slope of `reach`. With blades, the edges are found
/// along several radii, from the direction of a corner to that of the middle of an edge.
pub fn on_axis<R: Real>(path: &Path<R>, film: f64, reach: f64) -> f64 {
    let Some((_, blades)) = path.blades() else {
        return along_radius(path, film, reach, 0.0);
    };
    let from = blades.rotation.to_radians();
    let sector = PI / f64::from(blades.count);
    let radii = gauss_legendre();
    radii.iter().map(|(at, share)| share * along_radius(path, film, reach, from + at * sector)).sum()
}

/// Returns the irradiance on the axis for a rotationally symmetric pupil whose profile is that of the actual pupil
/// along the direction `azimuth`, in radians.
fn along_radius<R: Real>(path: &Path<R>, film: f64, reach: f64, azimuth: f64) -> f64 {
    const SCAN: u32 = 512;
    let (sine, cosine) = azimuth.sin_cos();
    let passes = |slope: f64| path.trace(film_ray([0.0; 2], film, [slope * cosine, slope * sine])).is_ok();
    // ∫ cos⁴ d(slope)² over a disk.
    let disk = |slope: f64| PI * slope * slope / (1.0 + slope * slope);
    let at = |i: u32| reach * f64::from(i) / f64::from(SCAN);
    let mut total = 0.0;
    let mut open = passes(0.0);
    for i in 1..=SCAN {
        let (from, to) = (at(i - 1), at(i));
        if passes(to) != open {
            let boundary = disk(edge(from, to, 0.0, |slope| passes(slope) == open));
            total += if open { boundary } else { -boundary };
            open = !open;
        }
    }
    if open { total + disk(reach) } else { total }
}

/// Results of tracing a grid of rays over a disk of slopes at one film point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Survey {
    /// Irradiance for unit radiance through the whole grid.
    pub irradiance: f64,
    /// The part of that irradiance that passes through the second disk.
    pub inside: f64,
    /// Area, in slope space, covered by the rays that get through.
    pub slope_area: f64,
}

/// Integrates over the disk `cover` on a square grid of `n` x `n` midpoints, and separately over the part of `cover`
/// inside the disk `within`. The edge of the pupil causes a relative error of about 1/n^1.5.
pub fn survey<R: Real>(
    path: &Path<R>,
    film: f64,
    point: [f64; 2],
    cover: SlopeDisk,
    within: SlopeDisk,
    n: u32,
) -> Survey {
    let mut survey = Survey::default();
    let step = 2.0 * cover.radius / f64::from(n);
    let at = |i: u32| (f64::from(i) + 0.5) * step - cover.radius;
    for i in 0..n {
        for j in 0..n {
            let offset = [at(i), at(j)];
            if squared(offset) > cover.radius * cover.radius {
                continue;
            }
            let slopes = [cover.center[0] + offset[0], cover.center[1] + offset[1]];
            if path.trace(film_ray(point, film, slopes)).is_err() {
                continue;
            }
            let share = cos4(slopes) * step * step;
            survey.irradiance += share;
            survey.slope_area += step * step;
            let offset = [slopes[0] - within.center[0], slopes[1] - within.center[1]];
            if squared(offset) <= within.radius * within.radius {
                survey.inside += share;
            }
        }
    }
    survey
}

fn squared([x, y]: [f64; 2]) -> f64 {
    x * x + y * y
}

//! Film irradiance for unit radiance, by brute force: E(x') = ∫ cos⁴θ' d(slope)² over the rays that get through (Kolb,
//! Mitchell and Hanrahan 1995, eq. 2, with dA''/Z² = d(slope)²).

use std::f64::consts::{PI, TAU};

use crate::{
    lens::{cos4, film_ray, pupil::SlopeDisk},
    trace::{ApertureTest, Path, Real},
};
use realistic_base::numeric::edge;

/// Returns the irradiance on the axis for a film at `film`. Seen from the axis the pupil of clear apertures is a disk or
/// annuli, whose edges are found along one radius, up to a slope of `reach`; the result is then exact except for
/// rounding. Other apertures and obstructions are tested along many radii, with a relative error below 1e-5, and a
/// picture is sampled there.
pub fn on_axis<R: Real>(path: &Path<R>, film: f64, reach: f64) -> f64 {
    let clear = path.clone().with_circles();
    let passes = |slope: f64| clear.trace(film_ray([0.0; 2], film, [slope, 0.0])).is_ok();
    let annuli = open_parts([0.0, reach], 512, 0.0, passes);
    if path.has_apertures() {
        return annuli.iter().map(|annulus| through_apertures(path, &clear, film, *annulus)).sum();
    }
    annuli.iter().map(|[from, to]| disk(*to) - disk(*from)).sum()
}

/// Returns ∫ cos⁴ d(slope)² over a disk of slopes.
fn disk(slope: f64) -> f64 {
    PI * slope * slope / (1.0 + slope * slope)
}

/// Returns the parts of an interval on which `passes` is true, found by `scan` steps of equal length. Their ends are
/// found by bisection to `width`.
fn open_parts([start, end]: [f64; 2], scan: u32, width: f64, passes: impl Fn(f64) -> bool) -> Vec<[f64; 2]> {
    let at = |i: u32| start + (end - start) * f64::from(i) / f64::from(scan);
    let mut parts = Vec::new();
    let mut open = passes(start).then_some(start);
    for i in 1..=scan {
        let (from, to) = (at(i - 1), at(i));
        if passes(to) != open.is_some() {
            let boundary = edge(from, to, width, |place| passes(place) == open.is_some());
            match open.take() {
                Some(begin) => parts.push([begin, boundary]),
                None => open = Some(boundary),
            }
        }
    }
    parts.extend(open.map(|begin| [begin, end]));
    parts
}

/// Returns the irradiance on the axis through the apertures of `path` for slopes in one annulus, in which all rays pass
/// `clear`, the same path without the apertures.
///
/// Rays from the axis stay in a plane with the axis: their distances from the axis at each surface, which are linearly
/// interpolated between traced rays, hold at every azimuth.
fn through_apertures<R: Real>(path: &Path<R>, clear: &Path<R>, film: f64, [from, to]: [f64; 2]) -> f64 {
    const SCAN: u32 = 256;
    const AZIMUTHS: u32 = 1440;
    let shaped: Vec<usize> =
        (0..path.surfaces()).filter(|&step| !path.steps()[step].apertures.is_empty()).collect();
    let slope = |place: f64| from + (to - from) * place / f64::from(SCAN);
    // The distance from the axis at each surface that has apertures.
    let traced = |i: u32| {
        let mut distances = vec![0.0; path.surfaces()];
        let ray = film_ray([0.0; 2], film, [slope(f64::from(i)), 0.0]);
        clear.walk_by(ray, |step, [x, ..]| distances[step] = x);
        distances
    };
    let rays: Vec<Vec<f64>> = (0..=SCAN).map(traced).collect();
    let lit = |azimuth: f64| {
        let (sine, cosine) = azimuth.sin_cos();
        let transmission = |place: f64| -> f64 {
            let first = (place as usize).min(SCAN as usize - 1);
            let share = place - first as f64;
            let of_step = |&step: &usize| {
                let distance = rays[first][step] * (1.0 - share) + rays[first + 1][step] * share;
                let point = [distance * cosine, distance * sine].map(R::from_f64);
                let of_aperture = |aperture: &ApertureTest<R>| {
                    if aperture.passes(point) { aperture.transmission(point) } else { 0.0 }
                };
                path.steps()[step].apertures.iter().map(of_aperture).product::<f64>()
            };
            shaped.iter().map(of_step).product()
        };
        let parts = open_parts([0.0, f64::from(SCAN)], SCAN, 1e-9, |place| transmission(place) > 0.0);
        let lit = |[from, to]: [f64; 2]| {
            transmission(f64::midpoint(from, to)) * (disk(slope(to)) - disk(slope(from)))
        };
        // The parts are cut at the steps of the scan.
        let cut = |[from, to]: &[f64; 2]| -> f64 {
            let first = from.floor();
            let steps = (to.ceil() - first) as u32;
            (0..steps)
                .map(|i| [from.max(first + f64::from(i)), to.min(first + f64::from(i + 1))])
                .map(lit)
                .sum()
        };
        parts.iter().map(cut).sum::<f64>()
    };
    let azimuth = |i: u32| (f64::from(i) + 0.5) * TAU / f64::from(AZIMUTHS);
    (0..AZIMUTHS).map(|i| lit(azimuth(i))).sum::<f64>() / f64::from(AZIMUTHS)
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

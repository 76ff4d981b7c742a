//! Rays that pass, spread evenly over a film and its pupil, for fitting and evaluating models of a lens.

use std::f64::consts::TAU;

use realistic_camera::sampling::{DiskMapping, PupilDisk};
use realistic_optics::{
    lens::film_ray,
    trace::{Path, Ray, Real},
};

use super::quasirandom::spread;

/// Maximum samples per passing ray.
const PATIENCE: usize = 4000;

/// Returns `count` rays that pass `path`, from the film disk of radius `reach` mm at `film` (z in lens space). They are
/// uniform in film area, and in slopes over the pupil, which is sampled in `cover`. Another `seed` gives other rays.
/// Returns fewer rays if hardly any light passes.
pub fn passing_rays<R: Real>(
    path: &Path<R>,
    film: f64,
    reach: f64,
    cover: PupilDisk,
    count: usize,
    seed: u32,
) -> Vec<Ray> {
    spread(f64::from(seed) * 0.618_033_988_749_894_9)
        .take(PATIENCE * count)
        .map(|[r, turn, u, v]| {
            let (sin, cos) = (TAU * turn).sin_cos();
            let radius = reach * r.sqrt();
            let point = [radius * cos, radius * sin];
            let disk = cover.seen_from(point);
            let [u, v] = DiskMapping::Concentric.map(u, v).expect("never rejects");
            film_ray(point, film, [disk.center[0] + disk.radius * u, disk.center[1] + disk.radius * v])
        })
        .filter(|ray| path.trace(*ray).is_ok())
        .take(count)
        .collect()
}

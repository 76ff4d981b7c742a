//! An integral over film and scene, by the camera's own rays and by rays from the scene: the light that reaches the
//! film from a dome around the camera, with every film point weighted by a smooth function of its position.

use std::{
    f64::consts::{PI, TAU},
    ops::Range,
};

use crate::support::columns::{RayColumns, SampleColumns};
use ::realistic_camera::{Aimed, Camera, ScenePoint};
use realistic_optics::prescription::catalogue;

use super::{
    CAMERAS, camera,
    scene::{numbers, rays, sample},
    support::{RASTER, on_all_cores},
};

const SIZE: [u32; 2] = [RASTER.xres, RASTER.yres];
/// Independent estimates, each from evenly spread samples with a random shift.
const REPLICATES: usize = 24;
/// Minimum and maximum numbers of samples of an estimate; each step doubles the number.
const SAMPLES: [usize; 2] = [512, 1 << 20];
/// Rays per batch.
const BLOCK: usize = 512;
/// Largest permitted standard error, relative to the value.
const PRECISE: f64 = 1e-3;
/// Largest share of light that tables of directions toward a lens may miss, in the mean over the points of the table.
const LEFT_OUT: f64 = 1e-3;
/// Largest permitted relative standard error for a lens that sees behind itself, whose stopped-down pupil receives
/// hardly any light from most of its dome.
const PRECISE_BEHIND: f64 = 3e-3;

/// Number of weightings of film points: one includes all of the film, the other mostly a corner.
const SHARES: usize = 2;

fn share([x, y]: [f64; 2]) -> [f64; SHARES] {
    [1.0 + 0.5 * (x / 60.0).sin() + y / 600.0, 0.02 + (x * y / (400.0 * 300.0)).powi(2)]
}

/// A cap of a sphere about the origin of camera space, centred on the axis, that emits inward.
struct Dome {
    radius: f64,
    /// Half the angle of the dome's cone.
    angle: f64,
}

impl Dome {
    /// Returns a dome of the given radius that fills the camera's field.
    fn before(camera: &Camera, radius: f64) -> Self {
        let mut dome = Self { radius, angle: PI };
        let seen = rays(camera, SIZE, 4000, 7)
            .iter()
            .filter_map(|(_, ray, _)| dome.met(ray.origin.map(f64::from), ray.direction.map(f64::from)))
            .map(|[x, y, z]| x.hypot(y).atan2(z))
            .fold(0.0, f64::max);
        dome.angle = (1.02 * seen + 0.001).min(PI);
        dome
    }

    /// Returns the point on the unit sphere where a ray meets the dome.
    fn met(&self, [x, y, z]: [f64; 3], [dx, dy, dz]: [f64; 3]) -> Option<[f64; 3]> {
        let along = x * dx + y * dy + z * dz;
        let inside = self.radius * self.radius - (x * x + y * y + z * z);
        let t = (along * along + inside).sqrt() - along;
        let point = [x + t * dx, y + t * dy, z + t * dz].map(|part| part / self.radius);
        (inside > 0.0 && point[2] >= self.angle.cos()).then_some(point)
    }

    /// Maps two numbers in [0, 1] to a point of the unit sphere, uniform in area.
    fn point(&self, [u, v]: [f64; 2]) -> [f64; 3] {
        let down = u * (1.0 - self.angle.cos());
        let (level, (sin, cos)) = ((down * (2.0 - down)).sqrt(), (TAU * v).sin_cos());
        [level * cos, level * sin, 1.0 - down]
    }

    fn area(&self) -> f64 {
        TAU * (1.0 - self.angle.cos()) * self.radius * self.radius
    }

    /// Returns the radiance at a point of the unit sphere in the direction opposite to the camera's ray: smooth, and
    /// never 0.
    fn radiance(&self, [x, y, _]: [f64; 3], [dx, dy, _]: [f64; 3]) -> f64 {
        let size = self.angle.min(1.0);
        1.6 + (2.0 * x / size + 0.4).sin() + 0.3 * (y / size) + 0.2 * (3.0 * (dx - dy)).sin()
    }
}

/// Estimates of one kind: one for each replicate and each weighting of film points.
type Estimates = Vec<[f64; SHARES]>;

/// Returns the mean of independent estimates, and its standard error.
fn mean(estimates: &Estimates, which: usize) -> (f64, f64) {
    let n = estimates.len() as f64;
    let mean = estimates.iter().map(|estimate| estimate[which]).sum::<f64>() / n;
    let square = estimates.iter().map(|estimate| (estimate[which] - mean).powi(2)).sum::<f64>();
    (mean, (square / (n * (n - 1.0))).sqrt())
}

fn add(sum: &mut [f64; SHARES], share: [f64; SHARES], times: f64) {
    for (sum, share) in sum.iter_mut().zip(share) {
        *sum += times * share;
    }
}

/// Returns the sum over a range of a replicate's samples, in whole blocks.
fn by_camera_rays(camera: &Camera, dome: &Dome, replicate: usize, range: Range<usize>) -> [f64; SHARES] {
    let (mut samples, mut found) = (SampleColumns::new(BLOCK), RayColumns::new(BLOCK));
    let mut sum = [0.0; SHARES];
    for first in range.step_by(BLOCK) {
        for i in 0..BLOCK {
            samples.set(i, &sample(numbers(first + i, replicate), SIZE));
        }
        camera.trace(&samples.all(), &mut found.all());
        for i in 0..BLOCK {
            let (Some((ray, weight)), sample) = (found.get(i), samples.get(i)) else { continue };
            let [origin, direction] = [ray.origin, ray.direction].map(|v| v.map(f64::from));
            let Some(point) = dome.met(origin, direction) else { continue };
            let light = f64::from(weight) * dome.radiance(point, direction);
            add(&mut sum, share([sample.image_x.into(), sample.image_y.into()]), light);
        }
    }
    sum
}

fn by_scene_rays(camera: &Camera, dome: &Dome, replicate: usize, range: Range<usize>) -> [f64; SHARES] {
    let normals: Vec<([f64; 3], [f32; 2])> = range
        .map(|index| {
            let [a, b, u, v, ..] = numbers(index, replicate + 50);
            (dome.point([a, b]), [u as f32, v as f32])
        })
        .collect();
    let points: Vec<ScenePoint> = normals
        .iter()
        .map(|(normal, sample)| {
            let point = normal.map(|part| (dome.radius * part) as f32);
            ScenePoint { point, sample: *sample, time: 0.5 }
        })
        .collect();
    let mut aimed = vec![Aimed::default(); points.len()];
    camera.adjoint().expect("defined").aim(&points, &mut aimed);
    let mut sum = [0.0; SHARES];
    for ((normal, _), Aimed { direction, density, importance, .. }) in normals.iter().zip(&aimed) {
        if importance.importance > 0.0 {
            let outward = direction.map(|part| -part);
            let cosine = (0..3).map(|axis| normal[axis] * outward[axis]).sum::<f64>();
            let light = importance.importance * dome.radiance(*normal, outward) * cosine / density;
            add(&mut sum, share(importance.raster), light);
        }
    }
    sum.map(|sum| sum * dome.area())
}

/// Returns estimates with relative errors of at most `most`, from as many samples as needed; `sum` computes the sum
/// over a range of a replicate's samples.
fn precise(most: f64, sum: impl Fn(usize, Range<usize>) -> [f64; SHARES] + Sync) -> Estimates {
    let replicates: Vec<usize> = (0..REPLICATES).collect();
    let mut sums = [[0.0; SHARES]; REPLICATES];
    let mut taken = 0..SAMPLES[0];
    loop {
        let more = on_all_cores(&replicates, |replicate| sum(*replicate, taken.clone()));
        sums.iter_mut().zip(more).for_each(|(sum, more)| add(sum, more, 1.0));
        let found: Estimates = sums.iter().map(|sum| sum.map(|sum| sum / taken.end as f64)).collect();
        let is_precise = (0..SHARES).all(|which| {
            let (mean, error) = mean(&found, which);
            error < most * mean
        });
        if is_precise || taken.end >= SAMPLES[1] {
            return found;
        }
        taken = taken.end..2 * taken.end;
    }
}

/// Returns disagreements between the two estimates of the light from a dome to a camera. A disagreement is a difference
/// above 4 standard errors plus the light that the tables may miss, or a standard error above [`PRECISE`]
/// ([`PRECISE_BEHIND`] for the lens that sees behind itself).
fn both_estimates(given: &[(&str, &str)], radius: f64) -> Vec<String> {
    let unit = if given.iter().any(|(name, _)| *name == "mm_per_unit") { 0.1 } else { 1.0 };
    let most = if given.contains(&("lens_file", "fisheye.6mm")) { PRECISE_BEHIND } else { PRECISE };
    disagreements(&format!("{given:?}"), &camera(given), unit * radius, [most, LEFT_OUT])
}

/// Returns disagreements for a camera and a dome in world units, where errors above `most` count and the tables may
/// miss `left_out`.
pub fn disagreements(name: &str, camera: &Camera, radius: f64, [most, left_out]: [f64; 2]) -> Vec<String> {
    let dome = Dome::before(camera, radius);
    let from_film = precise(0.35 * most, |replicate, range| by_camera_rays(camera, &dome, replicate, range));
    let from_scene = precise(0.92 * most, |replicate, range| by_scene_rays(camera, &dome, replicate, range));
    let mut wrong = Vec::new();
    for which in 0..SHARES {
        let (film, film_error) = mean(&from_film, which);
        let (scene, scene_error) = mean(&from_scene, which);
        let error = film_error.hypot(scene_error);
        let text = format!(
            "{name} at {radius}, weight {which}: {film:.6e} and {scene:.6e}, {:.2} standard errors of {:.1e} and {:.1e}",
            (film - scene) / error,
            film_error / film,
            scene_error / scene,
        );
        eprintln!("{text}");
        if !(error <= most * film && (film - scene).abs() <= left_out * film + 4.0 * error) {
            wrong.push(text);
        }
    }
    wrong
}

const WEIGHTINGS: [&str; 4] = ["radiometric", "assignment", "relative", "none"];
/// Returns a film diagonal, mm; each lens except a fisheye illuminates the corners of that film.
fn film(lens: &str) -> &'static str {
    if lens.starts_with("phone") { "6" } else { "30" }
}
const STOPS: [Option<&str>; 3] = [None, Some("8"), Some("16")];
const FOCUS: [Option<&str>; 2] = [None, Some("3000")];
const PUPILS: [&str; 2] = ["warped", "disk"];
/// Radii of the dome, from in front of the longest lens to far away.
const RADII: [f64; 3] = [1000.0, 4000.0, 50_000.0];

fn combination<'a>(
    lens: &'a str,
    weighting: &'a str,
    stop: Option<&'a str>,
    focus: Option<&'a str>,
    pupil: &'a str,
) -> Vec<(&'a str, &'a str)> {
    let given =
        [("lens_file", lens), ("film_diagonal", film(lens)), ("weighting", weighting), ("pupil", pupil)];
    // A zoom is at its first position or, with a near focus, between its ends.
    let zoom = match (lens, focus) {
        ("zoom.24-70mm", Some(_)) => Some("45"),
        ("zoom.70-200mm", Some(_)) => Some("135"),
        _ => None,
    };
    let more = [("fnumber", stop), ("focus_distance", focus), ("zoom", zoom)];
    given.into_iter().chain(more.into_iter().filter_map(|(name, text)| Some((name, text?)))).collect()
}

#[test]
fn integrals_by_rays_from_the_film_and_from_the_scene_agree() {
    let wrong: Vec<String> = CAMERAS
        .iter()
        .zip(RADII.iter().cycle())
        .flat_map(|(given, radius)| both_estimates(given, *radius))
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn integrals_agree_for_every_lens_of_the_catalogue() {
    let mut wrong = Vec::new();
    for (i, lens) in catalogue::round().enumerate() {
        // Neighbouring combinations differ in everything, and over a dozen lenses each weighting meets each stop.
        let given = combination(
            lens,
            WEIGHTINGS[i % 4],
            STOPS[i % 3],
            FOCUS[i / 2 % 2],
            PUPILS[usize::from(i % 5 == 0)],
        );
        wrong.extend(both_estimates(&given, RADII[(i + i / 3) % 3]));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "takes minutes: every weighting, stop and focus with every lens of the catalogue"]
fn integrals_agree_for_every_lens_weighting_stop_and_focus() {
    let mut wrong = Vec::new();
    let mut radii = RADII.iter().cycle();
    for lens in catalogue::round() {
        for (weighting, pupil) in WEIGHTINGS.into_iter().zip(PUPILS.into_iter().cycle()) {
            for stop in STOPS {
                for focus in FOCUS {
                    let given = combination(lens, weighting, stop, focus, pupil);
                    wrong.extend(both_estimates(&given, *radii.next().expect("endless")));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

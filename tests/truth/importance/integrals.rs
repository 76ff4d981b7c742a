//! An integral over film and scene, by the camera's own rays and by rays from the scene.

use realistic::{
    camera::{Aimed, Camera, ScenePoint},
    prescription::catalogue,
};

use super::{
    CAMERAS, camera,
    scene::{numbers, rays, sample},
    support::RASTER,
};

const SIZE: [u32; 2] = [RASTER.xres, RASTER.yres];
/// Independent estimates.
const REPLICATES: usize = 12;

/// A disk across the axis that shines toward the camera.
struct Disk {
    center: [f64; 2],
    depth: f64,
    radius: f64,
}

impl Disk {
    /// Radiance at a point, which falls to 0 at the edge, into a direction.
    fn radiance(&self, [x, y]: [f64; 2], slope: [f64; 2]) -> f64 {
        let square = ((x - self.center[0]).powi(2) + (y - self.center[1]).powi(2)) / self.radius.powi(2);
        if square < 1.0 {
            (1.0 - square).powi(2) * (1.5 + (3.0 * slope[0]).sin() - 0.5 * slope[1])
        } else {
            0.0
        }
    }
}

/// What a film point counts, besides.
fn share([x, y]: [f64; 2]) -> f64 {
    1.0 + 0.5 * (x / 60.0).sin() + y / 600.0
}

/// The mean of independent estimates, and its standard error.
fn mean(estimates: &[f64]) -> (f64, f64) {
    let n = estimates.len() as f64;
    let mean = estimates.iter().sum::<f64>() / n;
    let square = estimates.iter().map(|estimate| (estimate - mean).powi(2)).sum::<f64>();
    (mean, (square / (n * (n - 1.0))).sqrt())
}

fn by_camera_rays(camera: &Camera, disk: &Disk, count: usize) -> (f64, f64) {
    let estimates: Vec<f64> = (0..REPLICATES)
        .map(|replicate| {
            let sum: f64 = (0..count)
                .map(|index| {
                    let sample = sample(numbers(index, replicate), SIZE);
                    let Some((ray, weight)) = camera.ray(&sample) else { return 0.0 };
                    let ([x, y, z], [dx, dy, dz]) = (ray.origin.map(f64::from), ray.direction.map(f64::from));
                    let t = (disk.depth - z) / dz;
                    let light = if t > 0.0 {
                        disk.radiance([x + t * dx, y + t * dy], [dx / dz, dy / dz])
                    } else {
                        0.0
                    };
                    f64::from(weight) * light * share([sample.image_x.into(), sample.image_y.into()])
                })
                .sum();
            sum / count as f64
        })
        .collect();
    mean(&estimates)
}

fn by_scene_rays(camera: &Camera, disk: &Disk, count: usize) -> (f64, f64) {
    let backward = camera.backward().expect("defined");
    let area = std::f64::consts::PI * disk.radius * disk.radius;
    let estimates: Vec<f64> = (0..REPLICATES)
        .map(|replicate| {
            let points: Vec<ScenePoint> = (0..count)
                .map(|index| {
                    let [r, turn, u, v, ..] = numbers(index, replicate + 50);
                    let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
                    let far = disk.radius * r.sqrt();
                    let [x, y] = [disk.center[0] + far * cos, disk.center[1] + far * sin];
                    let point = [x as f32, y as f32, disk.depth as f32];
                    ScenePoint { point, sample: [u as f32, v as f32], time: 0.5 }
                })
                .collect();
            let mut aimed = vec![Aimed::default(); count];
            backward.aim(&points, &mut aimed);
            let sum: f64 = points
                .iter()
                .zip(&aimed)
                .filter(|(_, aim)| aim.importance.importance > 0.0)
                .map(|(point, Aimed { direction: [dx, dy, dz], density, importance, .. })| {
                    let light =
                        disk.radiance([point.point[0].into(), point.point[1].into()], [dx / dz, dy / dz]);
                    importance.importance * light * dz.abs() * share(importance.raster) / density
                })
                .sum();
            sum * area / count as f64
        })
        .collect();
    mean(&estimates)
}

/// Disks before a camera: the field's middle and toward one of its corners, near and far.
fn disks(camera: &Camera, unit: f64) -> Vec<Disk> {
    [300.0, 30_000.0]
        .map(|distance| {
            let depth = unit * distance;
            // The middle half of the field, and what lies about a corner.
            let crossing: Vec<[f64; 2]> = rays(camera, SIZE, 2000, 7)
                .iter()
                .filter(|(_, ray, _)| ray.direction[2] > 0.2)
                .map(|(_, ray, _)| {
                    let t = (depth as f32 - ray.origin[2]) / ray.direction[2];
                    [0, 1].map(|axis| f64::from(ray.origin[axis] + t * ray.direction[axis]))
                })
                .collect();
            let half = [0, 1].map(|axis| crossing.iter().map(|at| at[axis].abs()).fold(0.0, f64::max));
            [
                Disk { center: [0.1 * half[0], 0.0], depth, radius: 0.6 * half[1] },
                Disk { center: [0.65 * half[0], 0.6 * half[1]], depth, radius: 0.5 * half[1] },
            ]
        })
        .into_iter()
        .flatten()
        .collect()
}

/// What does not agree of the two estimates of a camera's disks by so many samples each: apart by more than 4 standard errors,
/// or with errors of more than `most`.
fn both_ways(given: &[(&str, &str)], count: usize, most: f64) -> Vec<String> {
    let camera = camera(given);
    let unit = if given.iter().any(|(name, _)| *name == "mmperunit") { 0.1 } else { 1.0 };
    let mut wrong = Vec::new();
    for disk in disks(&camera, unit) {
        let (from_film, film_error) = by_camera_rays(&camera, &disk, count);
        let (from_scene, scene_error) = by_scene_rays(&camera, &disk, count);
        let error = film_error.hypot(scene_error);
        let text = format!(
            "{given:?} at {} {:.1?}: {from_film:.6e} and {from_scene:.6e}, {:.2} standard errors of {:.1e}",
            disk.depth,
            disk.center,
            (from_film - from_scene) / error,
            error / from_film
        );
        eprintln!("{text}");
        // Toward the edge of all that a fisheye sees some directions are not sampled.
        let missed = if given.contains(&("specfile", "fisheye.10mm")) && given.contains(&("filmdiag", "40")) {
            0.03
        } else {
            0.0
        };
        if error > most * from_film || (from_film - from_scene).abs() > 4.0 * error + missed * from_film {
            wrong.push(text);
        }
    }
    wrong
}

#[test]
fn integrals_by_rays_from_the_film_and_from_the_scene_agree() {
    let wrong: Vec<String> = CAMERAS.iter().flat_map(|given| both_ways(given, 20_000, 0.03)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "takes minutes: every lens of the catalogue"]
fn integrals_agree_for_every_lens_of_the_catalogue() {
    let mut wrong = Vec::new();
    for name in catalogue::names() {
        for more in [
            &[][..],
            &[("fnumber", "8"), ("weighting", "relative")],
            &[("pupil", "rear"), ("weighting", "none")],
        ] {
            let given = [&[("specfile", name)], more].concat();
            wrong.extend(both_ways(&given, 40_000, 0.03));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

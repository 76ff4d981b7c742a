//! Light tracing: each vertex of a path from the lamps is connected to the camera along a direction that the camera
//! samples, and the vertex's light is added at the film point to which the direction leads (E. Veach, *Robust Monte
//! Carlo Methods for Light Transport Simulation*, 1997, §10.3: the paths with one vertex on the lens).

use super::lamplight::{Lights, REFLECTIONS, START, scattered};
use super::renderer::Settings;
use crate::host::plugin::{Connections, PluginError, ScenePoints};
use crate::host::scene::shapes::Ray;
use crate::host::scene::{Finish, Scene};
use crate::image::Picture;
use glam::{DVec3, Vec3};
use indicatif::ProgressBar;
use rand::{RngExt as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use realistic_lab::render::Tally;
use std::f32::consts::PI;
use std::time::Instant;

/// Number of parts into which a picture's paths are divided, each with its own random numbers, whatever the number of
/// threads.
const PARTS: u64 = 16;
/// Number of paths per call of the camera.
const BATCH: u64 = 1024;

/// Light that a vertex of a path sends toward the camera, still to be multiplied by the cosine and divided by the
/// density of the direction.
struct Vertex {
    normal: Vec3,
    /// Radiance divided by the density of the vertex per area, 1/mm².
    strength: Vec3,
}

/// Renders the scene with as many paths in total as the settings have samples.
///
/// # Errors
/// The camera's error.
pub fn trace(
    camera: impl Fn(&ScenePoints, &mut Connections) -> Result<(), PluginError> + Sync,
    scene: &Scene,
    settings: &Settings<'_>,
    [open, close]: [f32; 2],
    progress: &ProgressBar,
) -> Result<(Picture, Tally), PluginError> {
    let [width, height] = settings.size;
    let pixels = u64::from(width) * u64::from(height);
    let paths = pixels * u64::from(settings.spp);
    let lights = Lights::of(scene);
    progress.set_length(PARTS);
    let parts = (0..PARTS).into_par_iter().map(|part| {
        let seed = settings.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ part;
        let mut path = Tracer {
            scene,
            lights: &lights,
            random: Xoshiro256PlusPlus::seed_from_u64(seed),
            units_per_mm: settings.mm_per_unit.recip(),
            shutter: [open, close],
            sums: vec![DVec3::ZERO; pixels as usize],
            size: settings.size,
            tally: Tally::default(),
        };
        let [from, to] = [part, part + 1].map(|part| part * paths / PARTS);
        for first in (from..to).step_by(BATCH as usize) {
            path.batch(BATCH.min(to - first), &camera)?;
        }
        progress.inc(1);
        Ok((path.sums, path.tally))
    });
    let mut sums = vec![DVec3::ZERO; pixels as usize];
    let mut total = Tally::default();
    for (part, tally) in parts.collect::<Result<Vec<_>, PluginError>>()? {
        sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        total.add(&tally);
    }
    // The film has an area of 1 in total, and a pixel has its share of that area; the whole sum counts for each
    // pixel's share.
    let scale = pixels as f64 / paths as f64;
    let pixels = sums.into_iter().map(|sum| (scale * sum).as_vec3().to_array()).collect();
    Ok((Picture { size: settings.size, pixels }, total))
}

/// Tracer of one part of the picture's paths.
struct Tracer<'a> {
    scene: &'a Scene,
    lights: &'a Lights,
    random: Xoshiro256PlusPlus,
    units_per_mm: f32,
    shutter: [f32; 2],
    sums: Vec<DVec3>,
    size: [u32; 2],
    tally: Tally,
}

impl Tracer<'_> {
    /// Traces paths, and adds the part of their light that reaches the film.
    fn batch(
        &mut self,
        count: u64,
        camera: impl Fn(&ScenePoints, &mut Connections) -> Result<(), PluginError>,
    ) -> Result<(), PluginError> {
        let (mut scene_points, mut vertices) = (ScenePoints::default(), Vec::new());
        for _ in 0..count {
            self.path(&mut scene_points, &mut vertices);
        }
        let mut found = Connections::default();
        let start = Instant::now();
        camera(&scene_points, &mut found)?;
        self.tally.in_camera += start.elapsed();
        self.tally.rays += vertices.len() as u64;
        for (i, vertex) in vertices.iter().enumerate() {
            if found.importance[i] > 0.0 {
                self.tally.passed += 1;
                self.count(&scene_points, &found, i, vertex);
            }
        }
        Ok(())
    }

    /// Adds the vertices of one path, in the camera's units.
    fn path(&mut self, scene_points: &mut ScenePoints, vertices: &mut Vec<Vertex>) {
        let [open, close] = self.shutter;
        let time = open + (close - open) * self.random.random::<f32>();
        let choice = self.random.random();
        let lamp = self.lights.point(choice, [self.random.random(), self.random.random()]);
        self.push_point(scene_points, lamp.point, time);
        vertices.push(Vertex { normal: lamp.normal, strength: lamp.radiance / lamp.density });
        // Directions are sampled in proportion to the cosine, so the outgoing strength has a factor π.
        let mut strength = PI * lamp.radiance / lamp.density;
        let direction = scattered(lamp.normal, [self.random.random(), self.random.random()]);
        let mut ray = Ray { origin: lamp.point, direction, time };
        for _ in 0..REFLECTIONS {
            let Some((hit, material)) = self.scene.nearest(&ray, START) else { return };
            if material.finish == Finish::Lamp || hit.normal.dot(ray.direction) >= 0.0 {
                return;
            }
            let point = ray.at(hit.distance);
            strength *= material.colour;
            self.push_point(scene_points, point, time);
            vertices.push(Vertex { normal: hit.normal, strength: strength / PI });
            let direction = scattered(hit.normal, [self.random.random(), self.random.random()]);
            ray = Ray { origin: point, direction, time };
        }
    }

    /// Adds a point with a random lens sample.
    fn push_point(&mut self, scene_points: &mut ScenePoints, point: Vec3, time: f32) {
        let sample = [self.random.random(), self.random.random()];
        scene_points.push((point * self.units_per_mm).to_array(), sample, time);
    }

    /// Adds a vertex's light, unless it is occluded.
    fn count(&mut self, scene_points: &ScenePoints, found: &Connections, i: usize, vertex: &Vertex) {
        let direction = Vec3::from_array(found.direction(i));
        let cosine = vertex.normal.dot(direction);
        if cosine <= 0.0 {
            return;
        }
        let (point, front) = (Vec3::from_array(scene_points.point(i)), Vec3::from_array(found.origin(i)));
        let ray = Ray { origin: point / self.units_per_mm, direction, time: scene_points.time(i) };
        let distance = (front - point).length() / self.units_per_mm;
        if self.scene.nearest(&ray, START).is_some_and(|(hit, _)| hit.distance < distance) {
            return;
        }
        // Areas are measured in the scene, in mm².
        let area = f64::from(self.units_per_mm).powi(2);
        let share = f64::from(found.importance[i]) * f64::from(cosine) / f64::from(found.density[i]) * area;
        let [x, y] = found.pixel(i).map(|at| at as usize);
        let [width, height] = self.size.map(|side| side as usize);
        self.sums[y.min(height - 1) * width + x.min(width - 1)] += share * vertex.strength.as_dvec3();
    }
}

#[cfg(test)]
mod tests {
    use super::super::linked::{Linked, pictures};
    use super::super::render;
    use super::*;
    use crate::host::scene::night;

    /// Few and large pixels, so that paths from the camera meet lamps often enough in each pixel to estimate the
    /// pixel's error.
    const SIZE: [u32; 2] = [12, 8];
    fn settings(seed: u64, spp: u32) -> Settings<'static> {
        Settings::plain(SIZE, spp, seed)
    }

    /// The night scene, with lamps so large that paths from the camera meet them, too.
    fn large_lamps() -> Scene {
        const LARGER: f32 = 12.0;
        let mut scene = night::scene();
        for lamp in
            scene.lamps.iter_mut().flat_map(|group| &mut group.lamps).filter(|lamp| lamp.shape.radius < 20.0)
        {
            lamp.shape.radius *= LARGER;
            lamp.material.colour /= LARGER * LARGER;
        }
        let groups = std::mem::take(&mut scene.lamps);
        scene.lamps = groups.into_iter().map(|group| group.lamps.into_iter().collect()).collect();
        scene
    }

    #[test]
    fn paths_from_lamps_and_from_the_camera_make_one_picture() {
        let (camera, scene, hidden) = (Linked::new(SIZE, 1080.0), large_lamps(), ProgressBar::hidden());
        let from_camera = pictures(|seed| {
            render(|rays| camera.rays(rays), &scene, &settings(seed, 2048), &hidden).unwrap().0
        });
        let from_lamps = pictures(|seed| {
            let joined =
                |scene_points: &ScenePoints, found: &mut Connections| camera.connect(scene_points, found);
            trace(joined, &scene, &settings(seed, 8192), [0.0, 1.0], &hidden).unwrap().0
        });
        // Largest contribution to a mean of a single path from the camera that meets a lamp: for rare hits, it is
        // variance over mean.
        let hit =
            from_camera.iter().filter(|[a, _]| *a > 0.0).map(|[a, square]| square / a).fold(0.0, f64::max);
        let mut parts: Vec<f64> = Vec::new();
        for ([a, a_square], [b, b_square]) in from_camera.iter().zip(&from_lamps) {
            if *a > 0.0 {
                parts.push((a - b).powi(2) / (a_square + b_square));
            } else {
                // No path from the camera met a lamp. If seven hits are expected, the probability of this is below
                // one in a thousand.
                assert!(*b < 7.0 * hit, "{b} and nothing, a hit {hit}");
            }
        }
        let (sums, lamps): (f64, f64) =
            (from_camera.iter().map(|[mean, _]| mean).sum(), from_lamps.iter().map(|[mean, _]| mean).sum());
        let (chi, count) = (parts.iter().sum::<f64>(), parts.len() as f64);
        // Squares of a number that has Student's distribution with 15 to 30 degrees of freedom.
        let expected = 1.11 * count;
        let spread = (3.0_f64 * count).sqrt();
        let worst = parts.iter().copied().fold(0.0, f64::max).sqrt();
        eprintln!(
            "chi squared {chi:.0} of {count}, sums {sums:.5} and {lamps:.5}, at most {worst:.1} standard errors"
        );
        assert!((sums / lamps - 1.0).abs() < 0.02, "{sums} {lamps}");
        // The three channels of a pixel are correlated, so only a third of the numbers is independent.
        assert!((chi - expected).abs() < 5.0 * 3.0_f64.sqrt() * spread, "{chi} of {count}");
        assert!(count > 250.0, "{count}");
    }

    #[test]
    fn small_lamps_out_of_focus_take_a_hundredth_of_the_samples() {
        let (camera, scene, hidden) = (Linked::new(SIZE, 1080.0), night::scene(), ProgressBar::hidden());
        // Only the sky is compared: the upper third of the picture, which has the lamps.
        let noise = |found: &[[f64; 2]]| {
            found[..(SIZE[0] * SIZE[1] / 3 * 3) as usize].iter().map(|[_, square]| square).sum::<f64>()
        };
        let from_camera = noise(&pictures(|seed| {
            render(|rays| camera.rays(rays), &scene, &settings(seed, 512), &hidden).unwrap().0
        }));
        let from_lamps = noise(&pictures(|seed| {
            let joined =
                |scene_points: &ScenePoints, found: &mut Connections| camera.connect(scene_points, found);
            trace(joined, &scene, &settings(seed, 16), [0.0, 1.0], &hidden).unwrap().0
        }));
        // The variance is inversely proportional to the number of samples.
        let ratio = from_camera / from_lamps * 512.0 / 16.0;
        eprintln!("one path from a lamp for {ratio:.0} from the camera");
        assert!(ratio > 100.0, "{ratio}");
    }

    #[test]
    fn the_number_of_threads_changes_no_pixel() {
        let (camera, scene) = (Linked::new(SIZE, 1080.0), night::scene());
        let picture = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let joined =
                |scene_points: &ScenePoints, found: &mut Connections| camera.connect(scene_points, found);
            pool.install(|| trace(joined, &scene, &settings(3, 4), [0.0, 1.0], &ProgressBar::hidden()))
                .unwrap()
                .0
        };
        assert_eq!(picture(1), picture(3));
    }
}

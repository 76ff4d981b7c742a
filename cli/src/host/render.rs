//! Rendering: tiles over all cores, and every pixel the mean over its samples.

use super::image::Picture;
use super::plugin::PluginError;
use super::sampler;
use super::scene::Scene;
use super::shade::Numbers;
use super::shapes::Ray;
use glam::Vec3;
use indicatif::ProgressBar;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use realistic::abi::{realistic_ray, realistic_sample};
use std::time::{Duration, Instant};

/// Side of a tile in pixels.
const TILE: u32 = 16;

/// Where camera rays come from.
pub trait RaySource: Sync {
    /// One ray and one weight for every sample. Weight 0: the ray was blocked.
    ///
    /// # Errors
    /// The camera's own.
    fn rays(
        &self,
        samples: &[realistic_sample],
        rays: &mut [realistic_ray],
        weights: &mut [f32],
    ) -> Result<(), PluginError>;
}

/// How to render.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The top left pixel: not 0, 0 for a window into the camera's picture.
    pub corner: [u32; 2],
    /// Samples a pixel.
    pub spp: u32,
    /// Pictures with the same seed are the same, whatever the number of threads.
    pub seed: u64,
    /// Millimetres of the scene to a world unit of the camera.
    pub mm_per_unit: f32,
}

/// What a rendering did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Rays asked for.
    pub rays: u64,
    /// Rays that got through the lens.
    pub passed: u64,
    /// Time spent in the camera, summed over threads.
    pub in_camera: Duration,
}

impl Tally {
    /// Counts another rendering in.
    pub fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.passed += other.passed;
        self.in_camera += other.in_camera;
    }
}

/// Renders the scene on the current thread pool.
///
/// # Errors
/// The camera's own.
pub fn render(
    camera: &impl RaySource,
    scene: &Scene,
    settings: &Settings,
    progress: &ProgressBar,
) -> Result<(Picture, Tally), PluginError> {
    let [width, height] = settings.size;
    let across = width.div_ceil(TILE);
    let tiles = across * height.div_ceil(TILE);
    progress.set_length(u64::from(tiles));
    let done = (0..tiles).into_par_iter().map(|index| {
        let corner = [index % across * TILE, index / across * TILE];
        let mut tile = Tile::new(settings, index);
        let end = [0, 1].map(|axis| settings.size[axis].min(corner[axis] + TILE));
        for y in corner[1]..end[1] {
            tile.row(camera, scene, settings, corner[0]..end[0], y)?;
        }
        progress.inc(1);
        Ok((corner, end, tile.pixels, tile.tally))
    });
    let mut picture = Picture::plain(settings.size, [0.0; 3]);
    let mut total = Tally::default();
    for (corner, end, pixels, tally) in done.collect::<Result<Vec<_>, PluginError>>()? {
        let size = [0, 1].map(|axis| end[axis] - corner[axis]);
        picture.paste(&Picture { size, pixels }, corner);
        total.add(&tally);
    }
    Ok((picture, total))
}

/// One tile at work: its random numbers, and room for a row of samples and rays.
struct Tile {
    rng: Xoshiro256PlusPlus,
    /// For what came after the film, the lens and the light: those keep their numbers.
    more: Xoshiro256PlusPlus,
    film: Vec<[f32; 2]>,
    lens: Vec<[f32; 2]>,
    light: Vec<[f32; 2]>,
    facet: Vec<[f32; 2]>,
    time: Vec<f32>,
    samples: Vec<realistic_sample>,
    rays: Vec<realistic_ray>,
    weights: Vec<f32>,
    pixels: Vec<[f32; 3]>,
    tally: Tally,
}

impl Tile {
    fn new(settings: &Settings, index: u32) -> Self {
        let spp = settings.spp as usize;
        let row = spp * TILE as usize;
        // An odd multiple keeps neighbouring seeds from sharing tiles.
        let seed = settings.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ u64::from(index);
        let rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut more = rng.clone();
        more.jump();
        Self {
            rng,
            more,
            film: vec![[0.0; 2]; spp],
            lens: vec![[0.0; 2]; spp],
            light: vec![[0.0; 2]; row],
            facet: vec![[0.0; 2]; row],
            time: vec![0.0; spp],
            samples: vec![realistic_sample::default(); row],
            rays: vec![realistic_ray::default(); row],
            weights: vec![0.0; row],
            pixels: Vec::new(),
            tally: Tally::default(),
        }
    }

    fn row(
        &mut self,
        camera: &impl RaySource,
        scene: &Scene,
        settings: &Settings,
        columns: std::ops::Range<u32>,
        y: u32,
    ) -> Result<(), PluginError> {
        let spp = settings.spp as usize;
        let count = columns.len() * spp;
        let pixels = self.samples.chunks_exact_mut(spp).zip(self.light.chunks_exact_mut(spp));
        let [left, top] = settings.corner.map(|at| at as f32);
        for ((x, (samples, light)), facet) in columns.zip(pixels).zip(self.facet.chunks_exact_mut(spp)) {
            sampler::fill(&mut self.film, &mut self.rng);
            sampler::fill(&mut self.lens, &mut self.rng);
            sampler::fill(light, &mut self.rng);
            sampler::fill(facet, &mut self.more);
            sampler::strata(&mut self.time, &mut self.more);
            let numbers = self.film.iter().zip(&self.lens).zip(&self.time);
            for (sample, ((film, lens), &time)) in samples.iter_mut().zip(numbers) {
                *sample = realistic_sample {
                    image_x: left + x as f32 + film[0],
                    image_y: top + y as f32 + film[1],
                    lens_u: lens[0],
                    lens_v: lens[1],
                    time,
                };
            }
        }
        let (rays, weights) = (&mut self.rays[..count], &mut self.weights[..count]);
        let start = Instant::now();
        camera.rays(&self.samples[..count], rays, weights)?;
        self.tally.in_camera += start.elapsed();
        self.tally.rays += count as u64;
        let chosen = self.light.iter().zip(&self.facet);
        let traced = rays.iter().zip(&*weights).zip(chosen);
        let contributions: Vec<Vec3> = traced
            .map(|((ray, &weight), (&light, &facet))| {
                if weight == 0.0 {
                    return Vec3::ZERO;
                }
                self.tally.passed += 1;
                let ray = Ray {
                    origin: Vec3::from_array(ray.o) * settings.mm_per_unit,
                    direction: Vec3::from_array(ray.d),
                    time: ray.time,
                };
                weight * scene.radiance(&ray, Numbers { light, facet })
            })
            .collect();
        for samples in contributions.chunks_exact(spp) {
            let mean = samples.iter().sum::<Vec3>() / spp as f32;
            self.pixels.push(mean.to_array());
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pinhole at the origin, 60 degrees wide; its left half is blocked on demand.
    struct Pinhole {
        size: [u32; 2],
        half_blocked: bool,
    }

    impl RaySource for Pinhole {
        fn rays(
            &self,
            samples: &[realistic_sample],
            rays: &mut [realistic_ray],
            weights: &mut [f32],
        ) -> Result<(), PluginError> {
            let [width, height] = self.size.map(|side| side as f32);
            for ((sample, ray), weight) in samples.iter().zip(rays).zip(weights) {
                let x = (sample.image_x / width - 0.5) * 1.2;
                let y = (0.5 - sample.image_y / height) * 1.2 * height / width;
                ray.o = [0.0; 3];
                ray.d = Vec3::new(x, y, 1.0).normalize().to_array();
                ray.time = sample.time;
                *weight = if self.half_blocked && sample.lens_u < 0.5 { 0.0 } else { 1.0 };
            }
            Ok(())
        }
    }

    fn rendered(threads: usize, half_blocked: bool, spp: u32) -> (Picture, Tally) {
        pictured(&Scene::new(), threads, half_blocked, spp)
    }

    fn pictured(scene: &Scene, threads: usize, half_blocked: bool, spp: u32) -> (Picture, Tally) {
        let settings = Settings { size: [37, 21], corner: [0; 2], spp, seed: 7, mm_per_unit: 1.0 };
        let camera = Pinhole { size: settings.size, half_blocked };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render(&camera, scene, &settings, &ProgressBar::hidden())).unwrap()
    }

    fn with(effects: &str) -> Scene {
        Scene::new().with(effects.parse().unwrap())
    }

    #[test]
    fn without_effects_the_picture_is_that_of_a_scene_that_has_none() {
        let mut plain = Scene::new();
        plain.floor_roughness = 0.0;
        plain.sun.radius = 0.0;
        for ball in &mut plain.balls {
            ball.shape.velocity = Vec3::ZERO;
            ball.material.roughness = 0.0;
        }
        assert_eq!(pictured(&with("none"), 1, false, 4).0, pictured(&plain, 1, false, 4).0);
        assert_eq!(pictured(&with("all"), 1, false, 4).0, rendered(1, false, 4).0);
        for effect in ["gloss", "translucency", "soft-shadow", "motion"] {
            let (picture, _) = pictured(&with(effect), 1, false, 4);
            assert_ne!(picture, pictured(&plain, 1, false, 4).0, "{effect}");
        }
    }

    #[test]
    fn a_window_shows_its_part_of_the_picture() {
        let [corner, size] = [[16, 5], [20, 16]];
        let camera = Pinhole { size: [37, 21], half_blocked: false };
        let settings = Settings { size, corner, spp: 256, seed: 7, mm_per_unit: 1.0 };
        let scene = with("none");
        let (part, _) = render(&camera, &scene, &settings, &ProgressBar::hidden()).unwrap();
        let (whole, _) = pictured(&scene, 1, false, 256);
        let mut error = 0.0;
        for (index, pixel) in (0..).zip(&part.pixels) {
            let [x, y] = [corner[0] + index % size[0], corner[1] + index / size[0]];
            error += (pixel[1] - whole.pixels[(y * 37 + x) as usize][1]).abs();
        }
        assert!(error / (part.pixels.len() as f32) < 0.02, "{error}");
    }

    #[test]
    fn the_number_of_threads_and_their_order_change_no_pixel() {
        let (one, _) = rendered(1, false, 4);
        let (three, _) = rendered(3, false, 4);
        assert_eq!(one, three);
        assert!(one.pixels.iter().flatten().all(|value| *value > 0.0));
    }

    #[test]
    fn blocked_rays_count_in_the_mean() {
        let sum = |picture: &Picture| picture.pixels.iter().flatten().sum::<f32>();
        let (whole, _) = rendered(2, false, 64);
        let (half, tally) = rendered(2, true, 64);
        assert_eq!(tally.passed * 2, tally.rays);
        assert!((sum(&half) / sum(&whole) - 0.5).abs() < 0.01);
    }
}

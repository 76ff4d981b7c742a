//! Lamps that the camera sees, joined to it: points of each are connected to the lens by directions that the camera
//! samples, and counted where on the film they lead (as [`super::light`] does with all vertices of a path from a
//! lamp). What a ray from the camera meets by chance, a small lamp far out of focus, every sample finds here.

use super::dusk::{Dusk, facing_point};
use super::renderer::Settings;
use crate::host::plugin::{Connections, Places, PluginError};
use crate::host::scene::shapes::Ray;
use crate::image::Picture;
use glam::{DVec2, Vec3};
use rand::{Rng as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use realistic_lab::render::Tally;
use realistic_lab::render::sequence::{Point, Sequence, strata};
use std::time::Instant;

/// Samples that tell how large a lamp is on the film.
const PILOT: u32 = 512;
/// Samples for a pixel of a lamp's image, over those of a pixel's rays.
const DENSITY: f64 = 2.0;
/// Samples of a lamp, at least and at most.
const FEWEST: f64 = 1024.0;
const MOST: f64 = 4_194_304.0;
/// Points that are joined to the camera at once.
const BATCH: usize = 4096;

/// Irradiance, of one colour, on a rectangle of the film.
struct Spot {
    corner: [u32; 2],
    width: u32,
    values: Vec<f64>,
}

/// The whole picture of the lamps alone, for a camera that stands at `eye`.
pub struct Bulbs<'a> {
    /// The lamps.
    pub dusk: &'a Dusk<'a>,
    /// How to render. The part that `corner` and `size` say is returned.
    pub settings: &'a Settings,
    /// Width and height of the whole picture.
    pub whole: [u32; 2],
    /// When the shutter opens and closes.
    pub shutter: [f32; 2],
    /// Where the lens is, mm.
    pub eye: Vec3,
}

impl Bulbs<'_> {
    /// Takes the picture. A part of it has the whole one's bits.
    ///
    /// # Errors
    /// The camera's own.
    pub fn take(
        &self,
        camera: impl Fn(&Places, &mut Connections) -> Result<(), PluginError> + Sync,
    ) -> Result<(Picture, Tally), PluginError> {
        let Settings { size: [width, height], corner: [left, top], .. } = *self.settings;
        let mut picture = Picture::plain([width, height], [0.0; 3]);
        let mut total = Tally::default();
        let lamps = self.dusk.lamps();
        let spots = (0..lamps.len()).into_par_iter().map(|index| self.spot(index, &camera));
        for ((spot, tally), (_, colour)) in
            spots.collect::<Result<Vec<_>, PluginError>>()?.into_iter().zip(lamps)
        {
            total.add(&tally);
            for (y, row) in (spot.corner[1]..).zip(spot.values.chunks_exact(spot.width.max(1) as usize)) {
                for (x, value) in (spot.corner[0]..).zip(row) {
                    if (left..left + width).contains(&x) && (top..top + height).contains(&y) {
                        let pixel = &mut picture.pixels[((y - top) * width + x - left) as usize];
                        *pixel = (Vec3::from(*pixel) + *value as f32 * *colour).to_array();
                    }
                }
            }
        }
        Ok((picture, total))
    }

    /// A lamp's image.
    fn spot(
        &self,
        index: usize,
        camera: impl Fn(&Places, &mut Connections) -> Result<(), PluginError>,
    ) -> Result<(Spot, Tally), PluginError> {
        let seed = self.settings.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (index as u64) << 40;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut tally = Tally::default();
        let (mut count, mut sum, mut squares, mut mixed) = (0.0, DVec2::ZERO, DVec2::ZERO, 0.0);
        self.join(index, PILOT, random.next_u32(), &camera, &mut tally, |at, _| {
            (count, sum, squares, mixed) = (count + 1.0, sum + at, squares + at * at, mixed + at.x * at.y);
        })?;
        // An evenly lit ellipse has an area of 4π times the root of the determinant of its covariance.
        let (mean, n) = (sum / f64::max(count, 1.0), f64::max(count, 1.0));
        let spread = squares / n - mean * mean;
        let area = 4.0
            * std::f64::consts::PI
            * (spread.x * spread.y - (mixed / n - mean.x * mean.y).powi(2)).max(0.0).sqrt();
        let passing = n / f64::from(PILOT);
        let samples = DENSITY * f64::from(self.settings.spp) * (1.0 + area) / passing;
        let samples = if count == 0.0 { FEWEST } else { samples.clamp(FEWEST, MOST) } as u32;
        let mut found = Vec::with_capacity(samples as usize);
        self.join(index, samples, random.next_u32(), &camera, &mut tally, |at, share| {
            let pixel = [0, 1].map(|axis| (at[axis] as u32).min(self.whole[axis] - 1));
            found.push((pixel, share));
        })?;
        let bound = |choose: fn(u32, u32) -> u32, from: u32| {
            [0, 1].map(|axis| found.iter().map(|(pixel, _)| pixel[axis]).fold(from, choose))
        };
        let (low, high) = (bound(u32::min, u32::MAX), bound(u32::max, 0));
        if found.is_empty() {
            return Ok((Spot { corner: [0; 2], width: 0, values: Vec::new() }, tally));
        }
        let [width, height] = [0, 1].map(|axis| high[axis] - low[axis] + 1);
        let mut values = vec![0.0; (width * height) as usize];
        // The picture's film is one; a pixel's share of it gets the whole sum.
        let pixels = f64::from(self.whole[0]) * f64::from(self.whole[1]);
        for (pixel, share) in found {
            let [x, y] = [0, 1].map(|axis| pixel[axis] - low[axis]);
            values[(y * width + x) as usize] += share * pixels / f64::from(samples);
        }
        Ok((Spot { corner: low, width, values }, tally))
    }

    /// Joins points of a lamp to the camera; `found` takes where on the film each that is seen leads, and its light for
    /// radiance 1.
    fn join(
        &self,
        index: usize,
        samples: u32,
        seed: u32,
        camera: impl Fn(&Places, &mut Connections) -> Result<(), PluginError>,
        tally: &mut Tally,
        mut found: impl FnMut(DVec2, f64),
    ) -> Result<(), PluginError> {
        let (sphere, _) = &self.dusk.lamps()[index];
        let towards = (self.eye - sphere.centre).normalize();
        let units_per_mm = self.settings.mm_per_unit.recip();
        // Areas are of the scene, in mm².
        let area = f64::from(units_per_mm).powi(2);
        let mut numbers: Vec<Point> = vec![Point::default(); samples as usize];
        Sequence::Sobol.fill(seed, 4, &mut numbers);
        let mut times = vec![0.0; samples as usize];
        strata(seed, &mut times);
        let [open, close] = self.shutter;
        let mut connections = Connections::default();
        for (numbers, times) in numbers.chunks(BATCH).zip(times.chunks(BATCH)) {
            let mut places = Places::default();
            let mut points = Vec::with_capacity(numbers.len());
            for ([lens_u, lens_v, u, v], time) in numbers.iter().zip(times) {
                let (point, normal, density) = facing_point(sphere, towards, [*u, *v]);
                let time = open + (close - open) * time;
                places.push((point * units_per_mm).to_array(), [*lens_u, *lens_v], time);
                points.push((point, normal, density));
            }
            let start = Instant::now();
            camera(&places, &mut connections)?;
            tally.in_camera += start.elapsed();
            tally.rays += points.len() as u64;
            for (i, (point, normal, density)) in points.into_iter().enumerate() {
                let direction = Vec3::from_array(connections.direction(i));
                let cosine = normal.dot(direction);
                if !(connections.importance[i] > 0.0 && cosine > 0.0) {
                    continue;
                }
                tally.passed += 1;
                let ray = Ray { origin: point, direction, time: places.time(i) };
                let front = Vec3::from_array(connections.origin(i)) / units_per_mm;
                if self.dusk.hides(&ray, (front - point).length()) {
                    continue;
                }
                let share = f64::from(connections.importance[i]) * f64::from(cosine) * area
                    / (f64::from(connections.density[i]) * f64::from(density));
                let [x, y] = connections.pixel(i).map(f64::from);
                found(DVec2::new(x, y), share);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::dusk::Seen;
    use super::super::linked::{Linked, pictures};
    use super::super::render;
    use super::*;
    use crate::host::scene::{Scene, chess};
    use indicatif::ProgressBar;

    const SIZE: [u32; 2] = [12, 8];

    fn settings(seed: u64, spp: u32, seen: Seen) -> Settings {
        Settings { size: SIZE, corner: [0; 2], spp, seed, mm_per_unit: 1.0, seen }
    }

    fn lamps(camera: &Linked, scene: &Scene, settings: &Settings) -> Picture {
        let dusk = Dusk::of(scene, Seen::Joined);
        let eye = [3, 7, 11].map(|at| scene.pose[at]).into();
        let bulbs = Bulbs { dusk: &dusk, settings, whole: SIZE, shutter: [0.0, 1.0], eye };
        bulbs.take(|places, found| camera.connect(places, found)).unwrap().0
    }

    /// Lamps of the chess scene over the floor, as a camera at the origin sees them, so large that rays often meet them.
    fn scene() -> Scene {
        let mut scene = chess::scene();
        scene.lamps = scene
            .lamps
            .iter()
            .map(|group| {
                let moved = group.lamps.iter().cloned().map(|mut lamp| {
                    lamp.shape.radius *= 2.0;
                    lamp
                });
                moved.collect()
            })
            .collect();
        scene.solids = std::sync::Arc::default();
        scene.pose = crate::host::scene::LEVEL;
        scene
    }

    #[test]
    fn lamps_met_by_rays_and_lamps_joined_to_the_lens_make_one_picture() {
        let (camera, scene, hidden) = (Linked::new(SIZE, 720.0), scene(), ProgressBar::hidden());
        let taken = |seed: u64, spp: u32, seen: Seen| {
            render(|rays| camera.rays(rays), &scene, &settings(seed, spp, seen), &hidden).unwrap().0
        };
        let met = pictures(|seed| taken(seed, 256, Seen::Met));
        let joined = pictures(|seed| {
            let mut picture = taken(seed, 256, Seen::Joined);
            picture.add(&lamps(&camera, &scene, &settings(seed, 64, Seen::Joined)));
            picture
        });
        let sum = |all: &[[f64; 2]]| all.iter().map(|[mean, _]| mean).sum::<f64>();
        assert!((sum(&met) / sum(&joined) - 1.0).abs() < 0.01, "{} {}", sum(&met), sum(&joined));
        // Squares of a number with Student's distribution, of 15 to 30 degrees of freedom.
        let squares = met.iter().zip(&joined).map(|([a, of_a], [b, of_b])| (a - b).powi(2) / (of_a + of_b));
        let (chi, count) = (squares.sum::<f64>(), met.len() as f64);
        eprintln!("chi squared {chi:.0} of {count}");
        assert!(chi < 1.6 * count, "{chi} of {count}");
        // Rays alone do not show the lamps, and the lamps have far less noise than where rays meet them.
        let dark = pictures(|seed| taken(seed, 64, Seen::Joined));
        assert!(sum(&dark) < 0.8 * sum(&joined));
        let noise = |all: &[[f64; 2]]| all.iter().map(|[_, square]| square).sum::<f64>();
        assert!(noise(&joined) < 0.2 * noise(&met), "{} {}", noise(&joined), noise(&met));
    }

    #[test]
    fn a_part_is_the_whole_pictures_and_threads_change_nothing() {
        let (camera, scene) = (Linked::new(SIZE, 720.0), scene());
        let picture = |threads: usize, corner: [u32; 2], size: [u32; 2]| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let settings = Settings { size, corner, ..settings(3, 1, Seen::Joined) };
            pool.install(|| lamps(&camera, &scene, &settings))
        };
        let whole = picture(1, [0; 2], SIZE);
        assert_eq!(whole, picture(3, [0; 2], SIZE));
        let part = picture(2, [5, 1], [4, 6]);
        for (index, pixel) in (0..).zip(&part.pixels) {
            let [x, y] = [5 + index % 4, 1 + index / 4];
            assert_eq!(*pixel, whole.pixels[y * SIZE[0] as usize + x]);
        }
        assert!(whole.pixels.iter().flatten().any(|value| *value > 0.0));
    }
}

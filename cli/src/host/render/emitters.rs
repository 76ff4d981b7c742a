//! Connections of visible lamps and windows to the camera. Points of each emitter are connected to the lens along
//! directions that the camera samples, and their light is added at the film points of these rays (as [`super::light`]
//! does with all vertices of a path from a lamp). A ray from the camera meets a small lamp far out of focus only by
//! chance, but every connected sample reaches it. Rays are better for a large lamp nearly in focus: in most of the
//! lamp's image, every ray meets the lamp.
//!
//! The image of an emitter is its sharp image, blurred by the lens. A point represents a part of the emitter, and a
//! direction represents a part of the lens. The light is therefore spread over a square of the film, so that every
//! pixel receives light from many points. The area of the square is a sixteenth of that of the sharp image or of the
//! blur, whichever is smaller, and its side is at most [`WIDEST`] pixels. The edge of the image becomes wider by less
//! than a tenth, and an occluder in front of the emitter has an edge as wide as the square.

use super::dusk::{Dusk, EmitterPoint};
use super::renderer::Settings;
use crate::host::plugin::{Connections, PluginError, ScenePoints};
use crate::host::scene::shapes::Ray;
use crate::image::Picture;
use glam::{DVec2, DVec3, Vec3};
use rand::{Rng as _, SeedableRng as _};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use realistic_lab::render::Tally;
use realistic_lab::render::sequence::{Point, Sequence, strata};
use std::time::Instant;

/// Number of samples that estimate the size of an emitter's image.
const PILOT: u32 = 512;
/// Largest share of its image that the sharp image may fill for an emitter to be connected; this is about the share
/// of the rays to the image that meet the emitter.
const SHARP: f64 = 0.3;
/// Area of an image, pixels, below which the emitter is always connected.
const LARGE: f64 = 1000.0;
/// Ratio of the area of the sharp image, or of the blur if that is smaller, to the area of a point's square.
const PARTS: f64 = 16.0;
/// Largest side of the square, pixels. A larger one needs fewer points, but softens sharp objects in front of a window.
const WIDEST: f64 = 4.0;
/// Number of points that contribute to a pixel of an image, per ray sample of a pixel.
const DENSITY: f64 = 6.0;
/// Least and largest number of samples of an emitter.
const FEWEST: f64 = 1024.0;
const MOST: f64 = 4_194_304.0;
/// Number of points per call of the camera.
const BATCH: usize = 4096;

/// Irradiance on a rectangle of the film.
struct EmitterImage {
    corner: [u32; 2],
    width: u32,
    values: Vec<DVec3>,
}

/// Points of an emitter that are connected to the camera.
#[derive(Clone, Copy, Debug)]
struct Points {
    /// Index of the emitter.
    emitter: usize,
    /// Number of points.
    samples: u32,
    /// Seed of their random numbers.
    seed: u32,
    /// The lens sample that all points share; `None` if each point has its own.
    lens: Option<[f32; 2]>,
}

/// An emitter that is connected to the camera.
#[derive(Clone, Copy, Debug)]
pub struct EmitterPlan {
    /// Index of the emitter.
    pub emitter: usize,
    points: Points,
    /// Side of the square over which the light of a point is spread, pixels.
    side: f64,
}

/// The whole picture of only the emitters, for a camera at `eye`.
pub struct EmitterPicture<'a> {
    /// The scene.
    pub dusk: &'a Dusk<'a>,
    /// Render settings. The picture covers the part given by `corner` and `size`.
    pub settings: &'a Settings<'a>,
    /// Width and height of the whole picture.
    pub whole: [u32; 2],
    /// Times at which the shutter opens and closes.
    pub shutter: [f32; 2],
    /// Position of the lens, mm.
    pub eye: Vec3,
}

impl EmitterPicture<'_> {
    /// Chooses the emitters to connect, the same for all parts of a picture.
    ///
    /// # Errors
    /// The camera's error.
    pub fn plan(
        &self,
        camera: impl Fn(&ScenePoints, &mut Connections) -> Result<(), PluginError> + Sync,
    ) -> Result<Vec<EmitterPlan>, PluginError> {
        let all = 0..self.dusk.emitters().len();
        let plans = all.into_par_iter().filter_map(|emitter| self.plan_one(emitter, &camera).transpose());
        plans.collect()
    }

    fn plan_one(
        &self,
        emitter: usize,
        camera: impl Fn(&ScenePoints, &mut Connections) -> Result<(), PluginError>,
    ) -> Result<Option<EmitterPlan>, PluginError> {
        let seed = self.settings.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (emitter as u64) << 40;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut points = |samples: u32, lens| Points { emitter, samples, seed: random.next_u32(), lens };
        let pilot = |points: Points| -> Result<(f64, f64), PluginError> {
            let (mut count, mut sum, mut squares, mut mixed) = (0.0, DVec2::ZERO, DVec2::ZERO, 0.0);
            self.join(points, &camera, &mut Tally::default(), |at, _| {
                (count, sum, squares, mixed) =
                    (count + 1.0, sum + at, squares + at * at, mixed + at.x * at.y);
            })?;
            // The area of an evenly lit ellipse is 4π times the root of the determinant of its covariance.
            let (mean, n) = (sum / f64::max(count, 1.0), f64::max(count, 1.0));
            let spread = squares / n - mean * mean;
            let determinant = spread.x * spread.y - (mixed / n - mean.x * mean.y).powi(2);
            Ok((count, 4.0 * std::f64::consts::PI * determinant.max(0.0).sqrt()))
        };
        let (count, area) = pilot(points(PILOT, None))?;
        let (_, sharp) = pilot(points(PILOT, Some([0.5; 2])))?;
        if sharp > SHARP * area && area > LARGE {
            return Ok(None);
        }
        let blur = (area.sqrt() - sharp.sqrt()).max(0.0).powi(2);
        let square = (sharp.min(blur) / PARTS).min(WIDEST * WIDEST);
        let samples = DENSITY * f64::from(self.settings.spp) * (1.0 + area) * f64::from(PILOT)
            / (count.max(1.0) * square.max(1.0));
        let samples = if count == 0.0 { FEWEST } else { samples.clamp(FEWEST, MOST) } as u32;
        Ok(Some(EmitterPlan { emitter, points: points(samples, None), side: square.sqrt() }))
    }

    /// Renders the picture. A part of it is identical to that part of the whole picture, to the last bit.
    ///
    /// # Errors
    /// The camera's error.
    pub fn take(
        &self,
        plans: &[EmitterPlan],
        camera: impl Fn(&ScenePoints, &mut Connections) -> Result<(), PluginError> + Sync,
    ) -> Result<(Picture, Tally), PluginError> {
        let Settings { size: [width, height], corner: [left, top], .. } = *self.settings;
        let mut picture = Picture::plain([width, height], [0.0; 3]);
        let mut total = Tally::default();
        let spots = plans.par_iter().map(|plan| self.spot(plan, &camera));
        for (spot, tally) in spots.collect::<Result<Vec<_>, PluginError>>()? {
            total.add(&tally);
            for (y, row) in (spot.corner[1]..).zip(spot.values.chunks_exact(spot.width.max(1) as usize)) {
                for (x, value) in (spot.corner[0]..).zip(row) {
                    if (left..left + width).contains(&x) && (top..top + height).contains(&y) {
                        let pixel = &mut picture.pixels[((y - top) * width + x - left) as usize];
                        *pixel = (Vec3::from(*pixel) + value.as_vec3()).to_array();
                    }
                }
            }
        }
        Ok((picture, total))
    }

    /// Renders an emitter's image.
    fn spot(
        &self,
        plan: &EmitterPlan,
        camera: impl Fn(&ScenePoints, &mut Connections) -> Result<(), PluginError>,
    ) -> Result<(EmitterImage, Tally), PluginError> {
        let mut tally = Tally::default();
        let mut found = Vec::with_capacity(plan.points.samples as usize);
        self.join(plan.points, &camera, &mut tally, |at, light| found.push((at, light)))?;
        // Range of pixels that the square around a film point overlaps; its end is exclusive.
        let reach = |at: f64, axis: usize| {
            let [from, to] = [at - 0.5 * plan.side, at + 0.5 * plan.side];
            let last = self.whole[axis] - 1;
            [(from.max(0.0) as u32).min(last), (to.max(0.0) as u32).min(last) + 1]
        };
        let bound = |choose: fn(u32, u32) -> u32, end: usize, from: u32| {
            [0, 1].map(|axis| found.iter().map(|(at, _)| reach(at[axis], axis)[end]).fold(from, choose))
        };
        let (low, high) = (bound(u32::min, 0, u32::MAX), bound(u32::max, 1, 0));
        if found.is_empty() {
            return Ok((EmitterImage { corner: [0; 2], width: 0, values: Vec::new() }, tally));
        }
        let [width, height] = [0, 1].map(|axis| high[axis] - low[axis]);
        let mut values = vec![DVec3::ZERO; (width * height) as usize];
        // The film has an area of 1 in total, and a pixel has its share of that area; the whole sum counts for each
        // pixel's share.
        let pixels = f64::from(self.whole[0]) * f64::from(self.whole[1]);
        // Share of the square's side that lies in a pixel; a square of side 0 is a point.
        let part = |at: f64, pixel: u32| {
            let [from, to] = [at - 0.5 * plan.side, at + 0.5 * plan.side];
            let within = to.min(f64::from(pixel + 1)) - from.max(f64::from(pixel));
            if plan.side > 0.0 { within.max(0.0) / plan.side } else { 1.0 }
        };
        for (at, light) in &found {
            let light = light.as_dvec3() * (pixels / f64::from(plan.points.samples));
            let [columns, rows] = [0, 1].map(|axis| reach(at[axis], axis));
            for y in rows[0]..rows[1] {
                let light = light * part(at.y, y);
                let start = (y - low[1]) * width;
                for x in columns[0]..columns[1] {
                    values[(start + x - low[0]) as usize] += light * part(at.x, x);
                }
            }
        }
        Ok((EmitterImage { corner: low, width, values }, tally))
    }

    /// Connects points of an emitter to the camera; `found` receives the film point and the light of each point that
    /// is visible.
    fn join(
        &self,
        Points { emitter, samples, seed, lens }: Points,
        camera: impl Fn(&ScenePoints, &mut Connections) -> Result<(), PluginError>,
        tally: &mut Tally,
        mut found: impl FnMut(DVec2, Vec3),
    ) -> Result<(), PluginError> {
        let emitter = self.dusk.emitters()[emitter];
        let units_per_mm = self.settings.mm_per_unit.recip();
        // Areas are measured in the scene, in mm².
        let area = f64::from(units_per_mm).powi(2);
        let mut numbers: Vec<Point> = vec![Point::default(); samples as usize];
        Sequence::Sobol.fill(seed, 4, &mut numbers);
        let mut times = vec![0.0; samples as usize];
        strata(seed, &mut times);
        let [open, close] = self.shutter;
        let mut connections = Connections::default();
        for (numbers, times) in numbers.chunks(BATCH).zip(times.chunks(BATCH)) {
            let mut scene_points = ScenePoints::default();
            let mut points = Vec::with_capacity(numbers.len());
            for ([lens_u, lens_v, u, v], time) in numbers.iter().zip(times) {
                let point = emitter.point(self.eye, [*u, *v]);
                let time = open + (close - open) * time;
                scene_points.push(
                    (point.point * units_per_mm).to_array(),
                    lens.unwrap_or([*lens_u, *lens_v]),
                    time,
                );
                points.push(point);
            }
            let start = Instant::now();
            camera(&scene_points, &mut connections)?;
            tally.in_camera += start.elapsed();
            tally.rays += points.len() as u64;
            for (i, EmitterPoint { point, normal, radiance, density }) in points.into_iter().enumerate() {
                let direction = Vec3::from_array(connections.direction(i));
                let cosine = normal.dot(direction);
                if !(connections.importance[i] > 0.0 && cosine > 0.0 && radiance != Vec3::ZERO) {
                    continue;
                }
                tally.passed += 1;
                let ray = Ray { origin: point, direction, time: scene_points.time(i) };
                let front = Vec3::from_array(connections.origin(i)) / units_per_mm;
                if self.dusk.hides(&ray, (front - point).length()) {
                    continue;
                }
                let share = f64::from(connections.importance[i]) * f64::from(cosine) * area
                    / (f64::from(connections.density[i]) * f64::from(density));
                let [x, y] = connections.pixel(i).map(f64::from);
                found(DVec2::new(x, y), share as f32 * radiance);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::linked::{Linked, pictures};
    use super::super::render;
    use super::*;
    use crate::host::scene::solids::{Appearance, Block, Form};
    use crate::host::scene::{Finish, Material, Pane, Scene, chess};
    use glam::Vec2;
    use indicatif::ProgressBar;

    const SIZE: [u32; 2] = [12, 8];

    fn settings(seed: u64, spp: u32, joined: &[usize]) -> Settings<'_> {
        Settings { joined, ..Settings::plain(SIZE, spp, seed) }
    }

    /// Renders the picture of the connected emitters, and returns their indices.
    fn emitters(camera: &Linked, scene: &Scene, settings: &Settings<'_>) -> (Picture, Vec<usize>) {
        let dusk = Dusk::of(scene, &[]);
        let eye = [3, 7, 11].map(|at| scene.pose[at]).into();
        let bulbs = EmitterPicture { dusk: &dusk, settings, whole: SIZE, shutter: [0.0, 1.0], eye };
        let joined =
            |scene_points: &ScenePoints, found: &mut Connections| camera.connect(scene_points, found);
        let plans = bulbs.plan(joined).unwrap();
        (bulbs.take(&plans, joined).unwrap().0, plans.iter().map(|plan| plan.emitter).collect())
    }

    /// A wall with lit windows.
    fn wall(point: Vec3, _: Vec3) -> Material {
        if (point.x / 300.0).rem_euclid(1.0) < 0.6 {
            Material::new([1.5, 0.9, 0.4], Finish::Lamp)
        } else {
            Material::new([0.1; 3], Finish::Matte)
        }
    }

    /// Makes lamps of the chess scene over the floor, as a camera at the origin sees them. The lamps are so large
    /// that rays often meet them; behind some of them is a wall with windows.
    fn scene() -> Scene {
        const CENTRE: Vec3 = Vec3::new(-700.0, 250.0, 9000.0);
        const HALF: Vec3 = Vec3::new(1400.0, 350.0, 200.0);
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
        let block = Block { centre: CENTRE, half: HALF, turn: Vec2::X };
        let solids = [(Form::Block(block), Appearance::Painted(wall))].into_iter();
        scene.solids = std::sync::Arc::new(solids.collect());
        scene.panes = vec![Pane {
            corner: CENTRE - HALF,
            sides: [2.0 * HALF.x * Vec3::X, 2.0 * HALF.y * Vec3::Y],
            normal: Vec3::NEG_Z,
            material_at: wall,
        }];
        scene.pose = crate::host::scene::LEVEL;
        scene
    }

    #[test]
    fn lamps_joined_to_the_lens_make_the_picture_of_plain_rays() {
        let (camera, scene, hidden) = (Linked::new(SIZE, 720.0), scene(), ProgressBar::hidden());
        let taken = |seed: u64, spp: u32, joined: &[usize]| {
            render(|rays| camera.rays(rays), &scene, &settings(seed, spp, joined), &hidden).unwrap().0
        };
        let met = pictures(|seed| taken(seed, 256, &[]));
        let joined = pictures(|seed| {
            let (emitted, joined) = emitters(&camera, &scene, &settings(seed, 64, &[]));
            let mut picture = taken(seed, 256, &joined);
            picture.add(&emitted);
            picture
        });
        let sum = |all: &[[f64; 2]]| all.iter().map(|[mean, _]| mean).sum::<f64>();
        assert!((sum(&met) / sum(&joined) - 1.0).abs() < 0.01, "{} {}", sum(&met), sum(&joined));
        // Squares of a number that has Student's distribution with 15 to 30 degrees of freedom.
        let squares = met.iter().zip(&joined).map(|([a, of_a], [b, of_b])| (a - b).powi(2) / (of_a + of_b));
        let (chi, count) = (squares.sum::<f64>(), met.len() as f64);
        eprintln!("chi squared {chi:.0} of {count}");
        assert!(chi < 1.6 * count, "{chi} of {count}");
        // Without connections, the rays do not show the emitters. Connected emitters have far less noise than
        // emitters that rays meet.
        let (_, all) = emitters(&camera, &scene, &settings(1, 1, &[]));
        let lamps = scene.lamps.iter().map(|group| group.lamps.len()).sum();
        assert!(all.len() > 50 && all.contains(&lamps), "{all:?}");
        let dark = pictures(|seed| taken(seed, 64, &all));
        assert!(sum(&dark) < 0.8 * sum(&joined));
        let noise = |all: &[[f64; 2]]| all.iter().map(|[_, square]| square).sum::<f64>();
        assert!(noise(&joined) < 0.2 * noise(&met), "{} {}", noise(&joined), noise(&met));
    }

    #[test]
    fn a_part_is_the_whole_pictures_and_threads_change_nothing() {
        let (camera, scene) = (Linked::new(SIZE, 720.0), scene());
        let picture = |threads: usize, corner: [u32; 2], size: [u32; 2]| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let settings = Settings { size, corner, ..settings(3, 1, &[]) };
            pool.install(|| emitters(&camera, &scene, &settings)).0
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

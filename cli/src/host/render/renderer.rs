//! Rendering in tiles on all cores; every pixel is the mean over its samples.

use super::adaptive::{self, AdaptiveSampling};
use super::dusk::Dusk;
use super::lamplight::Lights;
use super::shade::{ShadingSample, radiance};
use crate::host::plugin::PluginError;
use crate::host::scene::shapes::Ray;
use crate::host::scene::{Light, Scene};
use crate::image::Picture;
use glam::Vec3;
use indicatif::ProgressBar;
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use realistic::ffi::{realistic_ray, realistic_sample};
use realistic_lab::render::sequence::{Point, sobol_from, strata};
use realistic_lab::render::{self, Integrand, Rays, Tally, Window};
use std::cmp::Ordering;

/// Side of a tile in pixels.
pub const TILE: u32 = 16;

/// Render settings.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'a> {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The top left pixel, which is not 0 for a tile of the camera's picture.
    pub corner: [u32; 2],
    /// Samples per pixel.
    pub spp: u32,
    /// Seed. Pictures with the same seed are equal, whatever the number of threads, and a tile equals that part of
    /// the whole.
    pub seed: u64,
    /// Millimetres in the scene per world unit of the camera.
    pub mm_per_unit: f32,
    /// Indices of the lamps and windows at dusk that rays from the camera see as dark ([`super::EmitterPicture`]).
    pub joined: &'a [usize],
    /// Criterion by which pixels at dusk get more or fewer samples than `spp`, while a table provides the light of
    /// surfaces; `None` for plain paths with equally many samples per pixel. Where the picture continues beyond the
    /// part, the part's pixels nearer than [`adaptive::REACH`] to its edge differ from those of the whole picture.
    pub adaptive: Option<AdaptiveSampling<'a>>,
    /// One tile in this number of tiles of the picture is rendered, with [`MARGIN`] pixels around it; the rest stays
    /// black.
    pub stride: u32,
}

impl Settings<'_> {
    /// Returns the settings for a whole picture by plain paths, of a scene in the camera's world units.
    pub fn plain(size: [u32; 2], spp: u32, seed: u64) -> Self {
        Self { size, corner: [0; 2], spp, seed, mm_per_unit: 1.0, joined: &[], adaptive: None, stride: 1 }
    }
}

/// Number of pixels around a tile that contribute to it: those that share samples, and one for the filter.
const MARGIN: u32 = adaptive::REACH + 1;

/// Renders the scene on the current thread pool.
///
/// # Errors
/// The camera's error.
pub fn render(
    camera: impl Fn(Rays<'_>) -> Result<(), PluginError> + Sync,
    scene: &Scene,
    settings: &Settings<'_>,
    progress: &ProgressBar,
) -> Result<(Picture, Tally), PluginError> {
    // The tiles have the same positions in every part of a picture.
    let first = settings.corner.map(|at| at / TILE);
    let end = [0, 1].map(|axis| settings.corner[axis] + settings.size[axis]);
    let across = end[0].div_ceil(TILE) - first[0];
    let tiles = across * (end[1].div_ceil(TILE) - first[1]);
    let light = Lighting::of(scene, settings);
    progress.set_length(u64::from(tiles));
    let done = (0..tiles).into_par_iter().filter_map(|index| {
        let tile = [index % across, index / across];
        let block = [0, 1].map(|axis| (first[axis] + tile[axis]) * TILE);
        let [low, high] = rendered_part(tile, [across, tiles / across], settings.stride)?;
        let corner = [0, 1].map(|axis| (block[axis] + low[axis]).max(settings.corner[axis]));
        let size = [0, 1].map(|axis| (block[axis] + high[axis]).min(end[axis]).checked_sub(corner[axis]));
        Some((block, corner, [size[0].filter(|side| *side > 0)?, size[1].filter(|side| *side > 0)?]))
    });
    let done = done.map(|(block, corner, size)| {
        let mut view = SceneSampler::new(scene, &light, settings);
        let window = Window { corner, size };
        let (pixels, blurs, tally) = match &settings.adaptive {
            None => {
                let (pixels, tally) = render::render(&camera, &mut view, window, settings.spp as usize)?;
                (pixels, Vec::new(), tally)
            }
            Some(adaptive) => {
                let block = Window { corner: block, size: [TILE; 2] };
                adaptive.render(&camera, &mut view, window, block, settings.spp)?
            }
        };
        progress.inc(1);
        let pixels = pixels.into_iter().map(|pixel| pixel.map(|value| value as f32)).collect();
        let offset = [0, 1].map(|axis| corner[axis] - settings.corner[axis]);
        Ok((offset, Picture { size, pixels }, blurs, tally))
    });
    let mut picture = Picture::plain(settings.size, [0.0; 3]);
    let mut all_blurs = vec![0.0; picture.pixels.len()];
    let mut total = Tally::default();
    for (offset, part, blurs, tally) in done.collect::<Result<Vec<_>, PluginError>>()? {
        picture.paste(&part, offset);
        for (row, blurs) in (offset[1]..).zip(blurs.chunks_exact(part.size[0] as usize)) {
            let start = (row * settings.size[0] + offset[0]) as usize;
            all_blurs[start..start + blurs.len()].copy_from_slice(blurs);
        }
        total.add(&tally);
    }
    if let Some(adaptive) = &settings.adaptive {
        picture.add(adaptive.beside);
        picture = adaptive::shared(&picture, &all_blurs);
    }
    Ok((picture, total))
}

/// Returns the part of a tile, relative to its top left pixel, that is rendered if one in `stride` tiles is rendered:
/// such a tile as a whole, or the margin of such a neighbour.
fn rendered_part(tile: [u32; 2], tiles: [u32; 2], stride: u32) -> Option<[[u32; 2]; 2]> {
    let around = |axis: usize| tile[axis].saturating_sub(1)..(tile[axis] + 2).min(tiles[axis]);
    let others = around(1).flat_map(|y| around(0).map(move |x| [x, y]));
    let taken = others.filter(|[x, y]| (y * tiles[0] + x).is_multiple_of(stride)).map(|other| {
        [0, 1].map(|axis| match other[axis].cmp(&tile[axis]) {
            Ordering::Less => [0, MARGIN],
            Ordering::Equal => [0, TILE],
            Ordering::Greater => [TILE - MARGIN, TILE],
        })
    });
    let all = taken.reduce(|one, other| {
        [0, 1].map(|axis| [one[axis][0].min(other[axis][0]), one[axis][1].max(other[axis][1])])
    })?;
    Some([all.map(|[low, _]| low), all.map(|[_, high]| high)])
}

/// Returns the RMS difference between two pictures over their rendered tiles, divided by √2, which is the noise of
/// either picture if their seeds differ. Also returns the mean.
pub fn noise(one: &Picture, other: &Picture, stride: u32) -> [f64; 2] {
    let [width, height] = one.size;
    let tiles = [width, height].map(|side| side.div_ceil(TILE));
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for index in (0..tiles[0] * tiles[1]).step_by(stride as usize) {
        let [left, top] = [index % tiles[0], index / tiles[0]].map(|at| at * TILE);
        for y in top..(top + TILE).min(height) {
            for x in left..(left + TILE).min(width) {
                let at = (y * width + x) as usize;
                for (one, other) in one.pixels[at].iter().zip(other.pixels[at]) {
                    count += 1.0;
                    sum += 0.5 * f64::from(one + other);
                    squares += 0.5 * f64::from(one - other).powi(2);
                }
            }
        }
    }
    [(squares / count).sqrt(), sum / count]
}

/// The lighting, which determines how the light along a ray is computed.
enum Lighting<'a> {
    Day,
    Lamps(Lights),
    Dusk(Box<Dusk<'a>>),
}

impl<'a> Lighting<'a> {
    fn of(scene: &'a Scene, settings: &Settings<'_>) -> Self {
        match scene.light {
            Light::Day => Self::Day,
            Light::Lamps => Self::Lamps(Lights::of(scene)),
            Light::Dusk => {
                let dusk = Dusk::of(scene, settings.joined);
                Self::Dusk(Box::new(match settings.adaptive {
                    Some(AdaptiveSampling { whole: [width, height], .. }) => {
                        let samples = u64::from(width) * u64::from(height) * u64::from(settings.spp);
                        dusk.with_cache(samples, settings.seed)
                    }
                    None => dusk,
                }))
            }
        }
    }
}

/// The scene as one tile samples it. Each pair of coordinates is well spread over the pixel, the lens, the sun or the
/// facets, and is independent of the other pairs.
struct SceneSampler<'a> {
    scene: &'a Scene,
    light: &'a Lighting<'a>,
    mm_per_unit: f32,
    seed: u64,
    /// Number of samples of a pixel that were taken before.
    before: usize,
    pairs: [Vec<Point>; 5],
    times: Vec<f32>,
    fates: Vec<f32>,
    /// Shading samples of the batch.
    shading: Vec<ShadingSample>,
}

impl<'a> SceneSampler<'a> {
    fn new(scene: &'a Scene, light: &'a Lighting<'a>, settings: &Settings<'_>) -> Self {
        Self {
            scene,
            light,
            mm_per_unit: settings.mm_per_unit,
            seed: settings.seed,
            before: 0,
            pairs: Default::default(),
            times: Vec::new(),
            fates: Vec::new(),
            shading: Vec::new(),
        }
    }

    /// Converts a ray of the camera to millimetres.
    fn world(&self, ray: &realistic_ray) -> Ray {
        let origin = Vec3::from_array(ray.o) * self.mm_per_unit;
        Ray { origin, direction: Vec3::from_array(ray.d), time: ray.time }
    }

    /// Returns the random numbers of a pixel of the whole picture, which are the same in every part of the picture.
    fn random(&self, [x, y]: [u32; 2]) -> Xoshiro256PlusPlus {
        let pixel = u64::from(y) << 32 | u64::from(x);
        // An odd multiplier keeps neighbouring seeds from sharing pixels.
        Xoshiro256PlusPlus::seed_from_u64(self.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ pixel)
    }
}

impl Integrand<3> for SceneSampler<'_> {
    fn place(&mut self, [x, y]: [u32; 2], first: usize, samples: &mut [realistic_sample]) {
        let mut random = self.random([x, y]);
        // The samples continue the earlier ones; the strata of times and fates are new.
        let before = self.before as u32;
        let [pairs @ .., aside] = &mut self.pairs;
        for pair in pairs {
            pair.resize(samples.len(), Point::default());
            sobol_from(before, random.next_u32(), 2, pair);
        }
        for numbers in [&mut self.times, &mut self.fates] {
            numbers.resize(samples.len(), 0.0);
            strata(random.next_u32() ^ before, numbers);
        }
        aside.resize(samples.len(), Point::default());
        sobol_from(before, random.next_u32(), 2, aside);
        self.shading.truncate(first);
        for (number, sample) in samples.iter_mut().enumerate() {
            let [film, lens, light, facet, aside] =
                self.pairs.each_ref().map(|pair| pair[number].first_chunk().copied().unwrap());
            *sample = realistic_sample {
                image_x: x as f32 + film[0],
                image_y: y as f32 + film[1],
                lens_u: lens[0],
                lens_v: lens[1],
                time: self.times[number],
            };
            self.shading.push(ShadingSample { light, facet, fate: self.fates[number], aside });
        }
    }

    fn radiance(&self, number: usize, ray: &realistic_ray) -> [f32; 3] {
        adaptive::AdaptiveIntegrand::seen(self, number, ray).0
    }
}

impl adaptive::AdaptiveIntegrand for SceneSampler<'_> {
    fn follow(&mut self, before: usize) {
        self.before = before;
    }

    fn seen(&self, number: usize, ray: &realistic_ray) -> ([f32; 3], f32) {
        let ray = self.world(ray);
        let sample = self.shading[number];
        // Only scenes at dusk need the distance, for the blur.
        let (found, distance) = match self.light {
            Lighting::Day => (radiance(self.scene, &ray, sample), f32::INFINITY),
            Lighting::Lamps(lights) => (lights.radiance(self.scene, &ray, sample), f32::INFINITY),
            Lighting::Dusk(dusk) => dusk.radiance(&ray, sample),
        };
        (found.to_array(), distance / self.mm_per_unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::scene::props;

    /// A pinhole at the origin, 60 degrees wide; its left half can be blocked.
    struct Pinhole {
        size: [u32; 2],
        half_blocked: bool,
    }

    impl Pinhole {
        fn rays(&self, rays: Rays<'_>) -> Result<(), PluginError> {
            let [width, height] = self.size.map(|side| side as f32);
            rays.fill(|sample, ray| {
                let x = (sample.image_x / width - 0.5) * 1.2;
                let y = (0.5 - sample.image_y / height) * 1.2 * height / width;
                ray.o = [0.0; 3];
                ray.d = Vec3::new(x, y, 1.0).normalize().to_array();
                ray.time = sample.time;
                if self.half_blocked && sample.lens_u < 0.5 { 0.0 } else { 1.0 }
            });
            Ok(())
        }
    }

    fn rendered(threads: usize, half_blocked: bool, spp: u32) -> (Picture, Tally) {
        pictured(&props::scene(), threads, half_blocked, spp)
    }

    fn pictured(scene: &Scene, threads: usize, half_blocked: bool, spp: u32) -> (Picture, Tally) {
        let settings = Settings::plain([37, 21], spp, 7);
        let camera = Pinhole { size: settings.size, half_blocked };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render(|rays| camera.rays(rays), scene, &settings, &ProgressBar::hidden())).unwrap()
    }

    fn with(effects: &str) -> Scene {
        props::scene().with(&effects.parse().unwrap())
    }

    #[test]
    fn without_effects_the_picture_is_that_of_a_scene_that_has_none() {
        let mut plain = props::scene();
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
    fn a_tile_is_a_part_of_the_picture_to_the_bit() {
        let camera = Pinhole { size: [37, 21], half_blocked: false };
        let scene = with("all");
        for spp in [1, 4, 48] {
            let (whole, _) = pictured(&scene, 1, false, spp);
            for [corner, size] in [[[16, 5], [20, 16]], [[0, 0], [37, 1]], [[36, 20], [1, 1]]] {
                let settings = Settings { corner, ..Settings::plain(size, spp, 7) };
                let (part, _) =
                    render(|rays| camera.rays(rays), &scene, &settings, &ProgressBar::hidden()).unwrap();
                for (index, pixel) in (0..).zip(&part.pixels) {
                    let [x, y] = [corner[0] + index % size[0], corner[1] + index / size[0]];
                    assert_eq!(*pixel, whole.pixels[(y * 37 + x) as usize], "{x} {y} at {spp}");
                }
            }
        }
    }

    #[test]
    fn a_tile_has_the_whole_pictures_pixels_and_a_margin() {
        let camera = Pinhole { size: [60, 37], half_blocked: false };
        let pictured = |stride: u32| {
            let settings = Settings { stride, ..Settings::plain(camera.size, 1, 7) };
            let hidden = ProgressBar::hidden();
            render(|rays| camera.rays(rays), &props::scene(), &settings, &hidden).unwrap().0
        };
        // Tiles 0 and 7 of 4 x 3 are rendered, one at the top left and one in the middle of the last column.
        let (whole, parts) = (pictured(1), pictured(7));
        let near = |at: u32, [from, to]: [u32; 2]| at + MARGIN >= from && at < to + MARGIN;
        for (index, pixel) in (0..).zip(&parts.pixels) {
            let (x, y) = (index % 60, index / 60);
            let is_taken = near(x, [0, 16]) && near(y, [0, 16]) || near(x, [48, 60]) && near(y, [16, 32]);
            let expected = if is_taken { whole.pixels[index as usize] } else { [0.0; 3] };
            assert_eq!(*pixel, expected, "{x} {y}");
        }
        let mut other = parts.clone();
        for pixel in &mut other.pixels {
            *pixel = pixel.map(|value| value + 0.2);
        }
        // A difference of 0.2 corresponds to two errors of 0.2 / √2.
        let [error, mean] = noise(&parts, &other, 7);
        assert!((error - 0.2 / 2.0_f64.sqrt()).abs() < 1e-6, "{error}");
        let taken = (0..16).flat_map(|y| (0..16).map(move |x| [x, y]));
        let taken = taken.chain((16..32).flat_map(|y| (48..60).map(move |x| [x, y])));
        let sum: f32 = taken.map(|[x, y]| parts.pixels[y * 60 + x].iter().sum::<f32>()).sum();
        let expected = f64::from(sum) / f64::from(3 * 16 * (16 + 12)) + 0.1;
        assert!((mean - expected).abs() < 1e-5, "{mean} {expected}");
    }

    #[test]
    fn pixels_and_pictures_have_random_numbers_of_their_own() {
        let scene = props::scene();
        let numbers = |seed: u64, pixel: [u32; 2]| {
            let settings = Settings::plain([1; 2], 1, seed);
            let mut random = SceneSampler::new(&scene, &Lighting::Day, &settings).random(pixel);
            [0; 5].map(|_| random.next_u32())
        };
        let mut all: Vec<u32> = (0..4)
            .flat_map(|seed| (0..8).flat_map(move |x| (0..8).map(move |y| (seed, [x, y]))))
            .flat_map(|(seed, pixel)| numbers(seed, pixel))
            .collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 4 * 64 * 5);
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

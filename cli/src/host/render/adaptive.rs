//! Adaptive sampling for pictures that are displayed with a known tone curve.
//!
//! **Number of samples.** For a given total, the mean squared error is least if the number of samples of each pixel
//! is proportional to the standard deviation of a single sample. Every pixel first gets a quarter of the usual
//! number. The samples of its eight neighbours then determine the number of its remaining samples. Its own samples do
//! not, so its mean is unbiased.
//!
//! **Out of focus.** Where the lens blurs the scene, the picture has no detail finer than the blur, and neighbouring
//! pixels share their samples (C. Soler, K. Subr, F. Durand, N. Holzschuch and F. Sillion, "Fourier Depth of Field",
//! *ACM Transactions on Graphics* 28(2), 2009). A pixel shows the mean over a square around it, if the blur of every
//! sample in the square is at least [`PARTS`] times the square's side. Edges become wider by at most a twelfth. The
//! light of emitters that are connected to the lens ([`super::emitters`]) is shared, too. Objects in focus are not
//! smoothed, whatever their noise.
//!
//! **The blur.** The camera's rays determine the blur. It is the width of a pixel's beam at the object's distance,
//! divided by the distance there between the beams of neighbouring pixels. A block of pixels uses one beam of 16
//! rays, and the beams of two other pixels beside it. The width is measured along the narrow side of the beam, which
//! is smaller toward the edges of the film.

use super::lamplight::START;
use crate::image::{Picture, Tone};
use glam::{Mat2, Vec2, Vec3};
use realistic::ffi::{realistic_ray, realistic_sample};
use realistic_lab::render::{self, Integrand, Rays, Tally, Window};

/// Standard deviation of a displayed sample, over the three colours and with white as 1, for which a pixel gets the
/// usual number of samples. With this value, the mean number over a picture of the chess game is about the usual one.
const DEVIATION: f32 = 0.12;
/// Least and largest number of samples of a pixel, as multiples of the usual number.
const LEAST: f32 = 0.25;
const MOST: f32 = 16.0;
/// Ratio of the blur diameter to the side of the square in which pixels share samples.
const PARTS: f32 = 12.0;
/// Largest number of pixels on either side of the middle of such a square.
pub const REACH: u32 = 4;
/// Side of the grid of lens samples that form a beam.
const GRID: u16 = 4;
/// Distance between pixels whose beams are compared, in pixels.
const STEP: u32 = 8;
/// Exponent of the power mean that approximates the smallest blur.
const POWER: i32 = -8;
/// Bounds of a blur in pixels, within which its powers are finite.
const BLURS: [f32; 2] = [0.1, 1e4];

/// Data for the visibility of a pixel's noise.
#[derive(Clone, Copy, Debug)]
pub struct AdaptiveSampling<'a> {
    /// Tone curve with which the picture is displayed.
    pub tone: Tone,
    /// Light that is added before pixels share samples, as a picture of the same part.
    pub beside: &'a Picture,
    /// Top left pixel of the part in the whole picture.
    pub corner: [u32; 2],
    /// Width and height of the whole picture.
    pub whole: [u32; 2],
}

/// An integrand that adaptive sampling can evaluate.
pub trait AdaptiveIntegrand: Integrand<3> {
    /// Makes the samples placed from now on follow `before` earlier samples of the same pixels.
    fn follow(&mut self, before: usize);

    /// Returns the radiance along the ray of sample `number` of the batch, and the ray's length, world units.
    fn seen(&self, number: usize, ray: &realistic_ray) -> ([f32; 3], f32);
}

/// Part of a picture: the mean of every pixel's samples, its blur in pixels, and the tally of samples.
pub type Sampled = (Vec<[f64; 3]>, Vec<f32>, Tally);

impl AdaptiveSampling<'_> {
    /// Samples a window, which lies within a block of pixels with the same blur.
    ///
    /// # Errors
    /// The camera's error.
    pub fn render<E>(
        &self,
        camera: impl Fn(Rays<'_>) -> Result<(), E>,
        view: &mut impl AdaptiveIntegrand,
        window: Window,
        block: Window,
        spp: u32,
    ) -> Result<Sampled, E> {
        let first = (LEAST * spp as f32).ceil().max(1.0) as u32;
        let low = window.corner.map(|at| at.saturating_sub(1));
        let high = [0, 1].map(|axis| (window.corner[axis] + window.size[axis] + 1).min(self.whole[axis]));
        let around = Window { corner: low, size: [high[0] - low[0], high[1] - low[1]] };
        let beam = self.beam(&camera, block)?;
        view.follow(0);
        let mut pilot = Pilot { view: &mut *view, beam };
        let (found, mut tally) = render::render(&camera, &mut pilot, around, first as usize)?;
        view.follow(first as usize);
        let at = |x: u32, y: u32| &found[((y - low[1]) * around.size[0] + x - low[0]) as usize];
        let [[left, top], [width, height]] = [window.corner, window.size];
        let (mut pixels, mut blurs) = (Vec::new(), Vec::new());
        for (y, x) in (top..top + height).flat_map(|y| (left..left + width).map(move |x| (y, x))) {
            let neighbours = (y.max(1) - 1..(y + 2).min(high[1]))
                .flat_map(|row| (x.max(1) - 1..(x + 2).min(high[0])).map(move |column| (column, row)))
                .filter(|neighbour| *neighbour != (x, y));
            let [column, row] = [x - self.corner[0], y - self.corner[1]];
            let beside = self.beside.pixels[(row * self.beside.size[0] + column) as usize];
            let deviation = self.deviation(neighbours.map(|(x, y)| at(x, y)), beside);
            let target = (deviation / DEVIATION).min(MOST) * spp as f32;
            let own = at(x, y);
            blurs.push(least_blur(own));
            let own = [own[0], own[1], own[2]];
            let more = (target as u32).saturating_sub(first);
            if more == 0 {
                pixels.push(own);
                continue;
            }
            let pixel = Window { corner: [x, y], size: [1, 1] };
            let (others, rays) = render::render(&camera, view, pixel, more as usize)?;
            tally.add(&rays);
            let share = f64::from(first) / f64::from(first + more);
            pixels.push([0, 1, 2].map(|colour| share * own[colour] + (1.0 - share) * others[0][colour]));
        }
        Ok((pixels, blurs, tally))
    }

    /// Returns the standard deviation of a displayed sample, added to a light, after the mean over the square that
    /// shares samples. The pixels in `around` determine it.
    fn deviation<'m>(&self, around: impl Iterator<Item = &'m Means>, beside: [f32; 3]) -> f32 {
        let (mut count, mut means, mut squares, mut blur) = (0.0, [0.0; 3], [0.0; 3], f32::INFINITY);
        for moments in around {
            count += 1.0;
            blur = blur.min(least_blur(moments));
            for colour in 0..3 {
                let mean = moments[colour];
                means[colour] += mean;
                // The product approximates the mean square of weight times light, because the weights of a pixel's
                // rays differ little.
                squares[colour] += (moments[6] * moments[3 + colour] - mean * mean).max(0.0);
            }
        }
        let shown = [0, 1, 2].map(|colour| {
            let slope = slope(self.tone, beside[colour] + (means[colour] / count) as f32);
            slope * slope * (squares[colour] / count) as f32
        });
        shown.into_iter().sum::<f32>().sqrt() / side(reach(blur))
    }

    /// Traces the beam of the pixel in the middle of a block.
    fn beam<E>(&self, camera: impl Fn(Rays<'_>) -> Result<(), E>, block: Window) -> Result<Beam, E> {
        let middle = [0, 1].map(|axis| (block.corner[axis] + block.size[axis] / 2).min(self.whole[axis] - 1));
        // The other two pixels lie toward the middle of the picture, so that they are inside the picture.
        let aside = |axis: usize| {
            let mut pixel = middle;
            pixel[axis] = if 2 * middle[axis] < self.whole[axis] {
                middle[axis] + STEP
            } else {
                middle[axis].saturating_sub(STEP)
            };
            pixel
        };
        let beam_pixels = [middle, aside(0), aside(1)];
        let grid = |number: u16| (f32::from(number) + 0.5) / f32::from(GRID);
        let samples: Vec<realistic_sample> = beam_pixels
            .into_iter()
            .flat_map(|[x, y]| {
                (0..GRID * GRID).map(move |number| realistic_sample {
                    image_x: x as f32 + 0.5,
                    image_y: y as f32 + 0.5,
                    lens_u: grid(number % GRID),
                    lens_v: grid(number / GRID),
                    time: 0.5,
                })
            })
            .collect();
        let mut rays = vec![realistic_ray::default(); samples.len()];
        let mut weights = vec![0.0; samples.len()];
        camera(Rays { samples: &samples, rays: &mut rays, weights: &mut weights })?;
        Ok(Beam::of(&rays, &weights))
    }
}

/// Returns the slope of the tone curve.
fn slope(tone: Tone, value: f32) -> f32 {
    let step = 0.01 / tone.scale;
    (tone.shown(value + step) - tone.shown(value)) / step
}

/// Returns the side of a square with `reach` pixels on either side of its middle.
fn side(reach: u32) -> f32 {
    (2 * reach + 1) as f32
}

/// Returns the number of pixels on either side of a pixel that share its samples, for a blur diameter in pixels.
fn reach(blur: f32) -> u32 {
    (((blur / PARTS - 1.0) / 2.0).max(0.0) as u32).min(REACH)
}

/// Returns a picture whose pixels share samples according to their blurs.
pub fn shared(picture: &Picture, blurs: &[f32]) -> Picture {
    let [width, height] = picture.size.map(|side| side as usize);
    let mut smooth = Picture::plain(picture.size, [0.0; 3]);
    for (index, pixel) in smooth.pixels.iter_mut().enumerate() {
        let (x, y) = (index % width, index / width);
        let square = |reach: usize| {
            let rows = y.saturating_sub(reach)..(y + reach + 1).min(height);
            rows.flat_map(move |row| {
                let columns = x.saturating_sub(reach)..(x + reach + 1).min(width);
                columns.map(move |column| row * width + column)
            })
        };
        // A larger square contains more pixels that may be too sharp for sharing.
        let fits = |radius: &u32| square(*radius as usize).all(|other| reach(blurs[other]) >= *radius);
        let reach = (1..=reach(blurs[index])).take_while(fits).last().unwrap_or(0);
        let (count, sum) = square(reach as usize).fold((0.0, Vec3::ZERO), |(count, sum), other| {
            (count + 1.0, sum + Vec3::from(picture.pixels[other]))
        });
        *pixel = (sum / count).to_array();
    }
    smooth
}

/// The rays of a pixel in a plane perpendicular to them, as positions at the start of the rays and slopes.
struct Beam {
    /// Covariances of the positions, of positions with slopes, and of the slopes.
    spread: [Mat2; 3],
    /// Displacements of the beams of two other pixels, per pixel: at the start of the rays, and per unit of distance.
    shifts: [[Vec2; 2]; 2],
    /// Whether there are enough rays.
    is_known: bool,
}

impl Beam {
    /// Computes the beam from the rays of three pixels that are [`STEP`] apart.
    fn of(rays: &[realistic_ray], weights: &[f32]) -> Self {
        let count = usize::from(GRID * GRID);
        let passes = |number: &usize| (0..3).all(|beam| weights[beam * count + number] > 0.0);
        let passing: Vec<usize> = (0..count).filter(passes).collect();
        let of = |beam: usize, number: usize| {
            let ray = &rays[beam * count + number];
            [Vec3::from(ray.o), Vec3::from(ray.d)]
        };
        let scale = 1.0 / passing.len().max(1) as f32;
        let mean = |beam: usize| {
            passing.iter().fold([Vec3::ZERO; 2], |sum, number| {
                let ray = of(beam, *number);
                [0, 1].map(|part| sum[part] + scale * ray[part])
            })
        };
        let middle = mean(0);
        let (across, up) = middle[1].normalize_or(Vec3::Z).any_orthonormal_pair();
        let seen = |ray: [Vec3; 2]| {
            [0, 1].map(|part| {
                let away = ray[part] - middle[part];
                Vec2::new(away.dot(across), away.dot(up))
            })
        };
        let product = |a: Vec2, b: Vec2| Mat2::from_cols(a * b.x, a * b.y);
        let mut spread = [Mat2::ZERO; 3];
        for number in &passing {
            let [start, slope] = seen(of(0, *number));
            spread[0] += scale * product(start, start);
            spread[1] += scale * (product(start, slope) + product(slope, start));
            spread[2] += scale * product(slope, slope);
        }
        let shifts = [1, 2].map(|beam| seen(mean(beam)).map(|away| away / STEP as f32));
        Self { spread, shifts, is_known: passing.len() > usize::from(GRID) }
    }

    /// Returns the diameter, pixels, of the disk to which the lens blurs a point at a distance, along the disk's
    /// narrow side.
    fn blur(&self, distance: f32) -> f32 {
        // Beyond this distance, the blur no longer changes.
        const FAR: f32 = 1e6;
        let t = distance.min(FAR);
        let [a, b, c] = self.spread;
        let sum = a + t * b + t * t * c;
        let (x, y) = (sum.x_axis, sum.y_axis);
        let (half, product) = (0.5 * (x.x + y.y), x.x * y.y - x.y * y.x);
        let least = half - (half * half - product).max(0.0).sqrt();
        let shift =
            self.shifts.iter().map(|[start, slope]| (*start + t * *slope).length()).fold(0.0, f32::max);
        // The diameter of an evenly lit disk is four standard deviations.
        let blur = 4.0 * least.max(0.0).sqrt() / shift;
        if self.is_known && blur.is_finite() { blur.clamp(BLURS[0], BLURS[1]) } else { BLURS[0] }
    }
}

/// Means over a pixel's samples of the ray's weight times each of these: the colours, their squares, 1, and a power
/// of the blur.
type Means = [f64; 8];

/// Returns an approximation of the smallest blur of a pixel's samples; the lower bound if no ray passes.
fn least_blur(means: &Means) -> f32 {
    if means[6] > 0.0 { (means[7] / means[6]).powf(1.0 / f64::from(POWER)) as f32 } else { BLURS[0] }
}

/// The first samples of the pixels, which give their moments.
struct Pilot<'v, V> {
    view: &'v mut V,
    beam: Beam,
}

impl<V: AdaptiveIntegrand> Integrand<8> for Pilot<'_, V> {
    fn place(&mut self, pixel: [u32; 2], first: usize, samples: &mut [realistic_sample]) {
        self.view.place(pixel, first, samples);
    }

    fn radiance(&self, number: usize, ray: &realistic_ray) -> [f32; 8] {
        let ([r, g, b], distance) = self.view.seen(number, ray);
        let blur = self.beam.blur(distance.max(START));
        [r, g, b, r * r, g * g, b * b, 1.0, blur.powi(POWER)]
    }
}

#[cfg(test)]
mod tests {
    use super::super::linked::{Linked, PICTURES, pictures};
    use super::super::{Settings, render};
    use super::*;
    use crate::host::scene::{LEVEL, Scene, chess};
    use crate::image::Curve;
    use indicatif::ProgressBar;

    const SIZE: [u32; 2] = [30, 20];

    fn scene() -> Scene {
        let mut scene = chess::scene();
        // The linked camera has no pose of its own.
        let up = scene.pose[7];
        scene.solids = std::sync::Arc::default();
        scene.pose = LEVEL;
        let moved = |group: &crate::host::scene::Lamps| {
            let lamps = group.lamps.iter().cloned().map(|mut lamp| {
                lamp.shape.centre.y -= 0.2 * up;
                lamp
            });
            lamps.collect()
        };
        scene.lamps = scene.lamps.iter().map(moved).collect();
        scene
    }

    fn settings<'a>(seed: u64, spp: u32, adaptive: Option<AdaptiveSampling<'a>>) -> Settings<'a> {
        Settings { adaptive, ..Settings::plain(SIZE, spp, seed) }
    }

    fn adaptive(beside: &Picture) -> AdaptiveSampling<'_> {
        let tone = Tone { scale: 20.0, curve: Curve::Film };
        AdaptiveSampling { tone, beside, corner: [0; 2], whole: SIZE }
    }

    #[test]
    fn tables_and_adaptive_samples_make_the_picture_of_plain_paths() {
        let (camera, scene, hidden) = (Linked::new(SIZE, 720.0), scene(), ProgressBar::hidden());
        let beside = Picture::plain(SIZE, [0.0; 3]);
        let taken =
            |settings: &Settings<'_>| render(|rays| camera.rays(rays), &scene, settings, &hidden).unwrap().0;
        let plain = pictures(|seed| taken(&settings(seed, 64, None)));
        let adaptive = pictures(|seed| taken(&settings(seed, 64, Some(adaptive(&beside)))));
        let sum = |all: &[[f64; 2]]| all.iter().map(|[mean, _]| mean).sum::<f64>();
        assert!((sum(&adaptive) / sum(&plain) - 1.0).abs() < 0.02, "{} {}", sum(&adaptive), sum(&plain));
        let noise =
            |all: &[[f64; 2]]| all.iter().map(|[_, square]| square * f64::from(PICTURES)).sum::<f64>();
        eprintln!("{} {} {}", sum(&adaptive) / sum(&plain), noise(&adaptive), noise(&plain));
        assert!(noise(&adaptive) < noise(&plain));
    }

    #[test]
    fn a_part_is_the_whole_pictures_and_threads_change_nothing() {
        let (camera, scene, hidden) = (Linked::new(SIZE, 720.0), scene(), ProgressBar::hidden());
        let picture = |threads: usize, corner: [u32; 2], size: [u32; 2]| {
            let beside = Picture::plain(size, [0.01; 3]);
            let adaptive = Some(AdaptiveSampling { corner, ..adaptive(&beside) });
            let settings = Settings { size, corner, ..settings(3, 16, adaptive) };
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(|rays| camera.rays(rays), &scene, &settings, &hidden)).unwrap().0
        };
        let whole = picture(1, [0; 2], SIZE);
        assert_eq!(whole, picture(3, [0; 2], SIZE));
        let [[left, top], [width, height]] = [[7, 3], [21, 17]];
        let part = picture(2, [left, top], [width, height]);
        // The lower right corner of the part equals the same pixels of the whole picture.
        for (y, x) in (REACH..height).flat_map(|y| (REACH..width - 2 * REACH).map(move |x| (y, x))) {
            let of_whole = whole.pixels[((y + top) * SIZE[0] + x + left) as usize];
            assert_eq!(part.pixels[(y * width + x) as usize], of_whole, "{x} {y}");
        }
    }

    #[test]
    fn a_thin_lens_blurs_by_its_diameter_and_the_defocus() {
        // The beam of a square lens in focus at a distance of 500, where a pixel is 0.01 wide.
        const FOCUS: f32 = 500.0;
        let mut rays = Vec::new();
        for aside in [[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]] {
            for number in 0..GRID * GRID {
                let [u, v] = [number % GRID, number / GRID].map(|at| 10.0 * (f32::from(at) - 1.5));
                let target = STEP as f32 * Vec3::new(aside[0], aside[1], 0.0) + FOCUS * Vec3::Z;
                let start = Vec3::new(u, v, 0.0);
                let d = (target - start).normalize().to_array();
                rays.push(realistic_ray { o: start.to_array(), d, ..Default::default() });
            }
        }
        let beam = Beam::of(&rays, &vec![1.0; rays.len()]);
        // Four points spaced by 10 have a standard deviation of 5 √5.
        for distance in [250.0_f32, 1000.0, 5000.0] {
            let shift = 0.01 * distance / FOCUS;
            let expected = 4.0 * 125.0_f32.sqrt() * (distance / FOCUS - 1.0).abs() / shift;
            let found = beam.blur(distance);
            assert!((found / expected - 1.0).abs() < 0.01, "{distance}: {found} {expected}");
        }
        assert!(beam.blur(FOCUS) < 10.0);
        let none = vec![0.0; rays.len()];
        assert_eq!(reach(Beam::of(&rays, &none).blur(1e9)), 0);
    }

    #[test]
    fn only_pixels_whose_whole_square_is_out_of_focus_share_samples() {
        let mut picture = Picture::plain([24, 24], [0.0; 3]);
        picture.pixels[12 * 24 + 12] = [81.0; 3];
        let value = |picture: &Picture, x: usize, y: usize| picture.pixels[y * 24 + x][0];
        let mut blurs = vec![PARTS * side(REACH); 24 * 24];
        let smooth = shared(&picture, &blurs);
        assert_eq!([8, 12, 16, 17].map(|x| value(&smooth, x, 12)), [1.0, 1.0, 1.0, 0.0]);
        // The dot is in focus: it keeps its light, and no other pixel shares that light.
        blurs[12 * 24 + 12] = 1.0;
        assert_eq!(shared(&picture, &blurs), picture);
    }
}

//! The renderer of the program and the laboratory. From camera rays and the light along them, it computes the mean over
//! every pixel's samples. The caller chooses the camera, the samples, the scene and the threads.

use realistic::ffi::{realistic_ray, realistic_sample};
use std::time::{Duration, Instant};

/// One request to a source of camera rays; all slices have the same length.
pub struct Rays<'a> {
    /// The samples.
    pub samples: &'a [realistic_sample],
    /// Output: a ray for every sample.
    pub rays: &'a mut [realistic_ray],
    /// Output: a weight for every sample; 0 for a blocked ray.
    pub weights: &'a mut [f32],
}

impl Rays<'_> {
    /// Calls `shoot` for each sample; `shoot` fills in a ray and returns its weight.
    pub fn fill(self, mut shoot: impl FnMut(&realistic_sample, &mut realistic_ray) -> f32) {
        for ((sample, ray), weight) in self.samples.iter().zip(self.rays).zip(self.weights) {
            *weight = shoot(sample, ray);
        }
    }
}

/// The samples of a pixel, and the light along its rays.
pub trait Integrand<const CHANNELS: usize> {
    /// Sets the positions of the samples of a pixel (column, row); in the batch, the samples are numbered from `first`.
    fn place(&mut self, pixel: [u32; 2], first: usize, samples: &mut [realistic_sample]);

    /// Returns the radiance along the ray of the batch's sample `number`.
    fn radiance(&self, number: usize, ray: &realistic_ray) -> [f32; CHANNELS];
}

/// A rectangle of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Top left pixel.
    pub corner: [u32; 2],
    /// Width and height in pixels.
    pub size: [u32; 2],
}

/// Counts and times of a rendering.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Rays requested.
    pub rays: u64,
    /// Rays that passed the lens.
    pub passed: u64,
    /// Time spent in the camera, summed over threads.
    pub in_camera: Duration,
}

impl Tally {
    /// Adds the counts and times of another rendering.
    pub fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.passed += other.passed;
        self.in_camera += other.in_camera;
    }
}

/// Samples per call of the camera, unless a single pixel has more.
const BATCH: usize = 2048;

/// Renders a window with `spp` samples per pixel (at least 1) on this thread, and returns its pixels row by
/// row. A blocked ray counts as black.
///
/// # Errors
/// The errors of the camera.
pub fn render<E, const CHANNELS: usize>(
    mut camera: impl FnMut(Rays<'_>) -> Result<(), E>,
    integrand: &mut impl Integrand<CHANNELS>,
    window: Window,
    spp: usize,
) -> Result<(Vec<[f64; CHANNELS]>, Tally), E> {
    let [[left, top], [width, height]] = [window.corner, window.size];
    let window_pixels: Vec<[u32; 2]> =
        (top..top + height).flat_map(|y| (left..left + width).map(move |x| [x, y])).collect();
    let room = (BATCH / spp).clamp(1, window_pixels.len().max(1)) * spp;
    let mut samples = vec![realistic_sample::default(); room];
    let mut rays = vec![realistic_ray::default(); room];
    let mut weights = vec![0.0; room];
    let mut pixels = Vec::with_capacity(window_pixels.len());
    let mut tally = Tally::default();
    for block in window_pixels.chunks(room / spp) {
        let count = block.len() * spp;
        for ((first, samples), pixel) in (0..).step_by(spp).zip(samples.chunks_exact_mut(spp)).zip(block) {
            integrand.place(*pixel, first, samples);
        }
        let (samples, rays, weights) = (&samples[..count], &mut rays[..count], &mut weights[..count]);
        let start = Instant::now();
        camera(Rays { samples, rays, weights })?;
        tally.in_camera += start.elapsed();
        tally.rays += count as u64;
        for first in (0..count).step_by(spp) {
            let mut sum = [0.0; CHANNELS];
            for number in (first..first + spp).filter(|&number| weights[number] != 0.0) {
                tally.passed += 1;
                for (sum, light) in sum.iter_mut().zip(integrand.radiance(number, &rays[number])) {
                    *sum += f64::from(weights[number] * light);
                }
            }
            pixels.push(sum.map(|sum| sum / spp as f64));
        }
    }
    Ok((pixels, tally))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// Blocks every ray of odd columns.
    fn even(rays: Rays<'_>) -> Result<(), Infallible> {
        rays.fill(|sample, ray| {
            ray.o = [sample.image_x, sample.image_y, 0.0];
            if sample.image_x % 2.0 == 0.0 { 0.5 } else { 0.0 }
        });
        Ok(())
    }

    /// An integrand that records the pixel and the number of the sample within its pixel.
    struct PixelRecorder(usize);

    impl Integrand<3> for PixelRecorder {
        fn place(&mut self, [x, y]: [u32; 2], first: usize, samples: &mut [realistic_sample]) {
            assert_eq!((samples.len(), first % self.0), (self.0, 0));
            samples.fill(realistic_sample { image_x: x as f32, image_y: y as f32, ..Default::default() });
        }

        fn radiance(&self, number: usize, ray: &realistic_ray) -> [f32; 3] {
            [ray.o[0], ray.o[1], (number % self.0) as f32]
        }
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_samples_in_any_number_of_calls() {
        let window = Window { corner: [4, 7], size: [3, 5] };
        for spp in [1, 3, 700, 2049] {
            let Ok((pixels, tally)) = render(even, &mut PixelRecorder(spp), window, spp);
            let rays = 15 * spp as u64;
            assert_eq!((pixels.len(), tally.rays, tally.passed), (15, rays, rays / 3 * 2));
            for (pixel, index) in pixels.iter().zip(0_u32..) {
                let [x, y] = [4 + index % 3, 7 + index / 3].map(f64::from);
                let mean = [x, y, (spp as f64 - 1.0) / 2.0].map(|value| value / 2.0);
                assert_eq!(*pixel, if x % 2.0 == 0.0 { mean } else { [0.0; 3] });
            }
        }
    }
}

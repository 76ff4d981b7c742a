//! Helpers shared by several test files: lenses, cameras from text, and random numbers that are the same in every run.

pub mod abi_camera;
pub mod abi_rays;
#[expect(dead_code, reason = "the laboratory uses more of it")]
#[path = "../../../lab/src/columns.rs"]
pub mod columns;
#[path = "../../support/inline.rs"]
pub mod inline;
pub mod light;
mod properties;

use std::{
    panic::resume_unwind,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};

use ::realistic_camera::{Camera, Host, Outcome, Parameters, Raster, Sample, WorldRay};
use rand::{RngExt as _, SeedableRng as _};
use rand_xoshiro::SplitMix64;
use realistic_optics::{
    lens::Lens,
    prescription::{catalogue, read},
    trace::{Direction, Ray},
};
use realistic_simd::Simd;
use realistic_trace::kernel::{Kernel, KernelScalar, RayBuffer};

pub use properties::cases;

/// The lenses of Kolb, Mitchell and Hanrahan's figure, each with a film diagonal (mm) that it illuminates into the
/// corners.
pub const LENSES: [(&str, &str); 4] =
    [("dgauss.50mm", "35"), ("wide.22mm", "30"), ("telephoto.250mm", "26"), ("fisheye.10mm", "22")];

/// Returns a lens of the catalogue at the d line.
pub fn lens(name: &str) -> Lens {
    Lens::at_d_line(&catalogue::find(name).expect("a catalogue name"))
}

/// Reads a lens from text, at the d line.
pub fn lens_of(text: &str) -> Lens {
    Lens::at_d_line(&read("own.dat", text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}")))
}

/// Applies `work` to each item on all cores, and returns the results in order; for tests that would otherwise be the
/// last to end.
pub fn on_all_cores<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let next = AtomicUsize::new(0);
    let take = || {
        let number = next.fetch_add(1, Ordering::Relaxed);
        items.get(number).map(|item| (number, work(item)))
    };
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let mut done: Vec<(usize, R)> = thread::scope(|scope| {
        let workers: Vec<_> =
            (0..cores).map(|_| scope.spawn(|| std::iter::from_fn(take).collect::<Vec<_>>())).collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)))
            .collect()
    });
    done.sort_by_key(|(number, _)| *number);
    done.into_iter().map(|(_, result)| result).collect()
}

/// The image of the tests' cameras: 400 x 300 pixels, so that the corner lies 250 pixels from the axis.
pub const RASTER: Raster = Raster { xres: 400, yres: 300 };

/// Returns a host that finds lenses in the catalogue only.
pub fn host() -> Host {
    Host::new(RASTER, None)
}

/// Returns [`host`] with the text of a lens file.
pub fn host_with(text: &str) -> Host {
    Host { lens_text: Some(("own.dat".to_owned(), text.as_bytes().to_vec())), ..host() }
}

/// Builds a camera from parameters in command-line syntax; returns it with its warnings, or the error.
pub fn build(host: &Host, given: &[(&str, &str)]) -> Result<(Camera, Vec<String>), String> {
    let mut parameters = Parameters::default();
    for (name, text) in given {
        parameters.set_from_text(name, text).map_err(|error| error.to_string())?;
    }
    let mut warnings = Vec::new();
    Camera::build(&parameters, host, &mut |_, text| warnings.push(text.to_owned()))
        .map(|camera| (camera, warnings))
        .map_err(|error| error.to_string())
}

/// Builds a camera, which must not cause a warning.
#[track_caller]
pub fn camera(given: &[(&str, &str)]) -> Camera {
    let (camera, warnings) = build(&host(), given).unwrap_or_else(|error| panic!("{given:?}: {error}"));
    assert_eq!(warnings, [""; 0], "{given:?}");
    camera
}

/// Returns a sample in the middle of the shutter's interval.
pub fn sample(image: [f32; 2], lens: [f32; 2]) -> Sample {
    Sample { image_x: image[0], image_y: image[1], lens_u: lens[0], lens_v: lens[1], time: 0.5 }
}

/// Returns the ray of a sample, and its weight.
pub fn ray(camera: &Camera, image: [f32; 2], lens: [f32; 2]) -> Option<(WorldRay, f32)> {
    match camera.generate(&sample(image, lens), None) {
        Outcome::Ray(ray, weight) => Some((ray, weight)),
        Outcome::Blocked(_) | Outcome::Redraw | Outcome::Shut | Outcome::Wavelength => None,
    }
}

/// A generator of numbers in [0, 1).
pub struct Random(SplitMix64);

impl Random {
    /// Seeds the generator.
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::seed_from_u64(seed))
    }

    /// Returns the next number.
    pub fn next(&mut self) -> f64 {
        self.0.random()
    }

    /// Returns the next number, mapped to [-1, 1).
    pub fn signed(&mut self) -> f64 {
        2.0 * self.next() - 1.0
    }
}

/// Traces rays by a kernel of every instruction set; all must agree to the bit.
pub fn by_kernel<S: KernelScalar>(lens: &Lens, direction: Direction, rays: &[Ray]) -> Vec<Option<Ray>> {
    let traced = |simd| {
        let kernel = Kernel::<S>::with_simd(lens, direction, simd)?;
        let mut buffer = RayBuffer::<S>::new(rays.len());
        rays.iter().enumerate().for_each(|(i, ray)| buffer.put(i, ray.origin, ray.direction));
        kernel.trace_in_place(&mut buffer.rays());
        Some((0..rays.len()).map(|i| buffer.get(i).map(|traced| traced.ray())).collect::<Vec<_>>())
    };
    let mut all = Simd::ALL.into_iter().filter_map(traced);
    let first = all.next().expect("the portable one");
    for other in all {
        assert_eq!(first, other);
    }
    first
}

//! A camera of the C ABI, as a calling program holds it, and samples for it, shared by the benches of whole cameras.

use std::{
    hint::black_box,
    ptr::{null, null_mut},
};

use super::inline::*;
use realistic::ffi::*;
use realistic_lab::subject::quasirandom::spread;

/// A camera that is freed on drop.
pub struct Camera(pub *mut realistic_camera);

// SAFETY: a camera does not change once it is built, and any thread may request rays.
unsafe impl Sync for Camera {}

impl Camera {
    /// Builds the camera of these options, whose strings outlive the call.
    pub fn new(options: &realistic_options) -> Self {
        let mut camera = null_mut();
        // SAFETY: the structure is as large as it says, and its strings outlive the call.
        let status = unsafe { realistic_camera_new(options, &mut camera) };
        assert_eq!(status, realistic_status::Ok);
        Self(camera)
    }

    /// Returns the weight of one ray, by the C export.
    pub fn one(&self, sample: &realistic_sample) -> f32 {
        let mut ray = realistic_ray::default();
        // SAFETY: the camera is live.
        black_box(unsafe { realistic_generate_ray(self.0, sample, null(), &mut ray) })
    }

    /// Returns the weight of one ray with differentials.
    pub fn differential(&self, sample: &realistic_sample) -> f32 {
        let struct_size = size_of::<realistic_ray_differential>() as u32;
        let mut ray = realistic_ray_differential { struct_size, ..Default::default() };
        // SAFETY: the camera is live.
        let weight = unsafe { realistic_generate_ray_differential(self.0, sample, null(), &mut ray) };
        black_box(&ray);
        weight
    }

    /// Calls the first slot of the vtable, as a pbrt-v1 host does.
    #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
    pub fn host(&self, sample: &realistic_sample) -> f32 {
        type GenerateRay =
            unsafe extern "C" fn(*const realistic_camera, *const realistic_sample, *mut realistic_ray) -> f32;
        let mut ray = realistic_ray::default();
        // SAFETY: in builds with the C++ interface, a camera begins with a pointer to its vtable, and this function is
        // in the first slot.
        unsafe {
            let generate = **self.0.cast::<*const GenerateRay>();
            black_box(generate(self.0, sample, &mut ray))
        }
    }
}

impl Drop for Camera {
    fn drop(&mut self) {
        // SAFETY: the camera was made in `new` and is freed once.
        unsafe { realistic_camera_free(self.0) }
    }
}

/// Returns samples nearly evenly spread over a square of the image, whose pixel range is the same in x and y.
pub fn samples(count: usize, [from, to]: [f32; 2]) -> Vec<realistic_sample> {
    let sample = |point: [f64; 4]| {
        let [x, y, lens_u, lens_v] = point.map(|number| number as f32);
        let [image_x, image_y] = [x, y].map(|share| from + (to - from) * share);
        realistic_sample { image_x, image_y, lens_u, lens_v, time: 0.5 }
    };
    spread(0.5).take(count).map(sample).collect()
}

/// Returns the sample moved a little to the right.
pub fn moved(sample: &realistic_sample, by: f32) -> realistic_sample {
    realistic_sample { image_x: sample.image_x + by, ..*sample }
}

/// Returns the three samples that a pbrt-v1 host requests for a sample with differentials.
#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
pub fn triple(sample: &realistic_sample) -> [realistic_sample; 3] {
    let right = moved(sample, 1.0);
    [*sample, right, realistic_sample { image_y: right.image_y + 1.0, ..moved(&right, -1.0) }]
}

/// Calls `call` once per sample, each call waiting for the previous one: `call` moves its sample by the number that it
/// receives.
pub fn chain<S>(samples: &[S], call: impl Fn(&S, f32) -> f32) {
    let mut carry = 0.0;
    for sample in samples {
        // The carry is too small to change the sum.
        carry = call(sample, carry) * 1e-30;
    }
    black_box(carry);
}

/// Samples and rays as structure of arrays.
pub struct Arrays {
    sample_columns: [Vec<f32>; 5],
    found: [Vec<f32>; 10],
}

impl Arrays {
    /// Copies samples into columns, and allocates their rays.
    pub fn new(samples: &[realistic_sample]) -> Self {
        let column = |part: fn(&realistic_sample) -> f32| samples.iter().map(part).collect::<Vec<f32>>();
        Self {
            sample_columns: [
                column(|sample| sample.image_x),
                column(|sample| sample.image_y),
                column(|sample| sample.lens_u),
                column(|sample| sample.lens_v),
                column(|sample| sample.time),
            ],
            found: std::array::from_fn(|_| vec![0.0; samples.len()]),
        }
    }

    /// Generates all rays in one call, without range and time.
    pub fn generate(&mut self, camera: &Camera) {
        self.generate_by(camera, self.sample_columns[0].len(), false);
    }

    /// Generates the rays in calls of `size` samples, optionally with range and time.
    pub fn generate_by(&mut self, camera: &Camera, size: usize, with_range_and_time: bool) {
        let count = self.sample_columns[0].len();
        for first in (0..count).step_by(size) {
            let part = first..count.min(first + size);
            let [image_x, image_y, lens_u, lens_v, time] =
                self.sample_columns.each_ref().map(|array| array[part.clone()].as_ptr());
            let samples = realistic_samples_soa { image_x, image_y, lens_u, lens_v, time };
            let [ox, oy, oz, dx, dy, dz, weight, mint, maxt, time] =
                self.found.each_mut().map(|array| array[part.clone()].as_mut_ptr());
            let [mint, maxt, time] =
                [mint, maxt, time].map(|array| if with_range_and_time { array } else { null_mut() });
            let reason = null_mut();
            let rays = realistic_rays_soa { ox, oy, oz, dx, dy, dz, mint, maxt, time, weight, reason };
            // SAFETY: every array that is passed has room for its elements.
            let status = unsafe { realistic_camera_generate_rays_soa(camera.0, part.len(), &samples, &rays) };
            assert_eq!(status, realistic_status::Ok);
        }
        black_box(&self.found);
    }
}

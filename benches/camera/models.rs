//! Models without interfaces against a plain pinhole and the exact lens, by single calls and by batches of both
//! layouts; two of the models move as well.

use std::{ffi::CStr, hint::black_box, ptr::null_mut};

use super::inline::realistic_camera_generate_rays;
use realistic::ffi::*;
use realistic_lab::timing::{Contest, Effort};

use super::c_camera::{Arrays, Camera, chain, moved};

/// Samples in a batch.
const LARGE: usize = 1024;
/// Width and height of the image, pixels.
const RESOLUTION: i32 = 1000;

/// A pinhole camera as a renderer might write it: it normalises the direction given by the film point and transforms
/// it by the camera's matrix. It uses
/// baseline instructions only, like a host compiled from C. It reads each component of the sample separately: a single
/// load of two components would stall on store forwarding, since the caller has just stored them one by one.
#[repr(C)]
struct Pinhole {
    to_world: [[f32; 4]; 3],
    middle: f32,
    per_pixel: f32,
}

type PinholeRay = unsafe extern "C" fn(*const Pinhole, *const realistic_sample, *mut realistic_ray) -> f32;

unsafe extern "C" fn pinhole_ray(
    camera: *const Pinhole,
    sample: *const realistic_sample,
    ray: *mut realistic_ray,
) -> f32 {
    // SAFETY: the caller guarantees that all three pointers are valid.
    let (camera, sample, ray) = unsafe { (&*camera, &*sample, &mut *ray) };
    // SAFETY: the references are valid.
    let [x, y] =
        [&sample.image_x, &sample.image_y].map(|number| unsafe { (&raw const *number).read_volatile() });
    let (x, y) = ((x - camera.middle) * camera.per_pixel, (camera.middle - y) * camera.per_pixel);
    let inverse = 1.0 / (x * x + y * y + 1.0).sqrt();
    let (x, y, z) = (x * inverse, y * inverse, inverse);
    for (i, [a, b, c, d]) in camera.to_world.into_iter().enumerate() {
        ray.o[i] = d;
        ray.d[i] = a * x + b * y + c * z;
    }
    (ray.mint, ray.maxt, ray.time) = (0.0, 1e30, sample.time);
    1.0
}

/// Prints one table, for cameras that are rotated and moved.
pub fn print(samples: &[realistic_sample], effort: Effort) {
    let turned = [0.6, 0.0, 0.8, 3.0, 0.0, 1.0, 0.0, -1.0, -0.8, 0.0, 0.6, 5.0, 0.0, 0.0, 0.0, 1.0];
    let plain = Pinhole {
        to_world: [0, 4, 8].map(|row| [0, 1, 2, 3].map(|column| turned[row + column])),
        middle: 500.0,
        per_pixel: 0.002,
    };
    let ended = [0.8, 0.0, 0.6, 7.0, 0.0, 1.0, 0.0, 2.0, -0.6, 0.0, 0.8, 5.0, 0.0, 0.0, 0.0, 1.0];
    let between = |model: &CStr, radius: f64, end: [f32; 16]| {
        Camera::new(&realistic_options {
            xres: RESOLUTION,
            yres: RESOLUTION,
            model: model.as_ptr(),
            camera_to_world: turned,
            camera_to_world_end: end,
            lens_radius: radius,
            focal_distance: 5.0,
            ..realistic_options::default()
        })
    };
    let with = |model: &CStr, radius: f64| between(model, radius, [f32::NAN; 16]);
    let cameras = [
        ("perspective", with(c"perspective", 0.0)),
        ("perspective with a lens", with(c"perspective", 0.1)),
        ("orthographic", with(c"orthographic", 0.0)),
        ("environment", with(c"environment", 0.0)),
        ("thick", with(c"thick", 0.0)),
        ("thin", with(c"thin", 0.0)),
        ("lens, exact", with(c"lens", 0.0)),
        ("perspective, moving", between(c"perspective", 0.0, ended)),
        ("lens, exact, moving", between(c"lens", 0.0, ended)),
    ];
    let mut contest = Contest::default();
    // Hide the function from the optimiser, as a plugin's function would be.
    let pinhole: PinholeRay = black_box(pinhole_ray);
    let plain = &plain;
    contest.enter(
        "a plain pinhole, one call",
        Box::new(move || {
            chain(samples, |sample, carry| {
                let mut ray = realistic_ray::default();
                // SAFETY: all three pointers are valid.
                black_box(unsafe { pinhole(plain, &moved(sample, carry), &mut ray) })
            });
        }) as Box<dyn FnMut()>,
    );
    for (name, camera) in &cameras {
        let one = move || chain(samples, |sample, carry| camera.one(&moved(sample, carry)));
        contest.enter(format!("{name}, one call"), Box::new(one) as Box<dyn FnMut()>);
        #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
        {
            let triples: Vec<_> =
                samples.iter().flat_map(super::c_camera::triple).take(samples.len()).collect();
            let host = move || chain(&triples, |sample, carry| camera.host(&moved(sample, carry)));
            contest
                .enter(format!("{name}, vtable, three calls per sample"), Box::new(host) as Box<dyn FnMut()>);
        }
        let mut arrays = Arrays::new(samples);
        let arrays = move || arrays.generate_by(camera, LARGE, false);
        contest.enter(format!("{name}, arrays, n = {LARGE}"), Box::new(arrays) as Box<dyn FnMut()>);
        let (mut rays, mut weights) =
            (vec![realistic_ray::default(); samples.len()], vec![0.0; samples.len()]);
        let structures = move || {
            for ((samples, rays), weights) in
                samples.chunks(LARGE).zip(rays.chunks_mut(LARGE)).zip(weights.chunks_mut(LARGE))
            {
                let (rays, weights) = (rays.as_mut_ptr(), weights.as_mut_ptr());
                // SAFETY: every array that is passed has room for its elements.
                let status = unsafe {
                    realistic_camera_generate_rays(
                        camera.0,
                        samples.len(),
                        samples.as_ptr(),
                        0,
                        rays,
                        0,
                        weights,
                        null_mut(),
                    )
                };
                assert_eq!(status, realistic_status::Ok);
            }
            black_box((&rays, &weights));
        };
        contest.enter(format!("{name}, structures, n = {LARGE}"), Box::new(structures) as Box<dyn FnMut()>);
    }
    contest.print("ns per call or ray", samples.len(), effort);
}

//! Every kind of call against its counterpart, timed in turns: batches of whole cameras against their kernel alone,
//! arrays of structures against structures of arrays, and calls with few samples against the call for one sample.

use std::{hint::black_box, ptr::null_mut};

use ::realistic_camera::sampling::PupilDisk;
use realistic::ffi::*;
use realistic_lab::{
    subject::{FilmRays, passing_rays},
    timing::{Effort, interleaved},
};
use realistic_optics::{
    imaging::open,
    lens::Lens,
    prescription::SearchPath,
    trace::{Direction, Path},
};
use realistic_trace::kernel::{Kernel, KernelScalar};

#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
use super::c_camera::triple;
use super::{
    c_camera::{Arrays, Camera, chain, moved},
    inline::{differentials as generate_differentials, realistic_camera_generate_rays},
};

/// Strides in bytes of a pbrt-v1 host's own `Sample` and `Ray`.
const HOST_STRIDES: [usize; 2] = [88, 36];
/// Numbers of samples in small calls, and in a large one.
const SMALL: [usize; 4] = [1, 4, 16, 64];
const LARGE: usize = 1024;

type Task<'a> = Box<dyn FnMut() + 'a>;

/// Prints one table: for each kind of call, the time per ray, the time per ray of its counterpart, and the ratio.
pub fn print(lens: &str, cameras: [(&str, &Camera); 2], samples: &[realistic_sample], effort: Effort) {
    println!("\n| call | ns per ray | beside | ns per ray | ratio |\n|---|---|---|---|---|");
    for (precision, camera) in cameras {
        let row = |call: &str, task: Task<'_>, beside: &str, other: Task<'_>| {
            let times = interleaved([other, task], effort);
            let [other, own] = [0, 1].map(|i| times[i].median / samples.len() as f64 * 1e9);
            println!("| {precision}, {call} | {own:.2} | {beside} | {other:.2} | {:.2} |", own / other);
        };
        let kernel = || match precision {
            "f32" => kernel::<f32>(lens, samples.len()),
            _ => kernel::<f64>(lens, samples.len()),
        };
        row("arrays", arrays(camera, samples, samples.len()), "kernel alone", kernel());
        for [sample_stride, ray_stride] in [[0, 0], HOST_STRIDES] {
            let structures = structures(camera, samples, LARGE, [sample_stride, ray_stride]);
            let call = format!("structures, strides {sample_stride} and {ray_stride}, n = {LARGE}");
            row(&call, structures, "arrays with range and time", arrays_with_all(camera, samples, LARGE));
        }
        for n in SMALL {
            let one = || one_by_one(camera, samples);
            row(
                &format!("structures, n = {n}"),
                structures(camera, samples, n, [0, 0]),
                "single call",
                one(),
            );
            row(&format!("arrays, n = {n}"), arrays(camera, samples, n), "single call", one());
        }
        let one = || one_by_one(camera, samples);
        row("with differentials, one call", differential(camera, samples), "single call", one());
        #[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
        row("with differentials, vtable, three calls", by_vtable(camera, samples), "single call", one());
        let rays = || structures(camera, samples, LARGE, [0, 0]);
        let call = format!("with differentials, structures, n = {LARGE}");
        row(&call, differentials(camera, samples, LARGE), "the same without", rays());
    }
}

/// Traces through the lens by the kernel alone, in one batch.
fn kernel<S: KernelScalar + 'static>(lens: &str, count: usize) -> Task<'static> {
    /// Largest coordinate of film points, mm.
    const REACH: f64 = 3.0;
    let prescription =
        open::find(lens, None, &SearchPath::from_environment()).expect("a catalogue lens or a file");
    let lens = Lens::at_d_line(&prescription);
    let path = Path::<f64>::film_to_scene(&lens);
    let film = lens.rear().vertex - lens.nominal_film_distance.unwrap_or(40.0);
    let cover = PupilDisk::rear(&lens, film, REACH).expect("film behind the lens");
    let mut rays = FilmRays::<S>::new(film, &passing_rays(&path, film, REACH, cover, count, 0));
    let kernel = Kernel::<S>::new(&lens, Direction::FilmToScene);
    Box::new(move || black_box(&mut rays).trace(count, |from, to| kernel.trace_batch(from, to)))
}

/// Makes one call per sample, each waiting for the previous one.
fn one_by_one<'a>(camera: &'a Camera, samples: &'a [realistic_sample]) -> Task<'a> {
    Box::new(move || chain(samples, |sample, carry| camera.one(&moved(sample, carry))))
}

/// Makes one call with differentials per sample, each waiting for the previous one.
fn differential<'a>(camera: &'a Camera, samples: &'a [realistic_sample]) -> Task<'a> {
    Box::new(move || chain(samples, |sample, carry| camera.differential(&moved(sample, carry))))
}

/// Makes the three calls of a pbrt-v1 host for each sample.
#[cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]
fn by_vtable<'a>(camera: &'a Camera, samples: &'a [realistic_sample]) -> Task<'a> {
    let calls = move |sample: &realistic_sample, carry| {
        triple(&moved(sample, carry)).iter().map(|sample| camera.host(sample)).sum::<f32>()
    };
    Box::new(move || chain(samples, calls))
}

/// Generates arrays of structures with differentials, `n` per call.
fn differentials<'a>(camera: &'a Camera, samples: &'a [realistic_sample], n: usize) -> Task<'a> {
    let struct_size = size_of::<realistic_ray_differential>() as u32;
    let mut found = vec![realistic_ray_differential { struct_size, ..Default::default() }; samples.len()];
    let mut weights = vec![0.0_f32; samples.len()];
    Box::new(move || {
        for ((samples, found), weights) in
            samples.chunks(n).zip(found.chunks_mut(n)).zip(weights.chunks_mut(n))
        {
            // SAFETY: every array that is passed has room for its elements.
            let status = unsafe {
                generate_differentials(
                    camera.0,
                    samples.len(),
                    samples.as_ptr(),
                    0,
                    found.as_mut_ptr(),
                    0,
                    weights.as_mut_ptr(),
                    null_mut(),
                )
            };
            assert_eq!(status, realistic_status::Ok);
        }
        black_box((&found, &weights));
    })
}

/// Generates structures of arrays, `n` per call.
fn arrays<'a>(camera: &'a Camera, samples: &[realistic_sample], n: usize) -> Task<'a> {
    let mut arrays = Arrays::new(samples);
    Box::new(move || arrays.generate_by(camera, n, false))
}

/// Generates structures of arrays as [`arrays`] does, with range and time, which arrays of structures always include.
fn arrays_with_all<'a>(camera: &'a Camera, samples: &[realistic_sample], n: usize) -> Task<'a> {
    let mut arrays = Arrays::new(samples);
    Box::new(move || arrays.generate_by(camera, n, true))
}

/// Generates arrays of structures, `n` per call; a stride of 0 means tightly packed.
fn structures<'a>(
    camera: &'a Camera,
    samples: &[realistic_sample],
    n: usize,
    strides: [usize; 2],
) -> Task<'a> {
    let sizes = [size_of::<realistic_sample>(), size_of::<realistic_ray>()];
    let [sample_step, ray_step] = [0, 1].map(|i| if strides[i] == 0 { sizes[i] } else { strides[i] });
    let mut sample_bytes = vec![0_u8; sample_step * samples.len()];
    for (bytes, sample) in sample_bytes.chunks_exact_mut(sample_step).zip(samples) {
        let realistic_sample { image_x, image_y, lens_u, lens_v, time } = *sample;
        for (bytes, number) in bytes.chunks_exact_mut(4).zip([image_x, image_y, lens_u, lens_v, time]) {
            bytes.copy_from_slice(&number.to_ne_bytes());
        }
    }
    let mut found = vec![0_u8; ray_step * samples.len()];
    let mut weights = vec![0.0_f32; samples.len()];
    let count = samples.len();
    Box::new(move || {
        for first in (0..count).step_by(n) {
            // SAFETY: every array that is passed has room for its elements.
            let status = unsafe {
                realistic_camera_generate_rays(
                    camera.0,
                    n.min(count - first),
                    sample_bytes.as_ptr().add(first * sample_step).cast(),
                    strides[0],
                    found.as_mut_ptr().add(first * ray_step).cast(),
                    strides[1],
                    weights.as_mut_ptr().add(first),
                    null_mut(),
                )
            };
            assert_eq!(status, realistic_status::Ok);
        }
        black_box((&found, &weights));
    })
}

//! Rays with differentials: their neighbours have the bits of single rays one pixel to the right and one below, one by
//! one and in batches.

use std::ptr::{null, null_mut};

use super::bytes::Bytes;
use super::inline::*;
use realistic::ffi::*;

const SIZE: usize = size_of::<realistic_ray_differential>();

/// Returns the initial content of a ray.
fn mark(ray: realistic_ray) -> realistic_ray_differential {
    realistic_ray_differential {
        struct_size: SIZE as u32,
        has: 0x5555,
        ray,
        rx_o: [-7.0; 3],
        rx_d: [-7.0; 3],
        ry_o: [-7.0; 3],
        ry_d: [-7.0; 3],
    }
}

/// Checks rays with differentials. Panics with `what` if they differ from `singles`, the rays without differentials,
/// or if a batch differs from separate calls. With `may_differ`, a batch may use another tracer than single calls.
/// `initial` is the
/// initial content of a ray.
pub fn check(
    camera: *const realistic_camera,
    samples: &[realistic_sample],
    singles: &[(realistic_ray, f32)],
    initial: realistic_ray,
    may_differ: bool,
    bytes: &mut Bytes<'_>,
    what: &dyn std::fmt::Debug,
) {
    let one = |(sample, single): (&realistic_sample, &(realistic_ray, f32))| {
        let mut ray = mark(initial);
        // SAFETY: the camera, the sample and the ray are live.
        let weight = unsafe { realistic_generate_ray_differential(camera, sample, null(), &mut ray) };
        assert!((ray.ray, weight) == *single, "{sample:?} {ray:?} {weight} {single:?} {what:?}");
        if weight == 0.0 {
            assert!(ray == mark(initial), "a blocked ray wrote to its place: {sample:?} {ray:?} {what:?}");
        } else {
            let alone = |at: &realistic_sample, ray: &mut realistic_ray| {
                // SAFETY: the camera, the sample and the ray are live.
                unsafe { realistic_generate_ray(camera, at, null(), ray) }
            };
            neighbours(sample, &ray, alone, what);
        }
        (ray, weight)
    };
    let found: Vec<_> = samples.iter().zip(singles).map(one).collect();
    batch(camera, samples, &found, initial, may_differ, bytes, what);
}

/// Returns the ray, with differentials, of a sample at a wavelength; panics with `what` if the ray differs from that of
/// a single call.
pub fn at_wavelength(
    camera: *const realistic_camera,
    sample: &realistic_sample,
    wavelength: f32,
    single: &(realistic_ray, f32),
    initial: realistic_ray,
    what: &dyn std::fmt::Debug,
) -> (realistic_ray_differential, f32) {
    let mut ray = mark(initial);
    // SAFETY: the camera, the sample and the ray are live.
    let weight = unsafe { differential_at(camera, sample, wavelength, &mut ray) };
    assert!((ray.ray, weight) == *single, "{sample:?} {wavelength} {ray:?} {weight} {single:?} {what:?}");
    if weight == 0.0 {
        assert!(ray == mark(initial), "a blocked ray wrote to its place: {sample:?} {ray:?} {what:?}");
    } else {
        let alone = |at: &realistic_sample, ray: &mut realistic_ray| {
            // SAFETY: as above.
            unsafe { ray_at(camera, at, wavelength, ray) }
        };
        neighbours(sample, &ray, alone, what);
    }
    (ray, weight)
}

/// Checks that each of the two neighbours of a passing ray is the ray that `alone` generates for the neighbour's own
/// sample, or the passing ray itself.
fn neighbours(
    sample: &realistic_sample,
    ray: &realistic_ray_differential,
    alone: impl Fn(&realistic_sample, &mut realistic_ray) -> f32,
    what: &dyn std::fmt::Debug,
) {
    let right = realistic_sample { image_x: sample.image_x + 1.0, ..*sample };
    let below = realistic_sample { image_y: sample.image_y + 1.0, ..*sample };
    for (at, bit, o, d) in
        [(right, REALISTIC_HAS_RX, ray.rx_o, ray.rx_d), (below, REALISTIC_HAS_RY, ray.ry_o, ray.ry_d)]
    {
        let mut single = ray.ray;
        let weight = alone(&at, &mut single);
        let has = ray.has & bit != 0;
        // If the shutter is closed at a neighbour's time, the neighbour exists although its own ray is blocked.
        let is_right = match (has, weight > 0.0) {
            (true, true) => (o, d) == (single.o, single.d),
            (true, false) => {
                let length = d.iter().map(|&d| f64::from(d).powi(2)).sum::<f64>().sqrt();
                o.iter().all(|o| o.is_finite()) && (length - 1.0).abs() <= 1e-6
            }
            (false, passes) => !passes && (o, d) == (ray.ray.o, ray.ray.d),
        };
        assert!(is_right && ray.has <= 3, "{sample:?} {ray:?} {single:?} {weight} {what:?}");
    }
}

/// Checks a batch of rays with differentials, with any stride, at any address.
fn batch(
    camera: *const realistic_camera,
    samples: &[realistic_sample],
    found: &[(realistic_ray_differential, f32)],
    initial: realistic_ray,
    may_differ: bool,
    bytes: &mut Bytes<'_>,
    what: &dyn std::fmt::Debug,
) {
    let stride = [0, SIZE, SIZE + 3, 128][bytes.choice(4)];
    let offset = bytes.choice(4);
    let step = stride.max(SIZE);
    let mut room = vec![0xA5_u8; offset + step * samples.len()];
    let mut weights = vec![-1.0; samples.len()];
    // SAFETY: the camera is live, and the arrays have room for one element per sample, from the offset on.
    let status = unsafe {
        let rays = room.as_mut_ptr().add(offset);
        for i in 0..samples.len() {
            rays.add(step * i).cast::<realistic_ray_differential>().write_unaligned(mark(initial));
        }
        differentials(
            camera,
            samples.len(),
            samples.as_ptr(),
            0,
            rays.cast(),
            stride,
            weights.as_mut_ptr(),
            null_mut(),
        )
    };
    assert_eq!(status, realistic_status::Ok);
    for (i, expected) in found.iter().enumerate() {
        let slot = &room[offset + step * i..offset + step * (i + 1)];
        // SAFETY: the ray was written above.
        let ray = unsafe { slot.as_ptr().cast::<realistic_ray_differential>().read_unaligned() };
        assert!(may_differ || (ray, weights[i]) == *expected, "{i} {ray:?} {expected:?} {what:?}");
        assert!(slot[SIZE..].iter().all(|&byte| byte == 0xA5), "wrote between two rays");
    }
}

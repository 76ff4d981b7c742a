//! Rays at wavelengths of their own, which must be sound and identical for every kind of call.

use std::array;
use std::ptr::null_mut;

use super::super::contract;
use super::{MARK, bytes::Bytes, differentials, inline::*, strided};
use realistic::ffi::*;

/// Checks rays at any wavelengths, and panics with `what` if they are not sound or if kinds of calls give different
/// rays. With `may_differ`, a batch may use another tracer than single calls, as with a tolerance and no dispersion.
pub fn check(
    camera: *const realistic_camera,
    samples: &[realistic_sample],
    may_differ: bool,
    bytes: &mut Bytes<'_>,
    what: &dyn std::fmt::Debug,
) {
    let wavelengths: Vec<f32> = samples.iter().map(|_| 380.0 + bytes.float(400.0)).collect();
    let single = |(sample, &wavelength): (&realistic_sample, &f32)| {
        let mut ray = MARK;
        // SAFETY: the camera, the sample and the ray are live.
        let weight = unsafe { ray_at(camera, sample, wavelength, &mut ray) };
        if let Some(broken) = contract::broken(sample, &ray, weight, &MARK) {
            panic!("{broken} at {wavelength} nm {what:?}");
        }
        assert!(weight == 0.0 || (380.0..=780.0).contains(&wavelength), "{wavelength} nm {what:?}");
        (ray, weight)
    };
    let singles: Vec<_> = samples.iter().zip(&wavelengths).map(single).collect();
    let by_strides = strided::rays(camera, samples, Some(&wavelengths), bytes);
    assert!(may_differ || by_strides == singles, "by strides {what:?}");
    let by_structures = in_structures(camera, samples, &wavelengths);
    assert!(may_differ || by_structures == singles, "by structures {what:?}");
    for ((samples, wavelengths), singles) in
        samples.chunks(4).zip(wavelengths.chunks_exact(4)).zip(singles.chunks(4))
    {
        let (mut rays, mut weights) = ([MARK; 4], [0.0; 4]);
        // SAFETY: the camera is live, and the arrays have four elements.
        let first = unsafe {
            let (rays, weights) = (rays.as_mut_ptr(), weights.as_mut_ptr());
            hero_rays(camera, &samples[0], wavelengths.as_ptr(), rays, weights)
        };
        let expected: [_; 4] = array::from_fn(|k| single((&samples[0], &wavelengths[k])));
        assert!((rays[0], weights[0]) == singles[0] && array::from_fn(|k| (rays[k], weights[k])) == expected);
        assert_eq!(first.to_bits(), weights[0].to_bits(), "{what:?}");
    }
}

/// Checks rays' neighbours at any wavelengths, found by single calls with differentials and by a batch; panics with
/// `what` if they differ from the rays of calls for one ray.
pub fn beside(
    camera: *const realistic_camera,
    samples: &[realistic_sample],
    may_differ: bool,
    bytes: &mut Bytes<'_>,
    what: &dyn std::fmt::Debug,
) {
    let wavelengths: Vec<f32> = samples.iter().map(|_| 380.0 + bytes.float(400.0)).collect();
    let by_strides = strided::found(camera, samples, Some(&wavelengths), true, bytes);
    for ((sample, wavelength), (_, beside)) in samples.iter().zip(&wavelengths).zip(by_strides) {
        let mut single = MARK;
        // SAFETY: the camera, the sample and the ray are live.
        let weight = unsafe { ray_at(camera, sample, *wavelength, &mut single) };
        let (ray, weight) =
            differentials::at_wavelength(camera, sample, *wavelength, &(single, weight), MARK, what);
        let expected = [(REALISTIC_HAS_RX, ray.rx_o, ray.rx_d), (REALISTIC_HAS_RY, ray.ry_o, ray.ry_d)];
        for ((bit, o, d), (origin, direction, beside)) in expected.into_iter().zip(beside.expect("asked for"))
        {
            let is_there = weight > 0.0 && ray.has & bit != 0;
            let is_same = (beside > 0.0) == is_there && (weight == 0.0 || (origin, direction) == (o, d));
            assert!(may_differ || is_same, "{sample:?} {wavelength} {what:?}");
        }
    }
}

fn in_structures(
    camera: *const realistic_camera,
    samples: &[realistic_sample],
    wavelengths: &[f32],
) -> Vec<(realistic_ray, f32)> {
    let n = samples.len();
    let (mut rays, mut weights) = (vec![MARK; n], vec![0.0; n]);
    // SAFETY: the camera is live, and the arrays have n elements.
    let status = unsafe {
        rays_at(
            camera,
            n,
            samples.as_ptr(),
            0,
            wavelengths.as_ptr(),
            0,
            rays.as_mut_ptr(),
            0,
            weights.as_mut_ptr(),
            null_mut(),
        )
    };
    assert_eq!(status, realistic_status::Ok);
    rays.into_iter().zip(weights).collect()
}

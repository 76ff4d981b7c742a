//! Any options give either a camera that returns sound rays for every kind of call, or an error with a message; nothing
//! crashes.

mod bytes;
mod crop;
mod differentials;
pub mod importance;
#[path = "../../../tests/support/inline.rs"]
pub mod inline;
mod lens;
mod options;
mod strided;
mod wavelengths;

use std::ffi::{CStr, c_void};
use std::mem::offset_of;
use std::ptr::{null, null_mut};

use self::bytes::Bytes;
use self::inline::*;
use super::contract;
use realistic::ffi::*;

/// A number of samples that exceeds the widest registers and is not a multiple of any width.
const COUNT: usize = 37;

/// Initial value of every ray, to detect rays that were not written.
const MARK: realistic_ray = realistic_ray { o: [-7.0; 3], d: [-7.0; 3], mint: -7.0, maxt: -7.0, time: -7.0 };

/// Checks the library's promises, and panics if one is broken. Returns whether the data give a camera.
pub fn run(data: &[u8]) -> bool {
    let mut bytes = Bytes(data);
    let options = options::options(&mut bytes);
    let samples: Vec<realistic_sample> = (0..COUNT)
        .map(|_| realistic_sample {
            image_x: bytes.float(40.0),
            image_y: bytes.float(30.0),
            lens_u: bytes.float(1.0),
            lens_v: bytes.float(1.0),
            time: bytes.float(1.0),
        })
        .collect();
    if bytes.choice(16) == 0 {
        autofocus(&options, &mut bytes);
    }
    let mut camera = null_mut();
    // SAFETY: the options and all that they point to live during the call; so does `camera`.
    let status = unsafe { realistic_camera_new(&options, &mut camera) };
    let message = last_error();
    assert_ne!(status, realistic_status::Panic, "{message} {options:?}");
    if status != realistic_status::Ok {
        assert!(camera.is_null() && message.len() > 10, "{message} {options:?}");
        lens::check(&options, &mut bytes);
        return false;
    }
    let live = LiveCamera { camera, samples: &samples, options: &options };
    live.about();
    let singles = live.singles();
    live.in_structures(&singles, &mut bytes);
    live.in_arrays(&singles, &mut bytes);
    let may_differ = options.tolerance > 0.0;
    differentials::check(camera, &samples, &singles, MARK, may_differ, &mut bytes, &options);
    lens::check(&options, &mut bytes);
    if bytes.choice(4) == 1 {
        let found = strided::rays(camera, &samples, None, &mut bytes);
        assert!(may_differ || found == singles, "{options:?}");
    }
    if bytes.choice(4) == 1 {
        wavelengths::check(camera, &samples, may_differ, &mut bytes, &options);
    }
    if bytes.choice(4) == 1 {
        importance::check(camera, &singles, &mut bytes, &options);
    }
    if bytes.choice(8) == 1 {
        crop::check(&live, &singles, &mut bytes);
    }
    if bytes.choice(4) == 1 {
        wavelengths::beside(camera, &samples, may_differ, &mut bytes, &options);
    }
    // SAFETY: no call uses the camera any more.
    unsafe { realistic_camera_free(camera) };
    true
}

fn last_error() -> String {
    // SAFETY: the message lives until this thread's next failure.
    unsafe { CStr::from_ptr(realistic_last_error()) }.to_string_lossy().into_owned()
}

/// A live camera, with its samples and options.
struct LiveCamera<'a> {
    camera: *mut realistic_camera,
    samples: &'a [realistic_sample],
    options: &'a realistic_options,
}

impl LiveCamera<'_> {
    /// Checks that facts, name and plan are available for any camera.
    fn about(&self) {
        let mut info = no_info();
        let mut text = [0x7F_u8; 64];
        let mut length = 0;
        // SAFETY: a live camera, a structure of its size, and a buffer of the capacity given.
        unsafe {
            assert_eq!(realistic_camera_get_info(self.camera, &mut info), realistic_status::Ok);
            for give in [realistic_camera_get_lens_name, realistic_camera_plan] {
                let buffer = text.as_mut_ptr().cast();
                assert_eq!(give(self.camera, buffer, text.len(), &mut length), realistic_status::Ok);
                let given = CStr::from_bytes_until_nul(&text).expect("ends in NUL within the buffer");
                assert!(given.to_str().is_ok() && given.count_bytes() <= length);
            }
        }
        let facts = [info.focal_length_mm, info.fnumber, info.film_distance, info.film_diagonal];
        let has_lens = info.interfaces > 0;
        assert!(facts.iter().all(|fact| fact.is_nan() != has_lens), "{info:?} {:?}", self.options);
    }

    fn singles(&self) -> Vec<(realistic_ray, f32)> {
        let single = |sample: &realistic_sample| {
            let mut ray = MARK;
            // SAFETY: the camera, the sample and the ray are live.
            let weight = unsafe { realistic_generate_ray(self.camera, sample, null(), &mut ray) };
            if let Some(broken) = contract::broken(sample, &ray, weight, &MARK) {
                panic!("{broken} {:?}", self.options);
            }
            (ray, weight)
        };
        self.samples.iter().map(single).collect()
    }

    fn check(
        &self,
        singles: &[(realistic_ray, f32)],
        i: usize,
        ray: realistic_ray,
        weight: f32,
        reason: i32,
    ) {
        let what = || format!("{i} {:?} {ray:?} {weight} {reason} {:?}", singles[i], self.options);
        // With a tolerance, single calls and batches may use different tracers.
        assert!(self.options.tolerance > 0.0 || (ray, weight) == singles[i], "{}", what());
        assert!((0..=6).contains(&reason) && (reason == 0) == (weight > 0.0), "{}", what());
    }

    /// Generates rays in arrays of structures with any stride and at any address.
    fn in_structures(&self, singles: &[(realistic_ray, f32)], bytes: &mut Bytes<'_>) {
        let sample_stride = [0, 20, 21, 24, 88][bytes.choice(5)];
        let ray_stride = [0, 36, 39, 64][bytes.choice(4)];
        let offset = bytes.choice(4);
        let [from, to] = [(sample_stride, 20), (ray_stride, 36)].map(|(given, size)| given.max(size));
        let mut sample_bytes = vec![0xA5_u8; offset + from * COUNT];
        let mut ray_bytes = vec![0xA5_u8; offset + to * COUNT];
        let mut weights = [-1.0; COUNT];
        let mut reasons = [realistic_reason::Ok; COUNT];
        let with_reasons = bytes.choice(2) == 0;
        // SAFETY: the camera is live, and the arrays have room for COUNT elements of the strides, from the offset on.
        let status = unsafe {
            let samples = sample_bytes.as_mut_ptr().add(offset);
            let rays = ray_bytes.as_mut_ptr().add(offset);
            for (i, sample) in self.samples.iter().enumerate() {
                samples.add(from * i).cast::<realistic_sample>().write_unaligned(*sample);
                rays.add(to * i).cast::<realistic_ray>().write_unaligned(MARK);
            }
            realistic_camera_generate_rays(
                self.camera,
                COUNT,
                samples.cast(),
                sample_stride,
                rays.cast(),
                ray_stride,
                weights.as_mut_ptr(),
                if with_reasons { reasons.as_mut_ptr() } else { null_mut() },
            )
        };
        assert_eq!(status, realistic_status::Ok);
        for i in 0..COUNT {
            // SAFETY: the ray was written above.
            let ray =
                unsafe { ray_bytes.as_ptr().add(offset + to * i).cast::<realistic_ray>().read_unaligned() };
            let without = if weights[i] > 0.0 { 0 } else { 1 };
            let reason = if with_reasons { reasons[i] as i32 } else { without };
            self.check(singles, i, ray, weights[i], reason);
            let gap = &ray_bytes[offset + to * i + 36..offset + to * (i + 1)];
            assert!(gap.iter().all(|&byte| byte == 0xA5), "wrote between two rays");
        }
    }

    /// Generates rays in structures of arrays, with and without the optional arrays.
    fn in_arrays(&self, singles: &[(realistic_ray, f32)], bytes: &mut Bytes<'_>) {
        let of = |member: fn(&realistic_sample) -> f32| self.samples.iter().map(member).collect::<Vec<_>>();
        let arrays =
            [of(|s| s.image_x), of(|s| s.image_y), of(|s| s.lens_u), of(|s| s.lens_v), of(|s| s.time)];
        let mut found = vec![[-7.0_f32; COUNT]; 10];
        let mut reasons = [realistic_reason::Ok; COUNT];
        let given = bytes.choice(16);
        let is_given = |bit: usize| given >> bit & 1 == 1;
        let samples = realistic_samples_soa {
            image_x: arrays[0].as_ptr(),
            image_y: arrays[1].as_ptr(),
            lens_u: arrays[2].as_ptr(),
            lens_v: arrays[3].as_ptr(),
            time: arrays[4].as_ptr(),
        };
        let mut room = found.iter_mut().map(|array| array.as_mut_ptr());
        let mut next = || room.next().expect("ten arrays");
        let rays = realistic_rays_soa {
            ox: next(),
            oy: next(),
            oz: next(),
            dx: next(),
            dy: next(),
            dz: next(),
            weight: next(),
            mint: Some(next()).filter(|_| is_given(0)).unwrap_or(null_mut()),
            maxt: Some(next()).filter(|_| is_given(1)).unwrap_or(null_mut()),
            time: Some(next()).filter(|_| is_given(2)).unwrap_or(null_mut()),
            reason: if is_given(3) { reasons.as_mut_ptr() } else { null_mut() },
        };
        // SAFETY: the camera is live, and the arrays have COUNT elements.
        let status = unsafe { realistic_camera_generate_rays_soa(self.camera, COUNT, &samples, &rays) };
        assert_eq!(status, realistic_status::Ok);
        for i in 0..COUNT {
            let at = |array: usize| found[array][i];
            let expected = singles[i].0;
            // Optional arrays that are not passed keep their content.
            let [mint, maxt, time] = [(0, expected.mint), (1, expected.maxt), (2, expected.time)]
                .map(|(bit, expected)| if is_given(bit) { at(7 + bit) } else { expected });
            let ray = realistic_ray { o: [at(0), at(1), at(2)], d: [at(3), at(4), at(5)], mint, maxt, time };
            let without = if at(6) > 0.0 { 0 } else { 1 };
            let reason = if is_given(3) { reasons[i] as i32 } else { without };
            self.check(singles, i, ray, at(6), reason);
        }
    }
}

/// Checks that any zones, rules and answers give a film distance or an error with a message.
fn autofocus(options: &realistic_options, bytes: &mut Bytes<'_>) {
    let zones: Vec<realistic_zone> = (0..bytes.choice(4))
        .map(|_| realistic_zone {
            left: bytes.float(40.0),
            top: bytes.float(30.0),
            right: bytes.float(40.0),
            bottom: bytes.float(30.0),
        })
        .collect();
    let mut answer = [bytes.number(), bytes.number()];
    unsafe extern "C" fn distance(user: *mut c_void, _: *const realistic_ray) -> f64 {
        // SAFETY: `answer` lives during the call, and only this thread uses it.
        let answer = unsafe { &mut *user.cast::<[f64; 2]>() };
        answer.swap(0, 1);
        answer[0]
    }
    unsafe extern "C" fn contrast(
        user: *mut c_void,
        camera: *const realistic_camera,
        zone: *const realistic_zone,
    ) -> f64 {
        // SAFETY: the zone, the camera and all that `distance` uses live during the call.
        unsafe {
            let mut ray = MARK;
            let middle = realistic_sample {
                image_x: ((*zone).left + (*zone).right) / 2.0,
                image_y: ((*zone).top + (*zone).bottom) / 2.0,
                lens_u: 0.75,
                lens_v: 0.5,
                time: 0.5,
            };
            let weight = realistic_generate_ray(camera, &middle, null(), &mut ray);
            if weight > 0.0 { f64::from(weight) } else { distance(user, &ray) }
        }
    }
    let (rule, mut found) = (bytes.choice(4) as i32 - 1, f64::NAN);
    let by_contrast = bytes.choice(4) == 0;
    // SAFETY: options, zones, answers and room for the result live during the call.
    let status = unsafe {
        realistic_autofocus(
            options,
            zones.as_ptr(),
            zones.len(),
            rule,
            (!by_contrast).then_some(distance as _),
            by_contrast.then_some(contrast as _),
            answer.as_mut_ptr().cast(),
            &mut found,
        )
    };
    assert_ne!(status, realistic_status::Panic, "{} {options:?}", last_error());
    if status == realistic_status::Ok {
        assert!(found > 0.0 && found.is_finite(), "{found} {options:?}");
    } else {
        assert!(found.is_nan() && last_error().len() > 10, "{} {options:?}", last_error());
    }
}

fn no_info() -> realistic_camera_info {
    realistic_camera_info {
        struct_size: size_of::<realistic_camera_info>() as u32,
        interfaces: 0,
        focal_length_mm: f64::NAN,
        fnumber: f64::NAN,
        film_distance: f64::NAN,
        focus_distance_mm: f64::NAN,
        film_diagonal: f64::NAN,
        crop: [0; 4],
    }
}

// The strides above rely on these layouts.
const _: () = assert!(size_of::<realistic_sample>() == 20 && size_of::<realistic_ray>() == 36);
const _: () = assert!(offset_of!(realistic_ray, time) == 32);

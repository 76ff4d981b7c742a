//! Models, shutters and moving cameras through the C ABI.

use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

use super::fuzz_bodies::c_abi::inline::realistic_camera_generate_rays;
use realistic::ffi::*;

/// Returns options for a 40 x 20 picture.
fn new_options() -> realistic_options {
    let mut options = MaybeUninit::<realistic_options>::zeroed();
    let size = size_of::<realistic_options>() as u32;
    // SAFETY: there is room for the whole structure.
    let mut options = unsafe {
        assert_eq!(realistic_options_init(options.as_mut_ptr(), size), realistic_status::Ok);
        options.assume_init()
    };
    (options.xres, options.yres) = (40, 20);
    options
}

/// Returns the ray and weight of a sample from a camera of these options.
fn ray(options: &realistic_options, sample: realistic_sample) -> (realistic_ray, f32) {
    let mut camera = null_mut();
    let mut ray = realistic_ray::default();
    // SAFETY: the strings are constants, and the camera is freed once.
    unsafe {
        let status = realistic_camera_new(options, &mut camera);
        assert_eq!(status, realistic_status::Ok, "{:?}", CStr::from_ptr(realistic_last_error()));
        let weight = realistic_generate_ray(camera, &sample, null(), &mut ray);
        realistic_camera_free(camera);
        (ray, weight)
    }
}

const MIDDLE: realistic_sample =
    realistic_sample { image_x: 20.0, image_y: 10.0, lens_u: 0.5, lens_v: 0.5, time: 0.5 };

#[test]
fn every_model_can_be_made_and_looks_ahead() {
    for model in [c"lens", c"thick", c"thin", c"perspective", c"orthographic"] {
        let options = realistic_options { model: model.as_ptr(), ..new_options() };
        let (ray, weight) = ray(&options, MIDDLE);
        assert!(weight > 0.0 && ray.d[2] > 0.999_999, "{model:?}: {ray:?}");
    }
    let options = realistic_options { model: c"environment".as_ptr(), ..new_options() };
    assert!((ray(&options, MIDDLE).0.d[0] + 1.0).abs() < 1e-6);
}

#[test]
fn a_camera_moves_while_the_shutter_is_open() {
    let mut end = new_options().camera_to_world;
    // The camera makes a quarter turn about y and moves along x.
    [end[0], end[2], end[8], end[10], end[3]] = [0.0, 1.0, -1.0, 0.0, 6.0];
    for model in [c"lens", c"thick", c"perspective"] {
        let options = realistic_options { model: model.as_ptr(), camera_to_world_end: end, ..new_options() };
        for time in [0.0_f32, 0.25, 0.5, 1.0] {
            let (ray, _) = ray(&options, realistic_sample { time, ..MIDDLE });
            let (sine, cosine) = (time * std::f32::consts::FRAC_PI_2).sin_cos();
            let apart = (ray.d[0] - sine).abs() + ray.d[1].abs() + (ray.d[2] - cosine).abs();
            assert!(apart < 1e-5, "{model:?} at {time}: {ray:?}");
            assert!((ray.o[0] - 6.0 * time).abs() < 2e-3, "{model:?} at {time}: {ray:?}");
        }
    }
}

#[test]
fn a_camera_moves_the_same_way_when_time_runs_backward() {
    let mut end = new_options().camera_to_world;
    [end[0], end[2], end[8], end[10], end[3]] = [0.0, 1.0, -1.0, 0.0, 6.0];
    for model in [c"lens", c"thick", c"perspective"] {
        let forward = realistic_options { model: model.as_ptr(), camera_to_world_end: end, ..new_options() };
        let backward = realistic_options { shutter_open: 1.0, shutter_close: 0.0, ..forward };
        for time in [0.0_f32, 0.25, 0.5, 1.0] {
            let sample = realistic_sample { time, ..MIDDLE };
            let ([one, other], same) =
                ([ray(&forward, sample).0, ray(&backward, sample).0], |a: f32, b: f32| (a - b).abs() < 1e-5);
            assert!((0..3).all(|axis| same(one.o[axis], other.o[axis]) && same(one.d[axis], other.d[axis])));
            assert_eq!(other.time, 1.0 - one.time, "{model:?}");
        }
    }
}

#[test]
fn a_shut_shutter_is_a_reason_of_its_own() {
    let options =
        realistic_options { shutter: c"focal-plane".as_ptr(), model: c"thick".as_ptr(), ..new_options() };
    let samples = [0.05, 0.5, 0.95].map(|time| realistic_sample { time, ..MIDDLE });
    let mut rays = [realistic_ray::default(); 3];
    let mut weights = [0.0_f32; 3];
    let mut reasons = [realistic_reason::Missed; 3];
    let mut camera = null_mut();
    // SAFETY: the arrays have three elements each, and the camera is freed once.
    unsafe {
        assert_eq!(realistic_camera_new(&options, &mut camera), realistic_status::Ok);
        let (samples, rays) = (samples.as_ptr(), rays.as_mut_ptr());
        let (weights, reasons) = (weights.as_mut_ptr(), reasons.as_mut_ptr());
        let status = realistic_camera_generate_rays(camera, 3, samples, 0, rays, 0, weights, reasons);
        assert_eq!(status, realistic_status::Ok);
        realistic_camera_free(camera);
    }
    assert_eq!(reasons, [realistic_reason::Shut, realistic_reason::Ok, realistic_reason::Shut]);
    assert!(weights[0] == 0.0 && weights[1] > 0.0 && weights[2] == 0.0);
}

#[test]
fn a_model_without_a_lens_says_so_in_its_info() {
    let options = realistic_options { model: c"perspective".as_ptr(), ..new_options() };
    let mut camera = null_mut();
    // SAFETY: zeros are plain numbers; the structure says its size; the camera is freed once.
    unsafe {
        let mut info: realistic_camera_info = std::mem::zeroed();
        info.struct_size = size_of::<realistic_camera_info>() as u32;
        let mut length = 9;
        assert_eq!(realistic_camera_new(&options, &mut camera), realistic_status::Ok);
        assert_eq!(realistic_camera_get_info(camera, &mut info), realistic_status::Ok);
        let name = realistic_camera_get_lens_name(camera, null_mut(), 0, &mut length);
        assert_eq!((name, length, info.interfaces), (realistic_status::Ok, 0, 0));
        assert!(info.focal_length_mm.is_nan() && info.film_diagonal.is_nan());
        realistic_camera_free(camera);
    }
}

#[test]
fn a_camera_is_refocused_from_one_that_is_freed_then() {
    let sample = realistic_sample { image_x: 11.0, image_y: 7.0, lens_u: 0.3, lens_v: 0.6, time: 0.5 };
    let near = realistic_options { focus_distance: 900.0, ..new_options() };
    let far = realistic_options { focus_distance: 1100.0, fnumber: 4.0, ..new_options() };
    // SAFETY: zeros are plain numbers; each camera is freed once, and the donor before rays are requested
    // from the other.
    unsafe {
        let (mut donor, mut camera, mut anew) = (null_mut(), null_mut(), null_mut());
        assert_eq!(realistic_camera_new(&near, &mut donor), realistic_status::Ok);
        assert_eq!(
            realistic_camera_new(&realistic_options { donor, ..far }, &mut camera),
            realistic_status::Ok
        );
        realistic_camera_free(donor);
        assert_eq!(realistic_camera_new(&far, &mut anew), realistic_status::Ok);
        let [(ray, weight), expected] = [camera, anew].map(|camera| {
            let mut ray: realistic_ray = std::mem::zeroed();
            let weight = realistic_generate_ray(camera, &sample, null_mut(), &mut ray);
            (ray, weight)
        });
        assert!(weight > 0.0);
        assert_eq!((ray.o, ray.d, weight), (expected.0.o, expected.0.d, expected.1));
        // A refused call leaves the output unchanged.
        let before = camera;
        let near = realistic_options { focus_distance: 1.0, donor: anew, ..new_options() };
        let refused = realistic_camera_new(&near, &mut camera);
        assert_eq!((refused, camera), (realistic_status::UnreachableFocus, before));
        let none = realistic_camera_new(
            &realistic_options { donor: (&raw const sample).cast(), ..far },
            &mut camera,
        );
        assert_eq!((none, camera), (realistic_status::NotACamera, before));
        assert_eq!(
            realistic_camera_new(&realistic_options { donor: anew, ..far }, null_mut()),
            realistic_status::NullPointer
        );
        realistic_camera_free(camera);
        realistic_camera_free(anew);
    }
}

fn info_of(options: &realistic_options) -> Result<realistic_camera_info, String> {
    let mut camera = null_mut();
    // SAFETY: the strings are constants, zeros are a structure of numbers, and the camera is freed once.
    unsafe {
        let mut info = MaybeUninit::<realistic_camera_info>::zeroed().assume_init();
        info.struct_size = size_of::<realistic_camera_info>() as u32;
        if realistic_camera_new(options, &mut camera) != realistic_status::Ok {
            return Err(CStr::from_ptr(realistic_last_error()).to_str().expect("UTF-8").to_owned());
        }
        assert_eq!(realistic_camera_get_info(camera, &mut info), realistic_status::Ok);
        realistic_camera_free(camera);
        Ok(info)
    }
}

#[test]
fn a_crop_is_reported_back_and_changes_no_ray() {
    for model in [c"lens", c"thick", c"thin", c"perspective", c"orthographic", c"environment"] {
        let weighting =
            if [c"lens", c"thick"].contains(&model) { c"relative".as_ptr() } else { std::ptr::null() };
        for tolerance in if model == c"lens" { &[f64::NAN, 0.5][..] } else { &[f64::NAN] } {
            let whole = realistic_options {
                model: model.as_ptr(),
                weighting,
                tolerance: *tolerance,
                ..new_options()
            };
            let part = realistic_options { crop: [30.0, 0.0, 40.0, 3.0], ..whole };
            assert_eq!(info_of(&whole).expect("built").crop, [0, 0, 40, 20], "{model:?}");
            assert_eq!(info_of(&part).expect("built").crop, [30, 0, 40, 3], "{model:?}");
            for i in 0..12_u8 {
                let at = |step: f32| (f32::from(i) * step).fract();
                let sample = realistic_sample {
                    image_x: 40.0 * at(0.618),
                    image_y: 20.0 * at(0.754),
                    lens_u: at(0.569),
                    lens_v: at(0.831),
                    time: 0.5,
                };
                assert_eq!(ray(&whole, sample), ray(&part, sample), "{model:?} {sample:?}");
            }
        }
    }
    let refused = |crop| info_of(&realistic_options { crop, ..new_options() }).expect_err("refused");
    assert!(refused([0.0, 0.0, 41.0, 20.0]).contains("\"crop\" is 0,0,41,20; it must be"));
    assert!(refused([0.0, f64::NAN, 40.0, 20.0]).contains("\"crop\" is not a number"));
}

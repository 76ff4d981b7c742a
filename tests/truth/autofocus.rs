//! `realistic_autofocus` from a C caller's view.

use std::ffi::{CStr, c_void};
use std::ptr::{null, null_mut};

use ::realistic_camera::{Host, Parameters, Raster, open_lens};
use realistic::ffi::{
    realistic_autofocus, realistic_autofocus_rule, realistic_camera, realistic_contrast, realistic_distance,
    realistic_last_error, realistic_options, realistic_ray, realistic_sample, realistic_status,
    realistic_zone,
};
use realistic_optics::imaging::focus::Focus;

const LEFT: realistic_zone = realistic_zone { left: 30.0, top: 90.0, right: 50.0, bottom: 110.0 };
const MIDDLE: realistic_zone = realistic_zone { left: 140.0, top: 90.0, right: 160.0, bottom: 110.0 };

fn options() -> realistic_options {
    let lens_file = c"dgauss.50mm".as_ptr();
    realistic_options { xres: 300, yres: 200, lens_file, ..Default::default() }
}

struct FocusResult {
    status: realistic_status,
    film_distance: f64,
    message: String,
}

fn focus(
    options: &realistic_options,
    zones: &[realistic_zone],
    rule: i32,
    distance: realistic_distance,
    contrast: realistic_contrast,
) -> FocusResult {
    let mut film_distance = -1.0;
    // SAFETY: everything is valid for the call.
    unsafe {
        let status = realistic_autofocus(
            options,
            zones.as_ptr(),
            zones.len(),
            rule,
            distance,
            contrast,
            null_mut(),
            &mut film_distance,
        );
        let message = CStr::from_ptr(realistic_last_error()).to_string_lossy().into_owned();
        FocusResult { status, film_distance, message }
    }
}

#[test]
fn a_lens_that_its_groups_focus_is_refused_with_what_to_do() {
    let by_groups = realistic_options { focus_by: c"group".as_ptr(), ..options() };
    let result = focus(&by_groups, &[MIDDLE], 0, Some(walls), None);
    assert_eq!((result.status, result.film_distance), (realistic_status::InvalidParameter, -1.0));
    assert!(result.message.contains("leave out \"focus_by\""), "{}", result.message);
}

/// Returns the distance along a ray to a wall at z = 1000; at the left of the picture, x < 100, to a wall at z = 600.
unsafe extern "C" fn walls(_: *mut c_void, ray: *const realistic_ray) -> f64 {
    // SAFETY: the library passes a ray.
    let ray = unsafe { &*ray };
    let along = |z: f32| f64::from((z - ray.o[2]) / ray.d[2]);
    if ray.d[0] < -0.1 { along(600.0) } else { along(1000.0) }
}

/// Returns the film distance for a plane `z` mm before the front vertex, from focusing alone.
fn expected(z: f64) -> f64 {
    let parameters = Parameters { lens_file: Some("dgauss.50mm".to_owned()), ..Parameters::default() };
    let host = Host::new(Raster { xres: 1, yres: 1 }, None);
    let (_, lens) = open_lens(&parameters, &host, &mut |_, _| ()).unwrap();
    let focus = Focus::new(&lens).unwrap();
    let from_film = |film: f64| z - lens.rear().vertex + film;
    (0..40).fold(40.0, |film, _| focus.film_distance(from_film(film)).unwrap())
}

#[test]
fn distances_focus_where_the_rays_end_and_the_rules_choose() {
    let found = |zones: &[realistic_zone], rule: realistic_autofocus_rule| {
        let result = focus(&options(), zones, rule as i32, Some(walls), None);
        assert_eq!(result.status, realistic_status::Ok, "{}", result.message);
        result.film_distance
    };
    use realistic_autofocus_rule::{Average, Centre, Nearest};
    let (near, far) = (expected(600.0), expected(1000.0));
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-4, "{a} and {b}");
    close(found(&[MIDDLE], Nearest), far);
    close(found(&[LEFT], Centre), near);
    close(found(&[MIDDLE, LEFT], Nearest), near);
    close(found(&[LEFT, MIDDLE], Centre), far);
    close(found(&[LEFT, MIDDLE], Average), f64::midpoint(near, far));
}

#[test]
fn a_moved_camera_focuses_by_its_own_axis() {
    // The camera looks along world +x from (100, 0, 0).
    let camera_to_world = [0.0, 0.0, 1.0, 100.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    unsafe extern "C" fn wall(_: *mut c_void, ray: *const realistic_ray) -> f64 {
        // SAFETY: the library passes a ray.
        let ray = unsafe { &*ray };
        f64::from((1100.0 - ray.o[0]) / ray.d[0])
    }
    let moved = focus(&realistic_options { camera_to_world, ..options() }, &[MIDDLE], 0, Some(wall), None);
    assert_eq!(moved.status, realistic_status::Ok, "{}", moved.message);
    assert!((moved.film_distance - expected(1000.0)).abs() < 1e-4, "{}", moved.film_distance);
}

/// Returns the reciprocal of the spot size, on the wall at z = 1000, of rays from the zone's
/// middle.
unsafe extern "C" fn sharpness(
    _: *mut c_void,
    camera: *const realistic_camera,
    zone: *const realistic_zone,
) -> f64 {
    // SAFETY: the library passes a zone.
    let zone = unsafe { &*zone };
    let (image_x, image_y) = (f32::midpoint(zone.left, zone.right), f32::midpoint(zone.top, zone.bottom));
    let at = |k: u16| (f32::from(k) + 0.5) / 32.0;
    let samples: Vec<realistic_sample> = (0..1024_u16)
        .map(|k| realistic_sample { image_x, image_y, lens_u: at(k % 32), lens_v: at(k / 32), time: 0.5 })
        .collect();
    let mut rays = vec![realistic_ray::default(); samples.len()];
    let mut weights = vec![0.0; samples.len()];
    // SAFETY: the camera lives, and the arrays have the stated lengths.
    let status = unsafe {
        crate::support::inline::realistic_camera_generate_rays(
            camera,
            samples.len(),
            samples.as_ptr(),
            0,
            rays.as_mut_ptr(),
            0,
            weights.as_mut_ptr(),
            null_mut(),
        )
    };
    assert_eq!(status, realistic_status::Ok);
    let (mut size, mut count) = (0.0, 0.0);
    for (ray, _) in rays.iter().zip(&weights).filter(|(_, weight)| **weight > 0.0) {
        let along = (1000.0 - ray.o[2]) / ray.d[2];
        let [x, y] = [0, 1].map(|axis| f64::from(ray.o[axis] + along * ray.d[axis]));
        size += x * x + y * y;
        count += 1.0;
    }
    1.0 / (size / count)
}

#[test]
fn contrast_finds_the_film_distance_of_the_sharpest_picture() {
    // A zone on the axis, where the spot is centred on the origin.
    let middle = realistic_zone { left: 149.0, top: 99.0, right: 151.0, bottom: 101.0 };
    let result = focus(&options(), &[middle], 0, None, Some(sharpness));
    assert_eq!(result.status, realistic_status::Ok, "{}", result.message);
    assert!((result.film_distance - expected(1000.0)).abs() < 0.02, "{}", result.film_distance);
}

#[test]
fn an_unfocusable_target_is_reported_with_what_to_do() {
    unsafe extern "C" fn unknown(_: *mut c_void, _: *const realistic_ray) -> f64 {
        f64::NAN
    }
    unsafe extern "C" fn sky(_: *mut c_void, _: *const realistic_ray) -> f64 {
        f64::INFINITY
    }
    unsafe extern "C" fn close(_: *mut c_void, _: *const realistic_ray) -> f64 {
        5.0
    }
    unsafe extern "C" fn no_contrast(
        _: *mut c_void,
        _: *const realistic_camera,
        _: *const realistic_zone,
    ) -> f64 {
        f64::NAN
    }
    unsafe extern "C" fn flat(_: *mut c_void, _: *const realistic_camera, _: *const realistic_zone) -> f64 {
        0.3
    }
    let nothing = |result: FocusResult| {
        assert_eq!(result.status, realistic_status::UnreachableFocus);
        assert_eq!(result.film_distance, -1.0, "the output is left as it was");
        assert!(result.message.contains("focus_distance"), "{}", result.message);
    };
    nothing(focus(&options(), &[MIDDLE], 0, Some(unknown), None));
    nothing(focus(&options(), &[MIDDLE, LEFT], 2, None, Some(no_contrast)));
    nothing(focus(&options(), &[MIDDLE], 0, None, Some(flat)));
    let near = focus(&options(), &[MIDDLE], 0, Some(close), None);
    assert_eq!(near.status, realistic_status::UnreachableFocus);
    assert!(near.message.contains("nearest"), "{}", near.message);
    let far = focus(&options(), &[MIDDLE], 0, Some(sky), None);
    assert_eq!(far.status, realistic_status::Ok);
    assert!((far.film_distance - expected(f64::INFINITY)).abs() < 1e-9);
}

#[test]
fn wrong_arguments_are_refused() {
    let refused = |result: FocusResult, status: realistic_status, words: &str| {
        assert_eq!(result.status, status, "{}", result.message);
        assert!(result.message.contains(words), "{}", result.message);
        assert_eq!(result.film_distance, -1.0);
    };
    use realistic_status::{InvalidParameter, NullPointer};
    let zones = [MIDDLE];
    refused(focus(&options(), &[], 0, Some(walls), None), InvalidParameter, "at least one zone");
    refused(focus(&options(), &zones, 3, Some(walls), None), InvalidParameter, "rule 3");
    refused(focus(&options(), &zones, 0, None, None), NullPointer, "both are NULL; give one");
    refused(focus(&options(), &zones, 0, Some(walls), Some(sharpness)), InvalidParameter, "not both");
    for bad in [
        realistic_zone { right: 140.0, ..MIDDLE },
        realistic_zone { left: -1.0, ..MIDDLE },
        realistic_zone { bottom: 201.0, ..MIDDLE },
        realistic_zone { top: f32::NAN, ..MIDDLE },
    ] {
        refused(focus(&options(), &[MIDDLE, bad], 0, Some(walls), None), InvalidParameter, "zone 1");
    }
    let focused = realistic_options { focus_distance: 900.0, ..options() };
    refused(focus(&focused, &zones, 0, Some(walls), None), InvalidParameter, "focus_distance");
    // SAFETY: the test passes NULL on purpose.
    unsafe {
        let options = options();
        let mut film = -1.0;
        let call = |options, zones, out| {
            realistic_autofocus(options, zones, 1, 0, Some(walls), None, null_mut(), out)
        };
        assert_eq!(call(null(), zones.as_ptr(), &mut film), NullPointer);
        assert_eq!(call(&options, null(), &mut film), NullPointer);
        assert_eq!(call(&options, zones.as_ptr(), null_mut()), NullPointer);
        assert_eq!(film, -1.0);
    }
}

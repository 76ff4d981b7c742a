//! Camera options from the fuzzer's data: all models, lens texts, shutters, motion, tolerances; and words and numbers
//! that are not valid.

use std::ffi::CStr;
use std::ptr::null;

use super::bytes::Bytes;
use realistic::ffi::realistic_options;

/// Returns one of the words, or null in half of the cases.
fn word(bytes: &mut Bytes<'_>, words: &[&'static CStr]) -> *const std::ffi::c_char {
    match bytes.choice(2 * words.len()) {
        i if i < words.len() => words[i].as_ptr(),
        _ => null(),
    }
}

/// Decodes options, whose lens text points into the data.
pub fn options(bytes: &mut Bytes<'_>) -> realistic_options {
    let mut options = realistic_options {
        lens_file: word(
            bytes,
            &[
                c"wide.22mm",
                c"telephoto.250mm",
                c"fisheye.10mm@1e9mm",
                c"dgauss.100mm",
                c"@mm",
                c"fisheye.10mm",
            ],
        ),
        weighting: word(bytes, &[c"radiometric", c"assignment", c"relative", c"none", c"?"]),
        pupil: word(bytes, &[c"rear", c"disk", c"warped", c""]),
        disk: word(bytes, &[c"concentric", c"polar", c"rejection", c"\xFF"]),
        refraction: word(bytes, &[c"fused", c"heckbert", c"whitted", c"other"]),
        precision: word(bytes, &[c"f64", c"f32", c"auto"]),
        shutter: word(bytes, &[c"global", c"leaf", c"focal-plane", c"slow"]),
        ..realistic_options::default()
    };
    (options.xres, options.yres) = match bytes.choice(4) {
        0 => (i32::from_le_bytes(bytes.take()), i32::from_le_bytes(bytes.take())),
        _ => (40, 30),
    };
    options.simple_weighting = [-1, -1, -1, 0, 1, 2][bytes.choice(6)];
    for number in [
        &mut options.film_distance,
        &mut options.focus_distance,
        &mut options.aperture_diameter,
        &mut options.fnumber,
        &mut options.film_diagonal,
        &mut options.hither,
        &mut options.yon,
        &mut options.shutter_open,
        &mut options.shutter_close,
        &mut options.wavelength,
        &mut options.mm_per_unit,
        &mut options.tolerance,
        &mut options.shutter_ramp,
        &mut options.shutter_slit,
    ] {
        *number = bytes.number();
    }
    if bytes.choice(4) == 0 {
        const MODELS: [&CStr; 7] =
            [c"thick", c"thin", c"perspective", c"orthographic", c"environment", c"lens", c"pinhole"];
        options.model = MODELS[bytes.choice(MODELS.len())].as_ptr();
        options.lens_plane = [null(), c"eye".as_ptr(), c"hither".as_ptr()][bytes.choice(3)];
        let [from_x, to_x, from_y, to_y] = &mut options.screen_window;
        let window = [from_x, to_x, from_y, to_y];
        let others = [
            &mut options.fov,
            &mut options.frame_aspect_ratio,
            &mut options.lens_radius,
            &mut options.focal_distance,
        ];
        for number in window.into_iter().chain(others) {
            *number = bytes.number();
        }
    }
    if bytes.choice(8) == 0 {
        for entry in &mut options.camera_to_world[..12] {
            *entry = bytes.float(4.0);
        }
    }
    if bytes.choice(8) == 0 {
        (options.transform_start, options.transform_end) = (bytes.number(), bytes.number());
        options.camera_to_world_end = options.camera_to_world;
        for entry in &mut options.camera_to_world_end[..12] {
            *entry += bytes.float(1.0);
        }
    }
    if bytes.choice(4) == 0 {
        // Names of positions in a lens text, and other words.
        const ZOOMS: [&CStr; 5] = [c"wide", c"tele", c"35", c"70mm", c"-1"];
        options.zoom = ZOOMS[bytes.choice(ZOOMS.len())].as_ptr();
        options.focus_by = [null(), c"film".as_ptr(), c"group".as_ptr()][bytes.choice(3)];
    }
    if bytes.choice(4) == 0 {
        options.blades = [5.0, 7.0, 0.0, 32.0, 2.5][bytes.choice(5)];
        (options.blade_rotation, options.blade_curvature) = (bytes.number(), bytes.number());
    }
    if bytes.choice(2) == 1 {
        let text = bytes.text(4096);
        options.lens_text = text.as_ptr().cast();
        options.lens_text_size = text.len();
    }
    options
}

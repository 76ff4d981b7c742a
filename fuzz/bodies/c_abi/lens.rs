//! The lens of the options without a film: its facts, exact rays in both directions, and its focus.

use std::mem::zeroed;
use std::ptr::{null, null_mut};

use super::bytes::Bytes;
use realistic::ffi::*;

const COUNT: usize = 11;

/// Checks the header's promises for a lens, and panics if one is broken.
pub fn check(options: &realistic_options, bytes: &mut Bytes<'_>) {
    let of_lens = realistic_options {
        lens_file: options.lens_file,
        lens_text: options.lens_text,
        lens_text_size: options.lens_text_size,
        wavelength: options.wavelength,
        aperture_diameter: options.aperture_diameter,
        fnumber: options.fnumber,
        ..realistic_options::default()
    };
    let mut lens = null_mut();
    // SAFETY: the options and all that they point to live during the call; so does the room for `lens`.
    let status = unsafe { realistic_lens_new(&of_lens, &mut lens) };
    assert_ne!(status, realistic_status::Panic, "{of_lens:?}");
    assert_eq!(status == realistic_status::Ok, !lens.is_null(), "{of_lens:?}");
    if lens.is_null() {
        return;
    }
    facts(lens, &of_lens);
    for side in [0, 1] {
        rays(lens, side, bytes, &of_lens);
    }
    let mut film = realistic_focused_film {
        struct_size: size_of::<realistic_focused_film>() as u32,
        film_distance: f64::NAN,
        film_tilt_x: f64::NAN,
        film_tilt_y: f64::NAN,
    };
    let points: [f64; 9] = std::array::from_fn(|_| f64::from(bytes.float(2000.0)));
    // SAFETY: the lens is live; there are nine numbers, and a structure of its size.
    let status = unsafe { realistic_lens_plane_of_focus(lens, points.as_ptr(), &mut film) };
    assert!(
        status != realistic_status::Ok || film.film_distance > 0.0 && film.film_tilt_x.is_finite(),
        "{film:?} {of_lens:?}"
    );
    let distances = [f64::INFINITY, bytes.number(), f64::from(bytes.float(1e4))];
    for distance in distances {
        for focus in [realistic_lens_focus, realistic_lens_focused_on] {
            let mut found = -7.0;
            // SAFETY: the lens is live; there is room for the answer.
            let status = unsafe { focus(lens, distance, &mut found) };
            assert_ne!(status, realistic_status::Panic, "{distance} {of_lens:?}");
            let is_answer = found > 0.0 || found.is_nan();
            assert!(
                if status == realistic_status::Ok { is_answer } else { found == -7.0 },
                "{distance} {found}"
            );
        }
    }
    // SAFETY: no call uses the lens any more.
    unsafe { realistic_lens_free(lens) };
}

fn facts(lens: *const realistic_lens, what: &dyn std::fmt::Debug) {
    // SAFETY: structures of numbers, for which all-zero bits are valid.
    let (mut info, mut surface): (realistic_lens_info, realistic_lens_surface) =
        unsafe { (zeroed(), zeroed()) };
    info.struct_size = size_of::<realistic_lens_info>() as u32;
    surface.struct_size = size_of::<realistic_lens_surface>() as u32;
    // SAFETY: the lens is live, and the structures have their sizes.
    unsafe {
        assert_eq!(realistic_lens_get_info(lens, &mut info), realistic_status::Ok, "{what:?}");
        for number in 0..info.surfaces + 1 {
            let status = realistic_lens_get_surface(lens, number, &mut surface);
            assert_eq!(status == realistic_status::Ok, number < info.surfaces, "{number} {what:?}");
        }
    }
    assert!(info.surfaces > 0 && info.limiting >= 0 && (info.limiting as u32) < info.surfaces, "{info:?}");
}

/// Checks that any ray passes the lens as a valid ray, or is blocked with a reason.
fn rays(lens: *const realistic_lens, side: i32, bytes: &mut Bytes<'_>, what: &dyn std::fmt::Debug) {
    let mut arrays: [[f64; COUNT]; 6] = [[0.0; COUNT]; 6];
    for ray in 0..COUNT {
        for (array, scale) in arrays.iter_mut().zip([8.0, 8.0, 8.0, 1.0, 1.0, 4.0]) {
            array[ray] = f64::from(bytes.float(scale)) - 0.5 * f64::from(scale);
        }
        // Rays start in front of the lens, and most travel toward it.
        let toward = if side == 0 { 1.0 } else { -1.0 };
        arrays[2][ray] -= toward * 100.0;
        arrays[5][ray] += 3.0 * toward;
    }
    let mut reasons = [realistic_reason::Ok; COUNT];
    let [x, y, z, dx, dy, dz] = arrays.each_mut().map(|array| array.as_mut_ptr());
    let lens_rays = realistic_lens_rays {
        struct_size: size_of::<realistic_lens_rays>() as u32,
        origin: realistic_vectors::columns([x, y, z]),
        direction: realistic_vectors::columns([dx, dy, dz]),
        reason: reasons.as_mut_ptr(),
        reason_stride: size_of::<realistic_reason>() as isize,
        optical_path: null_mut(),
        optical_path_stride: 0,
    };
    // SAFETY: the lens is live, and the arrays have COUNT elements.
    let status = unsafe { realistic_lens_trace(lens, side, COUNT, &lens_rays, null()) };
    assert_eq!(status, realistic_status::Ok, "{what:?}");
    for (ray, reason) in reasons.into_iter().enumerate() {
        if reason == realistic_reason::Ok {
            let [x, y, z, dx, dy, dz] = arrays.map(|array| array[ray]);
            let length = (dx * dx + dy * dy + dz * dz).sqrt();
            let is_ray =
                [x, y, z].iter().all(|coordinate| coordinate.is_finite()) && (length - 1.0).abs() < 1e-9;
            assert!(is_ray, "{side} {x} {y} {z} {dx} {dy} {dz} {what:?}");
        }
    }
}

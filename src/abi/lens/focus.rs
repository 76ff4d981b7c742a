//! Where a lens is sharp, by exact rays.

use super::{
    super::boundary::{self, Failure, realistic_status},
    handle::{OpenedLens, opened, realistic_lens},
};
use crate::{camera::CameraError, imaging::focus::Focus};

/// The film distance, from the last vertex in mm, at which a point on the axis `object_distance_mm` in front of the **film**
/// is sharpest: where its bundle of exact rays at the lens's stop and wavelength has the smallest RMS spot. Infinity is a
/// distance. `REALISTIC_STATUS_UNREACHABLE_FOCUS`, and in the message the nearest distance, where the lens cannot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_focus(
    lens: *const realistic_lens,
    object_distance_mm: f64,
    film_distance_mm: *mut f64,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let focus = focus_of(unsafe { opened(lens) }?)?;
        positive("object_distance_mm", object_distance_mm)?;
        let found = focus.film_distance(object_distance_mm).map_err(CameraError::from)?;
        // SAFETY: the caller's promise.
        unsafe { give(film_distance_mm, "film_distance_mm", found) }
    })
}

/// The distance from the film, mm along the axis, of what film `film_distance_mm` behind the last vertex shows sharp;
/// infinity for what lies there or, NaN, where nothing in front of the lens is in focus.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_lens_focused_on(
    lens: *const realistic_lens,
    film_distance_mm: f64,
    object_distance_mm: *mut f64,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let focus = focus_of(unsafe { opened(lens) }?)?;
        positive("film_distance_mm", film_distance_mm)?;
        let found = focus.object_distance(film_distance_mm).unwrap_or(f64::NAN);
        // SAFETY: the caller's promise.
        unsafe { give(object_distance_mm, "object_distance_mm", found) }
    })
}

fn focus_of(opened: &OpenedLens) -> Result<&Focus, Failure> {
    opened.focus.as_ref().map_err(|error| CameraError::from(error.clone()).into())
}

fn positive(name: &str, distance: f64) -> Result<(), Failure> {
    if distance > 0.0 {
        return Ok(());
    }
    Err(Failure::invalid(format!("{name} is {distance}; it must be positive")))
}

/// # Safety
/// `out` is NULL or writable.
unsafe fn give(out: *mut f64, name: &str, found: f64) -> Result<(), Failure> {
    if out.is_null() {
        return Err(boundary::null(name));
    }
    // SAFETY: not NULL, and the caller's promise.
    unsafe { out.write_unaligned(found) };
    Ok(())
}

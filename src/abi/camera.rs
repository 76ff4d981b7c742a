//! Construction, description and release of cameras for a C caller.

use std::ffi::{c_char, c_void};

use super::boundary::{self, Failure, realistic_status};
use super::exchange::{give, give_text};
use super::object::{self, Handle, HostPart};
use super::options;
use super::options::realistic_options;
use super::types::{level_number, realistic_camera, realistic_camera_info, realistic_log};
use ::realistic_camera::{Camera, Crop, Facts, Host, Level, Log, Parameters};

/// Builds a camera, which the caller frees with `realistic_camera_free`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_new(
    options: *const realistic_options,
    out: *mut *mut realistic_camera,
) -> realistic_status {
    // SAFETY: the caller's promise, here and within.
    unsafe {
        construct(options, out, |options, parameters, log| {
            make(options.donor()?, parameters, &options.host()?, log)
        })
    }
}

/// Builds an object from a caller's options with `make`, and writes the pointer to it to `out`.
///
/// # Safety
/// The promises for `options` and `out` are those of [`realistic_camera_new`].
pub(super) unsafe fn construct<T>(
    options: *const realistic_options,
    out: *mut *mut T,
    make: impl FnOnce(&realistic_options, &Parameters, Log<'_>) -> Result<*mut T, Failure>,
) -> realistic_status {
    boundary::status(|| {
        if out.is_null() {
            return Err(boundary::null("out"));
        }
        boundary::memory_to_build()?;
        // SAFETY: the caller's promise.
        let (options, parameters) = unsafe {
            let options = options::read(options)?;
            (options, options.parameters()?)
        };
        let mut log = |level, text: &str| log(options.log, options.log_user, level, text);
        let made = make(&options, &parameters, &mut log)?;
        // SAFETY: not NULL, and the caller's promise.
        unsafe { out.write_unaligned(made) };
        Ok(())
    })
}

/// Makes a camera object, which is deleted with [`object::delete`].
pub(super) fn make(
    donor: Option<&Camera>,
    parameters: &Parameters,
    host: &Host,
    log: Log<'_>,
) -> Result<*mut realistic_camera, Failure> {
    let handle = Handle::build(donor, parameters, host, log)?;
    let [open, _] = handle.camera().shutter_interval();
    let at_start = host.to_world.at(open);
    let no_film = std::ptr::null_mut();
    let host = HostPart::of(handle.camera(), no_film, at_start.inverse_rows(), at_start.rows());
    object::new(handle, &host).ok_or_else(boundary::out_of_memory)
}

/// Passes a message to the caller's log.
pub(super) fn log(callback: realistic_log, user: *mut c_void, level: Level, text: &str) {
    if let Some(callback) = callback {
        let text = boundary::c_string(text);
        // SAFETY: the caller's function is called with the arguments that its type declares.
        unsafe { callback(user, level_number(level), text.as_ptr()) }
    }
}

/// Frees a camera made by `realistic_camera_new`. Do not pass a camera made by `CreateCamera`, because its
/// host deletes it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_free(camera: *mut realistic_camera) {
    boundary::value((), || {
        // SAFETY: the caller's promise.
        if camera.is_null() || unsafe { object::delete(camera) } {
            Ok(())
        } else {
            Err(boundary::not_a_camera())
        }
    });
}

/// Describes a camera.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_get_info(
    camera: *const realistic_camera,
    info: *mut realistic_camera_info,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let camera = unsafe { object::handle_of(camera) }.ok_or_else(boundary::not_a_camera)?.camera();
        let facts = camera.facts();
        let Crop { from, to } = camera.crop();
        let filled = realistic_camera_info {
            struct_size: size_of::<realistic_camera_info>() as u32,
            interfaces: facts.map_or(0, |facts| facts.lens.surfaces.len() as u32),
            focal_length_mm: facts.map_or(f64::NAN, Facts::focal_length),
            fnumber: facts.map_or(f64::NAN, Facts::fnumber),
            film_distance: facts.map_or(f64::NAN, |facts| facts.film_distance),
            focus_distance_mm: facts.and_then(|facts| facts.focus_distance_mm).unwrap_or(f64::NAN),
            film_diagonal: facts.map_or(f64::NAN, |facts| facts.film.diagonal()),
            crop: [from[0], from[1], to[0], to[1]],
        };
        // SAFETY: the caller's promise.
        unsafe { give("realistic_camera_info", filled, "info", info) }
    })
}

/// Copies the name of a camera's lens; the text is empty for a model without a lens.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_get_lens_name(
    camera: *const realistic_camera,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let camera = unsafe { object::handle_of(camera) }.ok_or_else(boundary::not_a_camera)?.camera();
        let name = camera.facts().map_or("", |facts| &facts.lens.name);
        // SAFETY: the caller's promise.
        unsafe { give_text(name, buffer, capacity, length) }
    })
}

/// Copies a description of the effects that the camera keeps and leaves out, and of the lens model that a
/// tolerance selected. The text is for people; its wording may change.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_camera_plan(
    camera: *const realistic_camera,
    buffer: *mut c_char,
    capacity: usize,
    length: *mut usize,
) -> realistic_status {
    boundary::status(|| {
        // SAFETY: the caller's promise.
        let camera = unsafe { object::handle_of(camera) }.ok_or_else(boundary::not_a_camera)?.camera();
        let text = camera.plan().to_string();
        // SAFETY: the caller's promise.
        unsafe { give_text(&text, buffer, capacity, length) }
    })
}

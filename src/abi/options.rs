//! What a C caller gives: `realistic_options` to parameters and host.

use std::ffi::{CStr, c_char};
use std::mem::{offset_of, size_of};
use std::ptr::{null, null_mut};

use super::boundary::{self, Failure, realistic_status};
use super::exchange::check_size;
use super::library::plugin_directory;
use super::types::realistic_options;
use crate::camera::{
    CameraError, CameraMotion, CameraToWorld, Host, Parameters, Raster, Value, parameters::Written,
};
use crate::prescription::MAX_FILE_BYTES;

/// Bytes of the first version of `realistic_options`; later ones only add at the end.
const FIRST_SIZE: usize = offset_of!(realistic_options, camera_to_world_end);

const IDENTITY: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// The fields that are parameters by kind: what stands for "not given", and how they are read by name.
macro_rules! parameter_fields {
    (texts: $($text:ident)*; numbers: $($number:ident)*;) => {
        impl Default for realistic_options {
            fn default() -> Self {
                Self {
                    struct_size: size_of::<Self>() as u32,
                    xres: 0,
                    yres: 0,
                    simpleweighting: -1,
                    camera_to_world: IDENTITY,
                    log: None,
                    log_user: null_mut(),
                    lens_text: null(),
                    lens_text_size: 0,
                    camera_to_world_end: [f32::NAN; 16],
                    transformstart: f64::NAN,
                    transformend: f64::NAN,
                    screenwindow: [f64::NAN; 4],
                    crop: [f64::NAN; 4],
                    $($text: null(),)*
                    $($number: f64::NAN,)*
                }
            }
        }

        impl realistic_options {
            fn texts(&self) -> impl IntoIterator<Item = (&'static str, *const c_char)> {
                [$((stringify!($text), self.$text)),*]
            }

            fn numbers(&self) -> impl IntoIterator<Item = (&'static str, f64)> {
                [$((stringify!($number), self.$number)),*]
            }

            /// Fills in the fields of the parameters that are given and leaves the rest: the inverse of what the
            /// library does with a caller's options. `text` keeps a text for as long as the options are in use and
            /// points to it. `af_zones` has no field.
            ///
            /// # Errors
            /// Those of `text`.
            pub fn fill<E>(
                &mut self,
                given: &Parameters,
                mut text: impl FnMut(String) -> Result<*const c_char, E>,
            ) -> Result<(), E> {
                $(if let Some(value) = &given.$text {
                    self.$text = text(value.written())?;
                })*
                $(self.$number = given.$number.unwrap_or(self.$number);)*
                self.simpleweighting = given.simpleweighting.map_or(self.simpleweighting, i32::from);
                self.screenwindow = given.screenwindow.unwrap_or(self.screenwindow);
                self.crop = given.crop.unwrap_or(self.crop);
                Ok(())
            }
        }
    };
}

parameter_fields! {
    texts: model specfile weighting pupil disk refraction precision shutter lensplane focusby
        zoom glasscatalog;
    numbers: filmdistance focusdistance aperture_diameter fnumber filmdiag hither yon shutteropen shutterclose
        wavelength mmperunit shutterramp shutterslit fov frameaspectratio lensradius focaldistance tolerance
        blades bladerotation bladecurvature;
}

/// Sets every field to "not given" and the transform to the identity. `struct_size` is
/// `sizeof(realistic_options)` of the caller's header. Only `xres` and `yres` must be set after.
///
/// # Safety
/// `options` is NULL or points to `struct_size` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_options_init(
    options: *mut realistic_options,
    struct_size: u32,
) -> realistic_status {
    boundary::status(|| {
        check_size("realistic_options", struct_size, FIRST_SIZE, size_of::<realistic_options>())?;
        if options.is_null() {
            return Err(boundary::null("options"));
        }
        // SAFETY: not NULL, and the caller's promise for at least the bytes of the first version; the
        // check allows no more than this version's.
        unsafe {
            let defaults = realistic_options { struct_size, ..Default::default() };
            std::ptr::copy_nonoverlapping(
                (&raw const defaults).cast::<u8>(),
                options.cast::<u8>(),
                struct_size as usize,
            );
        }
        Ok(())
    })
}

/// A caller's options in this version's shape.
///
/// # Safety
/// `options` is NULL or points to a structure of its `struct_size` bytes.
pub(super) unsafe fn read(options: *const realistic_options) -> Result<realistic_options, Failure> {
    if options.is_null() {
        return Err(boundary::null("options"));
    }
    // SAFETY: not NULL; the first field is always there.
    let size = unsafe { (&raw const (*options).struct_size).read_unaligned() };
    check_size("realistic_options", size, FIRST_SIZE, size_of::<realistic_options>())?;
    let mut read = realistic_options::default();
    // SAFETY: the caller's promise; the check allows no more than `read` has.
    unsafe {
        std::ptr::copy_nonoverlapping(options.cast::<u8>(), (&raw mut read).cast::<u8>(), size as usize);
    }
    Ok(read)
}

impl realistic_options {
    /// The parameters that are given.
    ///
    /// # Safety
    /// The strings are NULL or end in NUL.
    pub(super) unsafe fn parameters(&self) -> Result<Parameters, Failure> {
        let mut parameters = Parameters::default();
        for (name, text) in self.texts() {
            // SAFETY: the caller's promise.
            if let Some(text) = unsafe { text_at(name, text) }? {
                parameters.set(name, Value::Text(text))?;
            }
        }
        for (name, number) in self.numbers() {
            if let Some(number) = given(number) {
                parameters.set(name, Value::Float(number))?;
            }
        }
        for (name, sides) in [("screenwindow", self.screenwindow), ("crop", self.crop)] {
            if !sides.iter().all(|side| side.is_nan()) {
                parameters.set(name, Value::Four(sides))?;
            }
        }
        match self.simpleweighting {
            -1 => {}
            0 | 1 => parameters.set("simpleweighting", Value::Bool(self.simpleweighting == 1))?,
            other => {
                let text = format!("parameter \"simpleweighting\" is {other}; it must be -1, 0 or 1");
                return Err(Failure::invalid(text));
            }
        }
        Ok(parameters)
    }

    /// The host that the caller is.
    ///
    /// # Safety
    /// `lens_text` is NULL or points to `lens_text_size` bytes.
    pub(super) unsafe fn host(&self) -> Result<Host, Failure> {
        let mut host = Host::new(raster(self.xres, self.yres)?, plugin_directory());
        host.to_world = self.motion()?;
        // SAFETY: the caller's promise.
        host.lens_text = unsafe { self.lens_text() }?;
        Ok(host)
    }

    /// The host of a caller who wants a lens and no camera: any raster serves.
    ///
    /// # Safety
    /// As [`realistic_options::host`].
    pub(super) unsafe fn lens_host(&self) -> Result<Host, Failure> {
        let mut host = Host::new(Raster { xres: 1, yres: 1 }, plugin_directory());
        // SAFETY: the caller's promise.
        host.lens_text = unsafe { self.lens_text() }?;
        Ok(host)
    }

    /// The text of a lens file, and what messages call it.
    ///
    /// # Safety
    /// `lens_text` is NULL or points to `lens_text_size` bytes.
    unsafe fn lens_text(&self) -> Result<Option<(String, Vec<u8>)>, Failure> {
        if self.lens_text.is_null() {
            return Ok(None);
        }
        // A length that was never set, or is that of another thing, must not be read to its end.
        if self.lens_text_size as u64 > MAX_FILE_BYTES {
            let text = format!(
                "lens_text_size is {}; a lens file has at most {MAX_FILE_BYTES} bytes",
                self.lens_text_size
            );
            return Err(Failure::new(realistic_status::LensFile, text));
        }
        // SAFETY: not NULL, and the caller's promise.
        let text = unsafe { std::slice::from_raw_parts(self.lens_text.cast::<u8>(), self.lens_text_size) };
        Ok(Some(("lens_text".to_owned(), text.to_vec())))
    }

    fn motion(&self) -> Result<CameraMotion, Failure> {
        let transform = |rows| CameraToWorld::from_rows(rows).map_err(CameraError::from);
        let start = transform(&self.camera_to_world)?;
        if self.camera_to_world_end.iter().all(|entry| entry.is_nan()) {
            if self.transformstart.is_nan() && self.transformend.is_nan() {
                return Ok(start.into());
            }
            return Err(Failure::invalid(
                "transformstart and transformend are the times of a moving camera's two transforms; give \
                 camera_to_world_end as well",
            ));
        }
        let end = transform(&self.camera_to_world_end)?;
        let shutter = Parameters {
            shutteropen: given(self.shutteropen),
            shutterclose: given(self.shutterclose),
            ..Parameters::default()
        };
        let start_time = given(self.transformstart).map_or_else(|| shutter.shutteropen(), Ok)?;
        let end_time = given(self.transformend).map_or_else(|| shutter.shutterclose(), Ok)?;
        let mut ends = [(start, start_time), (end, end_time)];
        if end_time < start_time && self.transformstart.is_nan() && self.transformend.is_nan() {
            // The shutter's time runs backward, from the first transform's to the second's.
            ends.reverse();
        }
        let [earlier, later] = ends;
        Ok(CameraMotion::between(earlier, later).map_err(CameraError::from)?)
    }
}

/// A number that is given.
fn given(number: f64) -> Option<f64> {
    (!number.is_nan()).then_some(number)
}

/// The raster of signed resolutions, as both C and pbrt give them.
pub(super) fn raster(xres: i32, yres: i32) -> Result<Raster, Failure> {
    match (u32::try_from(xres), u32::try_from(yres)) {
        (Ok(across), Ok(down)) if across > 0 && down > 0 => Ok(Raster { xres: across, yres: down }),
        _ => Err(CameraError::Raster { xres, yres }.into()),
    }
}

/// # Safety
/// `text` is NULL or ends in NUL.
unsafe fn text_at<'a>(name: &str, text: *const c_char) -> Result<Option<&'a str>, Failure> {
    if text.is_null() {
        return Ok(None);
    }
    // SAFETY: not NULL, and the caller's promise.
    unsafe { CStr::from_ptr(text) }
        .to_str()
        .map(Some)
        .map_err(|_| Failure::invalid(format!("parameter \"{name}\" is not UTF-8 text")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_versions_structure_still_serves() {
        // On a 64-bit machine the first header's structure had this size.
        #[cfg(target_pointer_width = "64")]
        assert_eq!(FIRST_SIZE, 256);
        let mut old = realistic_options {
            struct_size: FIRST_SIZE as u32,
            filmdiag: 24.0,
            // Past the caller's size there may be anything.
            fov: 1e300,
            camera_to_world_end: [7.0; 16],
            ..Default::default()
        };
        // SAFETY: a structure of at least its `struct_size` bytes.
        let read = unsafe { read(&old) }.expect("the first version");
        assert_eq!(read.filmdiag, 24.0);
        assert!(read.fov.is_nan() && read.camera_to_world_end[0].is_nan());
        old.struct_size -= 1;
        // SAFETY: as above.
        let failure = unsafe { super::read(&old) }.expect_err("smaller than any");
        assert_eq!(failure.status, realistic_status::StructSize);
    }

    fn moving(options: realistic_options) -> Result<Host, Failure> {
        // SAFETY: there is no lens text.
        unsafe { realistic_options { xres: 2, yres: 2, ..options }.host() }
    }

    #[test]
    fn a_moving_camera_begins_and_ends_with_the_shutter_unless_told() {
        let mut end = IDENTITY;
        end[3] = 8.0;
        let options = realistic_options { camera_to_world_end: end, ..Default::default() };
        let x = |options, time| {
            let motion = moving(options).expect("one motion").to_world;
            motion.at(time).origin().x as f32
        };
        assert_eq!(x(options, 0.5), 4.0);
        let shutter = realistic_options { shutteropen: 2.0, shutterclose: 6.0, ..options };
        assert_eq!([x(shutter, 2.0), x(shutter, 3.0), x(shutter, 6.0)], [0.0, 2.0, 8.0]);
        let times = realistic_options { transformstart: 0.0, transformend: 4.0, ..shutter };
        assert_eq!([x(times, 2.0), x(times, 6.0)], [4.0, 8.0]);
        // Backward in time, the first transform still is the one at the shutter's opening.
        let backward = realistic_options { shutteropen: 6.0, shutterclose: 2.0, ..options };
        assert_eq!([x(backward, 6.0), x(backward, 5.0), x(backward, 2.0)], [0.0, 2.0, 8.0]);
    }

    #[test]
    fn half_a_motion_is_refused_with_what_to_give() {
        let message = |options| moving(options).expect_err("refused").message;
        let none = realistic_options::default();
        let times = message(realistic_options { transformend: 1.0, ..none });
        assert!(times.contains("camera_to_world_end"), "{times}");
        let mut part = none;
        part.camera_to_world_end[0] = 1.0;
        assert!(message(part).contains("not finite"));
        let backward = realistic_options { camera_to_world_end: IDENTITY, transformend: -1.0, ..none };
        assert!(message(backward).contains("earlier time"));
    }
}

//! Converts a C caller's `realistic_options` to parameters and a host.

use std::ffi::{CStr, c_char, c_void};
use std::mem::size_of;
use std::ptr::{null, null_mut};

use super::boundary::{self, Failure, realistic_status};
use super::exchange::{check_size, take};
use super::library::plugin_directory;
use super::object;
use super::types::{realistic_camera, realistic_log};
use ::realistic_camera::{
    Camera, CameraError, CameraMotion, CameraToWorld, Host, Parameters, Raster, Value, for_each_parameter,
    parameters::Written,
};
use realistic_optics::prescription::MAX_FILE_BYTES;

const IDENTITY: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// A type of member that holds a parameter: the value that means "not given", and the conversion to the
/// parameter's value.
trait Member: Copy {
    const NOT_GIVEN: Self;

    /// # Safety
    /// A text is NULL or ends in NUL.
    unsafe fn value<'a>(self, name: &str) -> Result<Option<Value<'a>>, Failure>;
}

impl Member for f64 {
    const NOT_GIVEN: Self = f64::NAN;

    unsafe fn value<'a>(self, _: &str) -> Result<Option<Value<'a>>, Failure> {
        Ok(given(self).map(Value::Float))
    }
}

impl Member for [f64; 4] {
    const NOT_GIVEN: Self = [f64::NAN; 4];

    unsafe fn value<'a>(self, _: &str) -> Result<Option<Value<'a>>, Failure> {
        Ok((!self.iter().all(|number| number.is_nan())).then_some(Value::Four(self)))
    }
}

impl Member for i32 {
    const NOT_GIVEN: Self = -1;

    unsafe fn value<'a>(self, name: &str) -> Result<Option<Value<'a>>, Failure> {
        match self {
            -1 => Ok(None),
            0 | 1 => Ok(Some(Value::Bool(self == 1))),
            other => Err(Failure::invalid(format!("parameter \"{name}\" is {other}; it must be -1, 0 or 1"))),
        }
    }
}

impl Member for *const c_char {
    const NOT_GIVEN: Self = null();

    unsafe fn value<'a>(self, name: &str) -> Result<Option<Value<'a>>, Failure> {
        // SAFETY: the caller's promise.
        Ok(unsafe { text_at(name, self) }?.map(Value::Text))
    }
}

/// Conversion of a typed parameter to a member. `text` stores a text for as long as the options are in use
/// and returns a pointer to it.
trait AsMember<M> {
    fn member<E>(&self, text: &mut impl FnMut(String) -> Result<*const c_char, E>) -> Result<M, E>;
}

impl AsMember<f64> for f64 {
    fn member<E>(&self, _: &mut impl FnMut(String) -> Result<*const c_char, E>) -> Result<f64, E> {
        Ok(*self)
    }
}

impl AsMember<[f64; 4]> for [f64; 4] {
    fn member<E>(&self, _: &mut impl FnMut(String) -> Result<*const c_char, E>) -> Result<[f64; 4], E> {
        Ok(*self)
    }
}

impl AsMember<i32> for bool {
    fn member<E>(&self, _: &mut impl FnMut(String) -> Result<*const c_char, E>) -> Result<i32, E> {
        Ok((*self).into())
    }
}

impl<T: Written> AsMember<*const c_char> for T {
    fn member<E>(
        &self,
        text: &mut impl FnMut(String) -> Result<*const c_char, E>,
    ) -> Result<*const c_char, E> {
        text(self.written())
    }
}

/// Defines the options: first the members for the host, then one member per parameter.
macro_rules! options {
    (
        { $($(#[doc = $doc:literal])* pub $host:ident: $host_type:ty,)* }
        $($field:ident $(or $($alias:literal)+)?: $type:tt $(in $range:ident)?, $unit:tt, $how:tt $default:literal, $models:ident, $help:literal;)*
    ) => {
        /// Options of a camera or a lens. Start from `realistic_options_init`, which sets every member to "not given":
        /// NaN for numbers, NULL for strings, -1 for booleans.
        #[repr(C)]
        #[derive(Clone, Copy, Debug)]
        #[allow(non_camel_case_types)]
        pub struct realistic_options {
            $($(#[doc = $doc])* pub $host: $host_type,)*
            $(#[doc = $help] pub $field: options!(@member $type),)*
        }

        impl Default for realistic_options {
            fn default() -> Self {
                Self {
                    struct_size: size_of::<Self>() as u32,
                    xres: 0,
                    yres: 0,
                    camera_to_world: IDENTITY,
                    camera_to_world_end: [f32::NAN; 16],
                    transform_start: f64::NAN,
                    transform_end: f64::NAN,
                    lens_text: null(),
                    lens_text_size: 0,
                    donor: null(),
                    log: None,
                    log_user: null_mut(),
                    $($field: Member::NOT_GIVEN,)*
                }
            }
        }

        impl realistic_options {
            /// Sets the members of the parameters that are given and leaves the others unchanged: the inverse
            /// of reading a caller's options. `text` stores a text for as long as the options are in use and
            /// returns a pointer to it.
            ///
            /// # Errors
            /// Returns an error of `text`.
            pub fn fill<E>(
                &mut self,
                given: &Parameters,
                mut text: impl FnMut(String) -> Result<*const c_char, E>,
            ) -> Result<(), E> {
                $(if let Some(value) = &given.$field {
                    self.$field = value.member(&mut text)?;
                })*
                Ok(())
            }

            /// Returns the parameters that the caller gave.
            ///
            /// # Safety
            /// The strings are NULL or end in NUL.
            pub(super) unsafe fn parameters(&self) -> Result<Parameters, Failure> {
                let mut parameters = Parameters::default();
                $(
                    let name = stringify!($field);
                    // SAFETY: the caller's promise.
                    if let Some(value) = unsafe { self.$field.value(name) }? {
                        parameters.set(name, value)?;
                    }
                )*
                Ok(parameters)
            }
        }
    };
    (@member f64) => { f64 };
    (@member [f64; 4]) => { [f64; 4] };
    (@member bool) => { i32 };
    (@member $text:tt) => { *const c_char };
}

for_each_parameter! {
    options {
        /// `sizeof(realistic_options)`.
        pub struct_size: u32,
        /// Image width in pixels, 1 or more. No default.
        pub xres: i32,
        /// Image height in pixels, 1 or more. No default.
        pub yres: i32,
        /// Row-major 4x4 matrix for column vectors that transforms camera space (units of `mm_per_unit`, +z
        /// forward, +x right, +y up) to world space. Its last row must be 0 0 0 1, within rounding.
        /// `realistic_options_init` sets the identity.
        pub camera_to_world: [f32; 16],
        /// Second matrix of a moving camera, which holds at `transform_end`; `camera_to_world` holds at
        /// `transform_start`. Translation, rotation and scale are interpolated between them. If all entries
        /// are NaN, the camera does not move.
        pub camera_to_world_end: [f32; 16],
        /// The time at which `camera_to_world` holds. NaN means `shutter_open`.
        pub transform_start: f64,
        /// The time at which `camera_to_world_end` holds. NaN means `shutter_close`.
        pub transform_end: f64,
        /// Receives messages; NULL for none.
        pub log: realistic_log,
        /// Passed to `log` unchanged.
        pub log_user: *mut c_void,
        /// The text of a lens file, `lens_text_size` bytes, read instead of `lens_file`; NULL for none.
        pub lens_text: *const c_char,
        /// Number of bytes at `lens_text`, at most 1,048,576 (1 MiB), as for any lens file.
        pub lens_text_size: usize,
        /// A camera whose options differ only in focus, stop, zoom or pose, such as that of the previous
        /// frame of an animation; NULL for none. The new camera reuses the data that depends only on
        /// unchanged options, and does not read the lens file again. It is bit-identical to a camera built
        /// without the donor. The donor is not changed and may be freed once the call returns. Lenses and
        /// autofocus do not use it.
        pub donor: *const realistic_camera,
    }
}

/// Sets every member to "not given", the transform to the identity, and `struct_size` to
/// `sizeof(realistic_options)`. Only `xres` and `yres` must be set afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn realistic_options_init(
    options: *mut realistic_options,
    struct_size: u32,
) -> realistic_status {
    boundary::status(|| {
        check_size("realistic_options", struct_size, size_of::<realistic_options>())?;
        if options.is_null() {
            return Err(boundary::null("options"));
        }
        // SAFETY: not NULL, and the caller's promise.
        unsafe { options.write_unaligned(realistic_options::default()) };
        Ok(())
    })
}

/// Reads a caller's options.
///
/// # Safety
/// `options` is NULL or points to a structure of its `struct_size` bytes.
pub(super) unsafe fn read(options: *const realistic_options) -> Result<realistic_options, Failure> {
    // SAFETY: the caller's promise.
    unsafe { take("realistic_options", "options", options) }
}

impl realistic_options {
    /// Returns the host that the options describe.
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

    /// Returns the donor camera, if there is one.
    ///
    /// # Safety
    /// `donor` is NULL or a camera that is not freed during `'a`.
    ///
    /// # Errors
    /// The donor is not a camera of this library.
    pub(super) unsafe fn donor<'a>(&self) -> Result<Option<&'a Camera>, Failure> {
        if self.donor.is_null() {
            return Ok(None);
        }
        // SAFETY: the caller's promise.
        let handle = unsafe { object::handle_of(self.donor) };
        Ok(Some(handle.ok_or_else(boundary::not_a_camera)?.camera()))
    }

    /// Returns the host for a lens without a film; its raster is arbitrary.
    ///
    /// # Safety
    /// The promise of [`realistic_options::host`].
    pub(super) unsafe fn lens_host(&self) -> Result<Host, Failure> {
        let mut host = Host::new(Raster { xres: 1, yres: 1 }, plugin_directory());
        // SAFETY: the caller's promise.
        host.lens_text = unsafe { self.lens_text() }?;
        Ok(host)
    }

    /// Returns the text of a lens file and the name that messages use for it.
    ///
    /// # Safety
    /// `lens_text` is NULL or points to `lens_text_size` bytes.
    unsafe fn lens_text(&self) -> Result<Option<(String, Vec<u8>)>, Failure> {
        if self.lens_text.is_null() {
            return Ok(None);
        }
        // A length that is uninitialised or wrong must not cause reading beyond the text.
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
            if self.transform_start.is_nan() && self.transform_end.is_nan() {
                return Ok(start.into());
            }
            return Err(Failure::invalid(
                "transform_start and transform_end are the times of a moving camera's two transforms; give \
                 camera_to_world_end as well",
            ));
        }
        let end = transform(&self.camera_to_world_end)?;
        let shutter = Parameters {
            shutter_open: given(self.shutter_open),
            shutter_close: given(self.shutter_close),
            ..Parameters::default()
        };
        let start_time = given(self.transform_start).map_or_else(|| shutter.shutter_open(), Ok)?;
        let end_time = given(self.transform_end).map_or_else(|| shutter.shutter_close(), Ok)?;
        let mut ends = [(start, start_time), (end, end_time)];
        if end_time < start_time && self.transform_start.is_nan() && self.transform_end.is_nan() {
            // The shutter's time runs backward, from the time of the first transform to that of the second.
            ends.reverse();
        }
        let [earlier, later] = ends;
        Ok(CameraMotion::between(earlier, later).map_err(CameraError::from)?)
    }
}

/// Returns a number if it is given; NaN means "not given".
fn given(number: f64) -> Option<f64> {
    (!number.is_nan()).then_some(number)
}

/// Converts the signed resolutions of C and pbrt to a raster.
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

    fn moving(options: realistic_options) -> Result<Host, Failure> {
        // SAFETY: there is no lens text.
        unsafe { realistic_options { xres: 2, yres: 2, ..options }.host() }
    }

    #[test]
    fn a_moving_camera_begins_and_ends_with_the_shutter_by_default() {
        let mut end = IDENTITY;
        end[3] = 8.0;
        let options = realistic_options { camera_to_world_end: end, ..Default::default() };
        let x = |options, time| {
            let motion = moving(options).expect("one motion").to_world;
            motion.at(time).origin().x as f32
        };
        assert_eq!(x(options, 0.5), 4.0);
        let shutter = realistic_options { shutter_open: 2.0, shutter_close: 6.0, ..options };
        assert_eq!([x(shutter, 2.0), x(shutter, 3.0), x(shutter, 6.0)], [0.0, 2.0, 8.0]);
        let times = realistic_options { transform_start: 0.0, transform_end: 4.0, ..shutter };
        assert_eq!([x(times, 2.0), x(times, 6.0)], [4.0, 8.0]);
        // With a shutter whose time runs backward, the first transform still holds when the shutter opens.
        let backward = realistic_options { shutter_open: 6.0, shutter_close: 2.0, ..options };
        assert_eq!([x(backward, 6.0), x(backward, 5.0), x(backward, 2.0)], [0.0, 2.0, 8.0]);
    }

    #[test]
    fn half_a_motion_is_refused_with_what_to_give() {
        let message = |options| moving(options).expect_err("refused").message;
        let none = realistic_options::default();
        let times = message(realistic_options { transform_end: 1.0, ..none });
        assert!(times.contains("camera_to_world_end"), "{times}");
        let mut part = none;
        part.camera_to_world_end[0] = 1.0;
        assert!(message(part).contains("not finite"));
        let backward = realistic_options { camera_to_world_end: IDENTITY, transform_end: -1.0, ..none };
        assert!(message(backward).contains("earlier time"));
    }
}

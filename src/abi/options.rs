//! What a C caller gives: `realistic_options` to parameters and host.

use std::ffi::{CStr, c_char};
use std::mem::size_of;
use std::ptr::{null, null_mut};

use super::boundary::{self, Failure, realistic_status};
use super::plugin;
use super::types::realistic_options;
use crate::camera::{CameraError, CameraToWorld, Host, Parameters, Raster, Value};
use crate::prescription::MAX_FILE_BYTES;

/// Bytes of the first version of `realistic_options`; later ones only add at the end.
const FIRST_SIZE: usize = size_of::<realistic_options>();

const IDENTITY: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

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
            model: null(),
            specfile: null(),
            weighting: null(),
            pupil: null(),
            disk: null(),
            refraction: null(),
            precision: null(),
            filmdistance: f64::NAN,
            focusdistance: f64::NAN,
            aperture_diameter: f64::NAN,
            fnumber: f64::NAN,
            filmdiag: f64::NAN,
            hither: f64::NAN,
            yon: f64::NAN,
            shutteropen: f64::NAN,
            shutterclose: f64::NAN,
            wavelength: f64::NAN,
            mmperunit: f64::NAN,
        }
    }
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

/// Whether a caller's structure is one that this library knows.
pub(super) fn check_size(what: &str, given: u32, first: usize, current: usize) -> Result<(), Failure> {
    let size = given as usize;
    if size < first {
        return Err(Failure::new(
            realistic_status::StructSize,
            format!("{what}.struct_size is {size}; set it to sizeof({what}), {current} in this library"),
        ));
    }
    if size > current {
        return Err(Failure::new(
            realistic_status::StructSize,
            format!(
                "{what}.struct_size is {size}, and this library knows {current} bytes: it is older than \
                 the header that the caller was compiled with"
            ),
        ));
    }
    Ok(())
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
        let mut set = |name: &'static str, value: Value<'_>| {
            parameters
                .set(name, value)
                .map_err(|error| Failure::new(realistic_status::InvalidParameter, error.to_string()))
        };
        for (name, text) in [
            ("model", self.model),
            ("specfile", self.specfile),
            ("weighting", self.weighting),
            ("pupil", self.pupil),
            ("disk", self.disk),
            ("refraction", self.refraction),
            ("precision", self.precision),
        ] {
            // SAFETY: the caller's promise.
            if let Some(text) = unsafe { text_at(name, text) }? {
                set(name, Value::Text(text))?;
            }
        }
        for (name, number) in [
            ("filmdistance", self.filmdistance),
            ("focusdistance", self.focusdistance),
            ("aperture_diameter", self.aperture_diameter),
            ("fnumber", self.fnumber),
            ("filmdiag", self.filmdiag),
            ("hither", self.hither),
            ("yon", self.yon),
            ("shutteropen", self.shutteropen),
            ("shutterclose", self.shutterclose),
            ("wavelength", self.wavelength),
            ("mmperunit", self.mmperunit),
        ] {
            if !number.is_nan() {
                set(name, Value::Float(number))?;
            }
        }
        match self.simpleweighting {
            -1 => {}
            0 | 1 => set("simpleweighting", Value::Bool(self.simpleweighting == 1))?,
            other => {
                let text = format!("parameter \"simpleweighting\" is {other}; it must be -1, 0 or 1");
                return Err(Failure::new(realistic_status::InvalidParameter, text));
            }
        }
        Ok(parameters)
    }

    /// The host that the caller is.
    ///
    /// # Safety
    /// `lens_text` is NULL or points to `lens_text_size` bytes.
    pub(super) unsafe fn host(&self) -> Result<Host, Failure> {
        let to_world = CameraToWorld::from_rows(&self.camera_to_world).map_err(CameraError::Transform)?;
        let mut host = Host::new(raster(self.xres, self.yres)?, plugin::directory());
        host.to_world = to_world;
        if !self.lens_text.is_null() {
            // A length that was never set, or is that of another thing, must not be read to its end.
            if self.lens_text_size as u64 > MAX_FILE_BYTES {
                let text = format!(
                    "lens_text_size is {}; a lens file has at most {MAX_FILE_BYTES} bytes",
                    self.lens_text_size
                );
                return Err(Failure::new(realistic_status::LensFile, text));
            }
            // SAFETY: not NULL, and the caller's promise.
            let text =
                unsafe { std::slice::from_raw_parts(self.lens_text.cast::<u8>(), self.lens_text_size) };
            host.lens_text = Some(("lens_text".to_owned(), text.to_vec()));
        }
        Ok(host)
    }
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
    unsafe { CStr::from_ptr(text) }.to_str().map(Some).map_err(|_| {
        Failure::new(realistic_status::InvalidParameter, format!("parameter \"{name}\" is not UTF-8 text"))
    })
}

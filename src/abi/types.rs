//! The structures of the C ABI, by layout.
//!
//! Lengths are millimetres where a name or comment says so and world units otherwise;
//! angles do not occur. Structures that may grow begin with `struct_size`, which the
//! caller sets to `sizeof` of the structure that it was compiled with.

use std::ffi::{c_char, c_void};

use crate::camera::Level;

/// A camera. Opaque to C. Immutable once built: rays may be asked for from any number of threads.
// Not `repr(C)`, so that the header only declares it.
#[allow(non_camel_case_types)]
pub struct realistic_camera {
    _opaque: [u8; 0],
    _pinned: core::marker::PhantomData<(*mut u8, core::marker::PhantomPinned)>,
}

/// One camera sample: the first 20 bytes of pbrt-v1's `Sample`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(non_camel_case_types)]
pub struct realistic_sample {
    /// Raster x in pixels: 0 is the left edge of the image, `xres` the right one.
    pub image_x: f32,
    /// Raster y in pixels: 0 is the top edge of the image, `yres` the bottom one.
    pub image_y: f32,
    /// First lens number, in [0, 1].
    pub lens_u: f32,
    /// Second lens number, in [0, 1].
    pub lens_v: f32,
    /// Time number in [0, 1]: 0 is the shutter's opening, 1 its closing. Of numbers outside, as of lens numbers,
    /// the nearest inside is taken.
    pub time: f32,
}

/// One ray in world space: the 36 bytes of pbrt-v1's `Ray`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(non_camel_case_types)]
pub struct realistic_ray {
    /// Origin, world units: for `model` "lens" the point where the ray leaves the front interface.
    pub o: [f32; 3],
    /// Direction, unit length.
    pub d: [f32; 3],
    /// Distance from `o` at which the ray begins: `hither`; 0 for the two projections, whose rays begin on the
    /// near plane.
    pub mint: f32,
    /// Distance from `o` at which the ray ends: `yon`; for the two projections as far as their far plane.
    pub maxt: f32,
    /// Time between `shutteropen` and `shutterclose`.
    pub time: f32,
}

/// What became of a sample. The numbers are part of the ABI and never change.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(non_camel_case_types)]
pub enum realistic_reason {
    /// The ray gets through.
    Ok = 0,
    /// It passes beside a surface's sphere.
    Missed = 1,
    /// It meets a surface outside the clear aperture.
    Clipped = 2,
    /// It is totally reflected.
    Reflected = 3,
    /// The next surface lies behind it, or it travels backward.
    TurnedBack = 4,
    /// With `disk` "rejection": the lens numbers fell outside the disk. Draw new ones; the sample
    /// does not count.
    Redraw = 5,
    /// The shutter is closed over this film point at this time.
    Shut = 6,
}

/// Samples as structure of arrays; the members of `realistic_sample`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types, missing_docs)]
pub struct realistic_samples_soa {
    pub image_x: *const f32,
    pub image_y: *const f32,
    pub lens_u: *const f32,
    pub lens_v: *const f32,
    pub time: *const f32,
}

/// Rays as structure of arrays; the members of `realistic_ray`, with weight and reason.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types, missing_docs)]
pub struct realistic_rays_soa {
    pub ox: *mut f32,
    pub oy: *mut f32,
    pub oz: *mut f32,
    pub dx: *mut f32,
    pub dy: *mut f32,
    pub dz: *mut f32,
    pub mint: *mut f32,
    pub maxt: *mut f32,
    pub time: *mut f32,
    pub weight: *mut f32,
    pub reason: *mut realistic_reason,
}

/// Receives a message while a camera is being built. `level`: 0 information, 1 warning, 2 error.
/// `message` is UTF-8, ends in NUL, and lives until the callback returns.
#[allow(non_camel_case_types)]
pub type realistic_log = Option<unsafe extern "C" fn(user: *mut c_void, level: i32, message: *const c_char)>;

/// The `level` of a [`realistic_log`].
pub(super) fn level_number(level: Level) -> i32 {
    match level {
        Level::Info => 0,
        Level::Warning => 1,
        Level::Error => 2,
    }
}

/// What a camera is built from. Start from `realistic_options_init`, which sets every
/// field to "not given": NaN for numbers, NULL for strings, -1 for booleans.
/// The fields bear the names of the parameters (README, "Parameters").
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_options {
    /// `sizeof(realistic_options)` of the caller's header.
    pub struct_size: u32,
    /// Image width in pixels, 1 or more. No default.
    pub xres: i32,
    /// Image height in pixels, 1 or more. No default.
    pub yres: i32,
    /// `simpleweighting`: -1 not given, 0 false, 1 true.
    pub simpleweighting: i32,
    /// Row-major 4x4 matrix for column vectors that takes camera space (world units, +z forward,
    /// +x right, +y up) to world space. `realistic_options_init` sets the identity.
    pub camera_to_world: [f32; 16],
    /// Receives messages; NULL for none.
    pub log: realistic_log,
    /// Handed to `log` as it is.
    pub log_user: *mut c_void,
    /// The text of a lens file, `lens_text_size` bytes, read instead of `specfile`; NULL for none.
    pub lens_text: *const c_char,
    /// Bytes at `lens_text`; at most 1,048,576 (1 MiB), as of any lens file.
    pub lens_text_size: usize,
    /// Parameter `model`.
    pub model: *const c_char,
    /// Parameter `specfile`.
    pub specfile: *const c_char,
    /// Parameter `weighting`. `assignment` divides `radiometric` by an area, and so its exposure depends on `pupil`: with
    /// `rear` the area of the rear element's disk, with `disk` and `warped` that of the paraxial exit pupil.
    pub weighting: *const c_char,
    /// Parameter `pupil`.
    pub pupil: *const c_char,
    /// Parameter `disk`.
    pub disk: *const c_char,
    /// Parameter `refraction`.
    pub refraction: *const c_char,
    /// Parameter `precision`.
    pub precision: *const c_char,
    /// Parameter `filmdistance`, mm.
    pub filmdistance: f64,
    /// Parameter `focusdistance`, world units.
    pub focusdistance: f64,
    /// Parameter `aperture_diameter`, mm.
    pub aperture_diameter: f64,
    /// Parameter `fnumber`.
    pub fnumber: f64,
    /// Parameter `filmdiag`, mm.
    pub filmdiag: f64,
    /// Parameter `hither`, world units.
    pub hither: f64,
    /// Parameter `yon`, world units.
    pub yon: f64,
    /// Parameter `shutteropen`.
    pub shutteropen: f64,
    /// Parameter `shutterclose`. Before `shutteropen`, time runs backward, as in pbrt.
    pub shutterclose: f64,
    /// Parameter `wavelength`, nm.
    pub wavelength: f64,
    /// Parameter `mmperunit`, mm a world unit.
    pub mmperunit: f64,
    /// For a camera that moves: `camera_to_world` holds at `transformstart` and this one at `transformend`, and
    /// between the two a move, a rotation and a stretch are interpolated. All NaN: the camera stands still.
    pub camera_to_world_end: [f32; 16],
    /// The time of `camera_to_world`. NaN: `shutteropen`.
    pub transformstart: f64,
    /// The time of `camera_to_world_end`. NaN: `shutterclose`.
    pub transformend: f64,
    /// Parameter `shutter`.
    pub shutter: *const c_char,
    /// Parameter `lensplane`.
    pub lensplane: *const c_char,
    /// Parameter `shutterramp`.
    pub shutterramp: f64,
    /// Parameter `shutterslit`.
    pub shutterslit: f64,
    /// Parameter `fov`, degrees.
    pub fov: f64,
    /// Parameter `screenwindow`. All NaN: not given.
    pub screenwindow: [f64; 4],
    /// Parameter `frameaspectratio`.
    pub frameaspectratio: f64,
    /// Parameter `lensradius`, world units.
    pub lensradius: f64,
    /// Parameter `focaldistance`, world units.
    pub focaldistance: f64,
    /// Parameter `tolerance`, pixels.
    pub tolerance: f64,
}

/// What a built camera is, for a host to print. `realistic_camera_get_info` fills it. A model without a lens
/// (`perspective`, `orthographic`, `environment`) has 0 interfaces and NaN everywhere else.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_camera_info {
    /// `sizeof(realistic_camera_info)` of the caller's header.
    pub struct_size: u32,
    /// Interfaces of the lens, the stop included.
    pub interfaces: u32,
    /// Effective focal length, mm; infinite for an afocal lens.
    pub focal_length_mm: f64,
    /// Focal length over entrance pupil diameter at the stop in use; infinite for an afocal lens.
    pub fnumber: f64,
    /// Last vertex to film, mm.
    pub film_distance_mm: f64,
    /// Film plane to the plane in focus, mm along the axis; infinity when focused there or beyond, NaN
    /// when no object in front of the lens is in focus.
    pub focus_distance_mm: f64,
    /// Film diagonal, mm.
    pub film_diagonal_mm: f64,
}

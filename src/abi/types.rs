//! The structures of the C ABI, by layout.
//!
//! Lengths are millimetres where a name or comment says so and world units otherwise;
//! angles do not occur. Structures that may grow begin with `struct_size`, which the
//! caller sets to `sizeof` of the structure that it was compiled with.

use std::{
    ffi::{c_char, c_void},
    ptr::null_mut,
};

use crate::camera::Level;

/// A camera. Immutable and thread-safe once built.
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
    /// u of the lens sample (u, v), in [0, 1].
    pub lens_u: f32,
    /// v of the lens sample (u, v), in [0, 1].
    pub lens_v: f32,
    /// Time as a fraction of the shutter's interval: 0 is its opening, 1 its closing. Outside [0, 1], as of u and v,
    /// the nearest number inside is taken.
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

/// A ray with its differentials: beside the ray of a sample those of the same lens and time sample one pixel to the right
/// (image x + 1) and one pixel down (image y + 1).
///
/// Bit `REALISTIC_HAS_RX` of `has` says that the lens lets the ray to the right through, whether the shutter is open
/// there or not, and `REALISTIC_HAS_RY` the one below. Where a bit is 0 that neighbour is blocked, and the ray's own
/// origin and direction stand in its place: a footprint of no width, with numbers that are safe to use.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(non_camel_case_types)]
pub struct realistic_ray_differential {
    /// `sizeof(realistic_ray_differential)` of the caller's header. Set by the caller and never written; of several only the
    /// first's is read.
    pub struct_size: u32,
    /// Which neighbours there are: `REALISTIC_HAS_RX`, `REALISTIC_HAS_RY`, both (3) or none (0).
    pub has: u32,
    /// The ray.
    pub ray: realistic_ray,
    /// Origin of the ray to the right, world units.
    pub rx_o: [f32; 3],
    /// Its direction, unit length.
    pub rx_d: [f32; 3],
    /// Origin of the ray below, world units.
    pub ry_o: [f32; 3],
    /// Its direction, unit length.
    pub ry_d: [f32; 3],
}

/// A bit of `has` in `realistic_ray_differential`: there is a ray one pixel to the right.
pub const REALISTIC_HAS_RX: u32 = 1;
/// A bit of `has` in `realistic_ray_differential`: there is a ray one pixel down.
pub const REALISTIC_HAS_RY: u32 = 2;

/// What became of a sample. The numbers are part of the ABI and never change.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(non_camel_case_types)]
pub enum realistic_reason {
    /// The ray passes the lens.
    Ok = 0,
    /// It misses a surface.
    Missed = 1,
    /// It meets a surface outside the clear aperture.
    Clipped = 2,
    /// It is totally reflected.
    Reflected = 3,
    /// The next surface lies behind it, or it travels backward.
    TurnedBack = 4,
    /// With `disk` "rejection": the lens sample fell outside the disk. Draw another; this one
    /// does not count.
    Redraw = 5,
    /// The shutter is closed over this film point at this time.
    Shut = 6,
    /// The wavelength is invalid: not a number from 380 to 780 nm, or one at which the formula of a glass gives no
    /// index of 1 or more.
    Wavelength = 7,
}

/// Numbers (`x`) or pairs (`x` and `y`) that are read, one per sample: number i lies `i * stride` bytes from the first. A stride
/// may be negative; it is 0, where all samples have the same, or at least 4 bytes. `x` is NULL where something is left out.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_input {
    /// The first element's x, or number.
    pub x: *const f32,
    /// The first element's y; not read where there is none.
    pub y: *const f32,
    /// Bytes from one element to the next.
    pub stride: isize,
}

/// Room for numbers (`x`) or vectors, one per ray, as `realistic_input`, but without a stride of 0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_output {
    /// The first element's x, or number.
    pub x: *mut f32,
    /// The first element's y; not read where there is none.
    pub y: *mut f32,
    /// The first element's z; not read where there is none.
    pub z: *mut f32,
    /// Bytes from one element to the next.
    pub stride: isize,
}

/// What is requested of samples. Start from zeros, which leave everything out. A batch reads all of it, and `image`, `lens`,
/// `origin`, `direction` and `weight` must be there. A call for one sample has these as its arguments and reads
/// `wavelength`, `wavelengths_per_sample`, `weight` and `reason` only.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_request {
    /// `sizeof(realistic_request)`.
    pub struct_size: u32,
    /// How many rays a sample has, each at a wavelength of its own: ray i * this + k is sample i's at wavelength number
    /// i * this + k. 0 counts as 1; 4 are traced side by side (A. Wilkie et al., "Hero Wavelength Spectral Sampling", 2014).
    pub wavelengths_per_sample: u32,
    /// Raster points (x, y), pixels.
    pub image: realistic_input,
    /// Lens samples (u, v), in [0, 1].
    pub lens: realistic_input,
    /// Time as a fraction of the shutter's interval; left out: 0.
    pub time: realistic_input,
    /// Wavelengths, nm, one per ray (`n` times `wavelengths_per_sample`, the same ones repeated where samples share them); left
    /// out: the camera's own. One that is not from 380 to 780, such as 0.55, is no error: its ray is 0, with
    /// `REALISTIC_REASON_WAVELENGTH`. Each glass has the index of its own
    /// formula there; film, stop, groups and what `weighting` divides by stay those of the camera's own wavelength. A lens
    /// without dispersion data, and every model but "lens", has the same rays at each. Rays at a wavelength are
    /// traced exactly, also with a `tolerance` or a named `refraction`.
    pub wavelength: realistic_input,
    /// Origins (x, y, z), world units.
    pub origin: realistic_output,
    /// Directions (x, y, z), unit length.
    pub direction: realistic_output,
    /// Weights; 0 for a blocked ray, of which nothing else is written but its reason.
    pub weight: realistic_output,
    /// Distances from the origin at which rays begin.
    pub mint: realistic_output,
    /// Distances from the origin at which rays end.
    pub maxt: realistic_output,
    /// Times between `shutteropen` and `shutterclose`.
    pub ray_time: realistic_output,
    /// What became of each ray: as many as there are weights.
    pub reason: *mut realistic_reason,
    /// Bytes from one reason to the next.
    pub reason_stride: isize,
    /// Differentials: origins of the rays one pixel to the right (image x + 1). The six that follow go together.
    pub rx_origin: realistic_output,
    /// Their directions.
    pub rx_direction: realistic_output,
    /// Their weights: 0 where the lens blocks the neighbour, whose place the ray's own origin and direction take.
    pub rx_weight: realistic_output,
    /// Origins of the rays one pixel down (image y + 1).
    pub ry_origin: realistic_output,
    /// Their directions.
    pub ry_direction: realistic_output,
    /// Their weights.
    pub ry_weight: realistic_output,
}

impl Default for realistic_request {
    /// Everything is left out.
    fn default() -> Self {
        let (input, output) = (realistic_input::NONE, realistic_output::NONE);
        Self {
            struct_size: size_of::<Self>() as u32,
            wavelengths_per_sample: 0,
            image: input,
            lens: input,
            time: input,
            wavelength: input,
            origin: output,
            direction: output,
            weight: output,
            mint: output,
            maxt: output,
            ray_time: output,
            reason: null_mut(),
            reason_stride: 0,
            rx_origin: output,
            rx_direction: output,
            rx_weight: output,
            ry_origin: output,
            ry_direction: output,
            ry_weight: output,
        }
    }
}

/// Receives a message while a camera or a lens is being built. `level`: 0 information, 1 warning (2, an error, is reserved:
/// errors are returned). `message` lives until the callback returns.
#[allow(non_camel_case_types)]
pub type realistic_log = Option<unsafe extern "C" fn(user: *mut c_void, level: i32, message: *const c_char)>;

/// The `level` of a [`realistic_log`].
pub(super) fn level_number(level: Level) -> i32 {
    match level {
        Level::Info => 0,
        Level::Warning => 1,
        // Of a pbrt-v1 host.
        Level::Error => 2,
    }
}

/// What a built camera is, for a host to print. `realistic_camera_get_info` fills it. A model without a lens
/// (`perspective`, `orthographic`, `environment`) has 0 interfaces and NaN for lengths and f-number.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_camera_info {
    /// `sizeof(realistic_camera_info)`.
    pub struct_size: u32,
    /// Interfaces of the lens, the stop included.
    pub interfaces: u32,
    /// Effective focal length, mm; infinite for an afocal lens.
    pub focal_length_mm: f64,
    /// Focal length over the diameter of the beam of exact rays from a distant point on the axis, at the stop in use; infinite
    /// for an afocal lens.
    pub fnumber: f64,
    /// Last vertex to film, mm.
    pub film_distance_mm: f64,
    /// Film plane to the plane in focus, mm along the axis; infinity when focused there or beyond, NaN
    /// when no object in front of the lens is in focus.
    pub focus_distance_mm: f64,
    /// Film diagonal, mm.
    pub film_diagonal_mm: f64,
    /// Pixels that the host is to render: columns from `crop[0]` to before `crop[2]`, rows from `crop[1]` to before
    /// `crop[3]`; the whole picture where no `crop` is given. Of every model.
    pub crop: [u32; 4],
}

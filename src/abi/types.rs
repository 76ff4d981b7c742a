//! The structures of the C ABI, defined by their layout.
//!
//! Lengths are in millimetres if a name or comment states so, and in world units otherwise; there are no
//! angles. Structures that may grow begin with `struct_size`, which the caller sets to the `sizeof` of the
//! structure with which it was compiled.

use std::{
    ffi::{c_char, c_void},
    ptr::null_mut,
};

use ::realistic_camera::Level;

/// A camera. Immutable and thread-safe once built.
// This type is not `repr(C)`, so that the header only declares it.
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
    /// Raster x in pixels: 0 at the left edge of the image, `xres` at the right edge.
    pub image_x: f32,
    /// Raster y in pixels: 0 at the top edge of the image, `yres` at the bottom edge.
    pub image_y: f32,
    /// u of the lens sample (u, v), in [0, 1].
    pub lens_u: f32,
    /// v of the lens sample (u, v), in [0, 1].
    pub lens_v: f32,
    /// Time as a fraction of the shutter's interval: 0 when the shutter opens, 1 when it closes. Time, u and
    /// v are clamped to [0, 1].
    pub time: f32,
}

/// One ray in world space: the 36 bytes of pbrt-v1's `Ray`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(non_camel_case_types)]
pub struct realistic_ray {
    /// Origin, world units; for `model` "lens", the point where the ray leaves the front surface.
    pub o: [f32; 3],
    /// Direction, unit length.
    pub d: [f32; 3],
    /// Distance from `o` at which the ray begins: `hither`, or 0 for `model` "perspective" and
    /// "orthographic", whose rays begin on the near plane.
    pub mint: f32,
    /// Distance from `o` at which the ray ends: `yon`, or the distance to the far plane for `model`
    /// "perspective" and "orthographic".
    pub maxt: f32,
    /// Time between `shutter_open` and `shutter_close`.
    pub time: f32,
}

/// A ray with its differentials: the ray of a sample, and the rays with the same lens and time sample one
/// pixel to the right (image x + 1) and one pixel down (image y + 1).
///
/// The bit `REALISTIC_HAS_RX` of `has` states that the lens passes the ray to the right, whether or not the
/// shutter is open at that pixel; `REALISTIC_HAS_RY` states the same of the ray below. If a bit is 0, the
/// lens blocks that neighbour, and the origin and direction of the ray itself replace the neighbour's: the
/// footprint then has zero width, and the numbers are safe to use.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(non_camel_case_types)]
pub struct realistic_ray_differential {
    /// `sizeof(realistic_ray_differential)` of the caller's header. The caller sets this member, and the
    /// library never writes it; in an array, only that of the first element is read.
    pub struct_size: u32,
    /// The neighbours that are present: `REALISTIC_HAS_RX`, `REALISTIC_HAS_RY`, both (3) or none (0).
    pub has: u32,
    /// The ray of the sample.
    pub ray: realistic_ray,
    /// Origin of the ray to the right, world units.
    pub rx_o: [f32; 3],
    /// Unit direction of the ray to the right.
    pub rx_d: [f32; 3],
    /// Origin of the ray below, world units.
    pub ry_o: [f32; 3],
    /// Unit direction of the ray below.
    pub ry_d: [f32; 3],
}

/// A bit of `has` in `realistic_ray_differential`: the ray one pixel to the right is present.
pub const REALISTIC_HAS_RX: u32 = 1;
/// A bit of `has` in `realistic_ray_differential`: the ray one pixel down is present.
pub const REALISTIC_HAS_RY: u32 = 2;

/// Result of a sample: either the sample has a ray, or the reason why it has none. The numbers are part of
/// the ABI and never change.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(non_camel_case_types)]
pub enum realistic_reason {
    /// The ray passes the lens.
    Ok = 0,
    /// The ray misses a surface.
    Missed = 1,
    /// The ray meets a surface outside the clear aperture.
    Clipped = 2,
    /// The ray is totally reflected.
    Reflected = 3,
    /// The next surface lies behind the ray, or the ray travels backward.
    TurnedBack = 4,
    /// The lens sample lies outside the disk; only with `disk` "rejection". Draw another lens sample; this
    /// one does not count.
    Redraw = 5,
    /// The shutter is closed over this film point at this time.
    Shut = 6,
    /// The wavelength is invalid: it is not a number from 380 to 780 nm, or the dispersion formula of a glass
    /// gives no refractive index of 1 or more at it.
    Wavelength = 7,
}

/// Input array of numbers (`x`), pairs (`x` and `y`) or vectors (`x`, `y` and `z`). Element i lies `i *
/// stride` bytes from the first element. The stride is 0 if all elements are the same one; otherwise its
/// magnitude is at least 4 bytes, and it may be negative. `x` is NULL if the input is omitted.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_input {
    /// Address of the first element's x, or of the first number.
    pub x: *const f32,
    /// Address of the first element's y; not read for numbers.
    pub y: *const f32,
    /// Address of the first element's z; read only for vectors.
    pub z: *const f32,
    /// Bytes from one element to the next.
    pub stride: isize,
}

/// Output array of numbers, pairs or vectors, with the layout of `realistic_input`; the stride must not be 0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_output {
    /// Address of the first element's x, or of the first number.
    pub x: *mut f32,
    /// Address of the first element's y; not read for numbers.
    pub y: *mut f32,
    /// Address of the first element's z; read only for vectors.
    pub z: *mut f32,
    /// Bytes from one element to the next.
    pub stride: isize,
}

/// Array of vectors in double precision that a call writes, after it has read them where its description says
/// so, with the layout of `realistic_output`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_vectors {
    /// Address of the first element's x.
    pub x: *mut f64,
    /// Address of the first element's y.
    pub y: *mut f64,
    /// Address of the first element's z.
    pub z: *mut f64,
    /// Bytes from one element to the next.
    pub stride: isize,
}

/// Request for the rays of samples. Initialise it with zeros, which omit every member. A batch reads all
/// members and requires `image`, `lens`, `origin`, `direction` and `weight`. A call for one sample takes the
/// sample and the ray as arguments and reads only `wavelength`, `wavelengths_per_sample`, `weight` and
/// `reason`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_request {
    /// `sizeof(realistic_request)`.
    pub struct_size: u32,
    /// Number w of rays per sample, each at its own wavelength: ray i · w + k belongs to sample i and has
    /// element i · w + k of `wavelength`. 0 means 1. 4 rays are traced side by side (A. Wilkie et al., "Hero
    /// Wavelength Spectral Sampling", 2014).
    pub wavelengths_per_sample: u32,
    /// Raster points (x, y), pixels.
    pub image: realistic_input,
    /// Lens samples (u, v), in [0, 1].
    pub lens: realistic_input,
    /// Time as a fraction of the shutter's interval; 0 if omitted.
    pub time: realistic_input,
    /// Wavelengths, nm, one per ray (`n` times `wavelengths_per_sample`; repeated if samples share
    /// wavelengths). If omitted, rays have the camera's own wavelength. A wavelength outside 380 to 780, such
    /// as 0.55, is not an error: its ray has weight 0 and `REALISTIC_REASON_WAVELENGTH`. The refractive index
    /// of each glass follows from its dispersion formula; film, stop, groups and the divisor of `weighting`
    /// stay those of the camera's own wavelength. A lens without dispersion data, and every model but "lens",
    /// has the same rays at every wavelength. A lens with dispersion data, and every lens with a `tolerance`,
    /// traces rays at a wavelength exactly, whatever the value of `refraction`.
    pub wavelength: realistic_input,
    /// Origins (x, y, z), world units.
    pub origin: realistic_output,
    /// Directions (x, y, z), unit length.
    pub direction: realistic_output,
    /// Weights; 0 for a blocked ray. For a blocked ray nothing else is written except the reason and the
    /// neighbours' weights, which are 0.
    pub weight: realistic_output,
    /// Distances from the origin at which rays begin.
    pub mint: realistic_output,
    /// Distances from the origin at which rays end.
    pub maxt: realistic_output,
    /// Times between `shutter_open` and `shutter_close`.
    pub ray_time: realistic_output,
    /// Result of each ray, one element per weight.
    pub reason: *mut realistic_reason,
    /// Bytes from one reason to the next.
    pub reason_stride: isize,
    /// Origins of the rays one pixel to the right (image x + 1), for differentials. The six members from
    /// `rx_origin` to `ry_weight` must be given together or omitted together.
    pub rx_origin: realistic_output,
    /// Directions of the rays one pixel to the right.
    pub rx_direction: realistic_output,
    /// Weights of the rays one pixel to the right; 0 if the lens blocks such a ray, whose origin and
    /// direction are then replaced by those of the sample's ray.
    pub rx_weight: realistic_output,
    /// Origins of the rays one pixel down (image y + 1).
    pub ry_origin: realistic_output,
    /// Directions of the rays one pixel down.
    pub ry_direction: realistic_output,
    /// Weights of the rays one pixel down, as in `rx_weight`.
    pub ry_weight: realistic_output,
}

impl Default for realistic_request {
    /// Returns a request that omits every member.
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

/// Receives a message while a camera or a lens is being built. `level` is 0 for information and 1 for a
/// warning; 2, for an error, is reserved, because errors are returned. `message` is valid until the callback
/// returns.
#[allow(non_camel_case_types)]
pub type realistic_log = Option<unsafe extern "C" fn(user: *mut c_void, level: i32, message: *const c_char)>;

/// Returns the `level` that a [`realistic_log`] receives.
pub(super) fn level_number(level: Level) -> i32 {
    match level {
        Level::Info => 0,
        Level::Warning => 1,
        // Only a pbrt-v1 host receives errors as messages.
        Level::Error => 2,
    }
}

/// Description of a built camera, for a host to print. `realistic_camera_get_info` fills this structure. A
/// model without a lens (`perspective`, `orthographic`, `environment`) has 0 interfaces, and NaN for the
/// lengths and the f-number.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_camera_info {
    /// `sizeof(realistic_camera_info)`.
    pub struct_size: u32,
    /// Number of interfaces (surfaces) of the lens, including the stop.
    pub interfaces: u32,
    /// Effective focal length, mm; infinite for an afocal lens.
    pub focal_length_mm: f64,
    /// Focal length divided by the diameter of the beam of exact rays from a distant point on the axis, at
    /// the stop in use; infinite for an afocal lens.
    pub fnumber: f64,
    /// Distance from the last vertex to the film, mm.
    pub film_distance: f64,
    /// Distance from the film plane to the plane in focus, mm along the axis; infinity if the lens is focused
    /// at infinity or beyond, NaN if no object in front of the lens is in focus.
    pub focus_distance_mm: f64,
    /// Film diagonal, mm.
    pub film_diagonal: f64,
    /// The pixels that the host is to render: columns from `crop[0]` up to but excluding `crop[2]`, rows from
    /// `crop[1]` up to but excluding `crop[3]`; the whole picture if no `crop` is given. Valid for every
    /// model.
    pub crop: [u32; 4],
}

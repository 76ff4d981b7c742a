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
    /// `sizeof(realistic_ray_differential)` of the caller's header. Set by the caller and never written; of a batch only
    /// the first element's is read.
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
    /// With `disk` "rejection": the lens sample fell outside the disk. Draw another; this one
    /// does not count.
    Redraw = 5,
    /// The shutter is closed over this film point at this time.
    Shut = 6,
    /// The wavelength that the sample is asked for at is none: not a number from 380 to 780 nm, or one at which the
    /// formula of a glass has no index of 1 or more.
    Wavelength = 7,
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

/// Numbers or vectors that are read, one per sample, with strides as NumPy's: component k of element i lies
/// `i * stride + k * component_stride` bytes from `first`. Strides may be negative, and 0, which gives every sample the
/// same element. Nothing needs to be aligned beyond a byte.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_input {
    /// The first element's first component.
    pub first: *const f32,
    /// Bytes from one element to the next.
    pub stride: isize,
    /// Bytes from one component of an element to the next; of no meaning where there is one.
    pub component_stride: isize,
}

/// Room for numbers or vectors that are written, one per sample, with strides as in `realistic_input`, but not 0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_output {
    /// The first element's first component.
    pub first: *mut f32,
    /// Bytes from one element to the next.
    pub stride: isize,
    /// Bytes from one component of an element to the next; of no meaning where there is one.
    pub component_stride: isize,
}

/// Samples and room for their rays as arrays of numbers and vectors of any strides. `first` is NULL where something is
/// left out; `image`, `lens`, `origin`, `direction` and `weight` must be there.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
#[allow(non_camel_case_types)]
pub struct realistic_batch {
    /// `sizeof(realistic_batch)` of the caller's header.
    pub struct_size: u32,
    /// Raster points (x, y), pixels.
    pub image: realistic_input,
    /// Lens samples (u, v), in [0, 1].
    pub lens: realistic_input,
    /// Time as a fraction of the shutter's interval; left out: 0.
    pub time: realistic_input,
    /// Wavelengths, nm, from 380 to 780; left out: the camera's own.
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
    /// What became of each sample.
    pub reason: *mut realistic_reason,
    /// Bytes from one reason to the next; not 0.
    pub reason_stride: isize,
    /// Origins of the rays one pixel to the right. The six arrays of neighbours go together.
    pub rx_origin: realistic_output,
    /// Their directions.
    pub rx_direction: realistic_output,
    /// Their weights, as in `realistic_camera_generate_ray_differentials_soa`.
    pub rx_weight: realistic_output,
    /// Origins of the rays one pixel down.
    pub ry_origin: realistic_output,
    /// Their directions.
    pub ry_direction: realistic_output,
    /// Their weights.
    pub ry_weight: realistic_output,
}

/// Receives a message while a camera is being built. `level`: 0 information, 1 warning; 2, an error, is reserved, for
/// errors are returned. `message` is UTF-8, ends in NUL, and lives until the callback returns. It must return: an
/// exception that leaves it ends the process (`realistic.hpp` catches what its callbacks throw).
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

/// What a camera is built from. Start from `realistic_options_init`, which sets every
/// field to "not given": NaN for numbers, NULL for strings, -1 for booleans.
/// A field that is a parameter (README, "Parameters") says what it is, its values or range, and its default.
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
    /// Parameter `simpleweighting`: pbrt-v3's name for `weighting`, true for "relative" and false for "radiometric".
    /// -1: not given; 0: false; 1: true.
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
    /// Parameter `model`: what the camera is a model of: "lens", "thick", "thin", "perspective", "orthographic" or
    /// "environment"; default "lens".
    pub model: *const c_char,
    /// Parameter `specfile`: lens file, or a catalogue name such as "wide.22mm" or "wide.22mm@35mm"; default
    /// "dgauss.50mm".
    pub specfile: *const c_char,
    /// Parameter `weighting`: how a ray's weight is measured: "radiometric", "assignment", "relative" or "none";
    /// default "radiometric". `assignment` divides `radiometric` by an area, and so its exposure depends on `pupil`:
    /// with `rear` the area of the rear element's disk, with `disk` and `warped` that of the paraxial exit pupil.
    pub weighting: *const c_char,
    /// Parameter `pupil`: where lens samples lie, in the true pupil of each film point, the rear element's disk, or
    /// the thick-lens exit pupil: "warped", "rear" or "disk"; default "warped".
    pub pupil: *const c_char,
    /// Parameter `disk`: how lens samples map to the disk: "concentric", "polar" or "rejection"; default
    /// "concentric".
    pub disk: *const c_char,
    /// Parameter `refraction`: method of refraction: "fused", "heckbert", "whitted" or "other"; default "fused".
    pub refraction: *const c_char,
    /// Parameter `precision`: what rays are traced in, double, single, or ("auto") double or what `tolerance` allows:
    /// "auto", "f64", "f32", "double" or "single"; default "auto".
    pub precision: *const c_char,
    /// Parameter `filmdistance`: from the last vertex to the film: positive, in mm; default the lens file's, or
    /// focused at `focusdistance`.
    pub filmdistance: f64,
    /// Parameter `focusdistance`: from the film plane to the plane in focus, or inf, instead of `filmdistance`:
    /// positive, in world units; default infinity.
    pub focusdistance: f64,
    /// Parameter `aperture_diameter`: clear diameter of the stop: positive, in mm; default the file's.
    pub aperture_diameter: f64,
    /// Parameter `fnumber`: focal length over entrance pupil diameter, instead of `aperture_diameter`: positive.
    pub fnumber: f64,
    /// Parameter `filmdiag`: diagonal of the film: positive, in mm; default 35.
    pub filmdiag: f64,
    /// Parameter `hither`: where a ray begins, along it: 0 or more and finite, in world units; default 1e-3.
    pub hither: f64,
    /// Parameter `yon`: where a ray ends, along it, from `hither` on: 0 or more, in world units; default 1e30.
    pub yon: f64,
    /// Parameter `shutteropen`: time at which the shutter opens: a finite number; default 0.
    pub shutteropen: f64,
    /// Parameter `shutterclose`: time at which the shutter closes; before `shutteropen`, time runs backward, as in
    /// pbrt: a finite number; default 1.
    pub shutterclose: f64,
    /// Parameter `wavelength`: wavelength, for lenses with V-numbers or Sellmeier's constants: from 300 to 2000 nm;
    /// default 587.56.
    pub wavelength: f64,
    /// Parameter `mmperunit`: length of a world unit: positive, from 1e-15 to 1e30 mm per world unit; default 1.
    pub mmperunit: f64,
    /// For a camera that moves: `camera_to_world` holds at `transformstart` and this one at `transformend`, and
    /// between the two a move, a rotation and a stretch are interpolated. All NaN: the camera stands still.
    pub camera_to_world_end: [f32; 16],
    /// The time of `camera_to_world`. NaN: `shutteropen`.
    pub transformstart: f64,
    /// The time of `camera_to_world_end`. NaN: `shutterclose`.
    pub transformend: f64,
    /// Parameter `shutter`: what the shutter lets through, by film point and time: "global", "leaf" or "focal-plane";
    /// default "global".
    pub shutter: *const c_char,
    /// Parameter `lensplane`: where that thin lens lies, as in pbrt 1.05, or as in older versions and on the
    /// lecture's slide: "eye" or "hither"; default "eye".
    pub lensplane: *const c_char,
    /// Parameter `shutterramp`: share of the shutter's interval in which a leaf shutter opens, and closes: more than
    /// 0 and at most 0.5 of the interval; default 0.25.
    pub shutterramp: f64,
    /// Parameter `shutterslit`: share of the shutter's interval for which a focal-plane shutter exposes each row:
    /// more than 0 and at most 1 of the interval; default 0.25.
    pub shutterslit: f64,
    /// Parameter `fov`: angle across the shorter side of the image: from 0.0001 to less than 180 degrees; default 90.
    pub fov: f64,
    /// Parameter `screenwindow`: x from, x to, y from, y to of the part of the screen that becomes the image: from
    /// -1e15 to 1e15; default by the aspect ratio. All NaN: not given.
    pub screenwindow: [f64; 4],
    /// Parameter `frameaspectratio`: width over height of the screen window: positive, from 1e-15 to 1e15; default
    /// the image's.
    pub frameaspectratio: f64,
    /// Parameter `lensradius`: radius of the projection's thin lens: 0 (a pinhole) or more, up to 1e15 world units;
    /// default 0.
    pub lensradius: f64,
    /// Parameter `focaldistance`: from the eye to the plane of focus of a lens of `lensradius`, more than `hither`: a
    /// number, in world units; default 1e30.
    pub focaldistance: f64,
    /// Parameter `tolerance`: by how much 99.9 % of the rays may be off, for a faster model of the lens: 0 (exact) or
    /// more and finite, in pixels; default 0.
    pub tolerance: f64,
    /// Parameter `focusby`: what moves to focus, the film, or the lens's own groups with the film where the lens file
    /// has it: "film" or "group"; default "film".
    pub focusby: *const c_char,
    /// Parameter `zoom`: focal length of a zoom lens, a number of mm, or the name of one of its positions; without it
    /// the lens file's first.
    pub zoom: *const c_char,
    /// Parameter `blades`: how many blades the stop has, 3 or more, whose corners lie on the circle of its clear
    /// diameter: 0 (a round stop) or more, up to 32; default the lens file's, or 0.
    pub blades: f64,
    /// Parameter `bladerotation`: where the first corner of the blades lies, from image right toward image up: a finite
    /// number, in degrees; default the lens file's, or 0.
    pub bladerotation: f64,
    /// Parameter `bladecurvature`: curvature of the blades' edges over that of the circle: 0 is straight, 1 the circle:
    /// 0 or more, up to 1; default the lens file's, or 0.
    pub bladecurvature: f64,
    /// Parameter `glasscatalog`: glass catalogue (AGF) in which glasses that a lens file names are looked up first, before
    /// catalogues beside the file and the built-in glasses.
    pub glasscatalog: *const c_char,
    /// Parameter `crop`: x from, y from, x to, y to of the part of the picture that the host renders, which changes no
    /// ray: 0 or more and finite, in pixels; default the whole picture. Whole numbers inside the picture, `x to` and `y to`
    /// one past the last pixel; `realistic_camera_get_info` tells them back. `xres`, `yres` and samples are those of the
    /// whole picture, so that tiles fit together to the bit. All NaN: not given.
    pub crop: [f64; 4],
}

/// What a built camera is, for a host to print. `realistic_camera_get_info` fills it. A model without a lens
/// (`perspective`, `orthographic`, `environment`) has 0 interfaces and NaN for lengths and f-number.
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
    /// Pixels that the host is to render: columns from `crop[0]` to before `crop[2]`, rows from `crop[1]` to before
    /// `crop[3]`; the whole picture where no `crop` is given. Of every model.
    pub crop: [u32; 4],
}

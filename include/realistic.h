/* realistic: a real camera for renderers. MIT OR Apache-2.0.
 *
 * Made by cbindgen from src/abi; `REALISTIC_WRITE_HEADER=1 cargo test --test abi header` makes it again.
 *
 * Conventions. Functions that can fail return a realistic_status, 0 for success; the text is then got
 * from realistic_last_error() on the same thread. Outputs are written last and stay untouched on
 * failure. Handles come from a _new function and go to the matching _free, which takes NULL. A
 * camera is immutable: any number of threads may ask it for rays. Strings are UTF-8 and end in NUL.
 * No call panics or throws across this boundary. None prints, but for CreateCamera in a process without pbrt's
 * Error function, which says on standard error why it fails, and a defect of the library, which Rust reports there.
 *
 * Floating point. Calls compute in the default environment (to nearest, no trap, subnormal numbers kept) whatever
 * the caller's is, so that rays are the same to the bit, and leave the caller's control word as it is. Building, batches and
 * autofocus restore its flags; a single ray may raise inexact and underflow and no other. Callbacks are
 * called in the default environment. (x86-64 and AArch64; elsewhere calls compute in the caller's.) */

#ifndef REALISTIC_H
#define REALISTIC_H

#include <stddef.h>
#include <stdint.h>

/*
 A bit of `has` in `realistic_ray_differential`: there is a ray one pixel to the right.
 */
#define REALISTIC_HAS_RX 1

/*
 A bit of `has` in `realistic_ray_differential`: there is a ray one pixel down.
 */
#define REALISTIC_HAS_RY 2

/*
 The version of the C ABI that this header describes. It grows when something is added;
 nothing is ever taken away or renumbered. Version 2 states what version 1 had come to: the fields of
 `realistic_options` from `camera_to_world_end` on, `realistic_autofocus` and `realistic_camera_plan`; and it
 adds rays with differentials. Version 3 adds lenses without a film (`realistic_lens_new`),
 and `focusby` and `zoom`. Version 4 adds rays at a wavelength per sample (`realistic_generate_ray_at`), with
 differentials too (`realistic_generate_ray_differential_at`), batches of any strides (`realistic_camera_generate_batch`), `crop`, the figure of a surface (`realistic_lens_get_surface`), the points
 where rays meet the surfaces (`realistic_lens_trace_points`), and importance (`realistic_camera_importance`).
 */
#define REALISTIC_ABI_VERSION 4

/*
 The library can be loaded by a pbrt-v1 host (`CreateCamera` is there).
 */
#define REALISTIC_CAPABILITY_PBRT_V1 1

/*
 Rays can be asked for many at a time.
 */
#define REALISTIC_CAPABILITY_BATCH 2

/*
 Batches tell why a ray is blocked.
 */
#define REALISTIC_CAPABILITY_REASONS 4

/*
 The wavelength matters for lenses with V-numbers or Sellmeier's constants.
 */
#define REALISTIC_CAPABILITY_DISPERSION 8

/*
 `model` may be "thick", "thin", "perspective", "orthographic" and "environment".
 */
#define REALISTIC_CAPABILITY_MODELS 16

/*
 The camera may move (`camera_to_world_end`), and the shutter be other than global.
 */
#define REALISTIC_CAPABILITY_MOTION 32

/*
 `realistic_autofocus` is there.
 */
#define REALISTIC_CAPABILITY_AUTOFOCUS 64

/*
 `tolerance` and `realistic_camera_plan` are there.
 */
#define REALISTIC_CAPABILITY_PLAN 128

/*
 Rays can be asked for with their differentials (`realistic_generate_ray_differential`).
 */
#define REALISTIC_CAPABILITY_DIFFERENTIALS 256

/*
 A lens can be opened without a film, and asked what it is (`realistic_lens_new`).
 */
#define REALISTIC_CAPABILITY_LENS 512

/*
 `zoom` and `focusby` are there, for lenses whose groups move.
 */
#define REALISTIC_CAPABILITY_MOVING_GROUPS 1024

/*
 Rays can be asked for at a wavelength per sample (`realistic_generate_ray_at`).
 */
#define REALISTIC_CAPABILITY_WAVELENGTHS 2048

/*
 Cameras can be asked what rays from the scene count, and for directions toward the lens
 (`realistic_camera_importance`, `realistic_camera_sample_importance`).
 */
#define REALISTIC_CAPABILITY_IMPORTANCE 4096

/*
 `crop` is there, and `realistic_camera_get_info` tells the pixels to render.
 */
#define REALISTIC_CAPABILITY_CROP 8192

/*
 How a call of the C ABI ended. The numbers are part of the ABI and never change.
 */
enum realistic_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     It worked.
     */
    REALISTIC_STATUS_OK = 0,
    /*
     A pointer that must not be NULL is NULL; where it is the camera's, see `REALISTIC_STATUS_NOT_A_CAMERA`.
     */
    REALISTIC_STATUS_NULL_POINTER = 1,
    /*
     A `struct_size` is none that this library knows.
     */
    REALISTIC_STATUS_STRUCT_SIZE = 2,
    /*
     A parameter is unknown, of the wrong kind, out of range or given twice.
     */
    REALISTIC_STATUS_INVALID_PARAMETER = 3,
    /*
     The lens description is missing or cannot be read.
     */
    REALISTIC_STATUS_LENS_FILE = 4,
    /*
     The lens cannot be focused at the distance asked for.
     */
    REALISTIC_STATUS_UNREACHABLE_FOCUS = 5,
    /*
     Reserved, and not returned by this version: a file other than the lens description cannot be read or written.
     */
    REALISTIC_STATUS_IO = 6,
    /*
     A defect of this library: a panic was caught.
     */
    REALISTIC_STATUS_PANIC = 7,
    /*
     The pointer is NULL, or to no camera of this library.
     */
    REALISTIC_STATUS_NOT_A_CAMERA = 8,
    /*
     Memory is out: there are no 8 MiB for a camera or a lens to be built, or not what a caller's number asks for
     (the zones of an autofocus). Where other threads take the last of it meanwhile, or a message has no room, the
     process ends, as with most of Rust.
     */
    REALISTIC_STATUS_OUT_OF_MEMORY = 9,
    /*
     Reserved, and not returned by this version: the process lacks what the call needs. (`CreateCamera` returns NULL
     where a host's functions are missing, and `realistic.hpp` throws this for a library older than itself.)
     */
    REALISTIC_STATUS_UNSUPPORTED = 10,
    /*
     The pointer is NULL, or to no lens of this library.
     */
    REALISTIC_STATUS_NOT_A_LENS = 11,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum realistic_status realistic_status;
#else
typedef int32_t realistic_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 What became of a sample. The numbers are part of the ABI and never change.
 */
enum realistic_reason
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     The ray gets through.
     */
    REALISTIC_REASON_OK = 0,
    /*
     It passes beside a surface's sphere.
     */
    REALISTIC_REASON_MISSED = 1,
    /*
     It meets a surface outside the clear aperture.
     */
    REALISTIC_REASON_CLIPPED = 2,
    /*
     It is totally reflected.
     */
    REALISTIC_REASON_REFLECTED = 3,
    /*
     The next surface lies behind it, or it travels backward.
     */
    REALISTIC_REASON_TURNED_BACK = 4,
    /*
     With `disk` "rejection": the lens sample fell outside the disk. Draw another; this one
     does not count.
     */
    REALISTIC_REASON_REDRAW = 5,
    /*
     The shutter is closed over this film point at this time.
     */
    REALISTIC_REASON_SHUT = 6,
    /*
     The wavelength that the sample is asked for at is none: not a number from 380 to 780 nm, or one at which the
     formula of a glass has no index of 1 or more.
     */
    REALISTIC_REASON_WAVELENGTH = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum realistic_reason realistic_reason;
#else
typedef int32_t realistic_reason;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 How several zones make one film distance. The numbers are part of the ABI and never change.
 */
enum realistic_autofocus_rule
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     The zone that sees the nearest thing.
     */
    REALISTIC_AUTOFOCUS_RULE_NEAREST = 0,
    /*
     The zone nearest the middle of the picture among those that have an answer.
     */
    REALISTIC_AUTOFOCUS_RULE_CENTRE = 1,
    /*
     The mean of the zones' film distances.
     */
    REALISTIC_AUTOFOCUS_RULE_AVERAGE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum realistic_autofocus_rule realistic_autofocus_rule;
#else
typedef int32_t realistic_autofocus_rule;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 The side of a lens that rays come from. The numbers are part of the ABI and never change.
 */
enum realistic_side
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    /*
     From behind the lens; rays travel toward +z.
     */
    REALISTIC_SIDE_FILM = 0,
    /*
     From in front of it; rays travel toward -z.
     */
    REALISTIC_SIDE_SCENE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum realistic_side realistic_side;
#else
typedef int32_t realistic_side;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 A camera. Opaque to C. Immutable once built: rays may be asked for from any number of threads.
 */
typedef struct realistic_camera realistic_camera;

/*
 A lens at one wavelength and stop. Opaque to C. Immutable once built: any number of threads may use it.
 */
typedef struct realistic_lens realistic_lens;

/*
 Receives a message while a camera is being built. `level`: 0 information, 1 warning; 2, an error, is reserved, for
 errors are returned. `message` is UTF-8, ends in NUL, and lives until the callback returns. It must return: an
 exception that leaves it ends the process (`realistic.hpp` catches what its callbacks throw).
 */
typedef void (*realistic_log)(void *user, int32_t level, const char *message);

/*
 What a camera is built from. Start from `realistic_options_init`, which sets every
 field to "not given": NaN for numbers, NULL for strings, -1 for booleans.
 A field that is a parameter (README, "Parameters") says what it is, its values or range, and its default.
 */
typedef struct realistic_options {
    /*
     `sizeof(realistic_options)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     Image width in pixels, 1 or more. No default.
     */
    int32_t xres;
    /*
     Image height in pixels, 1 or more. No default.
     */
    int32_t yres;
    /*
     Parameter `simpleweighting`: pbrt-v3's name for `weighting`, true for "relative" and false for "radiometric".
     -1: not given; 0: false; 1: true.
     */
    int32_t simpleweighting;
    /*
     Row-major 4x4 matrix for column vectors that takes camera space (world units, +z forward,
     +x right, +y up) to world space. `realistic_options_init` sets the identity.
     */
    float camera_to_world[16];
    /*
     Receives messages; NULL for none.
     */
    realistic_log log;
    /*
     Handed to `log` as it is.
     */
    void *log_user;
    /*
     The text of a lens file, `lens_text_size` bytes, read instead of `specfile`; NULL for none.
     */
    const char *lens_text;
    /*
     Bytes at `lens_text`; at most 1,048,576 (1 MiB), as of any lens file.
     */
    size_t lens_text_size;
    /*
     Parameter `model`: what the camera is a model of: "lens", "thick", "thin", "perspective", "orthographic" or
     "environment"; default "lens".
     */
    const char *model;
    /*
     Parameter `specfile`: lens file, or a catalogue name such as "wide.22mm" or "wide.22mm@35mm"; default
     "dgauss.50mm".
     */
    const char *specfile;
    /*
     Parameter `weighting`: how a ray's weight is measured: "radiometric", "assignment", "relative" or "none";
     default "radiometric". `assignment` divides `radiometric` by an area, and so its exposure depends on `pupil`:
     with `rear` the area of the rear element's disk, with `disk` and `warped` that of the paraxial exit pupil.
     */
    const char *weighting;
    /*
     Parameter `pupil`: where lens samples lie, in the true pupil of each film point, the rear element's disk, or
     the thick-lens exit pupil: "warped", "rear" or "disk"; default "warped".
     */
    const char *pupil;
    /*
     Parameter `disk`: how lens samples map to the disk: "concentric", "polar" or "rejection"; default
     "concentric".
     */
    const char *disk;
    /*
     Parameter `refraction`: method of refraction: "fused", "heckbert", "whitted" or "other"; default "fused".
     */
    const char *refraction;
    /*
     Parameter `precision`: what rays are traced in, double, single, or ("auto") double or what `tolerance` allows:
     "auto", "f64", "f32", "double" or "single"; default "auto".
     */
    const char *precision;
    /*
     Parameter `filmdistance`: from the last vertex to the film: positive, in mm; default the lens file's, or
     focused at `focusdistance`.
     */
    double filmdistance;
    /*
     Parameter `focusdistance`: from the film plane to the plane in focus, or inf, instead of `filmdistance`:
     positive, in world units; default infinity.
     */
    double focusdistance;
    /*
     Parameter `aperture_diameter`: clear diameter of the stop: positive, in mm; default the file's.
     */
    double aperture_diameter;
    /*
     Parameter `fnumber`: focal length over entrance pupil diameter, instead of `aperture_diameter`: positive.
     */
    double fnumber;
    /*
     Parameter `filmdiag`: diagonal of the film: positive, in mm; default 35.
     */
    double filmdiag;
    /*
     Parameter `hither`: where a ray begins, along it: 0 or more and finite, in world units; default 1e-3.
     */
    double hither;
    /*
     Parameter `yon`: where a ray ends, along it, from `hither` on: 0 or more, in world units; default 1e30.
     */
    double yon;
    /*
     Parameter `shutteropen`: time at which the shutter opens: a finite number; default 0.
     */
    double shutteropen;
    /*
     Parameter `shutterclose`: time at which the shutter closes; before `shutteropen`, time runs backward, as in
     pbrt: a finite number; default 1.
     */
    double shutterclose;
    /*
     Parameter `wavelength`: wavelength, for lenses with V-numbers or Sellmeier's constants: from 300 to 2000 nm;
     default 587.56.
     */
    double wavelength;
    /*
     Parameter `mmperunit`: length of a world unit: positive, from 1e-15 to 1e30 mm per world unit; default 1.
     */
    double mmperunit;
    /*
     For a camera that moves: `camera_to_world` holds at `transformstart` and this one at `transformend`, and
     between the two a move, a rotation and a stretch are interpolated. All NaN: the camera stands still.
     */
    float camera_to_world_end[16];
    /*
     The time of `camera_to_world`. NaN: `shutteropen`.
     */
    double transformstart;
    /*
     The time of `camera_to_world_end`. NaN: `shutterclose`.
     */
    double transformend;
    /*
     Parameter `shutter`: what the shutter lets through, by film point and time: "global", "leaf" or "focal-plane";
     default "global".
     */
    const char *shutter;
    /*
     Parameter `lensplane`: where that thin lens lies, as in pbrt 1.05, or as in older versions and on the
     lecture's slide: "eye" or "hither"; default "eye".
     */
    const char *lensplane;
    /*
     Parameter `shutterramp`: share of the shutter's interval in which a leaf shutter opens, and closes: more than
     0 and at most 0.5 of the interval; default 0.25.
     */
    double shutterramp;
    /*
     Parameter `shutterslit`: share of the shutter's interval for which a focal-plane shutter exposes each row:
     more than 0 and at most 1 of the interval; default 0.25.
     */
    double shutterslit;
    /*
     Parameter `fov`: angle across the shorter side of the image: from 0.0001 to less than 180 degrees; default 90.
     */
    double fov;
    /*
     Parameter `screenwindow`: x from, x to, y from, y to of the part of the screen that becomes the image: from
     -1e15 to 1e15; default by the aspect ratio. All NaN: not given.
     */
    double screenwindow[4];
    /*
     Parameter `frameaspectratio`: width over height of the screen window: positive, from 1e-15 to 1e15; default
     the image's.
     */
    double frameaspectratio;
    /*
     Parameter `lensradius`: radius of the projection's thin lens: 0 (a pinhole) or more, up to 1e15 world units;
     default 0.
     */
    double lensradius;
    /*
     Parameter `focaldistance`: from the eye to the plane of focus of a lens of `lensradius`, more than `hither`: a
     number, in world units; default 1e30.
     */
    double focaldistance;
    /*
     Parameter `tolerance`: by how much 99.9 % of the rays may be off, for a faster model of the lens: 0 (exact) or
     more and finite, in pixels; default 0.
     */
    double tolerance;
    /*
     Parameter `focusby`: what moves to focus, the film, or the lens's own groups with the film where the lens file
     has it: "film" or "group"; default "film".
     */
    const char *focusby;
    /*
     Parameter `zoom`: focal length of a zoom lens, a number of mm, or the name of one of its positions; without it
     the lens file's first.
     */
    const char *zoom;
    /*
     Parameter `blades`: how many blades the stop has, 3 or more, whose corners lie on the circle of its clear
     diameter: 0 (a round stop) or more, up to 32; default the lens file's, or 0.
     */
    double blades;
    /*
     Parameter `bladerotation`: where the first corner of the blades lies, from image right toward image up: a finite
     number, in degrees; default the lens file's, or 0.
     */
    double bladerotation;
    /*
     Parameter `bladecurvature`: curvature of the blades' edges over that of the circle: 0 is straight, 1 the circle:
     0 or more, up to 1; default the lens file's, or 0.
     */
    double bladecurvature;
    /*
     Parameter `glasscatalog`: glass catalogue (AGF) in which glasses that a lens file names are looked up first, before
     catalogues beside the file and the built-in glasses.
     */
    const char *glasscatalog;
    /*
     Parameter `crop`: x from, y from, x to, y to of the part of the picture that the host renders, which changes no
     ray: 0 or more and finite, in pixels; default the whole picture. Whole numbers inside the picture, `x to` and `y to`
     one past the last pixel; `realistic_camera_get_info` tells them back. `xres`, `yres` and samples are those of the
     whole picture, so that tiles fit together to the bit. All NaN: not given.
     */
    double crop[4];
} realistic_options;

/*
 What a built camera is, for a host to print. `realistic_camera_get_info` fills it. A model without a lens
 (`perspective`, `orthographic`, `environment`) has 0 interfaces and NaN for lengths and f-number.
 */
typedef struct realistic_camera_info {
    /*
     `sizeof(realistic_camera_info)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     Interfaces of the lens, the stop included.
     */
    uint32_t interfaces;
    /*
     Effective focal length, mm; infinite for an afocal lens.
     */
    double focal_length_mm;
    /*
     Focal length over entrance pupil diameter at the stop in use; infinite for an afocal lens.
     */
    double fnumber;
    /*
     Last vertex to film, mm.
     */
    double film_distance_mm;
    /*
     Film plane to the plane in focus, mm along the axis; infinity when focused there or beyond, NaN
     when no object in front of the lens is in focus.
     */
    double focus_distance_mm;
    /*
     Film diagonal, mm.
     */
    double film_diagonal_mm;
    /*
     Pixels that the host is to render: columns from `crop[0]` to before `crop[2]`, rows from `crop[1]` to before
     `crop[3]`; the whole picture where no `crop` is given. Of every model.
     */
    uint32_t crop[4];
} realistic_camera_info;

/*
 One camera sample: the first 20 bytes of pbrt-v1's `Sample`.
 */
typedef struct realistic_sample {
    /*
     Raster x in pixels: 0 is the left edge of the image, `xres` the right one.
     */
    float image_x;
    /*
     Raster y in pixels: 0 is the top edge of the image, `yres` the bottom one.
     */
    float image_y;
    /*
     u of the lens sample (u, v), in [0, 1].
     */
    float lens_u;
    /*
     v of the lens sample (u, v), in [0, 1].
     */
    float lens_v;
    /*
     Time as a fraction of the shutter's interval: 0 is its opening, 1 its closing. Outside [0, 1], as of u and v,
     the nearest number inside is taken.
     */
    float time;
} realistic_sample;

/*
 One ray in world space: the 36 bytes of pbrt-v1's `Ray`.
 */
typedef struct realistic_ray {
    /*
     Origin, world units: for `model` "lens" the point where the ray leaves the front interface.
     */
    float o[3];
    /*
     Direction, unit length.
     */
    float d[3];
    /*
     Distance from `o` at which the ray begins: `hither`; 0 for the two projections, whose rays begin on the
     near plane.
     */
    float mint;
    /*
     Distance from `o` at which the ray ends: `yon`; for the two projections as far as their far plane.
     */
    float maxt;
    /*
     Time between `shutteropen` and `shutterclose`.
     */
    float time;
} realistic_ray;

/*
 A ray with its differentials: beside the ray of a sample those of the same lens and time sample one pixel to the right
 (image x + 1) and one pixel down (image y + 1).

 Bit `REALISTIC_HAS_RX` of `has` says that the lens lets the ray to the right through, whether the shutter is open
 there or not, and `REALISTIC_HAS_RY` the one below. Where a bit is 0 that neighbour is blocked, and the ray's own
 origin and direction stand in its place: a footprint of no width, with numbers that are safe to use.
 */
typedef struct realistic_ray_differential {
    /*
     `sizeof(realistic_ray_differential)` of the caller's header. Set by the caller and never written; of a batch only
     the first element's is read.
     */
    uint32_t struct_size;
    /*
     Which neighbours there are: `REALISTIC_HAS_RX`, `REALISTIC_HAS_RY`, both (3) or none (0).
     */
    uint32_t has;
    /*
     The ray.
     */
    struct realistic_ray ray;
    /*
     Origin of the ray to the right, world units.
     */
    float rx_o[3];
    /*
     Its direction, unit length.
     */
    float rx_d[3];
    /*
     Origin of the ray below, world units.
     */
    float ry_o[3];
    /*
     Its direction, unit length.
     */
    float ry_d[3];
} realistic_ray_differential;

/*
 Samples as structure of arrays; the members of `realistic_sample`.
 */
typedef struct realistic_samples_soa {
    const float *image_x;
    const float *image_y;
    const float *lens_u;
    const float *lens_v;
    const float *time;
} realistic_samples_soa;

/*
 Rays as structure of arrays; the members of `realistic_ray`, with weight and reason.
 */
typedef struct realistic_rays_soa {
    float *ox;
    float *oy;
    float *oz;
    float *dx;
    float *dy;
    float *dz;
    float *mint;
    float *maxt;
    float *time;
    float *weight;
    realistic_reason *reason;
} realistic_rays_soa;

/*
 Numbers or vectors that are read, one per sample, with strides as NumPy's: component k of element i lies
 `i * stride + k * component_stride` bytes from `first`. Strides may be negative, and 0, which gives every sample the
 same element. Nothing needs to be aligned beyond a byte.
 */
typedef struct realistic_input {
    /*
     The first element's first component.
     */
    const float *first;
    /*
     Bytes from one element to the next.
     */
    ptrdiff_t stride;
    /*
     Bytes from one component of an element to the next; of no meaning where there is one.
     */
    ptrdiff_t component_stride;
} realistic_input;

/*
 Room for numbers or vectors that are written, one per sample, with strides as in `realistic_input`, but not 0.
 */
typedef struct realistic_output {
    /*
     The first element's first component.
     */
    float *first;
    /*
     Bytes from one element to the next.
     */
    ptrdiff_t stride;
    /*
     Bytes from one component of an element to the next; of no meaning where there is one.
     */
    ptrdiff_t component_stride;
} realistic_output;

/*
 Samples and room for their rays as arrays of numbers and vectors of any strides. `first` is NULL where something is
 left out; `image`, `lens`, `origin`, `direction` and `weight` must be there.
 */
typedef struct realistic_batch {
    /*
     `sizeof(realistic_batch)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     Raster points (x, y), pixels.
     */
    struct realistic_input image;
    /*
     Lens samples (u, v), in [0, 1].
     */
    struct realistic_input lens;
    /*
     Time as a fraction of the shutter's interval; left out: 0.
     */
    struct realistic_input time;
    /*
     Wavelengths, nm, from 380 to 780; left out: the camera's own.
     */
    struct realistic_input wavelength;
    /*
     Origins (x, y, z), world units.
     */
    struct realistic_output origin;
    /*
     Directions (x, y, z), unit length.
     */
    struct realistic_output direction;
    /*
     Weights; 0 for a blocked ray, of which nothing else is written but its reason.
     */
    struct realistic_output weight;
    /*
     Distances from the origin at which rays begin.
     */
    struct realistic_output mint;
    /*
     Distances from the origin at which rays end.
     */
    struct realistic_output maxt;
    /*
     Times between `shutteropen` and `shutterclose`.
     */
    struct realistic_output ray_time;
    /*
     What became of each sample.
     */
    realistic_reason *reason;
    /*
     Bytes from one reason to the next; not 0.
     */
    ptrdiff_t reason_stride;
    /*
     Origins of the rays one pixel to the right. The six arrays of neighbours go together.
     */
    struct realistic_output rx_origin;
    /*
     Their directions.
     */
    struct realistic_output rx_direction;
    /*
     Their weights, as in `realistic_camera_generate_ray_differentials_soa`.
     */
    struct realistic_output rx_weight;
    /*
     Origins of the rays one pixel down.
     */
    struct realistic_output ry_origin;
    /*
     Their directions.
     */
    struct realistic_output ry_direction;
    /*
     Their weights.
     */
    struct realistic_output ry_weight;
} realistic_batch;

/*
 Rays of world space that enter a camera, as structure of arrays, one number per ray in each.
 */
typedef struct realistic_importance_rays {
    /*
     `sizeof(realistic_importance_rays)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     x of a point on each ray, before the lens or on its front: where the camera's own rays begin will do.
     */
    const float *ox;
    /*
     y.
     */
    const float *oy;
    /*
     z.
     */
    const float *oz;
    /*
     x of each direction, of any length but 0, toward the camera.
     */
    const float *dx;
    /*
     y.
     */
    const float *dy;
    /*
     z.
     */
    const float *dz;
    /*
     When each arrives, in the unit of `shutteropen`; may be NULL for the middle of the shutter's interval.
     */
    const float *time;
} realistic_importance_rays;

/*
 Importance as structure of arrays, one number per ray in each; all 0 where a ray counts nothing. Each array but
 `importance` may be NULL.
 */
typedef struct realistic_importance {
    /*
     `sizeof(realistic_importance)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     Raster x, pixels, where the ray reaches the film.
     */
    float *image_x;
    /*
     Raster y.
     */
    float *image_y;
    /*
     We (E. Veach 1997; PBRT's `We`): what radiance times cosθ dA dω is multiplied by, dA being area in square world units
     on the plane z = 0 of camera space and θ the angle to its normal. With `weighting` "radiometric" it is 1 over the
     film's area in square world units, times what the shutter lets through.
     */
    float *importance;
    /*
     Density of the camera's own rays there, per cosθ dA dω, where samples are spread evenly over the picture, the lens and
     time: `importance` is this times the weight of the same ray.
     */
    float *density;
    /*
     A density per area on that plane, 1 over the area of the front clear aperture (of the lens of a stock camera), and
     */
    float *area_density;
    /*
     one per solid angle that goes with it: their product is `density` times cosθ.
     */
    float *solid_angle_density;
} realistic_importance;

/*
 Points of the scene that ask for directions toward the lens, as structure of arrays, one number per point in each.
 */
typedef struct realistic_scene_points {
    /*
     `sizeof(realistic_scene_points)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     x of each point, world space.
     */
    const float *x;
    /*
     y.
     */
    const float *y;
    /*
     z.
     */
    const float *z;
    /*
     Where in the pupil as the point sees it: two numbers in [0, 1], of which this is the first,
     */
    const float *u;
    /*
     and this the second.
     */
    const float *v;
    /*
     When, in the unit of `shutteropen`; may be NULL for the middle of the shutter's interval.
     */
    const float *time;
} realistic_scene_points;

/*
 Directions toward the lens, as structure of arrays, one number per point in each. `ox`, `oy` and `oz` may be NULL.
 */
typedef struct realistic_aimed {
    /*
     `sizeof(realistic_aimed)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     x of where the ray meets the front of the lens: what lies between the point and this hides the light.
     */
    float *ox;
    /*
     y.
     */
    float *oy;
    /*
     z.
     */
    float *oz;
    /*
     x of the unit vector from the point toward there.
     */
    float *dx;
    /*
     y.
     */
    float *dy;
    /*
     z.
     */
    float *dz;
    /*
     Density of the direction per solid angle at the point; 0, and all other numbers, too, where there is no direction
     from which light could reach the film.
     */
    float *density;
} realistic_aimed;

/*
 A rectangle of the picture in pixels; (0, 0) is the picture's top left corner.
 */
typedef struct realistic_zone {
    /*
     Left edge, 0 or more.
     */
    float left;
    /*
     Top edge, 0 or more.
     */
    float top;
    /*
     Right edge, beyond `left` and at most `xres`.
     */
    float right;
    /*
     Bottom edge, below `top` and at most `yres`.
     */
    float bottom;
} realistic_zone;

/*
 Returns the distance along a ray from its origin to the first surface, world units: infinity for
 none, and NaN or a number that is not above 0 for "not known". It must return, without an exception (as a
 `realistic_log` must).
 */
typedef double (*realistic_distance)(void *user, const struct realistic_ray *ray);

/*
 Returns how much contrast the picture of a trial camera has in a zone, in any measure that is 0 or
 more and highest where the picture is sharpest (the mean square difference of neighbouring
 pixels, say): NaN for "not known". It should use the same random numbers for every camera. The camera
 lives until the callback returns. It must return, without an exception.
 */
typedef double (*realistic_contrast)(void *user,
                                     const struct realistic_camera *camera,
                                     const struct realistic_zone *zone);

/*
 What first-order optics says of a lens (M. Born and E. Wolf, *Principles of Optics*, chapter 4). Air being on both sides,
 the nodal points are the principal points. z is a place in lens space, mm; infinity stands for one at infinity.
 `realistic_lens_get_info` fills it.
 */
typedef struct realistic_lens_info {
    /*
     `sizeof(realistic_lens_info)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     How many surfaces it has, the stop included.
     */
    uint32_t surfaces;
    /*
     The stop's number, counted from 0 at the scene side; -1 for a lens without one.
     */
    int32_t stop;
    /*
     The number of the surface whose aperture limits the beam of a distant point on the axis.
     */
    int32_t limiting;
    /*
     Wavelength, nm.
     */
    double wavelength_nm;
    /*
     Effective focal length, mm; negative for a diverging lens, infinite for an afocal one.
     */
    double focal_length_mm;
    /*
     Focal length, without its sign, over the entrance pupil's diameter.
     */
    double fnumber;
    /*
     Last vertex to the film-side focal point, mm; NaN for an afocal lens, as the next four.
     */
    double back_focal_distance_mm;
    /*
     z of the scene-side focal point.
     */
    double front_focal_point_mm;
    /*
     z of the film-side focal point.
     */
    double rear_focal_point_mm;
    /*
     z of the scene-side principal plane.
     */
    double front_principal_plane_mm;
    /*
     z of the film-side principal plane.
     */
    double rear_principal_plane_mm;
    /*
     z of the last vertex; 0 or less.
     */
    double rear_vertex_mm;
    /*
     z of the entrance pupil.
     */
    double entrance_pupil_mm;
    /*
     Diameter of the entrance pupil, mm; infinite for a pupil at infinity.
     */
    double entrance_pupil_diameter_mm;
    /*
     z of the exit pupil.
     */
    double exit_pupil_mm;
    /*
     Diameter of the exit pupil, mm; infinite for a pupil at infinity.
     */
    double exit_pupil_diameter_mm;
    /*
     The focal length that the lens's description states, mm; NaN where it states none.
     */
    double stated_focal_length_mm;
    /*
     The film distance that the lens's description proposes, from the last vertex, mm; NaN where it proposes none.
     */
    double nominal_film_distance_mm;
} realistic_lens_info;

/*
 One surface of a lens. `realistic_lens_get_surface` fills it.
 */
typedef struct realistic_lens_surface {
    /*
     `sizeof(realistic_lens_surface)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     1 for the aperture stop, else 0.
     */
    uint32_t is_stop;
    /*
     z of its vertex, mm; 0 for the first, never positive.
     */
    double vertex_mm;
    /*
     Radius of curvature, mm: positive with the centre on the film's side, infinite for a plane.
     */
    double radius_mm;
    /*
     Distance to the next vertex, mm; 0 for the last.
     */
    double thickness_mm;
    /*
     Refractive index on the scene's side.
     */
    double index_scene;
    /*
     Refractive index on the film's side.
     */
    double index_film;
    /*
     Clear semi-diameter, mm.
     */
    double semi_diameter_mm;
    /*
     Radius of the figure's conic at its vertex, mm. It differs from `radius_mm` only where A2 adds to the curvature.
     */
    double conic_radius_mm;
    /*
     Conic constant k: 0 for a sphere and a plane, -1 a paraboloid, less a hyperboloid. With c = 1/`conic_radius_mm` and r
     the distance from the axis, the surface lies c r²/(1 + √(1 - (1 + k) c² r²)) + A2 r² + A3 r³ + … + A20 r^20 behind its
     vertex plane, toward the film (W. J. Smith, *Modern Optical Engineering*, on aspheric surfaces).
     */
    double conic;
    /*
     A2, A3, … A20, in mm^(1 - i).
     */
    double aspheric[19];
} realistic_lens_surface;

/*
 Rays in lens space as structure of arrays, one number per ray in each: a point on it, mm, and its direction.
 */
typedef struct realistic_lens_rays {
    /*
     `sizeof(realistic_lens_rays)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     x of a point on each ray.
     */
    double *ox;
    /*
     y.
     */
    double *oy;
    /*
     z.
     */
    double *oz;
    /*
     x of each direction, of any length but 0.
     */
    double *dx;
    /*
     y.
     */
    double *dy;
    /*
     z.
     */
    double *dz;
    /*
     What became of each ray; may be NULL.
     */
    realistic_reason *reason;
} realistic_lens_rays;

/*
 Where rays meet the surfaces of a lens, lens space, mm. The point of ray i on surface k, counted from 0 at the scene side
 whichever way rays travel, is element i · `surfaces` + k of `x`, `y` and `z`, with `surfaces` of `realistic_lens_info`; NaN
 where the ray does not get so far.
 */
typedef struct realistic_lens_points {
    /*
     `sizeof(realistic_lens_points)` of the caller's header.
     */
    uint32_t struct_size;
    /*
     x of the points.
     */
    double *x;
    /*
     y.
     */
    double *y;
    /*
     z.
     */
    double *z;
    /*
     How many surfaces each ray meets, the one that stops it included; one element per ray, may be NULL.
     */
    uint32_t *met;
} realistic_lens_points;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 The `REALISTIC_ABI_VERSION` that the loaded library was built with. A caller works with any
 library whose number is not below its own header's.
 */
uint32_t realistic_abi_version(void);

/*
 The library's version, such as "0.1.0"; lives as long as the library.
 */
const char *realistic_version(void);

/*
 The `REALISTIC_CAPABILITY_` bits of the loaded library.
 */
uint64_t realistic_capabilities(void);

/*
 The message of this thread's last failure, in one or more lines of UTF-8; empty when there was none. The
 pointer holds until the thread's next failing call.
 */
const char *realistic_last_error(void);

/*
 What a status means, in a few words; never NULL. Lives as long as the library.
 */
const char *realistic_status_name(int32_t status);

/*
 Sets every field to "not given" and the transform to the identity. `struct_size` is
 `sizeof(realistic_options)` of the caller's header. Only `xres` and `yres` must be set after.

 # Safety
 `options` is NULL or points to `struct_size` writable bytes.
 */
realistic_status realistic_options_init(struct realistic_options *options, uint32_t struct_size);

/*
 Builds a camera. On success `*out` is the camera, to be freed by `realistic_camera_free`; on
 failure `*out` is untouched and `realistic_last_error` says what to change.

 # Safety
 `options` is NULL or points to a structure of its `struct_size` bytes whose pointers are NULL or
 valid; `out` is NULL or writable.
 */
realistic_status realistic_camera_new(const struct realistic_options *options,
                                      struct realistic_camera **out);

/*
 Frees a camera of `realistic_camera_new`. NULL is fine. A camera of `CreateCamera` is its host's to
 `delete` and must not come here.

 # Safety
 `camera` is NULL or a camera of `realistic_camera_new` that nobody uses any more.
 */
void realistic_camera_free(struct realistic_camera *camera);

/*
 Fills `info`, whose `struct_size` the caller has set.

 # Safety
 `camera` is NULL or a live camera of this library; `info` is NULL or points to a structure of its
 `struct_size` bytes.
 */
realistic_status realistic_camera_get_info(const struct realistic_camera *camera,
                                           struct realistic_camera_info *info);

/*
 Copies the lens's name (nothing for a model without a lens) as UTF-8 with a closing NUL into `buffer`, cut to
 `capacity` bytes, and writes its whole length without the NUL to `*length`. `buffer` may be NULL when `capacity` is
 0, and `length` may be NULL.

 # Safety
 `camera` is NULL or a live camera of this library; `buffer` has `capacity` writable bytes;
 `length` is NULL or writable.
 */
realistic_status realistic_camera_get_lens_name(const struct realistic_camera *camera,
                                                char *buffer,
                                                size_t capacity,
                                                size_t *length);

/*
 Copies what the camera keeps and leaves out, and which model of the lens a tolerance chose, as lines of UTF-8 text
 into `buffer`: see `realistic_camera_get_lens_name` for `buffer`, `capacity` and `length`. The text is for people;
 its wording may change.

 # Safety
 `camera` is NULL or a live camera of this library; `buffer` has `capacity` writable bytes;
 `length` is NULL or writable.
 */
realistic_status realistic_camera_plan(const struct realistic_camera *camera,
                                       char *buffer,
                                       size_t capacity,
                                       size_t *length);

/*
 One ray of a camera of this library, made by `CreateCamera` or by `realistic_camera_new`.

 Returns the weight, positive. For a ray that the lens blocks, when a pointer is NULL, and when
 `camera` is another library's camera, returns exactly 0 and leaves the ray as it is.

 # Safety
 `camera` is NULL or points to an object of at least 8 bytes that lives during the call;
 `sample` and `ray` are NULL or valid.
 */
float realistic_generate_ray(const struct realistic_camera *camera,
                             const struct realistic_sample *sample,
                             struct realistic_ray *ray);

/*
 One ray of a camera at a wavelength, nm.

 The index of each glass is that of its own formula at this wavelength, from 380 to 780 nm. Everything else stands as
 the camera's own wavelength has it: film, stop, groups, and what `weighting` divides by. A lens file without dispersion
 data has the same rays at every wavelength, as have the models other than "lens". The first call for a wavelength
 prepares the camera, once and for all threads, which takes some milliseconds. With a `tolerance` or a named
 `refraction`, rays at a wavelength are traced exactly all the same.

 Returns the weight, positive. Returns exactly 0, and leaves the ray as it is, where `realistic_generate_ray` does, and
 when the wavelength is not a number from 380 to 780.

 # Safety
 As `realistic_generate_ray`.
 */
float realistic_generate_ray_at(const struct realistic_camera *camera,
                                const struct realistic_sample *sample,
                                float wavelength_nm,
                                struct realistic_ray *ray);

/*
 The rays of one sample at four wavelengths (nm), traced side by side, for hosts whose paths carry four (A. Wilkie et
 al., "Hero Wavelength Spectral Sampling", *Computer Graphics Forum* 33(4), 2014): each as `realistic_generate_ray_at` has
 it.

 Writes `weights`, and of `rays` those whose weight is positive. Returns how many that are; 0, and nothing written, when
 a pointer is NULL or `camera` is another library's.

 # Safety
 As `realistic_generate_ray`; `wavelengths_nm`, `rays` and `weights` are NULL or have four elements.
 */
uint32_t realistic_generate_hero_rays(const struct realistic_camera *camera,
                                      const struct realistic_sample *sample,
                                      const float *wavelengths_nm,
                                      struct realistic_ray *rays,
                                      float *weights);

/*
 One ray with its differentials: the ray of the sample, and those of the same lens and time sample one pixel to the
 right and one pixel down, in little more than the time of one. They have the bits that `realistic_generate_ray` gives
 for samples at `image_x` + 1 and at `image_y` + 1. `ray->struct_size` must be set.

 Returns the weight of the sample's ray, positive. Returns exactly 0, and leaves `ray` as it is, where
 `realistic_generate_ray` does, and when `ray->struct_size` is none that this library knows.

 # Safety
 `camera` is NULL or points to an object of at least 8 bytes that lives during the call;
 `sample` and `ray` are NULL or valid, `ray` for its `struct_size` bytes.
 */
float realistic_generate_ray_differential(const struct realistic_camera *camera,
                                          const struct realistic_sample *sample,
                                          struct realistic_ray_differential *ray);

/*
 One ray at a wavelength, nm, with its differentials: the ray of the sample, and those of the same lens and time sample
 and the same wavelength one pixel to the right and one pixel down. They have the bits that `realistic_generate_ray_at`
 gives for samples at `image_x` + 1 and at `image_y` + 1. `ray->struct_size` must be set.

 Returns the weight of the sample's ray, positive. Returns exactly 0, and leaves `ray` as it is, where
 `realistic_generate_ray_at` does, and when `ray->struct_size` is none that this library knows.

 # Safety
 As `realistic_generate_ray_differential`.
 */
float realistic_generate_ray_differential_at(const struct realistic_camera *camera,
                                             const struct realistic_sample *sample,
                                             float wavelength_nm,
                                             struct realistic_ray_differential *ray);

/*
 Rays of `n` samples. Element i lies `i * stride` bytes from the first, so that arrays of a host's own
 larger structures can be passed (pbrt-v1: 88 for `Sample`, 36 for `Ray`); a stride of 0 means tightly packed.
 Nothing needs to be aligned beyond a byte.

 `weights[i]` is 0 for a blocked ray, and `rays[i]` is then left as it is. `reasons` may be NULL. With `n` = 0
 the arrays may be NULL. The arrays must not overlap.

 # Safety
 `camera` is NULL or a live camera of this library; the arrays have room for `n` elements.
 */
realistic_status realistic_camera_generate_rays(const struct realistic_camera *camera,
                                                size_t n,
                                                const struct realistic_sample *samples,
                                                size_t sample_stride,
                                                struct realistic_ray *rays,
                                                size_t ray_stride,
                                                float *weights,
                                                realistic_reason *reasons);

/*
 Rays of `n` samples given and taken as structure of arrays. Blocked rays as in
 `realistic_camera_generate_rays`. In `rays` the arrays `mint`, `maxt`, `time` and `reason` may be NULL.

 # Safety
 `camera` is NULL or a live camera of this library; `samples` and `rays` are NULL or valid, and
 their arrays are NULL or have room for `n` elements and do not overlap.
 */
realistic_status realistic_camera_generate_rays_soa(const struct realistic_camera *camera,
                                                    size_t n,
                                                    const struct realistic_samples_soa *samples,
                                                    const struct realistic_rays_soa *rays);

/*
 Rays with differentials of `n` samples, the same as by `realistic_generate_ray_differential`. Strides, alignment,
 `weights` and `reasons` as in `realistic_camera_generate_rays`. `struct_size` must be set in the first of `rays`; a
 `ray_stride` of 0 is that size.

 # Safety
 `camera` is NULL or a live camera of this library; the arrays have room for `n` elements.
 */
realistic_status realistic_camera_generate_ray_differentials(const struct realistic_camera *camera,
                                                             size_t n,
                                                             const struct realistic_sample *samples,
                                                             size_t sample_stride,
                                                             struct realistic_ray_differential *rays,
                                                             size_t ray_stride,
                                                             float *weights,
                                                             realistic_reason *reasons);

/*
 Rays with differentials of `n` samples given and taken as structure of arrays: `rays` as in
 `realistic_camera_generate_rays_soa`, `rx` one pixel to the right, `ry` one pixel down. Of `rx` and `ry` the origins,
 directions and weights are written, and the other arrays may be NULL: where a weight is positive there is that
 neighbour; where the lens blocks it the weight is 0 and the ray's own origin and direction stand in its place; where
 the ray itself is blocked the three weights are 0 and the other numbers are left as they are.

 # Safety
 `camera` is NULL or a live camera of this library; `samples`, `rays`, `rx` and `ry` are NULL or valid, and
 their arrays are NULL or have room for `n` elements and do not overlap.
 */
realistic_status realistic_camera_generate_ray_differentials_soa(const struct realistic_camera *camera,
                                                                 size_t n,
                                                                 const struct realistic_samples_soa *samples,
                                                                 const struct realistic_rays_soa *rays,
                                                                 const struct realistic_rays_soa *rx,
                                                                 const struct realistic_rays_soa *ry);

/*
 Rays with differentials of `n` samples, each at its own wavelength (`n` of them, nm), the same as by
 `realistic_generate_ray_differential_at`. With `wavelengths_nm` NULL every ray is at the camera's own wavelength, and the
 call is `realistic_camera_generate_ray_differentials_soa`. All else as there.

 # Safety
 As `realistic_camera_generate_ray_differentials_soa`; `wavelengths_nm` is NULL or has `n` elements, and does not overlap
 the other arrays.
 */
realistic_status realistic_camera_generate_ray_differentials_at_soa(const struct realistic_camera *camera,
                                                                    size_t n,
                                                                    const struct realistic_samples_soa *samples,
                                                                    const float *wavelengths_nm,
                                                                    const struct realistic_rays_soa *rays,
                                                                    const struct realistic_rays_soa *rx,
                                                                    const struct realistic_rays_soa *ry);

/*
 Rays of `n` samples, each at its own wavelength, the same as by `realistic_generate_ray_at`: `wavelengths_nm[i]` lies
 `i * wavelength_stride` bytes from the first (0: tightly packed). With `wavelengths_nm` NULL every ray is at the
 camera's own wavelength, and the call is `realistic_camera_generate_rays`. All else as there.

 # Safety
 `camera` is NULL or a live camera of this library; the arrays have room for `n` elements.
 */
realistic_status realistic_camera_generate_rays_at(const struct realistic_camera *camera,
                                                   size_t n,
                                                   const struct realistic_sample *samples,
                                                   size_t sample_stride,
                                                   const float *wavelengths_nm,
                                                   size_t wavelength_stride,
                                                   struct realistic_ray *rays,
                                                   size_t ray_stride,
                                                   float *weights,
                                                   realistic_reason *reasons);

/*
 Rays of `n` samples, each at its own wavelength (`n` of them, nm), given and taken as structure of arrays. With
 `wavelengths_nm` NULL every ray is at the camera's own wavelength, and the call is
 `realistic_camera_generate_rays_soa`. All else as there.

 # Safety
 `camera` is NULL or a live camera of this library; `samples` and `rays` are NULL or valid, and they and
 `wavelengths_nm` are NULL or have room for `n` elements and do not overlap.
 */
realistic_status realistic_camera_generate_rays_at_soa(const struct realistic_camera *camera,
                                                       size_t n,
                                                       const struct realistic_samples_soa *samples,
                                                       const float *wavelengths_nm,
                                                       const struct realistic_rays_soa *rays);

/*
 Four rays of each of `n` samples, at four wavelengths (nm) each: the ray of sample i at `wavelengths_nm[4 i + k]` is
 ray 4 i + k, the same as by `realistic_generate_ray_at`. `samples` has arrays of `n` elements; `wavelengths_nm` and the
 arrays of `rays` have 4 `n`. All else as in `realistic_camera_generate_rays_at_soa`.

 # Safety
 `camera` is NULL or a live camera of this library; `samples` and `rays` are NULL or valid; the arrays are NULL or have
 room for `n` or 4 `n` elements and do not overlap.
 */
realistic_status realistic_camera_generate_hero_rays_soa(const struct realistic_camera *camera,
                                                         size_t n,
                                                         const struct realistic_samples_soa *samples,
                                                         const float *wavelengths_nm,
                                                         const struct realistic_rays_soa *rays);

/*
 Rays of `n` samples, the same as by `realistic_camera_generate_rays_soa`, with wavelengths as by
 `realistic_camera_generate_rays_at_soa`, with neighbours as by `realistic_camera_generate_ray_differentials_soa`, and with
 both as by `realistic_camera_generate_ray_differentials_at_soa`.
 The arrays must not overlap; where `n` is 0 they may all be NULL.

 # Safety
 `camera` is NULL or a live camera of this library; `batch` is NULL or valid, and what it points to is NULL or has room
 for `n` elements at its strides.
 */
realistic_status realistic_camera_generate_batch(const struct realistic_camera *camera,
                                                 size_t n,
                                                 const struct realistic_batch *batch);

/*
 What `n` rays that enter the camera count in its picture. A ray that does not get through the lens to the film, comes
 from behind, arrives while the shutter is closed, or has numbers that are none counts 0. One that passes as near an
 aperture's edge as its numbers are rounded may count 0 where the camera's own ray passes. The arrays must not overlap;
 nothing needs to be aligned. Fails with `REALISTIC_STATUS_INVALID_PARAMETER` for models whose rays have no area:
 "perspective" and "orthographic" without `lensradius`, and "environment".

 # Safety
 `camera` is NULL or a live camera of this library; `rays` and `importance` are NULL or valid, and their arrays are NULL
 or have room for `n` elements.
 */
realistic_status realistic_camera_importance(const struct realistic_camera *camera,
                                             size_t n,
                                             const struct realistic_importance_rays *rays,
                                             const struct realistic_importance *importance);

/*
 Directions toward the lens from `n` points of the scene, sampled from the pupil as each point sees it, and what a ray
 along each counts, as `realistic_camera_importance` has it. For a point that shines with the radiance L along the
 direction, at an angle to the normal there with the cosine c, the picture gets importance · L · c / (density · density of
 the point) at (image_x, image_y). Most directions count something; where one does not get through to the film its
 importance is 0, and that belongs to the mean. The first call of a camera looks at its lens from
 everywhere, which takes some tenths of a second.

 What is NULL, what overlaps and what fails as in `realistic_camera_importance`. Points that are not in front of the lens,
 nearer than `hither`, farther than `yon` or than 1e18 or so, and numbers that are none have no direction.

 # Safety
 `camera` is NULL or a live camera of this library; `points`, `aimed` and `importance` are NULL or valid, and their arrays
 are NULL or have room for `n` elements.
 */
realistic_status realistic_camera_sample_importance(const struct realistic_camera *camera,
                                                    size_t n,
                                                    const struct realistic_scene_points *points,
                                                    const struct realistic_aimed *aimed,
                                                    const struct realistic_importance *importance);

/*
 Autofocus: finds the film distance, mm, to be given as `filmdistance`, at which the camera of
 `options` has in focus what it sees in `n` zones of the picture. `rule` is a
 `realistic_autofocus_rule`. The host gives one of the two callbacks and NULL for the other:
 with `distance` some rays per zone are asked about, with `contrast` some tens to hundreds of trial cameras are built,
 from infinity to the nearest distance that the lens can focus. Zones that give no answer do not count. `options`
 must leave `filmdistance` and `focusdistance` open, and `focusby` "film". The callback is called on this thread, with `user` as it is.

 Fails with `REALISTIC_STATUS_UNREACHABLE_FOCUS`, and leaves `*film_distance_mm` as it is, when no zone has
 an answer.

 # Safety
 `options` as for `realistic_camera_new`; `zones` is NULL or has `n` elements; `film_distance_mm` is
 NULL or writable; the callbacks are functions of their types.
 */
realistic_status realistic_autofocus(const struct realistic_options *options,
                                     const struct realistic_zone *zones,
                                     size_t n,
                                     int32_t rule,
                                     realistic_distance distance,
                                     realistic_contrast contrast,
                                     void *user,
                                     double *film_distance_mm);

/*
 Opens a lens: the one that `specfile` names or `lens_text` describes, at `wavelength`, `zoom` and the stop of
 `aperture_diameter` or `fnumber`, as for a camera; `log` receives warnings. `xres`, `yres` and `camera_to_world` are not
 looked at, and any other parameter that is given is refused, for it would change nothing. On success `*out` is the
 lens, to be freed by `realistic_lens_free`; on failure `*out` is untouched and `realistic_last_error` says what to
 change.

 # Safety
 `options` is NULL or points to a structure of its `struct_size` bytes whose pointers are NULL or
 valid; `out` is NULL or writable.
 */
realistic_status realistic_lens_new(const struct realistic_options *options,
                                    struct realistic_lens **out);

/*
 Frees a lens. NULL is fine.

 # Safety
 `lens` is NULL or a lens of `realistic_lens_new` that nobody uses any more.
 */
void realistic_lens_free(struct realistic_lens *lens);

/*
 Fills `info`, whose `struct_size` the caller has set.

 # Safety
 `lens` is NULL or a live lens; `info` is NULL or points to a structure of its `struct_size` bytes.
 */
realistic_status realistic_lens_get_info(const struct realistic_lens *lens,
                                         struct realistic_lens_info *info);

/*
 Fills `surface`, whose `struct_size` the caller has set, with surface `number`, counted from 0 at the scene side.

 # Safety
 `lens` is NULL or a live lens; `surface` is NULL or points to a structure of its `struct_size` bytes.
 */
realistic_status realistic_lens_get_surface(const struct realistic_lens *lens,
                                            uint32_t number,
                                            struct realistic_lens_surface *surface);

/*
 Copies the lens's name: see `realistic_camera_get_lens_name` for `buffer`, `capacity` and `length`.

 # Safety
 `lens` is NULL or a live lens; `buffer` has `capacity` writable bytes; `length` is NULL or writable.
 */
realistic_status realistic_lens_get_name(const struct realistic_lens *lens,
                                         char *buffer,
                                         size_t capacity,
                                         size_t *length);

/*
 The film distance, from the last vertex in mm, at which a point on the axis `object_distance_mm` in front of the **film**
 is sharpest: where its bundle of exact rays at the lens's stop and wavelength has the smallest RMS spot. Infinity is a
 distance. `REALISTIC_STATUS_UNREACHABLE_FOCUS`, and in the message the nearest distance, where the lens cannot.

 # Safety
 `lens` is NULL or a live lens; `film_distance_mm` is NULL or writable.
 */
realistic_status realistic_lens_focus(const struct realistic_lens *lens,
                                      double object_distance_mm,
                                      double *film_distance_mm);

/*
 The distance from the film, mm along the axis, of what film `film_distance_mm` behind the last vertex shows sharp;
 infinity for what lies there or, NaN, where nothing in front of the lens is in focus.

 # Safety
 `lens` is NULL or a live lens; `object_distance_mm` is NULL or writable.
 */
realistic_status realistic_lens_focused_on(const struct realistic_lens *lens,
                                           double film_distance_mm,
                                           double *object_distance_mm);

/*
 Takes `n` rays through the lens from side `from` (`realistic_side`) and puts in their place the points where they leave
 the last surface and their unit directions there. A blocked ray ends on the last surface that it met, with the
 direction behind it, or, where it met none, stays as it was but for the length of its direction; `reason` says why. A
 start may lie anywhere before the lens. Numbers that are not finite, or a direction of length 0, count as
 `REALISTIC_REASON_MISSED`, and such a ray stays as it was. The arrays must not overlap; nothing needs to be aligned.

 # Safety
 `lens` is NULL or a live lens; `rays` is NULL or valid, and its arrays are NULL or have room for `n` elements.
 */
realistic_status realistic_lens_trace(const struct realistic_lens *lens,
                                      int32_t from,
                                      size_t n,
                                      const struct realistic_lens_rays *rays);

/*
 As `realistic_lens_trace`, surface by surface and one ray after another, with the points on the way. It is the slower of
 the two; their rays agree but for rounding, and where that decides at the very edge of an aperture.

 # Safety
 `lens` is NULL or a live lens; `rays` and `points` are NULL or valid; the arrays of `rays` are NULL or have room for `n`
 elements, as `points.met`, and those of `points` for `n` times the lens's surfaces.
 */
realistic_status realistic_lens_trace_points(const struct realistic_lens *lens,
                                             int32_t from,
                                             size_t n,
                                             const struct realistic_lens_rays *rays,
                                             const struct realistic_lens_points *points);

/*
 Copies the names of the built-in lenses, each of which `specfile` may be, the default's first, a newline between two: see
 `realistic_camera_get_lens_name` for `buffer`, `capacity` and `length`.

 # Safety
 `buffer` has `capacity` writable bytes; `length` is NULL or writable.
 */
realistic_status realistic_catalogue(char *buffer,
                                     size_t capacity,
                                     size_t *length);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#ifdef REALISTIC_PBRT_ENTRY
#ifdef __cplusplus
extern "C" {
#endif
/* What a pbrt-v1 host calls: takes its const ParamSet &, const Transform & (world to camera) and
 * Film *, and returns its Camera *, which the host deletes. NULL when there is none; the reason went to the
 * host's Error function (where there is none, to standard error) and is realistic_last_error(). Rays that the host asks
 * for through its own vtable may raise floating-point flags, but do not trap. */
realistic_camera *CreateCamera(const void *params, const void *world2cam, void *film);
/* realistic_generate_ray under the name that the assignment gives it. */
float GenerateRay(const realistic_camera *camera, const realistic_sample *sample,
                  realistic_ray *ray);
#ifdef __cplusplus
}
#endif
#endif /* REALISTIC_PBRT_ENTRY */

#endif  /* REALISTIC_H */

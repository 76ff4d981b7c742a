/* realistic: a real camera for renderers. MIT OR Apache-2.0.
 *
 * Made by cbindgen from src/abi; `REALISTIC_WRITE_HEADER=1 cargo test --test abi header` makes it again.
 *
 *     realistic_options options;
 *     realistic_camera *camera;
 *     realistic_options_init(&options, sizeof options);
 *     options.xres = 640, options.yres = 480, options.lens_file = "wide.22mm";
 *     if (realistic_camera_new(&options, &camera)) puts(realistic_last_error());
 *     realistic_sample sample = {320.5f, 240.5f, 0.5f, 0.5f, 0};
 *     realistic_ray ray;
 *     float weight = realistic_generate_ray(camera, &sample, NULL, &ray);
 *     realistic_camera_free(camera);
 *
 * Success and failure. A function that can fail returns a realistic_status, 0 for success; realistic_last_error() is then
 * the reason, and what to change, on the same thread. Outputs come last, are written last and stay as they are on failure.
 * No call panics, throws or prints (but CreateCamera, in a process without pbrt's Error function, and Rust's report of a
 * defect of this library).
 *
 * Pointers. Each is NULL or valid; one that must not be NULL is checked. A handle comes from a _new function, goes to the
 * matching _free once, which takes NULL, and is not used after; meanwhile any number of threads may use it. A camera's
 * first word is read to see whether it is this library's. Structures begin with struct_size, which the caller sets to sizeof,
 * but for those of fixed layout. A callback must return, without an exception.
 *
 * Text is UTF-8 and ends in NUL. A function that copies text takes a buffer of `capacity` bytes, NULL where that is 0, cuts
 * the text to fit, and writes its whole length without the NUL to `*length`, unless that is NULL.
 *
 * Arrays have `n` elements, begin at any byte, and do not overlap; where n is 0 they may be NULL. An n or a stride is refused
 * where an array would span more than 2^47 bytes, or step over the end of the address space.
 *
 * Space. World units are the host's (`mm_per_unit`); names and comments say where lengths are mm. Camera space: origin at
 * the lens's front vertex (the eye of a model without a lens), +z forward, +x right, +y up; the film lies at z =
 * `rear_vertex_mm` - `film_distance` of the lens and camera, in mm. Lens space, mm: origin at the vertex of the first surface, +z toward the scene, +x image right, +y image up.
 * Raster: (0, 0) is the picture's top left corner, pixel centres lie at halves.
 *
 * Floating point. Calls compute in the default environment (to nearest, no trap, subnormal numbers kept) whatever the
 * caller's is, so that rays are the same to the bit, and leave the caller's control word as it is. All but a single ray restore
 * its flags, too; a plain single ray may raise inexact and underflow. Callbacks are called in the default environment. (x86-64
 * and AArch64; elsewhere calls compute in the caller's.) */

#ifndef REALISTIC_H
#define REALISTIC_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

// A bit of `has` in `realistic_ray_differential`: the ray one pixel to the right is present.
#define REALISTIC_HAS_RX 1

// A bit of `has` in `realistic_ray_differential`: the ray one pixel down is present.
#define REALISTIC_HAS_RY 2

// The version of the C ABI that this header describes. It grows with each addition; nothing that was released is
// removed or renumbered.
#define REALISTIC_ABI_VERSION 1

// A bit of `realistic_capabilities`: a pbrt-v1 host can load the library, because it exports `CreateCamera`.
#define REALISTIC_CAPABILITY_PBRT_V1 1

// Result of a call of the C ABI. The numbers are part of the ABI and never change.
enum realistic_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Success.
    REALISTIC_STATUS_OK = 0,
    // A pointer that must not be NULL is NULL. For a pointer to a camera or a lens, see
    // `REALISTIC_STATUS_NOT_A_CAMERA` and `REALISTIC_STATUS_NOT_A_LENS`.
    REALISTIC_STATUS_NULL_POINTER = 1,
    // The `struct_size` is unknown.
    REALISTIC_STATUS_STRUCT_SIZE = 2,
    // A parameter is unknown, of the wrong kind, out of range or given twice.
    REALISTIC_STATUS_INVALID_PARAMETER = 3,
    // The lens description is missing or cannot be read.
    REALISTIC_STATUS_LENS_FILE = 4,
    // The lens cannot be focused at the requested distance.
    REALISTIC_STATUS_UNREACHABLE_FOCUS = 5,
    // A file other than the lens description cannot be read: the picture of `stop_picture`.
    REALISTIC_STATUS_IO = 6,
    // A panic was caught, which is a defect of this library.
    REALISTIC_STATUS_PANIC = 7,
    // The pointer is NULL or does not point to a camera of this library.
    REALISTIC_STATUS_NOT_A_CAMERA = 8,
    // Memory is exhausted. Building a camera or a lens needs 8 MiB, and autofocus needs memory for its
    // zones. If other threads use up the memory in the meantime, or if there is none for a message, the
    // process ends, as in most Rust programs.
    REALISTIC_STATUS_OUT_OF_MEMORY = 9,
    // Reserved, and not returned by this version. The process lacks a function that the call needs.
    // (`CreateCamera` returns NULL if functions of the host are missing, and `realistic.hpp` throws this
    // status if the library is older than the header.)
    REALISTIC_STATUS_UNSUPPORTED = 10,
    // The pointer is NULL or does not point to a lens of this library.
    REALISTIC_STATUS_NOT_A_LENS = 11,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum realistic_status realistic_status;
#else
typedef int32_t realistic_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Result of a sample: either the sample has a ray, or the reason why it has none. The numbers are part of
// the ABI and never change.
enum realistic_reason
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // The ray passes the lens.
    REALISTIC_REASON_OK = 0,
    // The ray misses a surface.
    REALISTIC_REASON_MISSED = 1,
    // The ray meets a surface outside the clear aperture.
    REALISTIC_REASON_CLIPPED = 2,
    // The ray is totally reflected.
    REALISTIC_REASON_REFLECTED = 3,
    // The next surface lies behind the ray, or the ray travels backward.
    REALISTIC_REASON_TURNED_BACK = 4,
    // The lens sample lies outside the disk; only with `disk` "rejection". Draw another lens sample; this
    // one does not count.
    REALISTIC_REASON_REDRAW = 5,
    // The shutter is closed over this film point at this time.
    REALISTIC_REASON_SHUT = 6,
    // The wavelength is invalid: it is not a number from 380 to 780 nm, or the dispersion formula of a glass
    // gives no refractive index of 1 or more at it.
    REALISTIC_REASON_WAVELENGTH = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum realistic_reason realistic_reason;
#else
typedef int32_t realistic_reason;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Rule that combines several zones into one film distance. The numbers are part of the ABI and never change.
enum realistic_autofocus_rule
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Chooses the zone with the nearest object.
    REALISTIC_AUTOFOCUS_RULE_NEAREST = 0,
    // Chooses the zone nearest to the centre of the picture, among the zones for which a film distance is
    // found.
    REALISTIC_AUTOFOCUS_RULE_CENTRE = 1,
    // Takes the mean of the zones' film distances.
    REALISTIC_AUTOFOCUS_RULE_AVERAGE = 2,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum realistic_autofocus_rule realistic_autofocus_rule;
#else
typedef int32_t realistic_autofocus_rule;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The side of a lens from which rays come. The numbers are part of the ABI and never change.
enum realistic_side
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Rays come from behind the lens and travel toward +z.
    REALISTIC_SIDE_FILM = 0,
    // Rays come from in front of the lens and travel toward -z.
    REALISTIC_SIDE_SCENE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum realistic_side realistic_side;
#else
typedef int32_t realistic_side;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A camera. Immutable and thread-safe once built.
typedef struct realistic_camera realistic_camera;

// A lens at one wavelength and stop. Immutable and thread-safe once built.
typedef struct realistic_lens realistic_lens;

// Receives a message while a camera or a lens is being built. `level` is 0 for information and 1 for a
// warning; 2, for an error, is reserved, because errors are returned. `message` is valid until the callback
// returns.
typedef void (*realistic_log)(void *user, int32_t level, const char *message);

typedef struct realistic_options {
    // `sizeof(realistic_options)`.
    uint32_t struct_size;
    // Image width in pixels, 1 or more. No default.
    int32_t xres;
    // Image height in pixels, 1 or more. No default.
    int32_t yres;
    // Row-major 4x4 matrix for column vectors that transforms camera space (units of `mm_per_unit`, +z
    // forward, +x right, +y up) to world space. Its last row must be 0 0 0 1, within rounding.
    // `realistic_options_init` sets the identity.
    float camera_to_world[16];
    // Second matrix of a moving camera, which holds at `transform_end`; `camera_to_world` holds at
    // `transform_start`. Translation, rotation and scale are interpolated between them. If all entries
    // are NaN, the camera does not move.
    float camera_to_world_end[16];
    // The time at which `camera_to_world` holds. NaN means `shutter_open`.
    double transform_start;
    // The time at which `camera_to_world_end` holds. NaN means `shutter_close`.
    double transform_end;
    // Receives messages; NULL for none.
    realistic_log log;
    // Passed to `log` unchanged.
    void *log_user;
    // The text of a lens file, `lens_text_size` bytes, read instead of `lens_file`; NULL for none.
    const char *lens_text;
    // Number of bytes at `lens_text`, at most 1,048,576 (1 MiB), as for any lens file.
    size_t lens_text_size;
    // A camera whose options differ only in focus, stop, zoom or pose, such as that of the previous
    // frame of an animation; NULL for none. The new camera reuses the data that depends only on
    // unchanged options, and does not read the lens file again. It is bit-identical to a camera built
    // without the donor. The donor is not changed and may be freed once the call returns. Lenses and
    // autofocus do not use it.
    const struct realistic_camera *donor;
    // Parameter `model`: kind of camera: "lens", "thick", "thin", "perspective", "orthographic" or
    // "environment"; default "lens".
    const char *model;
    // Parameter `lens_file`: lens file, or a catalogue name such as "wide.22mm" or "wide.22mm@35mm"; default
    // "dgauss.50mm".
    const char *lens_file;
    // Parameter `glass_catalog`: glass catalogue (AGF) to search first for the glasses of a lens file, before
    // the catalogues beside the file and the built-in glasses.
    const char *glass_catalog;
    // Parameter `strict`: whether to refuse a lens file of which a statement is replaced or left out that may
    // change the picture; default false.
    int32_t strict;
    // Parameter `film_distance`: distance from the last vertex to the film: positive, in mm; default the lens
    // file's, or focused at `focus_distance`.
    double film_distance;
    // Parameter `focus_distance`: distance from the film plane to the plane in focus, or inf, instead of
    // `film_distance`: positive, in units of camera space; default infinity.
    double focus_distance;
    // Parameter `focus_by`: part that moves to focus, the film or groups of the lens; the groups leave the film
    // where the lens file has it: "film" or "group"; default "film".
    const char *focus_by;
    // Parameter `zoom`: focal length of a zoom lens in mm, or the name of one of its positions; without it the
    // lens file's first position.
    const char *zoom;
    // Parameter `aperture_diameter`: clear diameter of the stop: positive, in mm; default the file's.
    double aperture_diameter;
    // Parameter `fnumber`: focal length over the diameter of the axial beam, instead of `aperture_diameter`:
    // positive.
    double fnumber;
    // Parameter `blades`: number of blades of the stop, 3 or more; their corners lie on the circle of its clear
    // diameter: 0 (a round stop) or more, up to 32; default the lens file's, or 0.
    double blades;
    // Parameter `blade_rotation`: angle of the blades' first corner, from image right toward image up: a finite
    // number, in degrees; default the lens file's, or 0.
    double blade_rotation;
    // Parameter `blade_curvature`: curvature of the blades' edges relative to that of the circle: 0 is
    // straight, 1 the circle: 0 or more, up to 1; default the lens file's, or 0.
    double blade_curvature;
    // Parameter `stop_picture`: PNG or EXR picture of the stop's transmission, centred on the axis and as wide
    // as the stop; 8-bit values are sRGB, all others linear.
    const char *stop_picture;
    // Parameter `stop_picture_gain`: whether the picture's mean transmission over the stop is scaled to 1;
    // default false.
    int32_t stop_picture_gain;
    // Parameter `film_diagonal`: diagonal of the film: positive, in mm; default 35.
    double film_diagonal;
    // Parameter `film_shift_x`: shift of the film from the axis toward image right; the picture shows more of
    // what lies on the left: from -1e15 to 1e15 mm; default 0.
    double film_shift_x;
    // Parameter `film_shift_y`: shift of the film from the axis toward image up; the picture shows more of what
    // lies below: from -1e15 to 1e15 mm; default 0.
    double film_shift_y;
    // Parameter `film_tilt_x`: tilt of the film about its own x axis, after the shift; turns the film's normal
    // from the axis toward image down: from -80 to 80 degrees; default 0.
    double film_tilt_x;
    // Parameter `film_tilt_y`: tilt of the film about its own y axis, after that about x; turns the film's
    // normal from the axis toward image right: from -80 to 80 degrees; default 0.
    double film_tilt_y;
    // Parameter `film_curvature_radius`: radius of a film that is curved like a sphere, positive with the
    // centre behind the film; the raster is projected along the film's axis: a number, in mm; default flat.
    double film_curvature_radius;
    // Parameter `hither`: distance along a ray at which it begins: 0 or more and finite, in units of camera
    // space; default 1e-3.
    double hither;
    // Parameter `yon`: distance along a ray at which it ends, beyond `hither`: 0 or more, in units of camera
    // space; default 1e30.
    double yon;
    // Parameter `shutter_open`: time at which the shutter opens: a finite number; default 0.
    double shutter_open;
    // Parameter `shutter_close`: time at which the shutter closes; before `shutter_open`, time runs backward,
    // as in pbrt: a finite number; default 1.
    double shutter_close;
    // Parameter `weighting`: definition of a ray's weight: "radiometric", "assignment", "relative" or "none";
    // default "radiometric".
    const char *weighting;
    // Parameter `simple_weighting`: pbrt-v3's name for `weighting`, true for "relative" and false for
    // "radiometric".
    int32_t simple_weighting;
    // Parameter `iso`: sensitivity of the film, a factor of iso/100 of radiometric weights: positive; default
    // 100, if another of the exposure is given.
    double iso;
    // Parameter `exposure_time`: time for which the film is exposed, a factor of radiometric weights; does not
    // depend on the shutter's times: positive, in s; default 1, if another of the exposure is given.
    double exposure_time;
    // Parameter `exposure`: exposure compensation, a factor of 2 to this power of radiometric weights: from
    // -100 to 100 stops; default 0, if another of the exposure is given.
    double exposure;
    // Parameter `responsivity`: response of the film to light, a factor of radiometric weights: positive;
    // default 1, if another of the exposure is given.
    double responsivity;
    // Parameter `transmission`: transmission of the surfaces, as a factor of every weight: 1, or that of
    // surfaces without a coating, with one, two or three layers for 550 nm between air and glass, or with the
    // coatings that the lens file names: "none", "bare", "quarter-wave", "v-coat", "three-layer" or "file";
    // default "none".
    const char *transmission;
    // Parameter `ghosts`: share of the lens samples for paths with two reflections, whose strength follows from
    // `transmission`; 1 for the light of those paths alone: 0 or more, up to 1 of the samples; default 0.
    double ghosts;
    // Parameter `pupil`: region of the lens samples, the true pupil of each film point, the rear element's
    // disk, or the thick-lens exit pupil: "warped", "rear" or "disk"; default "warped".
    const char *pupil;
    // Parameter `disk`: mapping of lens samples to the disk: "concentric", "polar" or "rejection"; default
    // "concentric".
    const char *disk;
    // Parameter `refraction`: method of refraction: "fused", "heckbert", "whitted" or "other"; default "fused".
    const char *refraction;
    // Parameter `wavelength`: wavelength of the rays, for lenses with V-numbers or dispersion formulas; below
    // 300 only with glasses whose data reach there: from 200 to 2000 nm; default the lens file's, or 587.56.
    double wavelength;
    // Parameter `mm_per_unit`: length of a unit of camera space; world units have the same length unless the
    // camera transform scales: positive, from 1e-15 to 1e30 mm; default 1.
    double mm_per_unit;
    // Parameter `precision`: precision of the trace; "auto" is double, or what `tolerance` allows: "auto",
    // "f64", "f32", "double" or "single"; default "auto".
    const char *precision;
    // Parameter `tolerance`: largest error of 99.9 % of the rays, which allows a faster model of the lens: 0
    // (exact) or more and finite, in pixels; default 0.
    double tolerance;
    // Parameter `shutter`: type of shutter: "global", "leaf" or "focal-plane"; default "global".
    const char *shutter;
    // Parameter `shutter_ramp`: share of the shutter's interval in which a leaf shutter opens, and in which it
    // closes: more than 0 and at most 0.5 of the interval; default 0.25.
    double shutter_ramp;
    // Parameter `shutter_slit`: share of the shutter's interval for which a focal-plane shutter exposes each
    // row: more than 0 and at most 1 of the interval; default 0.25.
    double shutter_slit;
    // Parameter `crop`: part of the picture that the host renders, which changes no ray: x from, y from, x to,
    // y to in whole pixels, the last two one past the last pixel: 0 or more and finite, in pixels; default the
    // whole picture.
    double crop[4];
    // Parameter `fov`: angle across the shorter side of the image: from 0.0001 to less than 180 degrees;
    // default 90.
    double fov;
    // Parameter `screen_window`: part of the screen that becomes the image: x from, x to, y from, y to: from
    // -1e15 to 1e15; default by the aspect ratio.
    double screen_window[4];
    // Parameter `frame_aspect_ratio`: width over height of the screen window: positive, from 1e-15 to 1e15;
    // default the image's.
    double frame_aspect_ratio;
    // Parameter `lens_radius`: radius of the projection's thin lens: 0 (a pinhole) or more, up to 1e15 units of
    // camera space; default 0.
    double lens_radius;
    // Parameter `focal_distance`: distance from the eye to the plane of focus, beyond `hither`, of a lens of
    // `lens_radius`: a number, in units of camera space; default 1e30.
    double focal_distance;
    // Parameter `lens_plane`: plane of the projection's thin lens, the eye's as in pbrt 1.05, or the near plane
    // as in older versions and on the lecture's slide: "eye" or "hither"; default "eye".
    const char *lens_plane;
} realistic_options;

// Description of a built camera, for a host to print. `realistic_camera_get_info` fills this structure. A
// model without a lens (`perspective`, `orthographic`, `environment`) has 0 interfaces, and NaN for the
// lengths and the f-number.
typedef struct realistic_camera_info {
    // `sizeof(realistic_camera_info)`.
    uint32_t struct_size;
    // Number of interfaces (surfaces) of the lens, including the stop.
    uint32_t interfaces;
    // Effective focal length, mm; infinite for an afocal lens.
    double focal_length_mm;
    // Focal length divided by the diameter of the beam of exact rays from a distant point on the axis, at
    // the stop in use; infinite for an afocal lens.
    double fnumber;
    // Distance from the last vertex to the film, mm.
    double film_distance;
    // Distance from the film plane to the plane in focus, mm along the axis; infinity if the lens is focused
    // at infinity or beyond, NaN if no object in front of the lens is in focus.
    double focus_distance_mm;
    // Film diagonal, mm.
    double film_diagonal;
    // The pixels that the host is to render: columns from `crop[0]` up to but excluding `crop[2]`, rows from
    // `crop[1]` up to but excluding `crop[3]`; the whole picture if no `crop` is given. Valid for every
    // model.
    uint32_t crop[4];
} realistic_camera_info;

// One camera sample: the first 20 bytes of pbrt-v1's `Sample`.
typedef struct realistic_sample {
    // Raster x in pixels: 0 at the left edge of the image, `xres` at the right edge.
    float image_x;
    // Raster y in pixels: 0 at the top edge of the image, `yres` at the bottom edge.
    float image_y;
    // u of the lens sample (u, v), in [0, 1].
    float lens_u;
    // v of the lens sample (u, v), in [0, 1].
    float lens_v;
    // Time as a fraction of the shutter's interval: 0 when the shutter opens, 1 when it closes. Time, u and
    // v are clamped to [0, 1].
    float time;
} realistic_sample;

// Input array of numbers (`x`), pairs (`x` and `y`) or vectors (`x`, `y` and `z`). Element i lies `i *
// stride` bytes from the first element. The stride is 0 if all elements are the same one; otherwise its
// magnitude is at least 4 bytes, and it may be negative. `x` is NULL if the input is omitted.
typedef struct realistic_input {
    // Address of the first element's x, or of the first number.
    const float *x;
    // Address of the first element's y; not read for numbers.
    const float *y;
    // Address of the first element's z; read only for vectors.
    const float *z;
    // Bytes from one element to the next.
    ptrdiff_t stride;
} realistic_input;

// Output array of numbers, pairs or vectors, with the layout of `realistic_input`; the stride must not be 0.
typedef struct realistic_output {
    // Address of the first element's x, or of the first number.
    float *x;
    // Address of the first element's y; not read for numbers.
    float *y;
    // Address of the first element's z; read only for vectors.
    float *z;
    // Bytes from one element to the next.
    ptrdiff_t stride;
} realistic_output;

// Request for the rays of samples. Initialise it with zeros, which omit every member. A batch reads all
// members and requires `image`, `lens`, `origin`, `direction` and `weight`. A call for one sample takes the
// sample and the ray as arguments and reads only `wavelength`, `wavelengths_per_sample`, `weight` and
// `reason`.
typedef struct realistic_request {
    // `sizeof(realistic_request)`.
    uint32_t struct_size;
    // Number w of rays per sample, each at its own wavelength: ray i · w + k belongs to sample i and has
    // element i · w + k of `wavelength`. 0 means 1. 4 rays are traced side by side (A. Wilkie et al., "Hero
    // Wavelength Spectral Sampling", 2014).
    uint32_t wavelengths_per_sample;
    // Raster points (x, y), pixels.
    struct realistic_input image;
    // Lens samples (u, v), in [0, 1].
    struct realistic_input lens;
    // Time as a fraction of the shutter's interval; 0 if omitted.
    struct realistic_input time;
    // Wavelengths, nm, one per ray (`n` times `wavelengths_per_sample`; repeated if samples share
    // wavelengths). If omitted, rays have the camera's own wavelength. A wavelength outside 380 to 780, such
    // as 0.55, is not an error: its ray has weight 0 and `REALISTIC_REASON_WAVELENGTH`. The refractive index
    // of each glass follows from its dispersion formula; film, stop, groups and the divisor of `weighting`
    // stay those of the camera's own wavelength. A lens without dispersion data, and every model but "lens",
    // has the same rays at every wavelength. A lens with dispersion data, and every lens with a `tolerance`,
    // traces rays at a wavelength exactly, whatever the value of `refraction`.
    struct realistic_input wavelength;
    // Origins (x, y, z), world units.
    struct realistic_output origin;
    // Directions (x, y, z), unit length.
    struct realistic_output direction;
    // Weights; 0 for a blocked ray. For a blocked ray nothing else is written except the reason and the
    // neighbours' weights, which are 0.
    struct realistic_output weight;
    // Distances from the origin at which rays begin.
    struct realistic_output mint;
    // Distances from the origin at which rays end.
    struct realistic_output maxt;
    // Times between `shutter_open` and `shutter_close`.
    struct realistic_output ray_time;
    // Result of each ray, one element per weight.
    realistic_reason *reason;
    // Bytes from one reason to the next.
    ptrdiff_t reason_stride;
    // Origins of the rays one pixel to the right (image x + 1), for differentials. The six members from
    // `rx_origin` to `ry_weight` must be given together or omitted together.
    struct realistic_output rx_origin;
    // Directions of the rays one pixel to the right.
    struct realistic_output rx_direction;
    // Weights of the rays one pixel to the right; 0 if the lens blocks such a ray, whose origin and
    // direction are then replaced by those of the sample's ray.
    struct realistic_output rx_weight;
    // Origins of the rays one pixel down (image y + 1).
    struct realistic_output ry_origin;
    // Directions of the rays one pixel down.
    struct realistic_output ry_direction;
    // Weights of the rays one pixel down, as in `rx_weight`.
    struct realistic_output ry_weight;
} realistic_request;

// One ray in world space: the 36 bytes of pbrt-v1's `Ray`.
typedef struct realistic_ray {
    // Origin, world units; for `model` "lens", the point where the ray leaves the front surface.
    float o[3];
    // Direction, unit length.
    float d[3];
    // Distance from `o` at which the ray begins: `hither`, or 0 for `model` "perspective" and
    // "orthographic", whose rays begin on the near plane.
    float mint;
    // Distance from `o` at which the ray ends: `yon`, or the distance to the far plane for `model`
    // "perspective" and "orthographic".
    float maxt;
    // Time between `shutter_open` and `shutter_close`.
    float time;
} realistic_ray;

// A ray with its differentials: the ray of a sample, and the rays with the same lens and time sample one
// pixel to the right (image x + 1) and one pixel down (image y + 1).
//
// The bit `REALISTIC_HAS_RX` of `has` states that the lens passes the ray to the right, whether or not the
// shutter is open at that pixel; `REALISTIC_HAS_RY` states the same of the ray below. If a bit is 0, the
// lens blocks that neighbour, and the origin and direction of the ray itself replace the neighbour's: the
// footprint then has zero width, and the numbers are safe to use.
typedef struct realistic_ray_differential {
    // `sizeof(realistic_ray_differential)` of the caller's header. The caller sets this member, and the
    // library never writes it; in an array, only that of the first element is read.
    uint32_t struct_size;
    // The neighbours that are present: `REALISTIC_HAS_RX`, `REALISTIC_HAS_RY`, both (3) or none (0).
    uint32_t has;
    // The ray of the sample.
    struct realistic_ray ray;
    // Origin of the ray to the right, world units.
    float rx_o[3];
    // Unit direction of the ray to the right.
    float rx_d[3];
    // Origin of the ray below, world units.
    float ry_o[3];
    // Unit direction of the ray below.
    float ry_d[3];
} realistic_ray_differential;

// Rays in world space that enter a camera.
typedef struct realistic_importance_rays {
    // `sizeof(realistic_importance_rays)`.
    uint32_t struct_size;
    // A point (x, y, z) on each ray, in front of the lens or on its front surface; the origins of the camera's own rays
    // are valid.
    struct realistic_input origin;
    // Directions (x, y, z) of any length but 0, toward the camera.
    struct realistic_input direction;
    // Arrival times, in the unit of `shutter_open`; the middle of the shutter's interval if omitted.
    struct realistic_input time;
} realistic_importance_rays;

// Importance of rays; all numbers are 0 for a ray without importance. Each array except `importance` may be
// omitted.
typedef struct realistic_importance {
    // `sizeof(realistic_importance)`.
    uint32_t struct_size;
    // Raster coordinates (x, y), pixels, of the points where the rays reach the film.
    struct realistic_output image;
    // Importance We (E. Veach 1997; PBRT's `We`), the factor that multiplies radiance times cosθ dA dω. dA
    // is area in square world units on the plane z = 0 of camera space, and θ is the angle to the plane's
    // normal. With `weighting` "radiometric", We is the reciprocal of the film's area in square world units,
    // times the shutter's transmission.
    struct realistic_output importance;
    // Density of the camera's own rays at this ray, per cosθ dA dω, for samples uniform over the picture, the lens and
    // time: `importance` is this density times the weight of the same ray.
    struct realistic_output density;
    // Density per area on the plane z = 0: the reciprocal of the area of the front clear aperture or, for a
    // stock camera, of its lens.
    struct realistic_output area_density;
    // Density per solid angle that corresponds to `area_density`: the product of the two is `density` times
    // cosθ.
    struct realistic_output solid_angle_density;
} realistic_importance;

// Points of the scene from which directions toward the lens are sampled.
typedef struct realistic_scene_points {
    // `sizeof(realistic_scene_points)`.
    uint32_t struct_size;
    // Points (x, y, z), world space.
    struct realistic_input point;
    // Samples (u, v), in [0, 1], of the pupil as seen from each point.
    struct realistic_input lens;
    // Time of each point's direction, in the unit of `shutter_open`; the middle of the shutter's interval if omitted.
    struct realistic_input time;
} realistic_scene_points;

// Directions toward the lens. `origin` may be omitted.
typedef struct realistic_aimed {
    // `sizeof(realistic_aimed)`.
    uint32_t struct_size;
    // Points (x, y, z) where the rays meet the front of the lens; an object between the scene point and such
    // a point blocks the light.
    struct realistic_output origin;
    // Unit vectors (x, y, z) from the scene points toward the points in `origin`.
    struct realistic_output direction;
    // Density of each direction per solid angle at the scene point. This number and all others of the point
    // are 0 if there is no direction along which light could reach the film.
    struct realistic_output density;
} realistic_aimed;

// A rectangle of the picture in pixels; (0, 0) is the picture's top left corner.
typedef struct realistic_zone {
    // Left edge, 0 or more.
    float left;
    // Top edge, 0 or more.
    float top;
    // Right edge, beyond `left` and at most `xres`.
    float right;
    // Bottom edge, below `top` and at most `yres`.
    float bottom;
} realistic_zone;

// Returns the distance along a ray from the ray's origin to the first surface, world units: infinity if
// there is no surface; NaN, 0 or a negative number if the distance is not known.
typedef double (*realistic_distance)(void *user, const struct realistic_ray *ray);

// Returns the contrast of a trial camera's picture in a zone; NaN if it is not known. Any measure will do
// that is at least 0 and highest for the sharpest picture, such as the mean square difference of
// neighbouring pixels. Use the same random numbers for every camera. A camera lives until the callback
// returns.
typedef double (*realistic_contrast)(void *user,
                                     const struct realistic_camera *camera,
                                     const struct realistic_zone *zone);

// First-order data of a lens (M. Born and E. Wolf, *Principles of Optics*, chapter 4). z is a coordinate in
// lens space, mm; it is infinite for a point at infinity. `realistic_lens_get_info` fills this structure.
typedef struct realistic_lens_info {
    // `sizeof(realistic_lens_info)`.
    uint32_t struct_size;
    // Number of surfaces, including the stop.
    uint32_t surfaces;
    // Number of the stop among the surfaces, counted from 0 at the scene side; -1 for a lens without a stop.
    int32_t stop;
    // Number of the surface that limits the beam from a distant point on the axis: the surface that blocks
    // the first exact ray outside the beam.
    int32_t limiting;
    // Wavelength, nm.
    double wavelength;
    // Effective focal length 1/φ, mm; negative for a diverging lens, infinite for an afocal one. The focal
    // lengths n/φ and n'/φ on both sides are this times `index_scene` and `index_film`.
    double focal_length_mm;
    // Absolute focal length divided by the diameter of the beam of exact rays from a distant point on the
    // axis; infinite for an afocal lens, or if no ray parallel to the axis passes.
    double fnumber;
    // Distance from the last vertex to the film-side focal point, mm. This and the next four members are NaN
    // for an afocal lens.
    double back_focal_distance_mm;
    // z of the scene-side focal point.
    double front_focal_point_mm;
    // z of the film-side focal point.
    double rear_focal_point_mm;
    // z of the scene-side principal plane.
    double front_principal_plane_mm;
    // z of the film-side principal plane.
    double rear_principal_plane_mm;
    // z of the last vertex; 0 or less.
    double rear_vertex_mm;
    // z of the entrance pupil, the first-order image of the limiting surface's aperture.
    double entrance_pupil_mm;
    // Diameter of the entrance pupil, mm, which is the diameter of the beam.
    double entrance_pupil_diameter_mm;
    // z of the exit pupil, the first-order image of the limiting surface's aperture.
    double exit_pupil_mm;
    // Diameter of the exit pupil, mm; infinite for a pupil at infinity.
    double exit_pupil_diameter_mm;
    // Focal length that the lens's description states, mm; NaN if it states none.
    double stated_focal_length_mm;
    // Film distance that the lens's description proposes, from the last vertex, mm; NaN if it proposes none.
    double nominal_film_distance_mm;
    // T-number with uncoated surfaces: the f-number divided by the square root of the transmission on the
    // axis, at the lens's wavelength; NaN if no light passes.
    double tnumber_bare;
    // T-number with a quarter-wave coating of MgF2 for 550 nm on all surfaces between air and glass.
    double tnumber_quarter_wave;
    // f-number by first-order optics alone: the absolute focal length divided by the diameter of the
    // smallest image of any aperture, formed by the surfaces in front of that aperture.
    double fnumber_paraxial;
    // Refractive index in front of the lens; 1 in air.
    double index_scene;
    // Refractive index behind the lens, where the film is; 1 in air.
    double index_film;
    // z of the scene-side nodal point: a ray toward it leaves the lens from the other one in the same
    // direction. Nodal points are the principal points if both indices are equal, and NaN for an afocal lens.
    double front_nodal_point_mm;
    // z of the film-side nodal point.
    double rear_nodal_point_mm;
    // Effective focal length in the meridian x, mm; the lengths above are those in the meridian y. The two differ for
    // lenses with cylinders, toroids, biconics or tilted surfaces.
    double focal_length_x_mm;
    // Distance from the last vertex to the film-side focal point in the meridian x, mm; NaN for an afocal lens.
    double back_focal_distance_x_mm;
    // 1 if all surfaces are symmetric about one axis, otherwise 0.
    uint32_t is_centred;
    // Number of mirrors among the surfaces.
    uint32_t mirrors;
    // The f-number in the meridian x.
    double fnumber_x;
    // z of the entrance pupil in the meridian x, mm.
    double entrance_pupil_x_mm;
    // Diameter of the entrance pupil in the meridian x, mm.
    double entrance_pupil_diameter_x_mm;
    // z of the exit pupil in the meridian x, mm.
    double exit_pupil_x_mm;
    // Diameter of the exit pupil in the meridian x, mm.
    double exit_pupil_diameter_x_mm;
} realistic_lens_info;

// One surface of a lens. `realistic_lens_get_surface` fills this structure.
typedef struct realistic_lens_surface {
    // `sizeof(realistic_lens_surface)`.
    uint32_t struct_size;
    // 1 for the aperture stop, otherwise 0.
    uint32_t is_stop;
    // z of the surface's vertex, mm; 0 for the first surface.
    double vertex_mm;
    // Radius of curvature, mm: positive if the centre of curvature lies on the film's side, infinite for a
    // plane.
    double radius_mm;
    // Distance to the next vertex, mm; 0 for the last surface.
    double thickness_mm;
    // Refractive index on the scene's side.
    double index_scene;
    // Refractive index on the film's side.
    double index_film;
    // Clear semi-diameter, mm.
    double semi_diameter_mm;
    // Vertex radius of the conic part of the surface, mm. It differs from `radius_mm` only if A2 adds to the
    // curvature.
    double conic_radius_mm;
    // Conic constant k: 0 for a sphere or a plane, -1 for a paraboloid, less for a hyperboloid. With c =
    // 1/`conic_radius_mm` and r the distance from the axis, the surface lies c r²/(1 + √(1 - (1 + k) c² r²)) + A1 r +
    // A2 r² + … + A30 r^30 behind its vertex plane, toward the film (W. J. Smith, *Modern Optical Engineering*, on
    // aspheric surfaces).
    double conic;
    // Coefficients A1, A2, … A30 of the asphere; Ai is in mm^(1 - i).
    double aspheric[30];
    // Vertex radius in the meridian x, mm. It differs from `radius_mm`, which is that in y, for a cylinder, a toroid or a
    // biconic; their other numbers are not given.
    double radius_x_mm;
    // 1 if the surface reflects, otherwise 0.
    uint32_t is_mirror;
    // 1 if the surface does not share the axis of the surface before it, or for the first that of the camera,
    // otherwise 0. `vertex_mm` then counts thicknesses alone.
    uint32_t is_turned;
} realistic_lens_surface;

// The film that has a given plane in focus. `realistic_lens_plane_of_focus` fills this structure.
typedef struct realistic_focused_film {
    // `sizeof(realistic_focused_film)`.
    uint32_t struct_size;
    // Distance from the last vertex to the film's centre, mm; the value for the parameter of this name.
    double film_distance;
    // Tilt about x, degrees; the value for the parameter of this name.
    double film_tilt_x;
    // Tilt about y, degrees; the value for the parameter of this name.
    double film_tilt_y;
} realistic_focused_film;

// Array of vectors in double precision that a call writes, after it has read them where its description says
// so, with the layout of `realistic_output`.
typedef struct realistic_vectors {
    // Address of the first element's x.
    double *x;
    // Address of the first element's y.
    double *y;
    // Address of the first element's z.
    double *z;
    // Bytes from one element to the next.
    ptrdiff_t stride;
} realistic_vectors;

// Rays in lens space: a point on each ray, mm, and its direction.
typedef struct realistic_lens_rays {
    // `sizeof(realistic_lens_rays)`.
    uint32_t struct_size;
    // A point on each ray.
    struct realistic_vectors origin;
    // Directions, of any length but 0.
    struct realistic_vectors direction;
    // Result of each ray; may be NULL.
    realistic_reason *reason;
    // Bytes from one reason to the next.
    ptrdiff_t reason_stride;
    // Result of each ray: the optical path, mm (lengths times indices), from the given point of the ray to the
    // one that replaces it; may be NULL.
    double *optical_path;
    // Bytes from one optical path to the next.
    ptrdiff_t optical_path_stride;
} realistic_lens_rays;

// Points where rays meet the surfaces of a lens, lens space, mm.
typedef struct realistic_lens_points {
    // `sizeof(realistic_lens_points)`.
    uint32_t struct_size;
    // The point of ray i on surface k is element i · `surfaces` + k, where `surfaces` is that of
    // `realistic_lens_info` and k is counted from 0 at the scene side, whatever the direction of travel. It
    // is NaN if the ray does not reach the surface.
    struct realistic_vectors point;
    // Number of surfaces that each ray meets, including the one that blocks it; one element per ray; may be
    // NULL.
    uint32_t *met;
    // Bytes from one element of `met` to the next.
    ptrdiff_t met_stride;
} realistic_lens_points;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Returns the `REALISTIC_ABI_VERSION` of the loaded library. A caller works with any library whose version
// is at least the version in the caller's header.
uint32_t realistic_abi_version(void);

// Returns the library's version, such as "0.1.0". The text lives as long as the library.
const char *realistic_version(void);

// Returns the optional features of the loaded library as `REALISTIC_CAPABILITY_` bits.
uint64_t realistic_capabilities(void);

// Returns the message of the last failure on this thread, one or more lines; empty if there was none. The
// text is valid until the next failure on this thread.
const char *realistic_last_error(void);

// Returns the meaning of a status in a few words; never NULL. The text lives as long as the library.
const char *realistic_status_name(int32_t status);

// Sets every member to "not given", the transform to the identity, and `struct_size` to
// `sizeof(realistic_options)`. Only `xres` and `yres` must be set afterwards.
realistic_status realistic_options_init(struct realistic_options *options, uint32_t struct_size);

// Builds a camera, which the caller frees with `realistic_camera_free`.
realistic_status realistic_camera_new(const struct realistic_options *options, struct realistic_camera **out);

// Frees a camera made by `realistic_camera_new`. Do not pass a camera made by `CreateCamera`, because its
// host deletes it.
void realistic_camera_free(struct realistic_camera *camera);

// Describes a camera.
realistic_status realistic_camera_get_info(const struct realistic_camera *camera, struct realistic_camera_info *info);

// Copies the name of a camera's lens; the text is empty for a model without a lens.
realistic_status realistic_camera_get_lens_name(const struct realistic_camera *camera,
                                                char *buffer,
                                                size_t capacity,
                                                size_t *length);

// Copies a description of the effects that the camera keeps and leaves out, and of the lens model that a
// tolerance selected. The text is for people; its wording may change.
realistic_status realistic_camera_plan(const struct realistic_camera *camera,
                                       char *buffer,
                                       size_t capacity,
                                       size_t *length);

// Generates one ray of a camera made by `CreateCamera` or `realistic_camera_new`, and returns the ray's
// weight. The weight is 0, and `*ray` is not changed, if the lens blocks the ray, a pointer is NULL, or the
// camera was not made by this library.
//
// `request` is NULL, or requests wavelengths or a reason. With a request, `ray` has room for
// `wavelengths_per_sample` rays, and the function returns the weight of the first ray. If the request is
// refused, the function returns 0, stores a message and writes nothing. The first request for a wavelength
// takes 2 to 35 ms (50 ms for a phone lens), once per camera for all threads.
float realistic_generate_ray(const struct realistic_camera *camera,
                             const struct realistic_sample *sample,
                             const struct realistic_request *request,
                             struct realistic_ray *ray);

// Generates one ray with its differentials, in little more than the time of one ray: the ray of the sample,
// and the rays one pixel to the right and one pixel down. The latter two are bit-identical to the rays of
// `realistic_generate_ray` at `image_x` + 1 and at `image_y` + 1, except that they exist even if the shutter
// is closed there. Returns the weight as `realistic_generate_ray` does, for the same `request`; returns 0
// and stores a message if `ray->struct_size` is not set.
float realistic_generate_ray_differential(const struct realistic_camera *camera,
                                          const struct realistic_sample *sample,
                                          const struct realistic_request *request,
                                          struct realistic_ray_differential *ray);

// Generates the rays of `n` samples. They are bit-identical to those of `realistic_generate_ray` and
// `realistic_generate_ray_differential`; with a `tolerance`, they agree within it. If `n` is 0, all arrays
// may be NULL.
realistic_status realistic_camera_generate_batch(const struct realistic_camera *camera,
                                                 size_t n,
                                                 const struct realistic_request *request);

// Computes the importance of `n` rays that enter the camera. It is 0 for a ray that does not reach the film,
// comes from behind, arrives while the shutter is closed, or has numbers that are not finite. A ray within
// rounding of an aperture's edge may have importance 0 although the camera's own ray passes. Returns
// `REALISTIC_STATUS_INVALID_PARAMETER` for models whose rays all begin at one point or are parallel:
// "perspective" and "orthographic" without `lens_radius`, and "environment".
realistic_status realistic_camera_importance(const struct realistic_camera *camera,
                                             size_t n,
                                             const struct realistic_importance_rays *rays,
                                             const struct realistic_importance *importance);

// Samples directions toward the lens from `n` points of the scene, in the pupil as seen from each point.
// Also computes the importance of a ray along each direction, as `realistic_camera_importance` does. A point
// that emits radiance L along a direction whose angle to the point's normal has the cosine c adds importance
// · L · c / (density · density of the point) to the picture at `image`; a sample with importance 0 counts in
// the mean. A point that is not in front of the lens between `hither` and `yon` has no direction. The first
// call for a camera builds the entrance-pupil table, which takes 20 to 100 ms on two cores.
realistic_status realistic_camera_sample_importance(const struct realistic_camera *camera,
                                                    size_t n,
                                                    const struct realistic_scene_points *points,
                                                    const struct realistic_aimed *aimed,
                                                    const struct realistic_importance *importance);

// Finds the film distance, mm, that focuses the camera of `options` on the objects in `n` zones of the
// picture; set the option `film_distance` to it afterwards. `rule` is a `realistic_autofocus_rule`. Pass one
// callback and NULL for the other: `distance` is called for several rays per zone, `contrast` for tens to
// hundreds of trial cameras. The callback is called on this thread. In `options`, `film_distance` and
// `focus_distance` must be unset, and `focus_by` must be "film". Returns
// `REALISTIC_STATUS_UNREACHABLE_FOCUS` if autofocus finds no film distance in any zone.
realistic_status realistic_autofocus(const struct realistic_options *options,
                                     const struct realistic_zone *zones,
                                     size_t n,
                                     int32_t rule,
                                     realistic_distance distance,
                                     realistic_contrast contrast,
                                     void *user,
                                     double *film_distance);

// Opens a lens, which the caller frees with `realistic_lens_free`. `lens_file` or `lens_text`, with
// `glass_catalog` and `strict`, selects the lens; `wavelength`, `zoom` and `aperture_diameter` or `fnumber`
// set it up, as for a camera. `xres`, `yres` and the transforms are not read. Any other parameter is
// refused, because it would have no effect.
realistic_status realistic_lens_new(const struct realistic_options *options, struct realistic_lens **out);

// Frees a lens.
void realistic_lens_free(struct realistic_lens *lens);

// Describes a lens.
realistic_status realistic_lens_get_info(const struct realistic_lens *lens, struct realistic_lens_info *info);

// Describes surface `number`, counted from 0 at the scene side.
realistic_status realistic_lens_get_surface(const struct realistic_lens *lens,
                                            uint32_t number,
                                            struct realistic_lens_surface *surface);

// Copies the name of a lens.
realistic_status realistic_lens_get_name(const struct realistic_lens *lens,
                                         char *buffer,
                                         size_t capacity,
                                         size_t *length);

// Finds the film distance, mm from the last vertex, at which a point on the axis `focus_distance_mm` in
// front of the **film** is sharpest: there the point's bundle of exact rays, at the lens's stop and
// wavelength, has the smallest RMS spot. The object distance may be infinite. Returns
// `REALISTIC_STATUS_UNREACHABLE_FOCUS` if the lens cannot focus at that distance; the message then states
// the nearest possible distance.
realistic_status realistic_lens_focus(const struct realistic_lens *lens,
                                      double focus_distance_mm,
                                      double *film_distance);

// Finds the distance in focus, mm from the film along the axis, for a film at `film_distance` behind the
// last vertex: infinity if the lens is focused at infinity, NaN if nothing in front of the lens is in focus.
realistic_status realistic_lens_focused_on(const struct realistic_lens *lens,
                                           double film_distance,
                                           double *focus_distance_mm);

// Finds the distance and the tilt of the film that brings the plane through three points of lens space into
// focus (Scheimpflug's rule). `points` are nine numbers in mm, x, y and z of each point, with z toward the
// scene. The tilt follows from first-order optics, the distance on the axis from exact rays. Returns
// `REALISTIC_STATUS_UNREACHABLE_FOCUS`, with the reason, if a point has no real image, the points do not
// define a plane, or the film would intersect the lens.
realistic_status realistic_lens_plane_of_focus(const struct realistic_lens *lens,
                                               const double *points,
                                               struct realistic_focused_film *film);

// Traces `n` rays through the lens from side `from` (`realistic_side`). Each ray is replaced by the point
// where it leaves the last surface and its unit direction there. A blocked ray is replaced by the point on
// the last surface that it met and its direction behind that surface; if it met none, only its direction
// changes, to unit length. Rays may start anywhere before the lens. A ray with numbers that are not finite,
// or with a direction of length 0, counts as `REALISTIC_REASON_MISSED` and does not change. Optical paths end
// where the ray does.
//
// `points` is NULL, or requests the points where the rays meet each surface. With points, rays are traced
// one after another, which is slower. The results are the same as without points, except for rounding, which
// may matter at the very edge of an aperture.
realistic_status realistic_lens_trace(const struct realistic_lens *lens,
                                      int32_t from,
                                      size_t n,
                                      const struct realistic_lens_rays *rays,
                                      const struct realistic_lens_points *points);

// Copies the names of the built-in lenses, one per line, beginning with that of the default lens. Each name
// is a valid `lens_file`.
realistic_status realistic_catalogue(char *buffer, size_t capacity, size_t *length);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

/* Samples as structure of arrays; the members of realistic_sample. */
typedef struct realistic_samples_soa {
    const float *image_x, *image_y, *lens_u, *lens_v, *time;
} realistic_samples_soa;

/* Rays as structure of arrays; the members of realistic_ray, with weight and reason. */
typedef struct realistic_rays_soa {
    float *ox, *oy, *oz, *dx, *dy, *dz, *mint, *maxt, *time, *weight;
    realistic_reason *reason;
} realistic_rays_soa;

#ifdef __cplusplus
extern "C" {
#endif

/* Fills the request of realistic_camera_generate_rays, for hosts that find the batch in a loaded library or add to it. */
static inline void realistic_request_of_structures(realistic_request *request, const realistic_sample *samples,
                                                   size_t sample_stride, realistic_ray *rays, size_t ray_stride,
                                                   float *weights, realistic_reason *reasons) {
    ptrdiff_t from = (ptrdiff_t)(sample_stride == 0 ? sizeof *samples : sample_stride);
    ptrdiff_t to = (ptrdiff_t)(ray_stride == 0 ? sizeof *rays : ray_stride);
    memset(request, 0, sizeof *request);
    request->struct_size = (uint32_t)sizeof *request;
    /* A stride of 1 is refused: structures would overlap. */
    if (from < (ptrdiff_t)sizeof *samples) from = 1;
    if (to < (ptrdiff_t)sizeof *rays) to = 1;
    /* The numbers of a structure one after another, and not its members by `->`: it need not be aligned. */
    if (samples != NULL) {
        const float *sample = (const float *)(const void *)samples;
        const realistic_input image = {sample, sample + 1, NULL, from};
        const realistic_input lens = {sample + 2, sample + 3, NULL, from}, time = {sample + 4, NULL, NULL, from};
        request->image = image, request->lens = lens, request->time = time;
    }
    if (rays != NULL) {
        float *ray = (float *)(void *)rays;
        const realistic_output origin = {ray, ray + 1, ray + 2, to}, direction = {ray + 3, ray + 4, ray + 5, to};
        const realistic_output mint = {ray + 6, NULL, NULL, to}, maxt = {ray + 7, NULL, NULL, to};
        const realistic_output ray_time = {ray + 8, NULL, NULL, to};
        request->origin = origin, request->direction = direction;
        request->mint = mint, request->maxt = maxt, request->ray_time = ray_time;
    }
    request->weight.x = weights, request->weight.stride = (ptrdiff_t)sizeof *weights;
    request->reason = reasons, request->reason_stride = (ptrdiff_t)sizeof *reasons;
}

/* Rays of `n` samples. Element i lies i * stride bytes from the first, so that a host's own larger structures can be passed
 * (pbrt-v1: 88 for `Sample`, 36 for `Ray`); a stride of 0 means tightly packed, a smaller one than the structure is refused.
 * weights[i] is 0 for a blocked ray, and rays[i] is then left as it is. `reasons` may be NULL. */
static inline realistic_status realistic_camera_generate_rays(const realistic_camera *camera, size_t n,
                                                              const realistic_sample *samples, size_t sample_stride,
                                                              realistic_ray *rays, size_t ray_stride,
                                                              float *weights, realistic_reason *reasons) {
    realistic_request request;
    realistic_request_of_structures(&request, samples, sample_stride, rays, ray_stride, weights, reasons);
    return realistic_camera_generate_batch(camera, n, &request);
}

/* Fills the request of realistic_camera_generate_rays_soa. */
static inline void realistic_request_of_arrays(realistic_request *request, const realistic_samples_soa *samples,
                                               const realistic_rays_soa *rays) {
    const ptrdiff_t number = (ptrdiff_t)sizeof(float);
    memset(request, 0, sizeof *request);
    request->struct_size = (uint32_t)sizeof *request;
    if (samples != NULL) {
        const realistic_input image = {samples->image_x, samples->image_y, NULL, number};
        const realistic_input lens = {samples->lens_u, samples->lens_v, NULL, number}, time = {samples->time, NULL, NULL, number};
        request->image = image, request->lens = lens, request->time = time;
    }
    if (rays != NULL) {
        const realistic_output origin = {rays->ox, rays->oy, rays->oz, number};
        const realistic_output direction = {rays->dx, rays->dy, rays->dz, number};
        const realistic_output mint = {rays->mint, NULL, NULL, number}, maxt = {rays->maxt, NULL, NULL, number};
        const realistic_output ray_time = {rays->time, NULL, NULL, number}, weight = {rays->weight, NULL, NULL, number};
        request->origin = origin, request->direction = direction, request->weight = weight;
        request->mint = mint, request->maxt = maxt, request->ray_time = ray_time;
        request->reason = rays->reason, request->reason_stride = (ptrdiff_t)sizeof *rays->reason;
    }
}

/* Rays of `n` samples given and taken as structure of arrays. Blocked rays as in realistic_camera_generate_rays. `time` of
 * `samples` and `mint`, `maxt`, `time` and `reason` of `rays` may be NULL. */
static inline realistic_status realistic_camera_generate_rays_soa(const realistic_camera *camera, size_t n,
                                                                  const realistic_samples_soa *samples,
                                                                  const realistic_rays_soa *rays) {
    realistic_request request;
    realistic_request_of_arrays(&request, samples, rays);
    return realistic_camera_generate_batch(camera, n, &request);
}

#ifdef REALISTIC_PBRT_ENTRY
/* What a pbrt-v1 host calls: takes its const ParamSet &, const Transform & (world to camera) and Film *, and returns its
 * Camera *, which the host deletes. NULL when there is none; the reason went to the host's Error function (where there is
 * none, to standard error) and is realistic_last_error(). Rays that the host asks for through its own vtable may raise
 * floating-point flags, but do not trap. */
realistic_camera *CreateCamera(const void *params, const void *world2cam, void *film);
/* realistic_generate_ray without a request, under the name that the assignment gives it. */
float GenerateRay(const realistic_camera *camera, const realistic_sample *sample, realistic_ray *ray);
#endif /* REALISTIC_PBRT_ENTRY */

#ifdef __cplusplus
} // extern "C"
#endif

#endif /* REALISTIC_H */

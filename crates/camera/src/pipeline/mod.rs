//! From samples to world rays; one ray and a million rays use the same loop.
//!
//! # The path of a ray
//!
//! [`Camera::trace`](crate::Camera::trace) takes input columns of samples and output columns for rays. If the
//! columns are contiguous and the shutter is global, it passes them to [`RayMaker`](ray_maker::RayMaker). Otherwise it
//! copies blocks of up to 128 samples into its own buffers, where it applies the shutter and traces neighbours, the rays
//! one pixel to the right and one pixel down. `RayMaker` selects the tracer: for single calls, for batches, or for rays
//! with wavelengths of their own. After tracing it writes each ray's range (mint, maxt) and time.
//!
//! The [`Tracer`](tracer::Tracer) of a lens is a [`Pipeline`](lanes::Pipeline). `instances` of the kernel compiles its
//! loop, `PipelinePass::group`, for each precision, vector width and instruction set. Each iteration takes up to four SIMD
//! vectors of samples to finished rays:
//!
//! 1. **Film and pupil** (`film_sampling`). With s mm per pixel, the film point is x = (xres/2 - imageX) s, y
//!    = (imageY - yres/2) s; the signs cancel the inversion of the image by the lens. The disk mapping takes
//!    (u, v) to the unit disk; the pupil mapping takes the disk to slopes dx/dz and dy/dz. J is the Jacobian
//!    determinant of the pupil mapping: a sample represents the slope area π J.
//! 2. **Lens**, through the trait `Optics`, by one of three tracers: the table of surfaces, where rays may
//!    carry a wavelength, their light or both; polynomials; or an ideal lens (`ideal`).
//! 3. **Finish**. The irradiance at a film point is E = ∫ L cos⁴θ d(slopes), θ being the angle to the axis at the film
//!    (Kolb, Mitchell and Hanrahan 1995, equation 2). The weight is the one-sample Monte Carlo estimate of E, divided by L:
//!
//!    ```text
//!    w = f T (n'/n)² π J cos⁴θ
//!    ```
//!
//!    The radiance at the film is (n'/n)² L, with the refractive index n' of the film's medium and n of the scene's.
//!
//!    With `transmission`, T is the fraction of its light that the ray still carries; otherwise T = 1. The
//!    parameter `weighting` selects f: 1 for `radiometric`; for `assignment` 1/A, where A is the area of the
//!    rear clear aperture if that is sampled, and otherwise the area of the exit pupil; for `relative` the
//!    reciprocal of E on the axis. `none` sets w = 1. The w of a valid ray is at least `f32::MIN_POSITIVE`;
//!    w = 0 marks a rejected sample. Finally the camera-to-world transform is applied, and
//!    [`Rays::store`](crate::rays::Rays) writes the result to the output columns.
//!
//! # Other tracers
//!
//! `walk` traces one ray at a time with a named refraction method, such as Heckbert's. `stock` implements
//! pbrt's stock cameras, which have no lens file. `ghosts` assigns a fraction of the samples to paths with
//! two reflections; it passes these samples to the direct tracer with NaN image coordinates, which every
//! tracer rejects. The tracing in blocks does the same for samples taken while the shutter is closed.
//! `spectral` builds the data for rays with wavelengths on first use. `compile` builds the tracers that the
//! plan selects.
//!
//! # Types
//!
//! | type | is |
//! |---|---|
//! | [`Sample`](crate::Sample), [`WorldRay`](crate::WorldRay) | one sample, one ray, with pbrt's layout |
//! | [`Samples`](crate::Samples), [`Rays`](crate::Rays) | one sample or ray, or a caller's columns of them |
//! | `Columns`, `FourRays` | internal columns, of up to 128 elements and of four rays |
//! | `SampleLanes` | a vector of samples |
//! | `FilmRays` | rays at the film |
//! | `Start`, `RayLanes`, `End` | rays before, between and after the surfaces |

pub(crate) mod body;
pub(crate) mod compile;
pub(crate) mod film_sampling;
pub(crate) mod ghosts;
pub(crate) mod ideal;
mod lanes;
pub(crate) mod on_demand;
pub(crate) mod ray_maker;
pub(crate) mod spectral;
pub(crate) mod stock;
pub(crate) mod tracer;
mod walk;

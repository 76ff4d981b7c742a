//! From samples to world rays: one way for one ray and for a million.
//!
//! # The way of a ray
//!
//! [`Camera::trace`](crate::camera::Camera::trace) takes columns of samples and room for columns of rays. Where these are slices
//! and the shutter is global it hands them to the [`RayMaker`](ray_maker::RayMaker); else it goes by blocks of 128 through columns of
//! its own, and there applies the shutter and traces neighbours. The `RayMaker` chooses a
//! [`Tracer`](tracer::Tracer), for single calls, batches, or rays with wavelengths, and writes ranges and times behind it.
//! A lens's is a [`Pipeline`](lanes::Pipeline). Its loop, which the kernel's `instances` compiles for each precision, number of
//! rays and set of instructions, takes a group of vectors of samples from beginning to end:
//!
//! 1. **Film and pupil** (`film_sampling`). With s mm per pixel the film point is x = (xres/2 - imageX) s, y = (imageY - yres/2) s:
//!    the picture is upright. The disk's map takes (u, v) to the unit disk, the pupil's map from there to slopes x' = dx/dz, y' = dy/dz
//!    with the Jacobian J: the sample stands for the slope area π J. `transmission` multiplies J by T, the share of its light
//!    that the lens leaves the ray.
//! 2. **Lens**: an `Optics`: the kernel's table, that for a wavelength per ray, polynomials, or an ideal lens (`ideal`).
//! 3. **Finish**. The irradiance of the film is E = ∫ L cos⁴θ dx' dy', θ being the ray's angle to the axis at the film (C. Kolb,
//!    D. Mitchell and P. Hanrahan, "A Realistic Camera Model for Computer Graphics", SIGGRAPH 1995, equation 2). The weight is
//!    its estimate by one sample, over L:
//!
//!    ```text
//!    w = f π J T cos⁴θ
//!    ```
//!
//!    f is 1 for `radiometric`; 1/A for `assignment`, A being the area of the rear clear aperture or the exit pupil; for
//!    `relative` 1 over the irradiance on the axis. With `none` w is 1. It is at least `f32::MIN_POSITIVE`, for 0 says that there is no
//!    ray: J is NaN, w above `f32::MAX`, the lens blocks it, or its numbers are no ray's. The placement's transform takes
//!    rays to the world, and [`Rays::store`](crate::camera::rays::Rays) to their columns.
//!
//! # Other tracers
//!
//! `walk` traces one ray at a time by a named method of refraction. `stock` has the models without a lens. `ghosts` sends a
//! share of the samples along paths with two reflections; to the direct tracer those are no image points (NaN), of which no tracer
//! makes a ray. A block does the same where the shutter is closed. `spectral` builds what rays with wavelengths need when
//! they are first asked for. `compile` chooses by the plan.
//!
//! # Types
//!
//! | type | is |
//! |---|---|
//! | [`Sample`](crate::camera::Sample), [`WorldRay`](crate::camera::WorldRay) | one, laid out as pbrt's |
//! | [`Samples`](crate::camera::Samples), [`Rays`](crate::camera::Rays) | one, or columns of a caller's: slices or members of structures |
//! | `Columns`, `FourRays` | columns of our own: up to 128, and four side by side |
//! | `SampleLanes`, `FilmRays`, `Start`, `RayLanes`, `End` | a vector of samples, on film, before, in and behind the lens |

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

//! From samples to world rays: film ray, trace, weight and world ray, for one sample, four, or many.
//!
//! # Method
//!
//! A sample is a raster point, a lens sample (u, v) and a time. In vectors of samples:
//!
//! 1. Film point (`film_sampling`). With s mm per pixel, x = (xres/2 - imageX) s and y = (imageY - yres/2) s: the image on film
//!    is upside down and mirrored.
//! 2. Direction (`film_sampling`). The disk's map takes (u, v) to the unit disk, the pupil's map from its point (X, Y) to slopes
//!    x' = dx/dz and y' = dy/dz. J is the Jacobian |∂(x', y')/∂(X, Y)| of the pupil's map there: the sample
//!    stands for the slope area π J. `FilmRays::area_per_pi` is J; with `transmission`, film sampling
//!    multiplies it by T, the share of its light that the lens leaves the ray.
//! 3. Through the lens: an `Optics` of the kernel, of polynomials or of an ideal lens, or a walk by a named method (`walk`).
//! 4. Weight (`Job::finish` in `lanes`). The irradiance of the film is E = ∫ L cos θ dω, θ being the angle
//!    between ray and axis at the film. With dω = cos³θ dx' dy' that is ∫ L cos⁴θ dx' dy', whose estimate by
//!    one sample is π J cos⁴θ L. So the weight is
//!
//!    ```text
//!    w = f π J T cos⁴θ
//!    ```
//!
//!    T is 1 without `transmission`. f depends on `weighting` (`weight_factor` in `models/lens_parts.rs`, of
//!    an ideal lens in `models/ideal.rs`): 1 for `radiometric`; 1/A for `assignment`, A being the area of
//!    the rear element's clear aperture or, unless that is the `pupil`, of the exit pupil; for `relative` 1
//!    over the irradiance on the axis of L = 1 and T = 1. With `none` w is 1 whatever J and θ are, and
//!    `transmission` and `ghosts` change nothing. `CameraBody::weight` is f, `LaneBody::weight` π f. A stock
//!    camera's rays have w = 1.
//!
//!    Limits: a ray whose `area_per_pi` is NaN is blocked (dark film, or a wavelength out of range), and
//!    so is one whose w is above `f32::MAX`. w is at least `f32::MIN_POSITIVE`, for a blocked ray has weight
//!    0, and nothing else of it is written. `RayStore::store` blocks a ray whose origin is not finite or
//!    whose direction is not a unit vector. Polynomials give film points out of their range the area NaN,
//!    too, and `Pipeline` traces those anew by the whole lens.
//!
//!    After that `ghosts` divides w by 1 - g, g being the share of the samples that go along paths with two
//!    reflections; the weight of such a ray is divided by g times the probability of its pair of surfaces.
//!    A shutter that is not `global` multiplies the weight last (`any_camera`), to `f32::MIN_POSITIVE` at
//!    least, and with `none`, too. `walk` and `ghosts` have the same formula for one ray at a time.
//!
//!    For a disk of area A in a plane at distance Z, π J cos⁴θ is the A cos⁴θ / Z² of C. Kolb, D. Mitchell
//!    and P. Hanrahan, "A Realistic Camera Model for Computer Graphics", SIGGRAPH 1995, equation 2.
//! 5. World ray: the placement's transform, in the same vectors. Range and time come last (`ray_maker`).
//!
//! `lanes` has the pass of vectors, once for all optics; `ideal` and `stock` are the models without a prescription, `spectral` a
//! wavelength per ray, `ghosts` a share of the samples along paths with two reflections. `tracer` is what a camera asks of any
//! of them, and `compile` has the match on what the plan decided. `body` is the camera without its lens.
//!
//! # How a host gets 1,000 rays
//!
//! A host fills a `realistic_request`: where the first number of each array lies, and how many bytes farther
//! the next. Two inline functions of the header do that for it: `realistic_camera_generate_rays` for arrays
//! of structures, `realistic_camera_generate_rays_soa` for structures of arrays.
//! `realistic_camera_generate_batch` (`abi/batch/request.rs`) checks, before it reads or writes any number,
//! that required arrays are there, that the numbers of an array do not overlap and that memory can hold so
//! many. `CheckedRequest::answer` (`abi/batch/answer.rs`) goes one of three ways:
//!
//! - `CheckedRequest::one` for a single ray, without wavelength and neighbours: `Camera::trace_one`.
//! - `CheckedRequest::straight` lends all arrays as slices, where in every array the numbers lie side by side and are
//!   aligned, times are given and each sample has one ray.
//! - `CheckedRequest::in_blocks` takes 128 rays at a time (`BLOCK` there), copies samples in and rays out where arrays
//!   are no slices, and lends those that are.
//!
//! The last two call `Camera::rays`, with wavelengths `Camera::rays_at`, with neighbours
//! `Camera::ray_differentials` or `Camera::ray_differentials_at`. `Camera::rays` hands samples and rays to
//! `RayMaker::many` (by blocks of 384, `BLOCK` in `arrays`, where a shutter is to dim the rays) and that to
//! the model's `Tracer::many` (a `GhostTracer`'s takes blocks of 384, too), which comes down to
//! `lanes::trace`: the widest vectors that the processor has (`in_registers`), four of them side by side
//! (`Through::group`). `Job::prepare` loads the samples of a vector and makes film rays (of all four vectors
//! at once where `Lanes::PREPARED_TOGETHER`), `Job::start` takes them to the first vertex plane,
//! `Optics::enter`, `through` and `leave` take them through the lens, and `Job::finish` weighs and stores
//! them. `RayMaker` writes range and time. A range that all rays of the camera share stands in the copies of
//! `in_blocks` from the beginning. Where reasons are requested, `Handle::reason` finds that of each blocked
//! ray by itself, after the batch or its block.
//!
//! In slices, by AVX-512 and in double precision, 1,000 rays are 125 vectors of eight: 31 groups of four, and
//! one vector alone. So are they in blocks: seven of 16 vectors and one of 13.
//!
//! What holds the numbers on their way:
//!
//! | type | for | made by | read by |
//! |---|---|---|---|
//! | `Strided` | numbers of the caller at any distance | `request.rs` | `answer.rs` |
//! | `Copies`, `Column` | a block of them side by side | `CheckedRequest::in_blocks` | the same, as slices |
//! | `SampleArrays` | many samples, borrowed: five slices | `answer.rs`, Rust callers | `Tracer::many` |
//! | `SampleBlock<N>` | up to N samples, owned | callers, differentials | `Tracer::four` |
//! | `Sample` | one sample, laid out as pbrt's | hosts | `Tracer::one` |
//! | `SampleLanes<L>` | a vector of samples | `SampleLanes::load` | a `FilmSource`, a `View` |
//! | `FilmRays<L>` | points on film, slopes, areas | a `FilmSource` | `Job::start`; one in double precision, the search for a reason |
//! | `Start<L>` | rays before the first surface | `from_plane`, `anywhere` | `Optics::enter` |
//! | `RayLanes<L>` | rays on their way: point, direction, cos²θ at the film, whether they pass | `RayLanes::enter` | the kernel's steps |
//! | `Group<T, U>` | up to U vectors side by side | `Through::group` | `Optics::through` |
//! | `End<L>` | rays behind the lens | `Optics::leave` | `Job::finish` |
//! | `RangedRays<L>` | rays of a stock camera, with a range each | a `View` | `RayStore::store` |
//! | `WorldRay`, `OneRay` | one ray, laid out as pbrt's; the same with its weight, to be written | `RayStore::store` | hosts |
//! | `RayArrays` | many rays, borrowed: origin, direction, weight, perhaps range and time | `answer.rs`, Rust callers | `RayStore::store` writes, hosts read |
//! | `RayBlock<N>` | up to N rays, owned | callers, differentials | the same |
//! | `RayDifferential` | a ray and its two neighbours | `Camera::ray_differential` | Rust callers; many are three `RayArrays` |
//!
//! Lanes load the three kinds of samples by the trait `SampleStore` and store the three kinds of rays by
//! `RayStore`, so that none is copied into another, but for up to four of a batch, which take the code of four
//! (`by_four`). Rays from the scene and those that the plan or a pupil's builder tries have no samples: they
//! are `PlaneRays` and `LensRays`, arrays of the kernel's own callers, and take the
//! same `Optics`.

pub(crate) mod arrays;
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

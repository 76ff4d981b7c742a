//! Measurements of the library: errors against an extended-precision reference, run times, and numerical stability. The
//! program's `report`, `refractions`, `pupil`, `disks` and `plan` print these measurements; the benches use this
//! crate's clock and its rays.
//!
//! | module | contents |
//! |---|---|
//! | [`results`] | quantiles, Pareto fronts and tables of results |
//! | [`timing`] | run times on a busy machine, and a description of the machine |
//! | [`mod@reference`] | rays in 30 and in 77 digits, and the condition number of a ray |
//! | [`subject`] | a lens with film behind it, and rays that get through |
//! | [`pupil`] | the outline of the true pupil; the uniformity of points in a disk |
//! | [`render`] | the renderer, shared with the program, which has the scenes |
//! | [`methods`] | every method to trace rays through a lens, in one list |
//! | [`columns`] | samples and rays in columns that own their memory |
//! | [`accuracy`] | error against run time: rays, film irradiance, pupils, pictures; a whole report in one run |
//! | [`stray`] | the fate of the light that enters a lens, photon by photon |
//! | [`stability`] | extreme lenses and rays with known answers, for every tracer |

pub mod accuracy;
pub mod columns;
pub mod methods;
pub mod pupil;
pub mod reference;
pub mod render;
pub mod results;
pub mod stability;
pub mod stray;
pub mod subject;
pub mod timing;

/// Samples in a batch that fits in the first-level cache.
pub const BLOCK: usize = 384;

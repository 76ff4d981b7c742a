//! What the library says about itself: errors against an extended-precision reference, run times, and
//! numerical stability. The program's `report`, `refractions`, `pupil`, `disks` and `plan` print what is
//! measured here, and the benches share its clock and its rays.
//!
//! | room | what it holds |
//! |---|---|
//! | [`results`] | quantiles and fronts of numbers, and the tables that they are written as |
//! | [`timing`] | run times on a busy machine, and what the machine is |
//! | [`mod@reference`] | double-double rays, and the condition number of a ray |
//! | [`subject`] | a lens with film behind it, and rays that get through |
//! | [`pupil`] | the outline of the true pupil; how evenly points lie in a disk |
//! | [`render`] | the renderer that the program uses, too; its scenes are the program's |
//! | [`methods`] | every way to take rays through a lens, in one list |
//! | [`columns`] | samples and rays as columns of one's own |
//! | [`accuracy`] | error against run time: rays, film irradiance, pupils, pictures; all of a report in one run |
//! | [`stray`] | where the light that enters a lens goes, photon by photon |
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

/// Samples in a batch, as many as stay in the first cache.
pub const BLOCK: usize = 384;

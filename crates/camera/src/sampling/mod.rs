//! The origins of rays: the film, mappings of the unit square to the disk, disks centred on the axis, and the
//! warped pupil.
//!
//! From a film point and a lens sample (u, v), this module computes the slopes of a ray and the slope area
//! per sample. The camera computes weights from that area.

pub(crate) mod disk;
pub mod film;
pub(crate) mod film_rays;
pub(crate) mod film_surface;
pub(crate) mod posed_pupil;
pub(crate) mod pupil_disk;
pub(crate) mod pupil_map;
pub(crate) mod pupil_sampler;

pub use disk::DiskMapping;
pub use film_surface::FilmSurface;
pub use posed_pupil::PosedPupil;
pub use pupil_disk::{PupilDisk, PupilSample};
pub use pupil_map::{BuildReport, GivenUp, MapFailure, WarpedPupil};
pub(crate) use pupil_sampler::PupilSampler;

//! The origins of rays: the film, mappings of the unit square to the disk, disks about the axis, and the warped pupil.
//!
//! Takes a film point and a lens sample (u, v); returns the slopes of a ray and the area in slopes per sample. The
//! camera computes weights from that area.

pub mod disk;
pub mod film;
pub mod film_rays;
pub mod pupil_disk;
pub mod pupil_map;
pub mod pupil_sampler;

pub use disk::DiskMapping;
pub use pupil_disk::{PupilDisk, PupilSample};
pub use pupil_map::{BuildReport, GivenUp, MapFailure, RectanglePupil, WarpedPupil};
pub use pupil_sampler::PupilSampler;

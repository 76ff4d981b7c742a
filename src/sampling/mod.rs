//! Where rays start: the film, mappings of the unit square to the disk, disks about the axis, and the warped pupil.
//!
//! A film point and a lens sample (u, v) in; the slopes of a ray and the area in slope that it stands for out. Weights are
//! made from that area by the camera.

pub(crate) mod disk;
pub(crate) mod film;
pub(crate) mod film_rays;
pub(crate) mod pupil_disk;
pub(crate) mod pupil_map;
pub(crate) mod pupil_sampler;

pub use disk::DiskMapping;
pub use pupil_disk::{PupilDisk, PupilSample};
pub use pupil_map::{BuildReport, GivenUp, MapFailure, RectanglePupil, WarpedPupil};
pub(crate) use pupil_sampler::PupilSampler;

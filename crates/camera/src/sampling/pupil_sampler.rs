//! The region to which a camera's lens samples are mapped: a disk centred on the axis, or the true pupil of
//! each film point.

use std::sync::Arc;

use super::{PosedPupil, PupilDisk, PupilSample, WarpedPupil, film_rays::FilmRays};
use realistic_simd::{Cpu, Lanes};

/// The region to which lens samples are mapped.
#[derive(Clone, Debug)]
pub enum PupilSampler {
    /// A disk centred on the axis.
    Disk(PupilDisk),
    /// The true pupil of each film point.
    Warped(Arc<WarpedPupil>),
    /// The pupils of film that is tilted or curved.
    Posed(Arc<PosedPupil>),
}

impl PupilSampler {
    /// Returns the disk centred on the axis; `None` if the true pupil is sampled.
    pub fn disk(&self) -> Option<&PupilDisk> {
        match self {
            Self::Disk(disk) => Some(disk),
            Self::Warped(_) => None,
            Self::Posed(pupil) => pupil.disk(),
        }
    }

    /// Returns the film radius beyond which no light arrives, mm, if it is known
    /// ([`WarpedPupil::image_radius`]).
    pub fn image_radius(&self) -> Option<f64> {
        match self {
            Self::Disk(_) | Self::Posed(_) => None,
            Self::Warped(pupil) => pupil.image_radius(),
        }
    }

    /// Returns the ray from a film point, mm, that corresponds to a point of the unit disk: the point where
    /// the ray crosses the plane through the film's centre perpendicular to the axis, and its slope there;
    /// `None` if the film is dark at the film point.
    pub fn sample(&self, film: [f64; 2], disk: [f64; 2]) -> Option<([f64; 2], PupilSample)> {
        match self {
            Self::Disk(pupil) => Some((film, pupil.sample(film, disk))),
            Self::Warped(pupil) => Some((film, pupil.sample(film, disk)?)),
            Self::Posed(pupil) => pupil.sample(film, disk),
        }
    }

    /// Sets the area per sample, divided by π, of rays with given slopes, NaN outside the sampled region.
    /// Replaces the rays' points in the plane through the film's centre perpendicular to the axis by points
    /// of the flat film. Returns the ratio of the flat film's area to that of its surface.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn areas<L: Lanes<Scalar = f64>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &mut [FilmRays<L>; U],
    ) -> [L; U] {
        match self {
            Self::Disk(pupil) => {
                for ray in rays {
                    ray.area_per_pi = pupil.lane_disk().areas(cpu, ray.point, ray.slopes);
                }
            }
            Self::Warped(pupil) => pupil.areas(cpu, &pupil.lane_pupil(), rays),
            Self::Posed(pupil) => return pupil.areas(cpu, &pupil.constants(), rays),
        }
        [L::splat(cpu, 1.0); U]
    }
}

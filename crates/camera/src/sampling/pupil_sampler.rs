//! The region of a camera's lens samples: a disk about the axis, or the true pupil of each film point.

use std::sync::Arc;

use super::{PosedPupil, PupilDisk, PupilSample, WarpedPupil, film_rays::FilmRays};
use realistic_simd::{Cpu, Lanes};

/// The region to which lens samples are mapped.
#[derive(Clone, Debug)]
pub enum PupilSampler {
    /// A disk about the axis.
    Disk(PupilDisk),
    /// The true pupil of each film point.
    Warped(Arc<WarpedPupil>),
    /// The pupils of film that is tilted or curved.
    Posed(Arc<PosedPupil>),
}

impl PupilSampler {
    /// Returns the disk about the axis; `None` if the true pupil is sampled.
    pub fn disk(&self) -> Option<&PupilDisk> {
        match self {
            Self::Disk(disk) => Some(disk),
            Self::Warped(_) => None,
            Self::Posed(pupil) => pupil.disk(),
        }
    }

    /// Returns the film radius from which on no light arrives, mm, if it is known ([`WarpedPupil::image_radius`]).
    pub fn image_radius(&self) -> Option<f64> {
        match self {
            Self::Disk(_) | Self::Posed(_) => None,
            Self::Warped(pupil) => pupil.image_radius(),
        }
    }

    /// Returns the ray from a film point, mm, for a point of the unit disk: the point where it crosses the film's plane
    /// across the axis, and its slope there; `None` if the film is dark there.
    pub fn sample(&self, film: [f64; 2], disk: [f64; 2]) -> Option<([f64; 2], PupilSample)> {
        match self {
            Self::Disk(pupil) => Some((film, pupil.sample(film, disk))),
            Self::Warped(pupil) => Some((film, pupil.sample(film, disk)?)),
            Self::Posed(pupil) => pupil.sample(film, disk),
        }
    }

    /// Sets the area per sample, over π, of rays with slopes, NaN outside the sampled region, and replaces their points
    /// in the plane across the axis by those of the film. Returns the flat film's area over that of its surface.
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

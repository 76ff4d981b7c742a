//! Where a camera's lens samples lie: on a disk about the axis, or in the true pupil of each film point.

use std::sync::Arc;

use super::{PupilDisk, PupilSample, WarpedPupil, film_rays::FilmRays};
use crate::trace::kernel::{Cpu, Lanes};

/// What lens samples are mapped to.
#[derive(Clone, Debug)]
pub(crate) enum PupilSampler {
    /// A disk about the axis.
    Disk(PupilDisk),
    /// The true pupil of each film point.
    Warped(Arc<WarpedPupil>),
}

impl PupilSampler {
    /// The disk about the axis; `None` where it is the true pupil that is sampled.
    pub fn disk(&self) -> Option<&PupilDisk> {
        match self {
            Self::Disk(disk) => Some(disk),
            Self::Warped(_) => None,
        }
    }

    /// The film radius from which on no light arrives, mm, where it is known ([`WarpedPupil::image_radius`]).
    pub fn image_radius(&self) -> Option<f64> {
        match self {
            Self::Disk(_) => None,
            Self::Warped(pupil) => pupil.image_radius(),
        }
    }

    /// The slope that a point of the unit disk stands for at a film point, mm; `None` where the film is dark.
    pub fn sample(&self, film: [f64; 2], disk: [f64; 2]) -> Option<PupilSample> {
        match self {
            Self::Disk(pupil) => Some(pupil.sample(film, disk)),
            Self::Warped(pupil) => pupil.sample(film, disk),
        }
    }

    /// Gives rays with slopes the area that such samples stand for, over π; NaN outside what is sampled.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn areas<L: Lanes<Scalar = f64>, const U: usize>(&self, cpu: Cpu<L>, rays: &mut [FilmRays<L>; U]) {
        match self {
            Self::Disk(pupil) => {
                for ray in rays {
                    ray.area_per_pi = pupil.lane_disk().areas(cpu, ray.point, ray.slopes);
                }
            }
            Self::Warped(pupil) => pupil.areas(cpu, &pupil.lane_pupil(), rays),
        }
    }
}

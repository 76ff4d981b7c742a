//! Where a camera's lens samples lie: on a disk about the axis, or in the true pupil of each film point.

use std::sync::Arc;

use super::{PupilDisk, PupilSample, WarpedPupil};

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

    /// The slope that a point of the unit disk stands for at a film point, mm; `None` where the film is dark.
    pub fn sample(&self, film: [f64; 2], disk: [f64; 2]) -> Option<PupilSample> {
        match self {
            Self::Disk(pupil) => Some(pupil.sample(film, disk)),
            Self::Warped(pupil) => pupil.sample(film, disk),
        }
    }

    /// The area, slope², that a sample with these slopes at a film point, mm, stands for; `None` outside what is sampled.
    pub fn area_at(&self, film: [f64; 2], slopes: [f64; 2]) -> Option<f64> {
        match self {
            Self::Disk(pupil) => pupil.area_at(film, slopes),
            Self::Warped(pupil) => pupil.area_at(film, slopes),
        }
    }
}

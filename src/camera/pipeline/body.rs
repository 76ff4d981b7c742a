//! A camera without its lens: the film and what is sampled there, what a ray weighs, and where the camera stands.

use super::film_sampling::FilmSampling;
use crate::{
    camera::{
        film::Film,
        placement::{Placement, ToWorld},
    },
    sampling::{DiskMapping, PupilSampler, disk::Turns},
};

/// What stands before and behind the lens.
#[derive(Clone, Debug)]
pub(crate) struct CameraBody {
    pub film: Film,
    /// z of the film, lens space, mm.
    pub film_z: f64,
    pub mapping: DiskMapping,
    pub sampler: PupilSampler,
    /// The weight of a ray is this times cos⁴ and the slope area it stands for; `None`: it is 1.
    pub weight: Option<f64>,
    pub placement: Placement,
    pub units_per_mm: f64,
}

impl CameraBody {
    /// The film's side in a precision.
    pub fn film_sampling<S: Turns>(&self) -> FilmSampling<S> {
        FilmSampling::new(&self.film, self.mapping, &self.sampler)
    }

    /// The world's side in a precision.
    pub fn to_world<S: Turns>(&self) -> ToWorld<S> {
        ToWorld::new(&self.placement, self.units_per_mm)
    }
}

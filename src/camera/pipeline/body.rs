//! A camera without its lens: the film and what is sampled there, what a ray weighs, and where the camera stands.

use std::{f64::consts::PI, sync::Arc};

use super::film_sampling::FilmSampling;
use crate::{
    camera::placement::{Placement, ToWorld},
    light::FilmTransmission,
    plan::FilmSide,
    sampling::disk::Turns,
};

/// What stands before and behind the lens.
#[derive(Clone, Debug)]
pub(crate) struct CameraBody {
    pub film_side: FilmSide,
    /// The weight of a ray is this times cos⁴ and the slope area it stands for; `None`: it is 1.
    pub weight: Option<f64>,
    /// What of the light the lens leaves, which counts with the area that a ray stands for.
    pub transmission: Option<Arc<FilmTransmission>>,
    pub placement: Placement,
    pub units_per_mm: f64,
}

impl CameraBody {
    /// The film's side in a precision.
    pub fn film_sampling<S: Turns>(&self) -> FilmSampling<S> {
        FilmSampling::new(&self.film_side, self.transmission.as_deref())
    }

    /// All of it in a precision.
    pub fn lane_body<S: Turns>(&self) -> LaneBody<S> {
        LaneBody {
            film: self.film_sampling(),
            film_z: self.film_side.z,
            weight: self.weight.map(|weight| S::from_f64(PI * weight)),
            to_world: ToWorld::new(&self.placement, self.units_per_mm),
        }
    }
}

/// [`CameraBody`], for lanes of a precision: the same type whatever the lens is traced by, so that what is compiled for it
/// is compiled once.
pub(crate) struct LaneBody<S> {
    pub film: FilmSampling<S>,
    /// z of the film, lens space, mm.
    pub film_z: f64,
    /// The weight of a ray is this times cos⁴ and the slope area it stands for, over π; `None`: it is 1. The sampler
    /// divides areas by π, so that a disk's is its radius squared; the π comes back in this factor.
    pub weight: Option<S>,
    pub to_world: ToWorld<S>,
}

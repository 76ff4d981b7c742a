//! Light tracing: the importance We of a ray from the scene, and directions from a point of the scene
//! toward the lens.
//!
//! A ray that enters the lens carries importance (E. Veach, *Robust Monte Carlo Methods for Light Transport Simulation*,
//! 1997, §4.5-4.6; `We` of M. Pharr, W. Jakob and G. Humphreys, *Physically Based Rendering*, 3rd ed. 2016, §16.1): We
//! multiplies L cosθ dA dω, dA being area on the plane z = 0 of camera space in square world units. The rays that a camera
//! makes of evenly spread samples have a density in the same measure, and **the weight of a ray is We divided by that
//! density**. As cosθ dA dω is the same before and behind a lens, the density is 1/(A_film π J cos⁴θ'), where π J is the slope
//! area that a sample stands for (A/Z² of a disk), θ' the ray's angle to the axis at the film, and A_film the film's area in square
//! world units. We follows from the weight: 1/A_film for `radiometric` weights, times the ray's transmission where that is asked
//! for. An ideal lens keeps slopes instead of cosθ dA dω; there, and for the
//! stock cameras, the density is that of their rays, too.
//!
//! `pose` takes rays from the world into camera space. `lens` traces them through a lens, `linear` through ideal lenses and
//! stock cameras; both also choose directions toward the lens from points of the scene. For a lens these points are taken as
//! its projection center sees them (`seen_point`), and `entrance` tabulates and samples the pupil that they see. `film`
//! evaluates We and the density where a ray meets the film. `adjoint` joins these steps, which hand on a `block` of rays.

mod adjoint;
pub(crate) mod block;
mod entrance;
mod film;
mod front;
mod lens;
mod linear;
mod pose;
mod seen_point;

pub use adjoint::AdjointCamera;
pub(crate) use lens::AdjointLens;
pub(crate) use linear::{Linear, PlaneMap};

use crate::camera::model::Model;
use crate::lens::Ray;
use thiserror::Error;

/// What a ray that enters a camera counts. All 0 where it counts nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Importance {
    /// Raster coordinates, pixels, where it reaches the film.
    pub raster: [f64; 2],
    /// We: what L cosθ dA dω is multiplied by, dA in square world units on the plane z = 0 of camera space; with the shutter's
    /// share at the ray's time.
    pub importance: f64,
    /// The density of the camera's own rays there, per cosθ dA dω: We is this times the weight.
    pub density: f64,
    /// A density per area on the plane z = 0, in square world units: 1 over the area of the front clear aperture, or of the
    /// lens of a camera without a prescription.
    pub area_density: f64,
    /// The density per solid angle that goes with it: the product of the two is `density` times cosθ.
    pub solid_angle_density: f64,
}

/// A point of the scene that asks for a direction toward the lens.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScenePoint {
    /// World space.
    pub point: [f32; 3],
    /// Where in the pupil that the point sees, two numbers in [0, 1).
    pub sample: [f32; 2],
    /// When, in the unit of `shutteropen`.
    pub time: f32,
}

/// A direction from a point of the scene toward the lens.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aimed {
    /// Where it meets the front of the lens, world space: what lies between the point and this hides the light.
    pub origin: [f64; 3],
    /// Unit vector from the point toward there.
    pub direction: [f64; 3],
    /// Density of the direction, per solid angle at the point; 0 where there is none that gets through.
    pub density: f64,
    /// What the ray counts.
    pub importance: Importance,
}

/// A direction toward the lens in camera space: a ray from the front on, with a unit direction, the direction's density per
/// solid angle at the point that it comes from, and what the ray counts, if anything.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LensDirection {
    pub ray: Ray,
    pub density: f64,
    pub we: Option<FilmWe>,
}

/// What a ray counts in camera space; the weight 0 is that of one that counts nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FilmWe {
    /// Raster coordinates, pixels.
    pub raster: [f64; 2],
    /// The weight that the camera gives the same ray from the film.
    pub weight: f64,
    /// The density of its rays from the film, per cosθ dA dω; the square of camera space's unit is dA's.
    pub density: f64,
}

/// Why a camera has no importance.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ImportanceError {
    /// Its rays begin in one point, or run in one direction only.
    #[error(
        "model \"{model}\" {}: its importance We is infinite or 0, and not defined; {advice}",
        if *parallel { "without a lens has parallel rays" } else { "without a lens has all its rays through one point" }
    )]
    NoArea {
        /// The model.
        model: Model,
        /// Whether they are parallel.
        parallel: bool,
        /// What to give instead.
        advice: &'static str,
    },
    /// Its rays are so nearly parallel that single precision does not hold their density.
    #[error(
        "model \"{model}\" is focused so far away that its rays are parallel in single precision, and has no importance; give \
         \"focaldistance\" up to {farthest}"
    )]
    Parallel {
        /// The model.
        model: Model,
        /// The farthest distance to give, world units.
        farthest: String,
    },
}

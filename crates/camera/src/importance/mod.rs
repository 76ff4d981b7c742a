//! Light tracing: the importance We of a ray from the scene, and directions from a point of the scene
//! toward the lens.
//!
//! A ray that enters the lens carries importance (E. Veach, *Robust Monte Carlo Methods for Light Transport
//! Simulation*, 1997, §4.5-4.6; `We` of M. Pharr, W. Jakob and G. Humphreys, *Physically Based Rendering*, 3rd ed.
//! 2016, §16.1): We multiplies L cosθ dA dω, where dA is area on the plane z = 0 of camera space in square world units.
//! A camera's rays from uniformly distributed samples have a density in the same measure, and **the weight of
//! a ray is We divided by that density**. A lens conserves n² cosθ dA dω, n being the index on either side: with n in
//! the scene and n' at the film, the density is (n/n')²/(A_film π J cos⁴θ'), where π J is the slope area per sample
//! (A/Z² for a disk), θ' the ray's angle to the axis at the film, and A_film the film's area in square world units. We
//! follows from the weight: it is 1/A_film for `radiometric` weights, whatever the media, times the ray's transmission
//! if the camera includes transmission. The factor (n'/n)² of the weight is that of the density's reciprocal. An ideal
//! lens conserves slopes instead of cosθ dA dω; for an ideal lens and for a stock camera, the density is that of the
//! rays which that camera itself generates.
//!
//! `pose` transforms rays from the world into camera space. `lens` traces them through a lens, `linear`
//! through ideal lenses and stock cameras; both also sample directions toward the lens from points of the
//! scene. For a lens, these points are described as seen from the lens's projection centre (`seen_point`),
//! and `entrance` tabulates and samples the pupil as seen from these points. `film` evaluates We and the
//! density where a ray meets the film. `adjoint` combines these steps, which process one `block` of rays at a
//! time.

mod adjoint;
pub mod block;
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

use crate::model::Model;
use thiserror::Error;

/// The importance of a ray that enters a camera. All fields are 0 for a ray that does not reach the film.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Importance {
    /// Raster coordinates, pixels, of the point where the ray reaches the film.
    pub raster: [f64; 2],
    /// We, the factor that multiplies L cosθ dA dω, with dA in square world units on the plane z = 0 of
    /// camera space; includes the shutter's transmission at the ray's time.
    pub importance: f64,
    /// Density of the camera's own rays at this ray, per cosθ dA dω: We is this density times the weight.
    pub density: f64,
    /// Density per area on the plane z = 0, per square world unit: the reciprocal of the area of the front
    /// clear aperture or, for a camera without a prescription, of the lens.
    pub area_density: f64,
    /// Density per solid angle that corresponds to `area_density`: the product of the two is `density` times
    /// cosθ.
    pub solid_angle_density: f64,
}

/// A point of the scene from which a direction toward the lens is requested.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScenePoint {
    /// Position in world space.
    pub point: [f32; 3],
    /// Sample (u, v) in [0, 1]² of the pupil that the point sees.
    pub sample: [f32; 2],
    /// Time, in the unit of `shutter_open`.
    pub time: f32,
}

/// A direction from a point of the scene toward the lens.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Aimed {
    /// The point where the direction meets the front of the lens, world space. An object between the scene
    /// point and this point blocks the light.
    pub origin: [f64; 3],
    /// Unit vector from the scene point toward `origin`.
    pub direction: [f64; 3],
    /// Density of the direction, per solid angle at the scene point; 0 if no direction passes the lens.
    pub density: f64,
    /// Importance of the ray.
    pub importance: Importance,
}

/// The importance of a ray in camera space; the weight is 0 for a ray without importance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmWe {
    /// Raster coordinates, pixels.
    pub raster: [f64; 2],
    /// The weight that the camera gives the same ray when it traces it from the film.
    pub weight: f64,
    /// Density of the camera's rays from the film, per cosθ dA dω; dA in square units of camera space.
    pub density: f64,
}

/// The reason why a camera has no importance.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ImportanceError {
    /// The camera's rays all begin at one point or are parallel.
    #[error(
        "model \"{model}\" {}: its importance We is infinite or 0, and not defined; {advice}",
        if *parallel { "without a lens has parallel rays" } else { "without a lens has all its rays through one point" }
    )]
    NoArea {
        /// The model.
        model: Model,
        /// Whether the rays are parallel.
        parallel: bool,
        /// Advice to the user.
        advice: &'static str,
    },
    /// The rays are so nearly parallel that their density does not fit in single precision.
    #[error(
        "model \"{model}\" is focused so far away that its rays are parallel in single precision, and has no importance; give \
         \"focal_distance\" up to {farthest}"
    )]
    Parallel {
        /// The model.
        model: Model,
        /// Farthest distance that has an importance, world units.
        farthest: String,
    },
}

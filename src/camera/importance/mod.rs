//! Light tracing: the importance We of a ray from the scene, and directions from a point of the scene
//! toward the lens.
//!
//! A ray that enters the lens carries importance (E. Veach, *Robust Monte Carlo Methods for Light Transport Simulation*,
//! 1997, §4.5-4.6; `We` of M. Pharr, W. Jakob and G. Humphreys, *Physically Based Rendering*, 3rd ed. 2016, §16.1): We
//! multiplies L cosθ dA dω, dA being area on the plane z = 0 of camera space in square world units. The rays that a camera
//! makes of evenly spread samples have a density in the same measure, and **the weight of a ray is We over that
//! density**. As cosθ dA dω is the same before and behind a lens, the density is 1/(A_film a cos⁴θ'), where a is the slope
//! area that a sample stands for (A/Z² of a disk) and A_film the film's area in square world units; We follows from the
//! weight: 1/A_film for `radiometric` weights. An ideal lens keeps slopes instead of cosθ dA dω; there, and for the
//! stock cameras, the density is that of their rays, too.
//!
//! `stand` takes rays from the world into camera space; `lens` traces them through a lens, `linear` through ideal lenses
//! and stock cameras, and both aim at the lens from points, which `spot` has as they are seen from the lens, through its
//! pupil as `entrance` tabulates it; `film` says what a ray at the film counts; `backward` is all of it.

mod backward;
mod counted;
mod entrance;
mod error;
mod film;
mod front;
mod lens;
mod linear;
mod spot;
mod stand;

pub use backward::Backward;
pub use counted::{Aimed, Importance, ScenePoint};
pub use error::ImportanceError;
pub(crate) use lens::LensBackward;
pub(crate) use linear::{Linear, PlaneMap};

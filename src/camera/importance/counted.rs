//! What the adjoint camera takes and gives: scene points, directions toward the lens, importance.

use crate::lens::Ray;

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
pub(crate) struct Towards {
    pub ray: Ray,
    pub density: f64,
    pub counted: Option<Counted>,
}

/// What a ray counts in camera space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Counted {
    /// Raster coordinates, pixels.
    pub raster: [f64; 2],
    /// The weight that the camera gives the same ray from the film.
    pub weight: f64,
    /// The density of its rays from the film, per cosθ dA dω; the square of camera space's unit is dA's.
    pub density: f64,
}

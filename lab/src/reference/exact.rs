//! An exact ray, and how far other rays are from it.

use realistic::unstable::trace::{Ray, Real};

use super::double_double::{Vector, cross, difference, norm, vector};

/// What the reference says of a ray that gets through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactRay {
    /// The point on the last surface, in the frame of its vertex (z along +z of lens space), mm.
    pub point: Vector,
    /// The unit direction after it.
    pub direction: Vector,
}

impl ExactRay {
    /// Distance in mm between this point and that of a ray in lens space, whose last vertex lies at
    /// `vertex`.
    pub fn position_error(&self, ray: &Ray, vertex: f64) -> f64 {
        let at = difference(vector(ray.origin), vector([0.0, 0.0, vertex]));
        norm(difference(at, self.point))
    }

    /// Distance in mm of this point from the line of a ray in lens space with a unit direction, for models whose
    /// rays start elsewhere. This ray is one toward the scene, its last vertex the lens's first, z = 0.
    pub fn distance_from_line(&self, ray: &Ray) -> f64 {
        norm(cross(difference(self.point, vector(ray.origin)), vector(ray.direction)))
    }

    /// The ray toward the scene in double precision, its last vertex the lens's first, z = 0.
    pub fn nearest(&self) -> Ray {
        Ray { origin: self.point.map(Real::to_f64), direction: self.direction.map(Real::to_f64) }
    }

    /// Angle in rad between this direction and a unit vector.
    pub fn direction_error(&self, ray: &Ray) -> f64 {
        norm(difference(vector(ray.direction), self.direction))
    }
}

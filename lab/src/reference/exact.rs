//! An exact ray, and the distance of other rays from it.

use realistic_optics::trace::{Ray, Real};

use super::double_double::{Vector, cross, difference, norm, vector};

/// The reference's result for a ray that passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactRay {
    /// The point on the last surface, in the frame of its vertex (z along +z of lens space), mm.
    pub point: Vector,
    /// The unit direction after that surface.
    pub direction: Vector,
}

impl ExactRay {
    /// Returns the distance in mm between this point and the point of a ray in lens space; the last vertex lies at
    /// `vertex`.
    pub fn position_error(&self, ray: &Ray, vertex: f64) -> f64 {
        let at = difference(vector(ray.origin), vector([0.0, 0.0, vertex]));
        norm(difference(at, self.point))
    }

    /// Returns the distance in mm of this point from the line of a ray in lens space with a unit direction, for
    /// models whose rays start elsewhere. This ray travels toward the scene, so that its last vertex is the
    /// lens's first, z = 0.
    pub fn distance_from_line(&self, ray: &Ray) -> f64 {
        norm(cross(difference(self.point, vector(ray.origin)), vector(ray.direction)))
    }

    /// Returns the ray toward the scene, rounded to double precision; its last vertex is the lens's first, z =
    /// 0.
    pub fn nearest(&self) -> Ray {
        Ray { origin: self.point.map(Real::to_f64), direction: self.direction.map(Real::to_f64) }
    }

    /// Returns the angle in rad between this direction and a ray's unit direction.
    pub fn direction_error(&self, ray: &Ray) -> f64 {
        norm(difference(vector(ray.direction), self.direction))
    }
}

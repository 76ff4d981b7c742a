//! The reference: the exact walk in double-double numbers, and how far other rays are from it.

use realistic::{
    lens::{Lens, refraction::Refraction},
    numeric::in_range,
    trace::{Blocked, Direction, Path, Ray, Real},
};

use super::double_double::{DoubleDouble, Vector, cross, difference, norm, vector};

/// A lens traced in double-double numbers.
#[derive(Clone, Debug)]
pub struct Reference(Path<DoubleDouble>);

/// What the reference says of a ray that gets through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactRay {
    /// The point on the last surface, in the frame of its vertex (z along +z of lens space), mm.
    pub point: Vector,
    /// The unit direction after it.
    pub direction: Vector,
}

impl Reference {
    /// The reference for a lens and a direction of travel.
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        Self(Path::new(lens, direction, Refraction::Fused))
    }

    /// Traces a ray whose components are taken as exact; the direction may have any length.
    ///
    /// # Errors
    /// The reason why it is blocked.
    pub fn trace(&self, ray: Ray) -> Result<ExactRay, Blocked> {
        let (point, direction) = self.0.trace_in_full(vector(ray.origin), vector(in_range(ray.direction)))?;
        Ok(ExactRay { point, direction })
    }
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

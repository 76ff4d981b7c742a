//! An exact ray, and the distance of other rays from it.

use realistic_optics::trace::{Ray, Real};

use super::double_double::DoubleDouble;

/// The reference's result for a ray that passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactRay<R = DoubleDouble> {
    /// The point on the last surface, mm, in the space behind it as a [`Path`](realistic_optics::trace::Path) gives it,
    /// with the origin at the last vertex.
    pub point: [R; 3],
    /// The unit direction after that surface.
    pub direction: [R; 3],
}

impl<R: Real> ExactRay<R> {
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

pub(super) fn vector<R: Real>(v: [f64; 3]) -> [R; 3] {
    v.map(R::from_f64)
}

pub(super) fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn difference<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// Returns the length, rounded to a double.
pub(super) fn norm<R: Real>(v: [R; 3]) -> f64 {
    v.iter().map(|x| x.to_f64().powi(2)).sum::<f64>().sqrt()
}

//! Rays in lens space: origin at the vertex of the first interface, +z toward the scene, +x image right, +y image up,
//! millimetres. Tracing accepts and returns such rays. This module also builds rays from a film point with slopes dx/dz
//! and dy/dz, and computes cos⁴ of a ray's angle to the axis, the factor by which film irradiance falls off.

/// A ray in lens space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// A point on the ray, mm.
    pub origin: [f64; 3],
    /// Direction: of any nonzero length before a lens, of length 1 behind a lens.
    pub direction: [f64; 3],
}

/// Returns the ray with the slopes dx/dz and dy/dz from a point of the film, mm, in the plane z = `film`.
pub fn film_ray([x, y]: [f64; 2], film: f64, slopes: [f64; 2]) -> Ray {
    Ray { origin: [x, y, film], direction: [slopes[0], slopes[1], 1.0] }
}

/// Returns cos⁴ of the angle between the axis and a ray of these slopes.
pub fn cos4([sx, sy]: [f64; 2]) -> f64 {
    (1.0 + sx * sx + sy * sy).powi(-2)
}

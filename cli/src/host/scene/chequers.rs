//! The report's scene. A short formula gives the radiance, so that the camera takes nearly all of the time. The scene
//! has a chequerboard plane perpendicular to the axis, lights in front of it, and a bright horizon beyond its edge.
//! Lengths are in focal lengths of the lens, so that every lens sees the same blur.

use realistic::ffi::realistic_ray;

/// Distance of the board, focal lengths.
const BOARD: f32 = 60.0;
/// Width of a square, as the tangent of an angle.
const SQUARE: f32 = 0.11;
/// Distance of the lights, focal lengths.
const LIGHTS: f32 = 15.0;
/// Distance between two lights, as the tangent of an angle.
const SPACING: f32 = 0.3;
/// Radius of a light, as the tangent of an angle.
const RADIUS: f32 = 0.02;
/// Tangent of the angle at which the board ends.
const EDGE: f32 = 3.0;

/// Returns the radiance toward a ray in lens space, mm, for a lens of this focal length, mm.
pub fn radiance(focal_length: f64, ray: &realistic_ray) -> f32 {
    let [dx, dy, dz] = ray.d;
    let tangents = |distance: f32| tangents(ray, distance * focal_length as f32);
    let Some(at) = tangents(LIGHTS) else {
        return 0.6 - 0.3 * dz;
    };
    let off = at.map(|t| t - SPACING * (t / SPACING).round());
    if off[0] * off[0] + off[1] * off[1] < RADIUS * RADIUS {
        return 6.0;
    }
    match tangents(BOARD) {
        Some([x, y]) => {
            let odd = ((x / SQUARE).floor() + (y / SQUARE).floor()).rem_euclid(2.0) > 0.5;
            if odd { 1.0 } else { 0.1 }
        }
        None => 0.6 + 0.2 * dx - 0.2 * dy,
    }
}

/// Returns the point at which the ray meets the plane at `distance`, divided by that distance.
fn tangents(
    &realistic_ray { o: [x, y, z], d: [dx, dy, dz], .. }: &realistic_ray,
    distance: f32,
) -> Option<[f32; 2]> {
    if dz <= 0.0 {
        return None;
    }
    let t = (distance - z) / dz;
    let at = [(x + t * dx) / distance, (y + t * dy) / distance];
    (at[0].abs().max(at[1].abs()) < EDGE).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_alternate_and_a_light_stands_before_the_middle() {
        let seen = |d: [f32; 3]| radiance(50.0, &realistic_ray { d, ..Default::default() });
        let at = |x: f32, y: f32| {
            let norm = (1.0 + x * x + y * y).sqrt();
            seen([x / norm, y / norm, 1.0 / norm])
        };
        assert_eq!(at(0.0, 0.0), 6.0);
        assert_eq!((at(0.05, 0.05), at(0.16, 0.05), at(0.16, 0.16), at(-0.05, 0.05)), (0.1, 1.0, 0.1, 1.0));
        assert!((seen([0.0, 0.0, -1.0]) - 0.9).abs() < 1e-6);
    }
}

//! From world space to camera space at one time, and what becomes of areas and solid angles on the way.

use glam::{DMat3, DVec3};

use crate::{camera::placement::transform::CameraToWorld, lens::Ray};

/// Where the camera stands at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stand {
    to_world: DMat3,
    to_camera: DMat3,
    origin: DVec3,
    /// The determinant of `to_world`, without its sign.
    volume: f64,
    /// By how much areas on the plane z = 0 grow.
    area: f64,
}

impl Stand {
    /// `units` are the world units that one of the optics' is.
    pub fn new(placed: &CameraToWorld, units: f64) -> Self {
        let to_world = placed.linear() * units;
        Self {
            to_world,
            to_camera: to_world.inverse(),
            origin: placed.origin(),
            volume: to_world.determinant().abs(),
            area: to_world.x_axis.cross(to_world.y_axis).length(),
        }
    }

    /// A point of the world in camera space, and how far off its rounding to single precision may put it there.
    pub fn point(&self, world: [f64; 3]) -> ([f64; 3], f64) {
        let from_origin = DVec3::from(world) - self.origin;
        let rounding = 1e-6 * (DVec3::from(world).abs().max_element() + self.origin.abs().max_element());
        let longest =
            self.to_camera.to_cols_array().iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
        ((self.to_camera * from_origin).into(), rounding * longest)
    }

    /// A direction of the world in camera space, of another length.
    pub fn direction(&self, world: [f64; 3]) -> [f64; 3] {
        (self.to_camera * DVec3::from(world)).into()
    }

    /// A ray of camera space, its direction a unit vector, in the world, its direction one, too.
    pub fn ray(&self, ray: Ray) -> Ray {
        let origin = self.to_world * DVec3::from(ray.origin) + self.origin;
        let direction = (self.to_world * DVec3::from(ray.direction)).normalize();
        Ray { origin: origin.into(), direction: direction.into() }
    }

    /// By how much cosθ dA dω about a unit direction of camera space grows on its way into the world: for the matrix T,
    /// det² T over |T d|⁴.
    pub fn throughput(&self, direction: [f64; 3]) -> f64 {
        self.volume * self.volume / self.stretch(direction).powi(4)
    }

    /// By how much solid angles about a unit direction of camera space grow.
    pub fn solid_angle(&self, direction: [f64; 3]) -> f64 {
        self.volume / self.stretch(direction).powi(3)
    }

    /// The cosine in the world, without its sign, of the angle between a unit direction of camera space and the normal of
    /// the plane z = 0.
    pub fn cosine(&self, direction: [f64; 3]) -> f64 {
        self.volume * direction[2].abs() / (self.area * self.stretch(direction))
    }

    /// By how much areas on the plane z = 0 grow.
    pub fn area(&self) -> f64 {
        self.area
    }

    fn stretch(&self, direction: [f64; 3]) -> f64 {
        (self.to_world * DVec3::from(direction)).length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_and_solid_angles_grow_as_little_ones_do() {
        let linear = DMat3::from_cols_array(&[2.0, 0.3, -0.1, 0.2, -1.5, 0.4, 0.5, 0.1, 3.0]);
        let stand = Stand::new(&CameraToWorld::from_parts(linear, DVec3::new(1.0, 2.0, 3.0)), 0.5);
        let direction = DVec3::new(0.3, -0.2, -0.9).normalize();
        let through = linear * 0.5;
        // Two rays a little apart on the plane, and the triangle of three directions a little apart.
        let [right, up] = [through * DVec3::X, through * DVec3::Y];
        let normal = right.cross(up);
        let (p, q) = direction.any_orthonormal_pair();
        let step = 1e-5;
        let turned = [DVec3::ZERO, p, q].map(|by| (through * (direction + step * by)).normalize());
        let solid = (turned[1] - turned[0]).cross(turned[2] - turned[0]).length() / (step * step);
        let cosine = normal.dot(turned[0]).abs() / normal.length();
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
        let d = direction.to_array();
        close(stand.area(), normal.length());
        close(stand.solid_angle(d), solid);
        close(stand.cosine(d), cosine);
        close(stand.throughput(d), normal.length() * solid * cosine / direction.z.abs());
        let ray = Ray { origin: [1.0, -2.0, 4.0], direction: d };
        let there = stand.ray(ray);
        let (back, _) = stand.point(there.origin);
        assert!(back.iter().zip(ray.origin).all(|(a, b)| (a - b).abs() < 1e-12));
        let along = DVec3::from(stand.direction(there.direction)).normalize();
        assert!(along.abs_diff_eq(direction, 1e-12));
    }
}

//! From world space to camera space at one time, and what becomes of areas and solid angles on the way.

use glam::{DMat3, DVec3};

use crate::camera::placement::transform::CameraToWorld;

/// Where the camera stands at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    to_world: DMat3,
    to_camera: DMat3,
    origin: DVec3,
    /// The determinant of `to_world`, without its sign.
    volume: f64,
    /// By how much areas on the plane z = 0 grow.
    area: f64,
}

/// A unit direction of camera space in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct TurnedDirection {
    /// A unit vector.
    pub direction: [f64; 3],
    /// By how much solid angles about it grow.
    pub solid_angle: f64,
    /// By how much cosθ dA dω about it grows.
    pub throughput: f64,
    /// The cosine, without its sign, of its angle to the normal of the plane z = 0.
    pub cosine: f64,
}

impl Pose {
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

    /// A point of the world in camera space.
    pub fn point(&self, world: [f64; 3]) -> [f64; 3] {
        (self.to_camera * (DVec3::from(world) - self.origin)).into()
    }

    /// How far off its rounding to single precision may put a point of the world in camera space.
    pub fn rounding(&self, world: [f64; 3]) -> f64 {
        let size = DVec3::from(world).abs().max_element() + self.origin.abs().max_element();
        let entries = self.to_camera.to_cols_array();
        1e-6 * size * entries.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()))
    }

    /// A direction of the world in camera space, of another length.
    pub fn direction(&self, world: [f64; 3]) -> [f64; 3] {
        (self.to_camera * DVec3::from(world)).into()
    }

    /// A point of camera space in the world.
    pub fn outside(&self, point: [f64; 3]) -> [f64; 3] {
        (self.to_world * DVec3::from(point) + self.origin).into()
    }

    /// What becomes of a unit direction of camera space. Of the matrix T, with s = |T d|: solid angles grow by det T/s³,
    /// throughput by det² T/s⁴.
    pub fn turned(&self, direction: [f64; 3]) -> TurnedDirection {
        let along = self.to_world * DVec3::from(direction);
        let per_stretch = along.length_recip();
        let volume = self.volume * per_stretch;
        TurnedDirection {
            direction: (along * per_stretch).into(),
            solid_angle: volume * per_stretch * per_stretch,
            throughput: (volume * per_stretch).powi(2),
            cosine: volume * direction[2].abs() / self.area,
        }
    }

    /// By how much areas on the plane z = 0 grow.
    pub fn area(&self) -> f64 {
        self.area
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_and_solid_angles_grow_as_little_ones_do() {
        let linear = DMat3::from_cols_array(&[2.0, 0.3, -0.1, 0.2, -1.5, 0.4, 0.5, 0.1, 3.0]);
        let pose = Pose::new(&CameraToWorld::from_parts(linear, DVec3::new(1.0, 2.0, 3.0)), 0.5);
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
        close(pose.area(), normal.length());
        let turned = pose.turned(d);
        close(turned.solid_angle, solid);
        close(turned.cosine, cosine);
        close(turned.throughput, normal.length() * solid * cosine / direction.z.abs());
        let point = [1.0, -2.0, 4.0];
        let back = pose.point(pose.outside(point));
        assert!(back.iter().zip(point).all(|(a, b)| (a - b).abs() < 1e-12));
        let along = DVec3::from(pose.direction(turned.direction)).normalize();
        assert!(along.abs_diff_eq(direction, 1e-12));
    }
}

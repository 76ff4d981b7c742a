//! Transforms from world space to camera space at one time, and the factors by which these transforms scale
//! areas and solid angles.

use glam::{DMat3, DVec3};

use super::block::PointColumns;
use crate::placement::transform::{CameraToWorld, largest_entry};
use realistic_simd::{Cpu, Lanes};

/// The camera's pose at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    to_world: DMat3,
    to_camera: DMat3,
    origin: DVec3,
    /// The absolute value of the determinant of `to_world`.
    volume: f64,
    /// Factor by which areas on the plane z = 0 grow from camera space to the world.
    area: f64,
}

impl Pose {
    /// Builds a pose; `units` is world units per unit of the optics.
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

    /// Transforms a point of the world to camera space.
    pub fn point(&self, world: [f64; 3]) -> [f64; 3] {
        (self.to_camera * (DVec3::from(world) - self.origin)).into()
    }

    /// Returns the distance by which rounding to single precision may move a point of the world in camera space.
    pub fn rounding(&self, world: [f64; 3]) -> f64 {
        let size = DVec3::from(world).abs().max_element() + self.origin.abs().max_element();
        1e-6 * size * largest_entry(self.to_camera)
    }

    /// Transforms a direction of the world to camera space; the length of the direction may change.
    pub fn direction(&self, world: [f64; 3]) -> [f64; 3] {
        (self.to_camera * DVec3::from(world)).into()
    }

    /// Returns the numbers of the pose that lanes compute with.
    fn numbers(&self) -> [f64; NUMBERS] {
        let mut numbers = [0.0; NUMBERS];
        numbers[TO_WORLD..TO_CAMERA].copy_from_slice(&self.to_world.to_cols_array());
        numbers[TO_CAMERA..ORIGIN].copy_from_slice(&self.to_camera.to_cols_array());
        numbers[ORIGIN..VOLUME].copy_from_slice(&self.origin.to_array());
        numbers[VOLUME..].copy_from_slice(&[self.volume, self.volume.recip(), self.area.recip()]);
        numbers
    }
}

/// Indices of the numbers that lanes compute with (matrices by columns), and the count of these numbers.
const TO_WORLD: usize = 0;
const TO_CAMERA: usize = 9;
const ORIGIN: usize = 18;
const VOLUME: usize = 21;
const PER_VOLUME: usize = 22;
const PER_AREA: usize = 23;
const NUMBERS: usize = 24;

/// The camera's poses for a list of rays or points.
pub(super) struct Poses {
    poses: Vec<Pose>,
    columns: PointColumns<NUMBERS>,
    /// Whether all rays or points share one pose.
    is_still: bool,
}

impl Poses {
    /// Returns one pose that all rays or points share.
    pub fn still(pose: Pose) -> Self {
        Self { is_still: true, ..Self::moving(vec![pose]) }
    }

    /// Returns a separate pose for each ray or point.
    pub fn moving(poses: Vec<Pose>) -> Self {
        let mut columns = PointColumns::new(poses.len());
        for (i, pose) in poses.iter().enumerate() {
            columns.put(i, pose.numbers());
        }
        Self { poses, columns, is_still: false }
    }

    /// Returns the pose of ray or point `i`.
    pub fn of(&self, i: usize) -> &Pose {
        &self.poses[if self.is_still { 0 } else { i }]
    }

    /// Returns the poses of a vector of rays or points from index `at` on.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, at: usize) -> LanePoses<'_, L> {
        LanePoses { poses: self, cpu, at }
    }
}

/// Poses in lanes.
#[derive(Clone, Copy)]
pub(super) struct LanePoses<'a, L> {
    poses: &'a Poses,
    cpu: Cpu<L>,
    at: usize,
}

/// Unit directions of camera space, transformed to the world.
#[derive(Clone, Copy)]
pub(super) struct TurnedDirections<L> {
    /// Unit vectors in the world.
    pub direction: [L; 3],
    /// Factor by which solid angles about each direction shrink.
    pub per_solid_angle: L,
    /// Factor by which cosθ dA dω about each direction shrinks.
    pub per_throughput: L,
    /// Factor by which the projected areas of the plane z = 0, seen along each direction, grow; it includes
    /// the absolute value of the cosine between the direction and the plane's normal.
    pub seen_area: L,
}

impl<L: Lanes<Scalar = f64>> LanePoses<'_, L> {
    /// Returns number `k` of each pose.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn number(&self, k: usize) -> L {
        let column = self.poses.columns.column(k);
        if self.poses.is_still {
            L::splat(self.cpu, column[0])
        } else {
            L::load(self.cpu, &column[self.at..])
        }
    }

    /// Multiplies a vector by the matrix that begins at number `first`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn product(&self, first: usize, [x, y, z]: [L; 3]) -> [L; 3] {
        let mut product = [x; 3];
        let mut row = 0;
        while row < 3 {
            let [a, b, c] =
                [self.number(first + row), self.number(first + row + 3), self.number(first + row + 6)];
            product[row] = c.mul_add(z, b.mul_add(y, a * x));
            row += 1;
        }
        product
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn origin(&self) -> [L; 3] {
        [self.number(ORIGIN), self.number(ORIGIN + 1), self.number(ORIGIN + 2)]
    }

    /// Returns points of the world in camera space.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn point(&self, [x, y, z]: [L; 3]) -> [L; 3] {
        let [ox, oy, oz] = self.origin();
        self.product(TO_CAMERA, [x - ox, y - oy, z - oz])
    }

    /// Returns points of camera space in the world.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn outside(&self, point: [L; 3]) -> [L; 3] {
        let ([ox, oy, oz], [x, y, z]) = (self.origin(), self.product(TO_WORLD, point));
        [x + ox, y + oy, z + oz]
    }

    /// Transforms unit directions of camera space to the world. With the matrix T and s = |T d|, solid angles
    /// grow by det T/s³ and throughput by det² T/s⁴.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn turned(&self, direction: [L; 3]) -> TurnedDirections<L> {
        let [x, y, z] = self.product(TO_WORLD, direction);
        let square = x * x + y * y + z * z;
        let stretch = square.sqrt();
        let per_stretch = L::splat(self.cpu, 1.0) / stretch;
        let [volume, per_volume] = [self.number(VOLUME), self.number(PER_VOLUME)];
        let shrunk = square * per_volume;
        TurnedDirections {
            direction: [x * per_stretch, y * per_stretch, z * per_stretch],
            per_solid_angle: stretch * shrunk,
            per_throughput: shrunk * shrunk,
            seen_area: volume * per_stretch * direction[2].abs(),
        }
    }

    /// Returns the reciprocal of the factor by which areas on the plane z = 0 grow.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn per_area(&self) -> L {
        self.number(PER_AREA)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_simd::{OneLane, Portable};

    #[test]
    fn areas_and_solid_angles_grow_as_little_ones_do() {
        let linear = DMat3::from_cols_array(&[2.0, 0.3, -0.1, 0.2, -1.5, 0.4, 0.5, 0.1, 3.0]);
        let pose = Pose::new(&CameraToWorld::from_parts(linear, DVec3::new(1.0, 2.0, 3.0)), 0.5);
        let direction = DVec3::new(0.3, -0.2, -0.9).normalize();
        let through = linear * 0.5;
        // Two nearby rays on the plane, and the triangle of three nearby directions.
        let [right, up] = [through * DVec3::X, through * DVec3::Y];
        let normal = right.cross(up);
        let (p, q) = direction.any_orthonormal_pair();
        let step = 1e-5;
        let turned = [DVec3::ZERO, p, q].map(|by| (through * (direction + step * by)).normalize());
        let solid = (turned[1] - turned[0]).cross(turned[2] - turned[0]).length() / (step * step);
        let cosine = normal.dot(turned[0]).abs() / normal.length();
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
        let d = direction.to_array();
        let (number, lane) = (|Portable([number]): OneLane<f64>| number, |number| Portable([number]));
        let poses = Poses::still(pose);
        let lanes = poses.lanes(OneLane::cpu(), 0);
        close(number(lanes.per_area()), normal.length().recip());
        let turned = lanes.turned(d.map(lane));
        close(number(turned.per_solid_angle), solid.recip());
        close(number(turned.seen_area), normal.length() * cosine);
        let throughput = normal.length() * solid * cosine / direction.z.abs();
        close(number(turned.per_throughput), throughput.recip());
        let point = [1.0, -2.0, 4.0];
        let outside = lanes.outside(point.map(lane));
        for back in [lanes.point(outside).map(number), pose.point(outside.map(number))] {
            assert!(back.iter().zip(point).all(|(a, b)| (a - b).abs() < 1e-12));
        }
        let along = DVec3::from(pose.direction(turned.direction.map(number))).normalize();
        assert!(along.abs_diff_eq(direction, 1e-12));
    }
}

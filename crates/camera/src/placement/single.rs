//! The transform from camera space to world space as in pbrt's stock cameras: in single precision, with each
//! row summed from left to right. If the transform only rotates, translates and reflects, rays are therefore
//! bit-identical to the stock cameras' rays. If it scales or shears, directions are normalised, and ranges
//! are adjusted accordingly.

use super::{
    Placement,
    interpolated::{Interpolated, PlacedRays},
    motion::CameraMotion,
    transform::CameraToWorld,
};
use realistic_simd::{Cpu, Lanes};

/// Rays with their start and end distances.
#[derive(Clone, Copy, Debug)]
pub struct RangedRays<L> {
    pub origin: [L; 3],
    pub direction: [L; 3],
    pub range: [L; 2],
}

/// The transform of a stock camera's rays to the world.
#[derive(Clone, Debug)]
pub enum SingleToWorld {
    /// The same transform at every time.
    Still(Affine),
    /// A transform for each ray's time.
    Moving(Box<Interpolated<f32>>),
}

/// An affine transform in single precision.
#[derive(Clone, Copy, Debug)]
pub struct Affine {
    linear: [[f32; 3]; 3],
    origin: [f32; 3],
    /// A power of two that scales the largest entry close to 1; `None` if the transform preserves lengths.
    scale: Option<f32>,
}

impl SingleToWorld {
    pub fn new(placement: &Placement) -> Self {
        match &placement.to_world {
            CameraMotion::Still(to_world) => Self::Still(Affine::of(to_world)),
            CameraMotion::Moving(moving) => {
                Self::Moving(Box::new(Interpolated::new(moving, placement.shutter, 1.0)))
            }
        }
    }

    /// Returns the world-space rays of camera-space rays with unit directions, at the given fractions of the
    /// shutter's interval.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = f32>>(
        &self,
        cpu: Cpu<L>,
        rays: RangedRays<L>,
        time_numbers: &[f32],
    ) -> RangedRays<L> {
        match self {
            Self::Still(affine) => affine.lanes(cpu, rays),
            Self::Moving(to_world) => moved(cpu, to_world, rays, time_numbers),
        }
    }
}

impl Affine {
    fn of(to_world: &CameraToWorld) -> Self {
        let (linear, origin) = (to_world.linear().as_mat3(), to_world.origin().as_vec3());
        let linear = [0, 1, 2].map(|row| linear.row(row).to_array());
        let largest = linear.as_flattened().iter().fold(0.0_f32, |most, entry| most.max(entry.abs()));
        let scale = (!to_world.is_rigid()).then(|| (-largest.log2().floor()).clamp(-100.0, 100.0).exp2());
        Self { linear, origin: origin.to_array(), scale }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<L: Lanes<Scalar = f32>>(&self, cpu: Cpu<L>, rays: RangedRays<L>) -> RangedRays<L> {
        let RangedRays { mut origin, mut direction, mut range } = rays;
        let ([x, y, z], [dx, dy, dz]) = (origin, direction);
        let mut row = 0;
        while row < 3 {
            let [a, b, c] = self.linear[row];
            let (a, b, c) = (L::splat(cpu, a), L::splat(cpu, b), L::splat(cpu, c));
            origin[row] = a * x + b * y + c * z + L::splat(cpu, self.origin[row]);
            direction[row] = a * dx + b * dy + c * dz;
            row += 1;
        }
        if let Some(scale) = self.scale {
            let scale = L::splat(cpu, scale);
            let [u, v, w] = [direction[0] * scale, direction[1] * scale, direction[2] * scale];
            let length;
            (direction, length) = unit([u, v, w]);
            let stretch = length / scale;
            range = [range[0] * stretch, range[1] * stretch];
        }
        RangedRays { origin, direction, range }
    }
}

/// Transforms rays to the world of a moving camera.
#[cfg_attr(not(debug_assertions), inline(always))]
fn moved<L: Lanes<Scalar = f32>>(
    cpu: Cpu<L>,
    to_world: &Interpolated<f32>,
    RangedRays { origin, direction, range: [first, last] }: RangedRays<L>,
    time_numbers: &[f32],
) -> RangedRays<L> {
    let PlacedRays { point: origin, direction, stretch } =
        to_world.lanes(cpu, origin, direction, time_numbers);
    if to_world.is_rigid() {
        return RangedRays { origin, direction, range: [first, last] };
    }
    let (direction, length) = unit(direction);
    let stretch = length * stretch;
    RangedRays { origin, direction, range: [first * stretch, last * stretch] }
}

/// Returns unit vectors and the original lengths.
#[cfg_attr(not(debug_assertions), inline(always))]
fn unit<L: Lanes<Scalar = f32>>([u, v, w]: [L; 3]) -> ([L; 3], L) {
    let length = (u * u + v * v + w * w).sqrt();
    ([u / length, v / length, w / length], length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_simd::{OneLane, Portable};

    fn placed(rows: &[f32; 16], origin: [f32; 3], direction: [f32; 3]) -> RangedRays<f32> {
        let affine = Affine::of(&CameraToWorld::from_rows(rows).expect("affine"));
        let one = |number| Portable([number]);
        let rays = RangedRays {
            origin: origin.map(one),
            direction: direction.map(one),
            range: [one(0.5), one(8.0)],
        };
        let RangedRays { origin, direction, range } = affine.lanes(OneLane::cpu(), rays);
        let number = |Portable([number]): Portable<f32, 1>| number;
        RangedRays { origin: origin.map(number), direction: direction.map(number), range: range.map(number) }
    }

    #[test]
    fn a_rigid_transform_keeps_the_bits_of_its_sums() {
        let (s, c) = 0.3_f32.sin_cos();
        let mut rows = [0.0_f32; 16];
        [rows[0], rows[1], rows[4], rows[5], rows[10], rows[15]] = [c, -s, s, c, 1.0, 1.0];
        let ray = placed(&rows, [1.0, 2.0, 3.0], [0.6, 0.8, 0.0]);
        assert_eq!(ray.direction, [c * 0.6 + -s * 0.8, s * 0.6 + c * 0.8, 0.0]);
        assert_eq!((ray.origin, ray.range), ([c + -s * 2.0, s + c * 2.0, 3.0], [0.5, 8.0]));
    }

    #[test]
    fn stretched_space_keeps_unit_directions_and_scales_ranges() {
        for scale in [1e-20_f32, 0.3, 2.0, 1e14] {
            let mut rows = [0.0_f32; 16];
            // A reflection in x, and a rotation that takes z to -y.
            [rows[0], rows[6], rows[9], rows[15]] = [-scale, -scale, scale, 1.0];
            [rows[3], rows[7], rows[11]] = [5.0, 6.0, 7.0];
            let ray = placed(&rows, [0.0; 3], [0.6, 0.0, 0.8]);
            for (got, expected) in ray.direction.iter().zip([-0.6, -0.8, 0.0]) {
                assert!((got - expected).abs() < 2e-7, "{scale}: {ray:?}");
            }
            for (got, expected) in ray.range.iter().zip([0.5, 8.0]) {
                assert!((got / (expected * scale) - 1.0).abs() < 2e-7, "{scale}: {ray:?}");
            }
            assert_eq!(ray.origin, [5.0, 6.0, 7.0]);
        }
    }
}

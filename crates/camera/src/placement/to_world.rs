//! The transform from lens space to world space, in the precision and vector width of lanes.

use glam::DMat3;

use super::{
    Placement,
    interpolated::{Interpolated, PlacedRays},
    motion::CameraMotion,
    transform::{CameraToWorld, largest_entry},
};
use realistic_simd::{Cpu, Lanes};
use realistic_trace::kernel::KernelScalar;

/// The transform from lens space, mm, to world space, in the precision of lanes.
#[derive(Clone, Debug)]
pub enum ToWorld<S> {
    /// Camera space is world space, and its unit is the millimetre.
    Same,
    /// Camera space is world space; the number is the units of camera space per millimetre.
    Scaled(S),
    /// The same transform at every time.
    Still(Box<StillTransform<S>>),
    /// A transform for each ray's time.
    Moving(Box<Interpolated<S>>),
}

/// An affine transform, stored by rows.
#[derive(Clone, Debug)]
pub struct StillTransform<S> {
    point: [[S; 4]; 3],
    direction: [[S; 3]; 3],
    /// Whether transformed directions are unit vectors up to rounding.
    keeps_angles: bool,
}

impl<S: KernelScalar> ToWorld<S> {
    pub fn new(placement: &Placement, units_per_mm: f64) -> Self {
        let to_world = match &placement.to_world {
            CameraMotion::Still(to_world) => to_world,
            CameraMotion::Moving(moving) => {
                return Self::Moving(Box::new(Interpolated::new(moving, placement.shutter, units_per_mm)));
            }
        };
        if *to_world == CameraToWorld::IDENTITY {
            let same = units_per_mm == 1.0;
            return if same { Self::Same } else { Self::Scaled(S::from_f64(units_per_mm)) };
        }
        let (linear, origin) = (to_world.linear(), to_world.origin());
        let keeps_angles = to_world.keeps_angles();
        // If directions are normalised afterwards, any scale that keeps their squares in range is allowed.
        let scale = if keeps_angles { to_world.scale() } else { largest_entry(linear) };
        let (point, direction) = (linear * units_per_mm, linear * scale.recip());
        let row = |matrix: &DMat3, row: usize| matrix.row(row).to_array().map(S::from_f64);
        let with_move = |k: usize| {
            let [x, y, z] = row(&point, k);
            [x, y, z, S::from_f64(origin[k])]
        };
        Self::Still(Box::new(StillTransform {
            point: [0, 1, 2].map(with_move),
            direction: [0, 1, 2].map(|k| row(&direction, k)),
            keeps_angles,
        }))
    }

    /// Returns the origins and unit directions in world space of lens-space rays, at the given fractions of
    /// the shutter's interval.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        origin: [L; 3],
        direction: [L; 3],
        time_numbers: &[f32],
    ) -> [[L; 3]; 2] {
        match self {
            Self::Same => [origin, direction],
            Self::Scaled(units_per_mm) => {
                let scale = L::splat(cpu, *units_per_mm);
                [[origin[0] * scale, origin[1] * scale, origin[2] * scale], direction]
            }
            Self::Still(still) => still.lanes(cpu, origin, direction),
            Self::Moving(to_world) => {
                let PlacedRays { point, direction, .. } =
                    to_world.lanes(cpu, origin, direction, time_numbers);
                [point, made_unit(cpu, direction, false)]
            }
        }
    }
}

impl<S: KernelScalar> StillTransform<S> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        [x, y, z]: [L; 3],
        [dx, dy, dz]: [L; 3],
    ) -> [[L; 3]; 2] {
        let (mut origin, mut direction) = ([x; 3], [dx; 3]);
        let mut row = 0;
        while row < 3 {
            let [a, b, c, d] = self.point[row];
            let sum = z.mul_add(L::splat(cpu, c), L::splat(cpu, d));
            origin[row] = x.mul_add(L::splat(cpu, a), y.mul_add(L::splat(cpu, b), sum));
            let [a, b, c] = self.direction[row];
            direction[row] =
                dx.mul_add(L::splat(cpu, a), dy.mul_add(L::splat(cpu, b), dz * L::splat(cpu, c)));
            row += 1;
        }
        [origin, made_unit(cpu, direction, self.keeps_angles)]
    }
}

/// Normalises vectors; `is_near` states that they are already unit vectors up to rounding.
#[cfg_attr(not(debug_assertions), inline(always))]
fn made_unit<S: KernelScalar, L: Lanes<Scalar = S>>(cpu: Cpu<L>, [u, v, w]: [L; 3], is_near: bool) -> [L; 3] {
    let square = w.mul_add(w, v.mul_add(v, u * u));
    let factor = if is_near {
        // One step of Newton's iteration.
        square.neg_mul_add(L::splat(cpu, S::from_f64(0.5)), L::splat(cpu, S::from_f64(1.5)))
    } else {
        L::splat(cpu, S::ONE) / square.sqrt()
    };
    [u * factor, v * factor, w * factor]
}

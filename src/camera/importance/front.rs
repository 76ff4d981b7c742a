//! The front surface of a lens as rays of the scene meet it.

use crate::{
    lens::{Lens, Ray, Surface},
    numeric::root,
    trace::kernel::{Cpu, Lanes, OneLane, Portable},
};

/// The front surface, and how deep the lens is behind it.
#[derive(Clone, Debug)]
pub(super) struct Front {
    pub surface: Surface,
    /// z of its foremost point.
    foremost: f64,
    /// z of the rear vertex.
    pub rear: f64,
}

impl Front {
    /// Of a lens.
    pub fn of(lens: &Lens) -> Self {
        let surface = *lens.front();
        Self { surface, foremost: surface.sagitta_range()[1], rear: lens.rear().vertex }
    }

    /// Whether a point lies before the surface or anywhere beside it: a fisheye sees what lies behind its rim.
    pub fn is_before(&self, [x, y, z]: [f64; 3]) -> bool {
        let (front, square) = (&self.surface, x * x + y * y);
        z > self.foremost
            || square >= front.semi_diameter * front.semi_diameter
            || z > front.sagitta(square.sqrt())
    }

    /// Whether a ray of unit direction that begins before it meets the surface from outside: one that begins farther back
    /// than the lens goes toward +z.
    pub fn meets(&self, ray: &Ray) -> bool {
        let [origin, direction] =
            [ray.origin, ray.direction].map(|vector| vector.map(|part| Portable([part])));
        OneLane::<f64>::all(self.are_met(OneLane::cpu(), origin, direction))
    }

    /// The same in lanes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn are_met<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, origin: [L; 3], direction: [L; 3]) -> L::Mask {
        let number = |number: f64| L::splat(cpu, number);
        let (zero, far, ([x, y, z], [dx, dy, dz])) =
            (number(0.0), number(f64::INFINITY), (origin, direction));
        let is_far = number(self.rear).less(z);
        if self.surface.figure.is_some() || L::all(is_far) {
            return is_far;
        }
        let length = self.length(cpu, origin, direction);
        let at = [length.mul_add(dx, x), length.mul_add(dy, y), length.mul_add(dz, z)];
        // The gradient of c (x² + y² + z²) + 2 z.
        let along = at[0] * dx + at[1] * dy + at[2] * dz;
        let inward = number(self.surface.curvature).mul_add(along, dz);
        let ahead = L::both(zero.less(length), length.less(far));
        let is_met = L::both(L::both(zero.less(dz), inward.less(zero)), ahead);
        let (no, yes) = (zero, number(1.0));
        zero.less(L::select(is_far, yes, L::select(is_met, yes, no)))
    }

    /// Where a ray from the scene, with a unit direction, meets the surface; where it misses that, where it begins.
    pub fn point(&self, ray: &Ray) -> [f64; 3] {
        let front = &self.surface;
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        let at = |t: f64| [x + t * dx, y + t * dy, z + t * dz];
        let length = if front.figure.is_some() {
            let [low, high] = front.sagitta_range();
            if !(dz < 0.0) {
                return ray.origin;
            }
            let above = |t: f64| {
                let [x, y, z] = at(t);
                z - front.sagitta(x.hypot(y).min(front.semi_diameter))
            };
            root((high - z) / dz, (low - z) / dz, above)
        } else {
            let [origin, direction] =
                [ray.origin, ray.direction].map(|vector| vector.map(|part| Portable([part])));
            let Portable([length]) = self.length(OneLane::cpu(), origin, direction);
            length
        };
        if length.is_finite() { at(length) } else { ray.origin }
    }

    /// How far along rays with unit directions a sphere, or a plane, is met.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn length<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, [x, y, z]: [L; 3], [dx, dy, dz]: [L; 3]) -> L {
        // c (x² + y² + z²) + 2 z = 0, by its root on the vertex's side.
        let c = L::splat(cpu, self.surface.curvature);
        let half = c * (x * dx + y * dy + z * dz) + dz;
        let constant = c * (x * x + y * y + z * z) + z + z;
        constant / ((half * half - c * constant).sqrt() - half)
    }

    /// Heights from 0 to the rim, and z there: so many and one more.
    pub fn profile(&self, parts: u32) -> Vec<[f64; 2]> {
        let height = |k: u32| self.surface.semi_diameter * f64::from(k) / f64::from(parts);
        (0..=parts).map(|k| [height(k), self.surface.sagitta(height(k))]).collect()
    }
}

//! One register of rays on its way through the lens, with the largest height over an aperture that it met.

use super::super::lanes::{Cpu, Lanes};
use crate::trace::surface::PathSurface;

/// Clear semi-diameter over radius up to which a surface is met as a plane nearly is, with a division: beyond, t is
/// exact to this many times fewer digits.
const WEAK: f64 = 1e-5;

/// Rays on their way, and how near they came to being clipped.
#[derive(Clone, Copy)]
pub struct Probe<L> {
    pub p: [L; 3],
    pub v: [L; 3],
    pub lead: L,
    pub open: L,
    pub largest: L,
    pub surface: L,
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn dot<L: Lanes>(a: [L; 3], b: [L; 3]) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl<L: Lanes<Scalar = f64>> Probe<L> {
    /// Rays on the first vertex plane, `distance` before the film, from (`height`, 0) on it: at any slope, for an edge
    /// needs few digits. `n` is the index there.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn enter(cpu: Cpu<L>, distance: f64, height: L, [sx, sy]: [L; 2], n: f64) -> Self {
        let (zero, one, distance) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0), L::splat(cpu, distance));
        let length = (one + sx * sx + sy * sy).sqrt();
        let vz = L::splat(cpu, n) / length;
        Self {
            p: [height + sx * distance, sy * distance, zero],
            v: [sx * vz, sy * vz, vz],
            lead: distance * length,
            open: one,
            largest: zero,
            surface: zero,
        }
    }

    /// Notes how near the clear aperture the rays in `met` come, at (x, y).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn note(&mut self, cpu: Cpu<L>, step: &PathSurface<f64>, number: f64, [x, y]: [L; 2], met: L::Mask) {
        let ratio = (x * x + y * y) * L::splat(cpu, step.aperture.recip());
        let more = L::both(met, self.largest.less(ratio));
        self.largest = L::select(more, ratio, self.largest);
        self.surface = L::select(more, L::splat(cpu, number), self.surface);
    }

    /// Takes the rays to the next surface and through it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn pass(&mut self, cpu: Cpu<L>, step: &PathSurface<f64>, number: f64) {
        let (zero, one) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0));
        let c = L::splat(cpu, step.curvature);
        let [vx, vy, vz] = self.v;
        let p = [self.p[0], self.p[1], self.p[2] - L::splat(cpu, step.distance)];
        let f = L::splat(cpu, step.curvature / 2.0) * dot(p, p) - p[2];
        let g = vz - c * dot(p, self.v);
        let cn2 = step.curvature * step.n * step.n;
        let square = g * g - L::splat(cpu, 2.0 * cn2) * f;
        let [before, after] = L::sqrt_pair(square, square + L::splat(cpu, step.index_step));
        let t = if step.curvature * step.curvature * step.aperture > WEAK * WEAK {
            (g - before) * L::splat(cpu, cn2.recip())
        } else {
            (f + f) / (g + before)
        };
        let [x, y, z] = [p[0] + t * vx, p[1] + t * vy, p[2] + t * vz];
        let slope = one - c * z;
        let least = if step.only_limits() { f64::NEG_INFINITY } else { -step.slack };
        let onward = L::both(L::splat(cpu, least).less_equal(self.lead + t), zero.less_equal(slope));
        let met = L::both(L::both(zero.less(square), onward), zero.less(self.open));
        let met = L::both(met, zero.less(vz));
        self.note(cpu, step, number, [x, y], met);
        // Snell's law, as `RayLanes::bend`: V' = V + (n' cos I' - n cos I) N.
        let bend = after - before;
        let across = c * bend;
        self.v = [vx - across * x, vy - across * y, vz + bend * slope];
        self.p = [x, y, z];
        self.lead = if step.only_limits() { self.lead + t } else { zero };
        self.open = L::select(L::both(met, zero.less(after)), one, zero);
    }
}

//! Through surfaces that are neither spheres nor planes, by the kernel's own code for them (see `asphere`): where a ray
//! meets one, proven to be the first crossing, and how it goes on behind.

use super::{
    super::{
        asphere::Asphere,
        dispersion::Own,
        lanes::{Cpu, Lanes},
        ray::RayLanes,
        simd::Compiled,
    },
    probe::Probe,
};
use crate::trace::surface::PathSurface;

/// The square of the ratio from which on rays that lanes leave open are no longer walked: they count as lost, which is
/// all that a search asks of them.
const FAR: f64 = 1.44;

/// Takes several registers' rays to the next surface and through it, compiled apart.
pub struct PassAsphere<'a, L, const U: usize> {
    pub cpu: Cpu<L>,
    pub step: &'a PathSurface<f64>,
    pub asphere: &'a Asphere<f64>,
    /// The surface's number, as the bits of a float.
    pub number: f64,
    pub probes: &'a mut [Probe<L>; U],
}

impl<L: Lanes<Scalar = f64>, const U: usize> Compiled for PassAsphere<'_, L, U> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run(self) {
        let Self { cpu, step, asphere, number, probes } = self;
        let (zero, one) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0));
        let mut rays = [RayLanes::at(cpu, [zero; 2], [zero; 3], zero); U];
        let (mut minus_z, mut leads) = ([zero; U], [zero; U]);
        let mut worth = [zero.less_equal(zero); U];
        for u in 0..U {
            let Probe { p: [x, y, z], v, lead, open, largest, .. } = probes[u];
            worth[u] = largest.less_equal(L::splat(cpu, FAR));
            rays[u] = RayLanes::at(cpu, [x, y], v, zero);
            rays[u].keep(zero.less(open));
            (minus_z[u], leads[u]) = (L::splat(cpu, step.distance) - z, lead);
        }
        let normals = asphere.meet(cpu, &mut rays, minus_z, leads, Some(worth));
        for u in 0..U {
            let (probe, ray) = (&mut probes[u], &mut rays[u]);
            probe.note(cpu, step, number, [ray.x, ray.y], ray.passed);
            ray.refract(cpu, &asphere.common, Own, &normals[u]);
            probe.p = [ray.x, ray.y, ray.height];
            probe.v = [ray.vx, ray.vy, ray.vz];
            probe.lead = zero;
            probe.open = L::select(ray.passed, one, zero);
        }
    }
}

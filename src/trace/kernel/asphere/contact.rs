//! A surface with terms near places on rays, several vectors side by side.

use super::{
    super::{
        apertures::Apertures,
        lanes::{Cpu, Lanes, Scalar},
        ray::RayLanes,
    },
    constants::Asphere,
};

/// A ray from the plane where it starts.
#[derive(Clone, Copy)]
pub struct Way<L> {
    /// x² + y² there.
    pub u: L,
    /// x Vx + y Vy there.
    pub along: L,
    /// Vx² + Vy².
    pub across: L,
    /// From where on it may meet the surface.
    pub from: L,
}

impl<L: Lanes> Way<L> {
    /// x² + y² on the ray.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn height_squared(&self, t: L) -> L {
        t.mul_add(t.mul_add(self.across, self.along + self.along), self.u)
    }
}

/// The surface near a point of each ray.
#[derive(Clone, Copy)]
pub struct Contact<L> {
    /// x² + y².
    pub u: L,
    pub m: L,
    pub q: L,
    /// N·V.
    pub facing: L,
    /// G.
    pub residual: L,
}

impl<S: Scalar> Asphere<S> {
    /// The surface near each ray at t.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn contacts<L: Lanes<Scalar = S>, A: Apertures<L>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &[RayLanes<L, A>; U],
        ways: &[Way<L>; U],
        t: &[L; U],
    ) -> [Contact<L>; U] {
        let (one, start) = (L::splat(cpu, S::ONE), L::splat(cpu, self.common.start));
        let (per_unit, two_per_unit) = (L::splat(cpu, self.terms.per_unit), L::splat(cpu, self.two_per_unit));
        let (mut u, mut s, mut along) = ([start; U], [start; U], [start; U]);
        for i in 0..U {
            along[i] = t[i].mul_add(ways[i].across, ways[i].along);
            u[i] = t[i].mul_add(along[i] + ways[i].along, ways[i].u);
            s[i] = u[i] * per_unit;
        }
        let [terms, slope] = self.terms.at(cpu, &s);
        let (c, half_c) = (L::splat(cpu, self.c), L::splat(cpu, self.half_c));
        let (kappa_c, half_kappa_c) = (L::splat(cpu, self.kappa_c), L::splat(cpu, self.half_kappa_c));
        let mut contacts = [Contact { u: one, m: c, q: one, facing: one, residual: one }; U];
        for i in 0..U {
            let vz = rays[i].vz;
            let w = t[i].mul_add(vz, start - terms[i]);
            let q = w.neg_mul_add(kappa_c, one);
            let residual = u[i].mul_sub(half_c, w * w.neg_mul_add(half_kappa_c, one));
            let m = (q * two_per_unit).mul_add(slope[i], c);
            contacts[i] = Contact { u: u[i], m, q, facing: m.neg_mul_add(along[i], q * vz), residual };
        }
        contacts
    }
}

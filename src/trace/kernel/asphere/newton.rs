//! A surface with terms in lanes: Newton's iteration from the vertex plane, for several vectors side by side, so that one's
//! sums overlap another's.

use super::{
    super::{
        lanes::{Cpu, Lanes, Scalar},
        ray::RayLanes,
    },
    constants::Asphere,
};

/// The surface near a point of each ray.
#[derive(Clone, Copy)]
struct Contact<L> {
    x: L,
    y: L,
    z: L,
    height_squared: L,
    m: L,
    q: L,
    /// N·V.
    facing: L,
    /// G.
    residual: L,
}

/// Steps in all at most, before a ray goes to the walk.
const MOST_STEPS: usize = 12;
/// The widest vector.
const WIDEST: usize = 16;

impl<S: Scalar> Asphere<S> {
    /// Takes rays through the surface, whose vertex lies -z ahead; `lead` is how far they were moved on before.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn trace<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &mut [RayLanes<L>; U],
        minus_z: [L; U],
        lead: [L; U],
    ) {
        let zero = L::splat(cpu, S::ZERO);
        let mut from = [zero; U];
        for i in 0..U {
            from[i] = rays[i].reach_vertex_plane(cpu, &self.common, minus_z[i], lead[i]);
        }
        let mut t = [zero; U];
        for _ in 0..self.steps {
            let contacts = self.contacts(cpu, rays, &t);
            for i in 0..U {
                t[i] = t[i] + contacts[i].residual / contacts[i].facing;
            }
        }
        let mut contacts = self.contacts(cpu, rays, &t);
        let tolerance = L::splat(cpu, self.tolerance);
        for _ in self.steps..MOST_STEPS {
            let mut far = 0;
            for i in 0..U {
                let near = L::bits(contacts[i].residual.abs().less_equal(tolerance));
                far |= rays[i].passed_bits() & !near;
            }
            if far == 0 {
                break;
            }
            for i in 0..U {
                let near = contacts[i].residual.abs().less_equal(tolerance);
                t[i] = L::select(near, t[i], t[i] + contacts[i].residual / contacts[i].facing);
            }
            contacts = self.contacts(cpu, rays, &t);
        }
        let mut open = [0; U];
        let mut any = 0;
        for i in 0..U {
            open[i] =
                rays[i].passed_bits() & !L::bits(self.is_first(cpu, &rays[i], &contacts[i], t[i], from[i]));
            any |= open[i];
        }
        if any != 0 {
            for i in 0..U {
                let (found, met) = self.one_by_one(cpu, &rays[i], t[i], from[i], open[i]);
                t[i] = found;
                rays[i].keep(zero.less(met));
            }
            contacts = self.contacts(cpu, rays, &t);
        }
        for i in 0..U {
            let Contact { x, y, z, height_squared, m, q, facing, .. } = contacts[i];
            (rays[i].x, rays[i].y, rays[i].height) = (x, y, z);
            let square = q.mul_add(q, (m * m) * height_squared);
            rays[i].bend_at(cpu, &self.common, [m, q], facing, square);
        }
    }

    /// Whether the iteration has ended at the first crossing after `from`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_first<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        ray: &RayLanes<L>,
        contact: &Contact<L>,
        t: L,
        from: L,
    ) -> L::Mask {
        let (zero, rim) = (L::splat(cpu, S::ZERO), L::splat(cpu, self.terms.rim));
        let vz_squared = ray.vz * ray.vz;
        let across = L::splat(cpu, self.n2) - vz_squared;
        let bend = vz_squared.mul_add(L::splat(cpu, self.bend_by_vz2), L::splat(cpu, self.bend));
        let way = t - from;
        let four = L::splat(cpu, S::from_f64(4.0));
        let near =
            L::both(contact.height_squared.less_equal(four * rim), (way * way * across).less_equal(rim));
        let first = L::both(zero.less_equal(way), (bend * way).less(contact.facing + contact.facing));
        let there = contact.residual.abs().less_equal(L::splat(cpu, self.tolerance));
        let ahead = L::both(zero.less(contact.q), zero.less(contact.facing));
        L::both(L::both(near, first), L::both(there, ahead))
    }

    /// The surface near each ray at t.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn contacts<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &[RayLanes<L>; U],
        t: &[L; U],
    ) -> [Contact<L>; U] {
        let (zero, one) = (L::splat(cpu, S::ZERO), L::splat(cpu, S::ONE));
        let mut contacts = [Contact {
            x: zero,
            y: zero,
            z: zero,
            height_squared: zero,
            m: zero,
            q: zero,
            facing: zero,
            residual: zero,
        }; U];
        let mut u = [zero; U];
        for i in 0..U {
            contacts[i].x = t[i].mul_add(rays[i].vx, rays[i].x);
            contacts[i].y = t[i].mul_add(rays[i].vy, rays[i].y);
            u[i] = contacts[i].y.mul_add(contacts[i].y, contacts[i].x * contacts[i].x);
        }
        let [terms, slope] = self.terms.at(cpu, &u);
        let (c, half_c) = (L::splat(cpu, self.c), L::splat(cpu, self.half_c));
        let (kappa_c, half_kappa_c) = (L::splat(cpu, self.kappa_c), L::splat(cpu, self.half_kappa_c));
        for i in 0..U {
            let ray = &rays[i];
            let (Contact { x, y, .. }, height_squared) = (contacts[i], u[i]);
            let z = t[i] * ray.vz;
            let w = z - terms[i];
            let q = w.neg_mul_add(kappa_c, one);
            let residual = height_squared.mul_sub(half_c, w * w.neg_mul_add(half_kappa_c, one));
            let m = (q + q).mul_add(slope[i], c);
            let along = y.mul_add(ray.vy, x * ray.vx);
            let facing = m.neg_mul_add(along, q * ray.vz);
            contacts[i] = Contact { x, y, z, height_squared, m, q, facing, residual };
        }
        contacts
    }

    /// Where the walk meets the surface along the rays that `open` has a bit for, and `t` for the others; and where that
    /// is anywhere, 1, else 0.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn one_by_one<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        ray: &RayLanes<L>,
        t: L,
        from: L,
        open: u32,
    ) -> (L, L) {
        let mut columns = [[S::ZERO; WIDEST]; 7];
        for (column, lanes) in columns.iter_mut().zip([ray.x, ray.y, ray.vx, ray.vy, ray.vz, from, t]) {
            lanes.store(column);
        }
        let mut met = [S::ONE; WIDEST];
        self.walk(&mut columns, &mut met, open);
        (L::load(cpu, &columns[6]), L::load(cpu, &met))
    }

    #[cold]
    #[inline(never)]
    fn walk(&self, columns: &mut [[S; WIDEST]; 7], met: &mut [S; WIDEST], mut open: u32) {
        while open != 0 {
            let lane = open.trailing_zeros() as usize;
            open &= open - 1;
            let [x, y, vx, vy, vz, from, _] = columns.each_ref().map(|column| column[lane].to_f64());
            match self.exact.first_crossing([x, y, 0.0], [vx, vy, vz], from) {
                Ok(t) => columns[6][lane] = S::from_f64(t),
                Err(_) => met[lane] = S::ZERO,
            }
        }
    }
}

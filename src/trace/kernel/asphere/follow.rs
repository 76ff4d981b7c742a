//! Rays that Newton's iteration leaves open, followed to the first crossing as the walk follows them (see
//! [`Aspheric`](crate::trace::aspheric::Aspheric)), but side by side: for searches, of whose rays many pass beside a surface.

use super::{
    super::{
        apertures::Apertures,
        lanes::{Cpu, Lanes, Scalar},
        ray::RayLanes,
    },
    constants::Asphere,
    contact::{Contact, Way},
};
use crate::trace::work;

/// Steps at most; a ray that takes more goes to the walk.
const STEPS: usize = 24;
/// By how much rounding may put a point beyond the square of a distance.
const BESIDE: f64 = 1.0 + 1e-6;

/// What became of rays.
pub struct Followed<L> {
    /// Where they cross the surface, of those that do.
    pub t: L,
    /// Above 0 for these, and for those that took too many steps.
    pub kept: L,
    /// The latter.
    pub left: u32,
}

/// The surface near a place on each ray.
struct Measure<L: Lanes> {
    /// -φ and φ' of the φ whose bend is bounded.
    before: L,
    facing: L,
    /// Where the ray is behind the equator, and φ is q.
    behind: L::Mask,
}

impl<S: Scalar> Asphere<S> {
    /// Follows the rays that `open` has a bit for.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn follow<L: Lanes<Scalar = S>, A: Apertures<L>>(
        &self,
        cpu: Cpu<L>,
        ray: &RayLanes<L, A>,
        way: &Way<L>,
        open: u32,
    ) -> Followed<L> {
        let (zero, one) = (L::splat(cpu, S::ZERO), L::splat(cpu, S::ONE));
        let tolerance = L::splat(cpu, S::from_f64(self.exact.tolerance));
        let highest = S::from_f64(self.exact.extent[1] - self.common.start.to_f64());
        let end = L::splat(cpu, highest) / ray.vz;
        let (rim, reach) = (L::splat(cpu, self.rim), L::splat(cpu, self.reach));
        let beside = L::splat(cpu, S::from_f64(self.exact.bend.reach * BESIDE));
        let inside = self.inside.along_rays(cpu, way.across).larger(zero);
        let beyond = self.beyond.along_rays(cpu, way.across).larger(zero);
        let equator = self.equator.along_rays(cpu, way.across).larger(zero);
        // Where the ray first comes as near to the axis as the bounds hold.
        let is_near = way.height_squared(way.from).less_equal(reach);
        let square = way.along * way.along - way.across * (way.u - reach);
        let entry = zero - (way.along + square.sqrt()) / way.across;
        let mut t = L::select(is_near, way.from, entry);
        // 1 for rays that are on their way, and for those that have come to the surface.
        let mut going = L::select(is_near, one, L::select(way.from.less(entry), one, zero));
        let mut met = zero;
        let mut evaluations = 0;
        for _ in 0..STEPS {
            evaluations += (open & L::bits(zero.less(going))).count_ones();
            let Measure { before, facing, behind } = self.measure(cpu, ray, way, t);
            let here = way.height_squared(t);
            let in_reach = L::both(t.less_equal(end), here.less_equal(beside));
            let goes_on = L::both(zero.less(going), in_reach);
            let is_near = L::both(before.abs().less_equal(tolerance), zero.less(facing));
            let is_there = zero.less(L::select(behind, zero, L::select(is_near, one, zero)));
            let arrives = L::both(goes_on, is_there);
            met = L::select(arrives, one, met);
            let is_before = L::both(goes_on, zero.less(before));
            going = L::select(arrives, zero, L::select(is_before, one, zero));
            let inside = L::select(behind, equator, inside);
            let beyond = L::select(behind, equator, beyond);
            // To where a parabola of this bend meets 0.
            let (twice, square) = (before + before, facing * facing);
            let by_inside = facing + inside.mul_add(twice, square).sqrt();
            let by_beyond = facing + beyond.mul_add(twice, square).sqrt();
            let (short, long) = (twice / by_beyond, twice / by_inside);
            let stays = L::both(here.less_equal(rim), way.height_squared(t + long).less_equal(rim));
            let is_long = L::both(stays, L::both(zero.less(by_inside), zero.less(long)));
            let is_short = L::both(zero.less(by_beyond), zero.less(short));
            going = L::select(is_long, going, L::select(is_short, going, zero));
            t = L::select(zero.less(going), t + L::select(is_long, long, short), t);
            if open & L::bits(zero.less(going)) == 0 {
                break;
            }
        }
        work::count(evaluations);
        let left = open & L::bits(zero.less(going));
        let mut contact = self.contact(cpu, ray, way, t);
        for _ in 0..2 {
            t = t + contact.residual / contact.facing;
            contact = self.contact(cpu, ray, way, t);
        }
        // The conic's other half or sheet is no part of the surface, nor is where a ray comes back up through it.
        let is_ahead = L::both(zero.less(contact.q), zero.less(contact.facing));
        let met = L::select(is_ahead, met, zero);
        Followed { t, kept: met.larger(going), left }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn contact<L: Lanes<Scalar = S>, A: Apertures<L>>(
        &self,
        cpu: Cpu<L>,
        ray: &RayLanes<L, A>,
        way: &Way<L>,
        t: L,
    ) -> Contact<L> {
        self.contacts(cpu, &[*ray], &[*way], &[t])[0]
    }

    /// Far below the surface q may have any sign, and G with it; heights do not.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn measure<L: Lanes<Scalar = S>, A: Apertures<L>>(
        &self,
        cpu: Cpu<L>,
        ray: &RayLanes<L, A>,
        way: &Way<L>,
        t: L,
    ) -> Measure<L> {
        let zero = L::splat(cpu, S::ZERO);
        let along = t.mul_add(way.across, way.along);
        if !self.by_height {
            let Contact { residual, facing, q, .. } = self.contact(cpu, ray, way, t);
            let behind = q.less(L::splat(cpu, S::from_f64(-S::EPSILON.sqrt())));
            // q' = -κ c w', and N·V = q w' - c (x Vx + y Vy).
            let rise = along.mul_add(L::splat(cpu, self.c), facing) / q;
            let to_equator = zero - L::splat(cpu, self.kappa_c) * rise;
            return Measure {
                before: L::select(behind, zero - q, residual),
                facing: L::select(behind, to_equator, facing),
                behind,
            };
        }
        let u = t.mul_add(along + way.along, way.u);
        let [[terms], [slope]] = self.terms.at(cpu, &[u * L::splat(cpu, self.terms.per_unit)]);
        let (one, c) = (L::splat(cpu, S::ONE), L::splat(cpu, self.c));
        let root = (c * L::splat(cpu, self.kappa_c)).neg_mul_add(u, one).sqrt();
        let z = t.mul_add(ray.vz, L::splat(cpu, self.common.start));
        let before = (c * u / (one + root) + terms) - z;
        let slope = slope.mul_add(L::splat(cpu, self.two_per_unit), c / root);
        Measure { before, facing: slope.neg_mul_add(along, ray.vz), behind: zero.less(zero) }
    }
}

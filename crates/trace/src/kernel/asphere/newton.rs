//! Newton's iteration at a surface with terms, in lanes. It runs for several vectors side by side, so that their sums
//! overlap. Afterwards the rays that it leaves open are traced.
//!
//! Along a ray from (x, y) on its start plane ([`RadialPath`]), u = u0 + 2 a0 t + (Vx² + Vy²) t² and x Vx + y Vy = a0 +
//! (Vx² + Vy²) t, so no step needs the point itself. A step takes t to t + G/(N·V) ([`LaneContact`]). A single ray
//! waits for each step's chain of operations, from t through s and the terms to the quotient: the order of the sums
//! keeps it short.
//!
//! If apertures block rays, the rays that remain open go to the walk one by one. In searches for edges, many rays pass
//! beside a surface; these are followed side by side to the first crossing ([`LaneAsphere::follow`]), as the walk does
//! (see [`Aspheric`](realistic_optics::trace::Aspheric)).

use super::{
    super::{
        apertures::Apertures,
        dispersion::Media,
        ray_lanes::{Crossing, RayLanes},
    },
    conic::Normal,
    figure::{LaneAsphere, nested},
};
use realistic_simd::{Compiled, Cpu, Lanes, Scalar};

/// The squared distance from the axis along a ray from its start plane.
#[derive(Clone, Copy)]
struct RadialPath<L> {
    /// x² + y² at the start.
    u: L,
    /// x Vx + y Vy at the start.
    along: L,
    /// Vx² + Vy².
    across: L,
    /// Coefficients of s = u/unit, a quadratic polynomial in t; the coefficient of t² is first.
    s: [L; 3],
    /// The first t at which the ray may meet the surface.
    from: L,
    /// Distance to the start plane, in units of V.
    to_start: L,
}

impl<L: Lanes> RadialPath<L> {
    /// Returns x² + y² on the ray at t.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn height_squared(&self, t: L) -> L {
        t.mul_add(t.mul_add(self.across, self.along + self.along), self.u)
    }

    /// Returns s on the ray at t.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn s_at(&self, t: L) -> L {
        let [square, linear, constant] = self.s;
        t.mul_add(t.mul_add(square, linear), constant)
    }
}

/// The surface near a point of each ray.
#[derive(Clone, Copy)]
struct LaneContact<L> {
    /// (x² + y²)/unit.
    s: L,
    m: L,
    q: L,
    /// N·V.
    facing: L,
    /// G.
    residual: L,
}

impl<S: Scalar> LaneAsphere<S> {
    /// Evaluates the surface near each ray at t.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn contacts<L: Lanes<Scalar = S>, A: Apertures<L>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &[RayLanes<L, A>; U],
        paths: &[RadialPath<L>; U],
        t: &[L; U],
    ) -> [LaneContact<L>; U] {
        let (one, start) = (L::splat(cpu, S::ONE), L::splat(cpu, self.common.start));
        let two_per_unit = L::splat(cpu, self.two_per_unit);
        let mut s = [start; U];
        for i in 0..U {
            s[i] = paths[i].s_at(t[i]);
        }
        let [terms, slope] = self.terms.at(cpu, &s);
        let (c, half_c_unit) = (L::splat(cpu, self.c), L::splat(cpu, self.half_c_unit));
        let (kappa_c, half_kappa_c) = (L::splat(cpu, self.kappa_c), L::splat(cpu, self.half_kappa_c));
        let mut contacts = [LaneContact { s: one, m: c, q: one, facing: one, residual: one }; U];
        for i in 0..U {
            // In each sum, the operands that do not wait for the terms come first. N·V = q w' - c (x Vx + y Vy), w' =
            // Vz - dT/dt.
            let along = t[i].mul_add(paths[i].across, paths[i].along);
            let w = t[i].mul_add(rays[i].vz, start) - terms[i];
            let rise = slope[i].neg_mul_add(along * two_per_unit, rays[i].vz);
            let q = w.neg_mul_add(kappa_c, one);
            let residual = w.mul_add(w.mul_sub(half_kappa_c, one), s[i] * half_c_unit);
            let m = (q * two_per_unit).mul_add(slope[i], c);
            contacts[i] = LaneContact { s: s[i], m, q, facing: q.mul_sub(rise, c * along), residual };
        }
        contacts
    }
}

/// Least length, mm, by which another is divided.
const LEAST: f64 = 1e-30;
/// Maximum number of additional steps after those of the plan, before a ray goes to the walk.
const FURTHER_STEPS: usize = 6;
/// Width of the widest vector.
const WIDEST: usize = 16;

/// A single vector of rays before the surface, as work for a function of its own.
struct SingleVector<'a, L: Lanes, A, M> {
    cpu: Cpu<L>,
    asphere: &'a LaneAsphere<L::Scalar>,
    rays: &'a mut [RayLanes<L, A>; 1],
    media: M,
    minus_z: L,
    lead: L,
    crossing: &'a mut Option<Crossing<L>>,
}

impl<L: Lanes, A: Apertures<L>, M: Media<L>> Compiled for SingleVector<'_, L, A, M> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run(self) {
        let [crossing] =
            self.asphere.trace_here(self.cpu, self.rays, [self.media], [self.minus_z], [self.lead]);
        *self.crossing = Some(crossing);
    }
}

impl<S: Scalar> LaneAsphere<S> {
    /// Traces rays through the surface, whose vertex lies `minus_z` ahead; `lead` is the distance by which the rays
    /// were moved before, in units of V.
    ///
    /// A single vector goes through a function that all its callers share: inlined, this code would be a third of the
    /// library. Only a copy of the rays has its address taken, so that they stay in registers at the other surfaces.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn trace<L: Lanes<Scalar = S>, A: Apertures<L>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &mut [RayLanes<L, A>; U],
        media: [impl Media<L>; U],
        minus_z: [L; U],
        lead: [L; U],
    ) -> [Crossing<L>; U] {
        if U > 1 {
            self.trace_here(cpu, rays, media, minus_z, lead)
        } else {
            let (mut alone, mut crossing) = ([rays[0]], None);
            let work = SingleVector {
                cpu,
                asphere: self,
                rays: &mut alone,
                media: media[0],
                minus_z: minus_z[0],
                lead: lead[0],
                crossing: &mut crossing,
            };
            L::apart(cpu, work);
            rays[0] = alone[0];
            [crossing.expect("the work sets it"); U]
        }
    }

    /// Traces rays as [`Self::trace`] does, inlined.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn trace_here<L: Lanes<Scalar = S>, A: Apertures<L>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &mut [RayLanes<L, A>; U],
        media: [impl Media<L>; U],
        minus_z: [L; U],
        lead: [L; U],
    ) -> [Crossing<L>; U] {
        let normals = self.meet(cpu, rays, minus_z, lead);
        let mut crossings = [rays[0].bend_at(cpu, &self.common, media[0], normals[0]); U];
        for i in 1..U {
            crossings[i] = rays[i].bend_at(cpu, &self.common, media[i], normals[i]);
        }
        crossings
    }

    /// Moves rays to the surface, as in [`LaneAsphere::trace`], and returns the normals where they meet it. Rays that
    /// the lanes leave open and that are not worth the walk ([`Apertures::worth`]) count as blocked.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn meet<L: Lanes<Scalar = S>, A: Apertures<L>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        rays: &mut [RayLanes<L, A>; U],
        minus_z: [L; U],
        lead: [L; U],
    ) -> [Normal<L>; U] {
        let zero = L::splat(cpu, S::ZERO);
        let per_unit = L::splat(cpu, self.terms.per_unit);
        let start =
            RadialPath { u: zero, along: zero, across: zero, s: [zero; 3], from: zero, to_start: zero };
        let mut paths = [start; U];
        for i in 0..U {
            let ray = &mut rays[i];
            let [to_start, from] = ray.reach_plane(cpu, &self.common, minus_z[i], lead[i]);
            let u = ray.height_squared();
            let along = ray.y.mul_add(ray.vy, ray.x * ray.vx);
            let across = ray.vy.mul_add(ray.vy, ray.vx * ray.vx);
            let s = [across * per_unit, (along + along) * per_unit, u * per_unit];
            paths[i] = RadialPath { u, along, across, s, from, to_start };
        }
        let mut t = [zero; U];
        for coefficients in &self.approximants {
            self.approach(cpu, coefficients, rays, &paths, &mut t);
        }
        for _ in 0..self.exact_steps {
            let contacts = self.contacts(cpu, rays, &paths, &t);
            for i in 0..U {
                t[i] = t[i] + contacts[i].residual / contacts[i].facing;
            }
        }
        let mut contacts = self.contacts(cpu, rays, &paths, &t);
        let tolerance = L::splat(cpu, self.tolerance);
        for _ in 0..FURTHER_STEPS {
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
            contacts = self.contacts(cpu, rays, &paths, &t);
        }
        let mut open = [0; U];
        let mut firsts = [zero.less(zero); U];
        let mut any = 0;
        for i in 0..U {
            let first = self.is_first(cpu, &paths[i], &contacts[i], t[i]);
            if let Some(worth) = rays[i].apertures.worth(cpu) {
                let one = L::splat(cpu, S::ONE);
                let spared = L::select(first, zero, L::select(worth, zero, one));
                rays[i].keep(spared.less(one));
            }
            firsts[i] = first;
            open[i] = rays[i].passed_bits() & !L::bits(first);
            any |= open[i];
        }
        if any != 0 {
            for i in 0..U {
                if !A::BLOCK && open[i] != 0 && !self.has_cone() {
                    let FollowedRays { t: found, unblocked, unresolved } =
                        self.follow(cpu, &rays[i], &paths[i], open[i]);
                    t[i] = L::select(firsts[i], t[i], found);
                    rays[i].keep(zero.less(L::select(firsts[i], L::splat(cpu, S::ONE), unblocked)));
                    open[i] = unresolved;
                }
                if A::BLOCK || open[i] != 0 {
                    let (found, met) =
                        self.one_by_one(cpu, &rays[i], paths[i].from, t[i], open[i], !A::BLOCK);
                    t[i] = found;
                    rays[i].keep(zero.less(met));
                }
            }
            contacts = self.contacts(cpu, rays, &paths, &t);
        }
        let none = Normal { m: zero, q: zero, facing: zero, square: zero, distance: zero };
        let mut normals = [none; U];
        for i in 0..U {
            let LaneContact { m, q, facing, .. } = contacts[i];
            let ray = &mut rays[i];
            ray.advance(t[i]);
            ray.height = t[i].mul_add(ray.vz, L::splat(cpu, self.common.start));
            let square = q.mul_add(q, (m * m) * ray.height_squared());
            normals[i] = Normal { m, q, facing, square, distance: paths[i].to_start + t[i] };
        }
        normals
    }

    /// Takes a step of Newton's iteration with a polynomial that approximates twice the profile.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn approach<L: Lanes<Scalar = S>, A: Apertures<L>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        coefficients: &[S],
        rays: &[RayLanes<L, A>; U],
        paths: &[RadialPath<L>; U],
        t: &mut [L; U],
    ) {
        let (edge, start) = (L::splat(cpu, self.terms.edge_s), L::splat(cpu, self.common.start));
        let (per_unit, half) = (L::splat(cpu, self.terms.per_unit), L::splat(cpu, S::from_f64(0.5)));
        let (mut s, mut along) = ([start; U], [start; U]);
        for i in 0..U {
            along[i] = t[i].mul_add(paths[i].across, paths[i].along);
            s[i] = paths[i].s_at(t[i]).smaller(edge);
        }
        let [twice, slope] = nested(cpu, coefficients, &s);
        for i in 0..U {
            let below = twice[i].mul_sub(half, t[i].mul_add(rays[i].vz, start));
            let facing = slope[i].neg_mul_add(along[i] * per_unit, rays[i].vz);
            t[i] = t[i] + below / facing;
        }
    }

    /// Whether a cone opens toward rays; such rays are followed by the walk.
    fn has_cone(&self) -> bool {
        self.inside.cone > S::ZERO
    }

    /// Whether the iteration has converged to the first crossing ahead.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn is_first<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        path: &RadialPath<L>,
        contact: &LaneContact<L>,
        t: L,
    ) -> L::Mask {
        let zero = L::splat(cpu, S::ZERO);
        let (across, reach) = (path.across, L::splat(cpu, self.reach));
        let u_from = path.height_squared(path.from);
        let distance = t - path.from;
        let there = contact.residual.abs().less_equal(L::splat(cpu, self.tolerance));
        // On a line segment, the distance from the axis is largest at an end.
        let u = contact.s * L::splat(cpu, self.unit);
        let near = L::both(u_from.less_equal(reach), u.less_equal(reach));
        let edge = L::splat(cpu, self.edge_u);
        let is_inside = L::both(u_from.less_equal(edge), u.less_equal(edge));
        let (inside, beyond) = (&self.inside, &self.beyond);
        let bend = L::select(is_inside, inside.along_rays(cpu, across), beyond.along_rays(cpu, across));
        let mut bend = bend * distance;
        if self.has_cone() {
            let cone = L::select(is_inside, L::splat(cpu, inside.cone), L::splat(cpu, beyond.cone));
            // The chord of r(t) from the start, less the tangent at t.
            let least = L::splat(cpu, S::from_f64(LEAST));
            let (r, r_from) = (u.sqrt(), u_from.sqrt());
            let slope = t.mul_add(across, path.along) / r.larger(least);
            let excess = slope.mul_add(distance, r_from - r) / distance.larger(least);
            bend = bend + cone * (excess + excess);
        }
        let bend = if self.by_height { bend * contact.q } else { bend };
        let first = bend.less(contact.facing + contact.facing);
        let ahead = L::both(zero.less(contact.q), zero.less(contact.facing));
        L::both(L::both(L::both(there, near), L::both(first, ahead)), zero.less_equal(distance))
    }

    /// Finds, by the walk, where the rays in `open` (one bit each) meet the surface. Returns their t, with `t` for the
    /// other rays, and a second vector: 0 for rays that miss the surface, else 1. If `follow` is set, the walk makes no
    /// further attempt by Newton's iteration.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn one_by_one<L: Lanes<Scalar = S>, A: Apertures<L>>(
        &self,
        cpu: Cpu<L>,
        ray: &RayLanes<L, A>,
        from: L,
        t: L,
        open: u32,
        follow: bool,
    ) -> (L, L) {
        let mut columns = [[S::ZERO; WIDEST]; 7];
        for (column, lanes) in columns.iter_mut().zip([ray.x, ray.y, ray.vx, ray.vy, ray.vz, from, t]) {
            lanes.store(column);
        }
        let mut met = [S::ONE; WIDEST];
        self.walk(&mut columns, &mut met, open, follow);
        (L::load(cpu, &columns[6]), L::load(cpu, &met))
    }

    #[cold]
    #[inline(never)]
    fn walk(&self, columns: &mut [[S; WIDEST]; 7], met: &mut [S; WIDEST], mut open: u32, follow: bool) {
        while open != 0 {
            let lane = open.trailing_zeros() as usize;
            open &= open - 1;
            let [x, y, vx, vy, vz, from, _] = columns.each_ref().map(|column| column[lane].to_f64());
            let (start, v) = ([x, y, self.common.start.to_f64()], [vx, vy, vz]);
            let crossing = if follow {
                self.exact.followed(start, v, from)
            } else {
                self.exact.first_crossing(start, v, from)
            };
            match crossing {
                Ok(t) => columns[6][lane] = S::from_f64(t),
                Err(_) => met[lane] = S::ZERO,
            }
        }
    }
}

/// Maximum number of steps along a followed ray; a ray that takes more steps goes to the walk.
const STEPS: usize = 24;
/// Factor by which rounding may make a squared distance exceed its bound.
const BESIDE: f64 = 1.0 + 1e-6;

/// Result for rays that are followed.
struct FollowedRays<L> {
    /// t where the rays cross the surface; arbitrary for rays that do not cross it.
    t: L,
    /// Positive for rays that cross the surface, and for rays that took too many steps.
    unblocked: L,
    /// The rays that took too many steps, one bit each.
    unresolved: u32,
}

/// The surface near a point of each followed ray.
struct Measure<L: Lanes> {
    /// -φ and φ', where φ is the function whose second derivative is bounded.
    before: L,
    facing: L,
    /// Lanes where the ray is behind the equator, and φ is q.
    behind: L::Mask,
}

impl<S: Scalar> LaneAsphere<S> {
    /// Follows the rays in `open`, one bit each, to their first crossing of the surface.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn follow<L: Lanes<Scalar = S>, A: Apertures<L>>(
        &self,
        cpu: Cpu<L>,
        ray: &RayLanes<L, A>,
        path: &RadialPath<L>,
        open: u32,
    ) -> FollowedRays<L> {
        let (zero, one) = (L::splat(cpu, S::ZERO), L::splat(cpu, S::ONE));
        let tolerance = L::splat(cpu, S::from_f64(self.exact.tolerance));
        let highest = S::from_f64(self.exact.extent[1] - self.common.start.to_f64());
        let end = L::splat(cpu, highest) / ray.vz;
        let (edge, reach) = (L::splat(cpu, self.edge_u), L::splat(cpu, self.reach));
        let beside = L::splat(cpu, S::from_f64(self.exact.bend.reach * BESIDE));
        let inside = self.inside.along_rays(cpu, path.across).larger(zero);
        let beyond = self.beyond.along_rays(cpu, path.across).larger(zero);
        let equator = self.equator.along_rays(cpu, path.across).larger(zero);
        // The ray is followed from its first point within the reach of the bounds.
        let is_near = path.height_squared(path.from).less_equal(reach);
        let square = path.along * path.along - path.across * (path.u - reach);
        let entry = zero - (path.along + square.sqrt()) / path.across;
        let mut t = L::select(is_near, path.from, entry);
        // `going` is 1 for rays that have not reached the surface yet, `met` is 1 for rays that have reached it.
        let mut going = L::select(is_near, one, L::select(path.from.less(entry), one, zero));
        let mut met = zero;
        for _ in 0..STEPS {
            let Measure { before, facing, behind } = self.measure(cpu, ray, path, t);
            let here = path.height_squared(t);
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
            // The step leads to the point where a parabola with this second derivative reaches 0.
            let (twice, square) = (before + before, facing * facing);
            let by_inside = facing + inside.mul_add(twice, square).sqrt();
            let by_beyond = facing + beyond.mul_add(twice, square).sqrt();
            let (short, long) = (twice / by_beyond, twice / by_inside);
            let stays = L::both(here.less_equal(edge), path.height_squared(t + long).less_equal(edge));
            let is_long = L::both(stays, L::both(zero.less(by_inside), zero.less(long)));
            let is_short = L::both(zero.less(by_beyond), zero.less(short));
            going = L::select(is_long, going, L::select(is_short, going, zero));
            t = L::select(zero.less(going), t + L::select(is_long, long, short), t);
            if open & L::bits(zero.less(going)) == 0 {
                break;
            }
        }
        let unresolved = open & L::bits(zero.less(going));
        let mut contact = self.contact(cpu, ray, path, t);
        for _ in 0..2 {
            t = t + contact.residual / contact.facing;
            contact = self.contact(cpu, ray, path, t);
        }
        // The other half or sheet of the conic is not part of the surface. A point where a ray comes back up through
        // the surface does not count either.
        let is_ahead = L::both(zero.less(contact.q), zero.less(contact.facing));
        let met = L::select(is_ahead, met, zero);
        FollowedRays { t, unblocked: met.larger(going), unresolved }
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn contact<L: Lanes<Scalar = S>, A: Apertures<L>>(
        &self,
        cpu: Cpu<L>,
        ray: &RayLanes<L, A>,
        path: &RadialPath<L>,
        t: L,
    ) -> LaneContact<L> {
        self.contacts(cpu, &[*ray], &[*path], &[t])[0]
    }

    /// Returns -φ and φ' at t. Far below the surface, q and thus G may have either sign; the sign of a height is
    /// certain.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn measure<L: Lanes<Scalar = S>, A: Apertures<L>>(
        &self,
        cpu: Cpu<L>,
        ray: &RayLanes<L, A>,
        path: &RadialPath<L>,
        t: L,
    ) -> Measure<L> {
        let zero = L::splat(cpu, S::ZERO);
        let along = t.mul_add(path.across, path.along);
        if !self.by_height {
            let LaneContact { residual, facing, q, .. } = self.contact(cpu, ray, path, t);
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
        let u = t.mul_add(along + path.along, path.u);
        let [[terms], [slope]] = self.terms.at(cpu, &[u * L::splat(cpu, self.terms.per_unit)]);
        let (one, c) = (L::splat(cpu, S::ONE), L::splat(cpu, self.c));
        let root = (c * L::splat(cpu, self.kappa_c)).neg_mul_add(u, one).sqrt();
        let z = t.mul_add(ray.vz, L::splat(cpu, self.common.start));
        let before = (c * u / (one + root) + terms) - z;
        let slope = slope.mul_add(L::splat(cpu, self.two_per_unit), c / root);
        Measure { before, facing: slope.neg_mul_add(along, ray.vz), behind: zero.less(zero) }
    }
}

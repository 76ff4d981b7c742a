//! The algorithm: traces vectors of rays through a table step by step, each step for all of them.

use super::{
    apertures::Apertures,
    asphere::LaneAsphere,
    dispersion::MediaOnWay,
    lanes::{Cpu, Lanes},
    ray::RayLanes,
    simd::Compiled,
    table::{ApertureTest, Link, Step, Table},
};
use crate::numeric::Real;

/// Traces vectors of rays, each behind the first surface, through all other surfaces, with the treatment `A` at their
/// apertures: the first `count` of `U` vectors, at least one. The vectors behind them are idle: their values are
/// arbitrary, and they become blocked.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn through<L: Lanes, A: Apertures<L>, const U: usize>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    on_way: &mut impl MediaOnWay<L>,
    rays: &mut [RayLanes<L, A>; U],
    count: usize,
) {
    if U == 1 && !L::SHARED {
        return trace_steps(cpu, table, on_way, rays, 1);
    }
    // Idle vectors are blocked, so that no search is made for their crossings either.
    let zero = L::splat(cpu, L::Scalar::ZERO);
    for ray in rays.iter_mut().skip(count) {
        ray.keep(zero.less(zero));
    }
    // Several vectors side by side exceed the registers and are in memory already, so that a separate function costs
    // nothing.
    L::apart(cpu, Steps { cpu, table, on_way, rays, count });
}

/// [`trace_steps`], as work to be compiled apart.
struct Steps<'a, L: Lanes, A, W, const U: usize> {
    cpu: Cpu<L>,
    table: &'a Table<L::Scalar>,
    on_way: &'a mut W,
    rays: &'a mut [RayLanes<L, A>; U],
    count: usize,
}

impl<L: Lanes, A: Apertures<L>, W: MediaOnWay<L>, const U: usize> Compiled for Steps<'_, L, A, W, U> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run(self) {
        let Self { cpu, table, on_way, rays, count } = self;
        if U > 1 {
            trace_steps(cpu, table, on_way, rays, count);
        } else {
            // A single vector stays in registers from here on.
            let mut own = *rays;
            trace_steps(cpu, table, on_way, &mut own, 1);
            *rays = own;
        }
    }
}

/// Traces vectors of rays through all surfaces but the first, each surface for all of them.
///
/// The loops over vectors are not unrolled: a step of one vector does not wait for that of another, and the
/// processor's out-of-order window spans several of them. Only an asphere is too long for that.
#[cfg_attr(not(debug_assertions), inline(always))]
fn trace_steps<L: Lanes, A: Apertures<L>, W: MediaOnWay<L>, const U: usize>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    on_way: &mut W,
    rays: &mut [RayLanes<L, A>; U],
    count: usize,
) {
    let count = if U == 1 { 1 } else { count };
    // Loops, not closures, here and below: a closure that is not inlined would be compiled for another processor than
    // its enclosing function.
    for (number, step) in (1..).zip(&table.steps[1..]) {
        on_way.go_to(cpu, number);
        let all = &mut *rays;
        let rays = &mut all[..count];
        match step {
            Step::Link(link) => {
                if link.forward {
                    for ray in &mut *rays {
                        ray.go_forward(cpu);
                    }
                }
                match (link.aperture_test, link.rarer) {
                    (ApertureTest::NormalZ(limit), false) => {
                        cross::<L, A, W, true, false>(cpu, link, on_way, limit, rays)
                    }
                    (ApertureTest::NormalZ(limit), true) => {
                        cross::<L, A, W, true, true>(cpu, link, on_way, limit, rays)
                    }
                    (ApertureTest::Height(limit), false) => {
                        cross::<L, A, W, false, false>(cpu, link, on_way, limit, rays)
                    }
                    (ApertureTest::Height(limit), true) => {
                        cross::<L, A, W, false, true>(cpu, link, on_way, limit, rays)
                    }
                }
            }
            Step::Stop(stop) => {
                for ray in rays {
                    ray.stop(cpu, stop);
                }
            }
            Step::Blades(stop) => {
                for ray in rays {
                    ray.blades(cpu, stop);
                }
            }
            Step::Sphere(sphere) => {
                if sphere.tests.forward {
                    for ray in &mut *rays {
                        ray.go_forward(cpu);
                    }
                }
                if sphere.plain {
                    for (u, ray) in rays.iter_mut().enumerate() {
                        let minus_z = ray.minus_z(cpu, &sphere.transfer);
                        ray.sphere::<true>(cpu, sphere, on_way.media(u), minus_z, None);
                    }
                } else {
                    for (u, ray) in rays.iter_mut().enumerate() {
                        let minus_z = ray.minus_z(cpu, &sphere.transfer);
                        ray.sphere::<false>(cpu, sphere, on_way.media(u), minus_z, ray.lead(sphere.is_led));
                    }
                }
            }
            Step::Conic(conic) => {
                for (u, ray) in rays.iter_mut().enumerate() {
                    let minus_z = ray.minus_z(cpu, &conic.transfer);
                    let lead = ray.lead(conic.common.is_led).unwrap_or(L::splat(cpu, L::Scalar::ZERO));
                    ray.conic(cpu, conic, on_way.media(u), minus_z, lead);
                }
            }
            // Unrolled for the whole group, of which some vectors may be idle, and for a pair. Searches of edges use
            // whole groups only.
            Step::Asphere(asphere) => {
                if U > 2
                    && A::BLOCK
                    && count == 2
                    && let Some(pair) = all.first_chunk_mut::<2>()
                {
                    meet(cpu, asphere, on_way, count, pair);
                } else {
                    meet(cpu, asphere, on_way, count, all);
                }
            }
            Step::Mirror(mirror) => {
                for ray in rays {
                    ray.mirror(cpu, mirror);
                }
            }
            Step::Renormalise(length) => {
                for (u, ray) in rays.iter_mut().enumerate() {
                    ray.scale_to(cpu, *length, on_way.media(u));
                }
            }
            Step::Plane(plane) => {
                for (u, ray) in rays.iter_mut().enumerate() {
                    let minus_z = ray.minus_z(cpu, &plane.transfer);
                    ray.plane::<false>(cpu, plane, on_way.media(u), minus_z, ray.lead(plane.is_led));
                }
            }
        }
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn cross<L: Lanes, A: Apertures<L>, W: MediaOnWay<L>, const STEEP: bool, const RARER: bool>(
    cpu: Cpu<L>,
    link: &Link<L::Scalar>,
    on_way: &W,
    limit: L::Scalar,
    rays: &mut [RayLanes<L, A>],
) {
    for (u, ray) in rays.iter_mut().enumerate() {
        ray.link::<STEEP, RARER>(cpu, link, on_way.media(u), limit);
    }
}

/// Takes `V` vectors through an asphere, so that their sums overlap; the first `count` of them are not idle.
#[cfg_attr(not(debug_assertions), inline(always))]
fn meet<L: Lanes, A: Apertures<L>, W: MediaOnWay<L>, const V: usize>(
    cpu: Cpu<L>,
    asphere: &LaneAsphere<L::Scalar>,
    on_way: &W,
    count: usize,
    rays: &mut [RayLanes<L, A>; V],
) {
    let zero = L::splat(cpu, L::Scalar::ZERO);
    let (mut minus_z, mut leads, mut media) = ([zero; V], [zero; V], [on_way.media(0); V]);
    for (v, ray) in rays.iter().enumerate() {
        minus_z[v] = ray.minus_z(cpu, &asphere.transfer);
        leads[v] = ray.lead(asphere.common.is_led).unwrap_or(zero);
    }
    for (v, media) in media[..count].iter_mut().enumerate() {
        *media = on_way.media(v);
    }
    asphere.trace(cpu, rays, media, minus_z, leads);
}

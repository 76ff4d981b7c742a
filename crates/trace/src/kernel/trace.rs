//! The algorithm, which traces vectors of rays through a table step by step, each step for all vectors.

use super::{
    apertures::Apertures,
    asphere::LaneAsphere,
    carried::Carried,
    ray_lanes::{RayLanes, Start},
    table::{ClearTest, Link, Step, Table},
    unsymmetric::GeneralSteps,
};
use realistic_base::numeric::Real;
use realistic_simd::{Compiled, Cpu, Lanes};

/// Takes rays to the place where [`through`] takes over: behind the first surface, or before it if its step is general.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn enter<L: Lanes, A: Apertures<L>, C: Carried<L::Scalar>>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    carried: &C,
    wavelengths: L,
    start: Start<L>,
) -> (RayLanes<L, A>, C::State<L>) {
    let mut state = carried.start(cpu, wavelengths);
    carried.depart(&mut state, start.lead());
    if table.entered == 0 {
        return (RayLanes::before(cpu, start), state);
    }
    let first = &table.steps[0];
    carried.go_to(cpu, 0, &mut state);
    let (ray, crossing) = RayLanes::enter(cpu, first, carried.media(&state), start);
    carried.cross(cpu, 0, &mut state, &crossing);
    if first.reflects() {
        carried.turn_round(cpu, &mut state);
    }
    (ray, state)
}

/// Traces vectors of rays that have entered ([`enter`]) through all other surfaces, with the treatment `A` at
/// apertures and with the data that the rays carry. The first `count` of the `U` vectors, at least one, are traced. The
/// remaining vectors are idle: their values are arbitrary, and their rays become blocked.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn through<L: Lanes, A: Apertures<L>, C: Carried<L::Scalar>, const U: usize>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    carried: &C,
    rays: &mut [RayLanes<L, A>; U],
    states: &mut [C::State<L>; U],
    count: usize,
) {
    if U == 1 && !L::SHARED {
        return trace_steps(cpu, table, carried, rays, states, 1);
    }
    // Idle vectors are blocked, so that no search is made for their crossings.
    let zero = L::splat(cpu, L::Scalar::ZERO);
    for ray in rays.iter_mut().skip(count) {
        ray.keep(zero.less(zero));
    }
    // Several vectors side by side exceed the registers and are in memory already, so a separate function costs
    // nothing.
    L::apart(cpu, Steps { cpu, table, carried, rays, states, count });
}

/// The arguments of [`trace_steps`], packed so that [`Lanes::apart`] can call it from a separate function.
struct Steps<'a, L: Lanes, A, C: Carried<L::Scalar>, const U: usize> {
    cpu: Cpu<L>,
    table: &'a Table<L::Scalar>,
    carried: &'a C,
    rays: &'a mut [RayLanes<L, A>; U],
    states: &'a mut [C::State<L>; U],
    count: usize,
}

impl<L: Lanes, A: Apertures<L>, C: Carried<L::Scalar>, const U: usize> Compiled for Steps<'_, L, A, C, U> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run(self) {
        let Self { cpu, table, carried, rays, states, count } = self;
        if U > 1 {
            trace_steps(cpu, table, carried, rays, states, count);
        } else {
            // A single vector stays in registers from here on.
            let (mut own, mut state) = (*rays, *states);
            trace_steps(cpu, table, carried, &mut own, &mut state, 1);
            (*rays, *states) = (own, state);
        }
    }
}

/// Traces vectors of rays that have entered through all other surfaces, each surface for all vectors.
///
/// The loops over vectors are not unrolled: a step of one vector does not wait for that of another, and the processor's
/// out-of-order window spans several such steps. Only the step of an asphere is too long for the window.
#[cfg_attr(not(debug_assertions), inline(always))]
fn trace_steps<L: Lanes, A: Apertures<L>, C: Carried<L::Scalar>, const U: usize>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    carried: &C,
    rays: &mut [RayLanes<L, A>; U],
    states: &mut [C::State<L>; U],
    count: usize,
) {
    let count = if U == 1 { 1 } else { count };
    // Here and below, loops are used rather than closures: a closure that is not inlined would be compiled without the
    // instructions that its enclosing function may use.
    for (number, step) in table.steps.iter().enumerate().skip(table.entered) {
        for state in &mut states[..count] {
            carried.go_to(cpu, number, state);
        }
        let (all, all_states) = (&mut *rays, &mut *states);
        let (rays, states) = (&mut all[..count], &mut all_states[..count]);
        match step {
            Step::Link(link) => {
                if link.forward {
                    for ray in &mut *rays {
                        ray.go_forward(cpu);
                    }
                }
                match (link.aperture_test, link.rarer) {
                    (ClearTest::NormalZ(limit), false) => {
                        cross::<L, A, C, true, false>(cpu, link, carried, number, limit, rays, states)
                    }
                    (ClearTest::NormalZ(limit), true) => {
                        cross::<L, A, C, true, true>(cpu, link, carried, number, limit, rays, states)
                    }
                    (ClearTest::Height(limit), false) => {
                        cross::<L, A, C, false, false>(cpu, link, carried, number, limit, rays, states)
                    }
                    (ClearTest::Height(limit), true) => {
                        cross::<L, A, C, false, true>(cpu, link, carried, number, limit, rays, states)
                    }
                }
            }
            Step::Stop(stop) => {
                for ray in rays {
                    ray.stop(cpu, stop);
                }
            }
            Step::Aperture(aperture) => {
                for ray in rays {
                    ray.aperture(cpu, aperture);
                }
            }
            Step::Sphere(sphere) => {
                if sphere.tests.forward {
                    for ray in &mut *rays {
                        ray.go_forward(cpu);
                    }
                }
                if sphere.plain {
                    for (ray, state) in rays.iter_mut().zip(states) {
                        let minus_z = ray.minus_z(cpu, &sphere.transfer);
                        let crossing = ray.sphere::<true>(cpu, sphere, carried.media(state), minus_z, None);
                        carried.cross(cpu, number, state, &crossing);
                    }
                } else {
                    for (ray, state) in rays.iter_mut().zip(states) {
                        let (minus_z, lead) = (ray.minus_z(cpu, &sphere.transfer), ray.lead(sphere.is_led));
                        let crossing = ray.sphere::<false>(cpu, sphere, carried.media(state), minus_z, lead);
                        carried.cross(cpu, number, state, &crossing);
                    }
                }
            }
            Step::Conic(conic) => {
                for (ray, state) in rays.iter_mut().zip(states) {
                    let minus_z = ray.minus_z(cpu, &conic.transfer);
                    let lead = ray.lead(conic.common.is_led).unwrap_or(L::splat(cpu, L::Scalar::ZERO));
                    let crossing = ray.conic(cpu, conic, carried.media(state), minus_z, lead);
                    conic.common.cross(cpu, carried, number, state, &crossing);
                }
            }
            Step::General(step) if U == 1 => {
                // Only copies have their address taken, so that the ray stays in registers at other steps.
                let (mut own, mut own_states) = (*all, *all_states);
                let (rays, states) = (&mut own[..], &mut own_states[..]);
                L::far_apart(cpu, GeneralSteps { cpu, step, carried, number, rays, states });
                (*all, *all_states) = (own, own_states);
            }
            Step::General(step) => {
                L::far_apart(cpu, GeneralSteps { cpu, step, carried, number, rays, states });
            }
            // This step is unrolled for the whole group, in which some vectors may be idle, and for a pair of vectors.
            // Searches for edges use whole groups only.
            Step::Asphere(asphere) => {
                if U > 2
                    && A::BLOCK
                    && count == 2
                    && let (Some(pair), Some(states)) = (all.first_chunk_mut(), all_states.first_chunk_mut())
                {
                    meet::<L, A, C, 2>(cpu, asphere, carried, number, count, pair, states);
                } else {
                    meet(cpu, asphere, carried, number, count, all, all_states);
                }
            }
            Step::Mirror(mirror) => {
                for (ray, state) in rays.iter_mut().zip(states) {
                    ray.mirror(cpu, mirror);
                    carried.turn_round(cpu, state);
                }
            }
            Step::Renormalise(length) => {
                for (ray, state) in rays.iter_mut().zip(states) {
                    ray.scale_to(cpu, *length, carried.media(state));
                }
            }
            Step::Plane(plane) => {
                for (ray, state) in rays.iter_mut().zip(states) {
                    let (minus_z, lead) = (ray.minus_z(cpu, &plane.transfer), ray.lead(plane.is_led));
                    let crossing = ray.plane::<false>(cpu, plane, carried.media(state), minus_z, lead);
                    carried.cross(cpu, number, state, &crossing);
                }
            }
        }
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn cross<L: Lanes, A: Apertures<L>, C: Carried<L::Scalar>, const STEEP: bool, const RARER: bool>(
    cpu: Cpu<L>,
    link: &Link<L::Scalar>,
    carried: &C,
    number: usize,
    limit: L::Scalar,
    rays: &mut [RayLanes<L, A>],
    states: &mut [C::State<L>],
) {
    for (ray, state) in rays.iter_mut().zip(states) {
        let crossing = ray.link::<STEEP, RARER>(cpu, link, carried.media(state), limit);
        carried.cross(cpu, number, state, &crossing);
    }
}

/// Takes `V` vectors through an asphere together, so that their sums overlap; all but the first `count` vectors are
/// idle.
#[cfg_attr(not(debug_assertions), inline(always))]
fn meet<L: Lanes, A: Apertures<L>, C: Carried<L::Scalar>, const V: usize>(
    cpu: Cpu<L>,
    asphere: &LaneAsphere<L::Scalar>,
    carried: &C,
    number: usize,
    count: usize,
    rays: &mut [RayLanes<L, A>; V],
    states: &mut [C::State<L>; V],
) {
    let zero = L::splat(cpu, L::Scalar::ZERO);
    let (mut minus_z, mut leads, mut media) = ([zero; V], [zero; V], [carried.media(&states[0]); V]);
    for (v, ray) in rays.iter().enumerate() {
        minus_z[v] = ray.minus_z(cpu, &asphere.transfer);
        leads[v] = ray.lead(asphere.common.is_led).unwrap_or(zero);
    }
    for v in 0..count {
        media[v] = carried.media(&states[v]);
    }
    let crossings = asphere.trace(cpu, rays, media, minus_z, leads);
    for v in 0..count {
        asphere.common.cross(cpu, carried, number, &mut states[v], &crossings[v]);
    }
}

//! The algorithm: vectors of rays taken through a table step by step, each step for all of them.

use super::{
    apertures::{Apertures, Blocking},
    dispersion::{Media, MediaOnWay},
    lanes::{Cpu, Lanes, each_further},
    ray::{End, RayLanes, Start},
    simd::Compiled,
    table::{ApertureTest, Link, Step, Table},
};
use crate::numeric::Real;

/// From where the rays start to where they end, each vector with its squared cosine to the axis before the lens.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn trace<L: Lanes, const U: usize>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    on_way: impl MediaOnWay<L, U>,
    starts: [Start<L>; U],
) -> [(End<L>, L); U] {
    let rays = through::<L, Blocking, U>(cpu, table, on_way, starts);
    let mut ended = [(rays[0].leave(cpu, table), rays[0].cos2); U];
    each_further!(u < U, {
        ended[u] = (rays[u].leave(cpu, table), rays[u].cos2);
    });
    ended
}

/// Through all surfaces, as `A` has it at their apertures.
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn through<L: Lanes, A: Apertures<L>, const U: usize>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    mut on_way: impl MediaOnWay<L, U>,
    starts: [Start<L>; U],
) -> [RayLanes<L, A>; U] {
    let media = on_way.at(cpu, 0);
    let mut rays = [RayLanes::enter(cpu, &table.steps[0], media[0], starts[0]); U];
    each_further!(u < U, {
        rays[u] = RayLanes::enter(cpu, &table.steps[0], media[u], starts[u]);
    });
    // Vectors side by side are more than the registers hold, and in memory already, so that a function of their own costs
    // nothing. One alone stays in registers where latency is all that counts.
    if U > 1 || L::SHARED {
        L::apart(cpu, Steps { cpu, table, on_way: &mut on_way, rays: &mut rays });
    } else {
        trace_steps(cpu, table, &mut on_way, &mut rays);
    }
    rays
}

/// [`trace_steps`] to be compiled apart.
struct Steps<'a, L: Lanes, A, W, const U: usize> {
    cpu: Cpu<L>,
    table: &'a Table<L::Scalar>,
    on_way: &'a mut W,
    rays: &'a mut [RayLanes<L, A>; U],
}

impl<L: Lanes, A: Apertures<L>, W: MediaOnWay<L, U>, const U: usize> Compiled for Steps<'_, L, A, W, U> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run(self) {
        let Self { cpu, table, on_way, rays } = self;
        if U > 1 {
            trace_steps(cpu, table, on_way, rays);
        } else {
            // In registers from here on, too.
            let mut own = *rays;
            trace_steps(cpu, table, on_way, &mut own);
            *rays = own;
        }
    }
}

/// Takes vectors of rays through all surfaces but the first, each surface for all of them.
#[cfg_attr(not(debug_assertions), inline(always))]
fn trace_steps<L: Lanes, A: Apertures<L>, W: MediaOnWay<L, U>, const U: usize>(
    cpu: Cpu<L>,
    table: &Table<L::Scalar>,
    on_way: &mut W,
    rays: &mut [RayLanes<L, A>; U],
) {
    // Loops and not closures, here and below: a closure that is not inlined would be compiled for
    // another processor than the function it stands in.
    for (number, step) in (1..).zip(&table.steps[1..]) {
        for ray in &mut *rays {
            ray.apertures.step(number);
        }
        let media = on_way.at(cpu, number);
        match step {
            Step::Link(link) => {
                if link.forward {
                    for ray in &mut *rays {
                        ray.go_forward(cpu);
                    }
                }
                match (link.aperture_test, link.rarer) {
                    (ApertureTest::NormalZ(limit), false) => {
                        cross::<L, A, _, U, true, false>(cpu, link, media, limit, rays)
                    }
                    (ApertureTest::NormalZ(limit), true) => {
                        cross::<L, A, _, U, true, true>(cpu, link, media, limit, rays)
                    }
                    (ApertureTest::Height(limit), false) => {
                        cross::<L, A, _, U, false, false>(cpu, link, media, limit, rays)
                    }
                    (ApertureTest::Height(limit), true) => {
                        cross::<L, A, _, U, false, true>(cpu, link, media, limit, rays)
                    }
                }
            }
            Step::Stop(stop) => {
                for ray in &mut *rays {
                    ray.stop(cpu, stop);
                }
            }
            // Blades are no edge that is searched for: what they leave open lies inside the stop's.
            Step::Blades(stop) if A::BLOCK => {
                for ray in &mut *rays {
                    ray.blades(cpu, stop);
                }
            }
            Step::Blades(_) => {}
            Step::Sphere(sphere) => {
                if sphere.tests.forward {
                    for ray in &mut *rays {
                        ray.go_forward(cpu);
                    }
                }
                if sphere.plain {
                    for (ray, media) in rays.iter_mut().zip(&media) {
                        let minus_z = ray.minus_z(cpu, &sphere.transfer);
                        ray.sphere::<true>(cpu, sphere, *media, minus_z, None);
                    }
                } else {
                    for (ray, media) in rays.iter_mut().zip(&media) {
                        let minus_z = ray.minus_z(cpu, &sphere.transfer);
                        ray.sphere::<false>(cpu, sphere, *media, minus_z, ray.lead(sphere.is_led));
                    }
                }
            }
            Step::Conic(conic) => {
                for (ray, media) in rays.iter_mut().zip(&media) {
                    let minus_z = ray.minus_z(cpu, &conic.transfer);
                    let lead = ray.lead(conic.common.is_led).unwrap_or(L::splat(cpu, L::Scalar::ZERO));
                    ray.conic(cpu, conic, *media, minus_z, lead);
                }
            }
            Step::Asphere(asphere) => {
                let zero = L::splat(cpu, L::Scalar::ZERO);
                let (mut minus_z, mut leads) = ([zero; U], [zero; U]);
                for (u, ray) in rays.iter().enumerate() {
                    minus_z[u] = ray.minus_z(cpu, &asphere.transfer);
                    leads[u] = ray.lead(asphere.common.is_led).unwrap_or(zero);
                }
                asphere.trace(cpu, rays, media, minus_z, leads);
            }
            Step::Renormalise(length) => {
                for (ray, media) in rays.iter_mut().zip(&media) {
                    ray.scale_to(cpu, *length, *media);
                }
            }
            Step::Plane(plane) => {
                for (ray, media) in rays.iter_mut().zip(&media) {
                    let minus_z = ray.minus_z(cpu, &plane.transfer);
                    ray.plane::<false>(cpu, plane, *media, minus_z, ray.lead(plane.is_led));
                }
            }
        }
    }
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn cross<L: Lanes, A: Apertures<L>, M: Media<L>, const U: usize, const STEEP: bool, const RARER: bool>(
    cpu: Cpu<L>,
    link: &Link<L::Scalar>,
    media: [M; U],
    limit: L::Scalar,
    rays: &mut [RayLanes<L, A>; U],
) {
    for (ray, media) in rays.iter_mut().zip(&media) {
        ray.link::<STEEP, RARER>(cpu, link, *media, limit);
    }
}

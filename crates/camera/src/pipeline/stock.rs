//! Cameras without a prescription in lanes of single precision, from samples to world rays of weight 1.

use super::{film_sampling::SampleLanes, tracer::Tracer};
use crate::vectors::in_vectors;
use crate::{
    placement::{Placement, RangedRays, SingleToWorld},
    rays::Rays,
    samples::Samples,
};
use realistic_simd::{Available, Cpu, Lanes};
use realistic_trace::kernel::{Grouping, InVectors};

/// A projection that makes a camera-space ray with a unit direction from a sample.
pub trait View: Send + Sync {
    /// Makes the rays in lanes. The numbers of a lane are not those of a valid ray if its sample has no ray
    /// or one beyond single precision.
    fn lanes<L: Lanes<Scalar = f32>>(&self, cpu: Cpu<L>, samples: &SampleLanes<L>) -> RangedRays<L>;
}

/// A camera with a projection.
pub struct StockTracer<V> {
    view: V,
    to_world: SingleToWorld,
    simd: Available,
}

impl<V: View> StockTracer<V> {
    pub fn new(view: V, placement: &Placement) -> Self {
        Self { view, to_world: SingleToWorld::new(placement), simd: Available::best() }
    }
}

impl<V: View> Tracer for StockTracer<V> {
    fn trace(&self, samples: &Samples<'_>, rays: &mut Rays<'_>) {
        in_vectors(self.simd, Grouping::of(samples.len()), &mut StockPass { camera: self, samples, rays });
    }

    fn writes_range(&self) -> bool {
        true
    }
}

/// The state of one call: the samples, and the columns of their world rays.
struct StockPass<'a, 'b, 'c, V> {
    camera: &'a StockTracer<V>,
    samples: &'a Samples<'b>,
    rays: &'a mut Rays<'c>,
}

impl<V: View> InVectors<f32> for StockPass<'_, '_, '_, V> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        self.samples.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = f32>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        let StockTracer { view, to_world, .. } = self.camera;
        for at in (first..).step_by(L::WIDTH).take(count) {
            let rays = view.lanes(cpu, &SampleLanes::load(cpu, self.samples, at));
            let RangedRays { origin, direction, range } =
                to_world.lanes(cpu, rays, &self.samples.column(4)[at..]);
            let weight = L::splat(cpu, 1.0);
            let all = weight.less_equal(weight);
            self.rays.store(cpu, at, [origin, direction], Some(range), weight, all);
        }
    }
}

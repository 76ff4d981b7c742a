//! Cameras without a prescription in lanes of single precision, from samples to world rays of weight 1.

use super::{
    arrays::{OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore},
    film_sampling::SampleLanes,
    tracer::Tracer,
};
use crate::{
    camera::{
        placement::{Placement, RangedRays, SingleToWorld},
        ray::Sample,
    },
    trace::kernel::{Available, Cpu, Grouping, InVectors, Lanes, in_registers, portable},
};

/// What makes a camera-space ray, in its units and with a unit direction, of a sample.
pub(crate) trait View: Send + Sync {
    /// In lanes. Where a sample makes no ray, or one beyond single precision, the numbers are no ray's.
    fn lanes<L: Lanes<Scalar = f32>>(&self, cpu: Cpu<L>, samples: &SampleLanes<L>) -> RangedRays<L>;
}

/// A camera with a view.
pub(crate) struct StockTracer<V> {
    view: V,
    to_world: SingleToWorld,
    simd: Available,
}

impl<V: View> StockTracer<V> {
    pub fn new(view: V, placement: &Placement) -> Self {
        Self { view, to_world: SingleToWorld::new(placement), simd: Available::best() }
    }

    #[inline(always)]
    fn trace(&self, grouping: Grouping, samples: &impl SampleStore, rays: &mut impl RayStore) {
        if !in_registers(self.simd, grouping, &mut Job { camera: self, samples, rays: &mut *rays }) {
            portable(&mut Job { camera: self, samples: &samples.as_arrays(), rays: &mut rays.as_arrays() });
        }
    }
}

impl<V: View> Tracer for StockTracer<V> {
    fn one(&self, sample: &Sample, ray: &mut OneRay<'_>) {
        self.trace(Grouping::One, sample, ray);
    }

    fn four(&self, samples: &SampleBlock<4>, rays: &mut RayBlock<4>) -> bool {
        self.trace(Grouping::Quad, samples, rays);
        true
    }

    fn many(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        self.trace(Grouping::of(samples.len()), samples, rays);
    }

    fn writes_range(&self) -> bool {
        true
    }
}

/// Samples on their way to world rays.
struct Job<'a, V, I, R> {
    camera: &'a StockTracer<V>,
    samples: &'a I,
    rays: &'a mut R,
}

impl<V: View, I: SampleStore, R: RayStore> Job<'_, V, I, R> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes<Scalar = f32>>(&mut self, cpu: Cpu<L>, at: usize) {
        let StockTracer { view, to_world, .. } = self.camera;
        let rays = view.lanes(cpu, &SampleLanes::load(cpu, self.samples, at));
        let RangedRays { origin, direction, range } = to_world.lanes(cpu, rays, &self.samples.array(4)[at..]);
        let weight = L::splat(cpu, 1.0);
        let all = weight.less_equal(weight);
        self.rays.store(cpu, at, [origin, direction], Some(range), weight, all);
    }
}

impl<V: View, I: SampleStore, R: RayStore> InVectors<f32> for Job<'_, V, I, R> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        self.samples.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vectors<L: Lanes<Scalar = f32>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize) {
        self.group::<L, U>(cpu, first, U);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = f32>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        for u in 0..count {
            self.vector(cpu, first + u * L::WIDTH);
        }
    }
}

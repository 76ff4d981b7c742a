//! A camera's whole arithmetic in one precision: film ray, trace, weight and world ray in one pass of vectors.
//!
//! One sample, four and many take the same way, in vectors of another width.

use std::cell::Cell;

use super::{
    arrays::{OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore},
    body::{CameraBody, LaneBody},
    film_sampling::SampleLanes,
    tracer::{LensTracer, Tracer},
};
use crate::{
    camera::ray::Sample,
    sampling::{disk::Turns, film_rays::FilmRays},
    trace::{
        Blocked, Ray,
        kernel::{
            Approach, Available, Batch, Cpu, End, Grouping, Kernel, Lanes, Optics, Start, Through,
            from_plane, in_registers, portable,
        },
        polynomial::{Polynomial, PolynomialLens},
    },
};

/// A camera compiled for a precision and a way through the lens. How a call is grouped does not change a bit of its
/// results.
pub(crate) struct Pipeline<S> {
    body: LaneBody<S>,
    whole: Kernel<S>,
    /// What serves rays from the film in the place of the whole lens, and the square of the film's radius, mm²: it knows
    /// nothing of rays from beyond.
    fit: Option<(PolynomialLens<S>, S)>,
}

impl<S: Turns> Pipeline<S> {
    /// Every ray goes through the whole lens.
    pub fn exact(whole: &Kernel<S>, body: &CameraBody) -> Self {
        Self { body: body.lane_body(), whole: whole.clone(), fit: None }
    }

    /// Rays from the film go through polynomials; a host that asks for points beyond gets the `whole` lens there.
    pub fn fitted(whole: &Kernel<S>, fit: &Polynomial, body: &CameraBody) -> Self {
        let reach = body.film_side.film.reach();
        let fit = (PolynomialLens::new(fit), S::from_f64(reach * reach));
        Self { fit: Some(fit), ..Self::exact(whole, body) }
    }

    /// The way of every sample, however many they are.
    #[inline(always)]
    fn trace(&self, grouping: Grouping, samples: &impl SampleStore, rays: &mut impl RayStore) {
        let Some((fit, within)) = &self.fit else {
            let (simd, table) = (self.whole.available(), self.whole.table());
            trace(simd, grouping, &self.body, table, None, samples, rays);
            return;
        };
        if trace(fit.available(), grouping, &self.body, fit, Some(*within), samples, rays) {
            self.trace_out_of_range(*within, samples, rays);
        }
    }

    /// Traces anew, by the whole lens, those samples whose film points lie beyond the polynomials' range.
    #[cold]
    fn trace_out_of_range(&self, within: S, samples: &impl SampleStore, rays: &mut impl RayStore) {
        for i in 0..samples.len() {
            let sample = samples.sample(i);
            // Not "greater": a film point that is not a number is out of range, too.
            if !(self.body.film.radius_squared(&sample) <= within) {
                let (mut ray, mut weight) = Default::default();
                let mut one = OneRay { ray: &mut ray, weight: &mut weight };
                let (simd, table) = (self.whole.available(), self.whole.table());
                trace(simd, Grouping::One, &self.body, table, None, &sample, &mut one);
                rays.put(i, (weight > 0.0).then_some((ray, weight)));
            }
        }
    }
}

impl<S: Turns + Send + Sync> Tracer for Pipeline<S> {
    fn one(&self, sample: &Sample, ray: &mut OneRay<'_>) {
        self.trace(Grouping::One, sample, ray);
    }

    fn four(&self, samples: &SampleBlock<4>, rays: &mut RayBlock<4>) -> bool {
        self.trace(Grouping::Quad, samples, rays);
        true
    }

    fn many(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        match samples.len() {
            n @ 1..=4 => {
                let mut found = RayBlock::<4>::new();
                self.four(&SampleBlock::first_of(samples), &mut found);
                (0..n).for_each(|i| rays.copy(i, &mut found, i));
            }
            _ => self.trace(Grouping::Wide, samples, rays),
        }
    }
}

impl<S: Turns + Send + Sync> LensTracer for Pipeline<S> {
    fn film_ray(&self, sample: &Sample) -> FilmRays<f64> {
        self.body.film.one(sample)
    }

    fn reason(&self, _: &Sample, ray: Ray) -> Blocked {
        self.whole.reason(ray)
    }
}

/// Takes samples, however many they are, through optics to world rays; whether there were film points farther out than `within`,
/// which have no rays. In portable vectors all are arrays, so that those are compiled for one kind of samples.
#[inline(always)]
pub(super) fn trace<S: Turns>(
    simd: Available,
    grouping: Grouping,
    body: &LaneBody<S>,
    optics: &impl Optics<S>,
    within: Option<S>,
    samples: &impl SampleStore,
    rays: &mut impl RayStore,
) -> bool {
    let mut job = Job::new(body, samples, rays, within);
    if in_registers(simd, grouping, &mut Through { optics, batch: &mut job }) {
        return job.is_out_of_range.get();
    }
    trace_arrays(body, optics, within, &samples.as_arrays(), &mut rays.as_arrays())
}

/// [`trace`] in portable vectors. Not inlined, so that single rays by other instructions do not pay for it.
#[cold]
#[inline(never)]
fn trace_arrays<S: Turns>(
    body: &LaneBody<S>,
    optics: &impl Optics<S>,
    within: Option<S>,
    samples: &SampleArrays<'_>,
    rays: &mut RayArrays<'_>,
) -> bool {
    let mut job = Job::new(body, samples, rays, within);
    portable(&mut Through { optics, batch: &mut job });
    job.is_out_of_range.get()
}

/// Samples on their way to world rays.
pub(super) struct Job<'a, S, I, R> {
    body: &'a LaneBody<S>,
    samples: &'a I,
    rays: &'a mut R,
    /// The square of the film radius up to which polynomials serve, mm²; `None` for any.
    within: Option<S>,
    /// Set where a film point lies beyond.
    is_out_of_range: Cell<bool>,
}

impl<'a, S: Turns, I: SampleStore, R> Job<'a, S, I, R> {
    #[inline(always)]
    pub fn new(body: &'a LaneBody<S>, samples: &'a I, rays: &'a mut R, within: Option<S>) -> Self {
        Self { body, samples, rays, within, is_out_of_range: Cell::new(false) }
    }

    /// Takes their areas from film rays out of range: polynomials must not write what the whole lens may block.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn check_range<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, rays: &mut [FilmRays<L>]) {
        let Some(within) = self.within else { return };
        let within = L::splat(cpu, within);
        for ray in rays {
            let is_within = ray.radius_squared().less_equal(within);
            if !L::all(is_within) {
                self.is_out_of_range.set(true);
                let none = L::splat(cpu, S::from_f64(f64::NAN));
                ray.area_per_pi = L::select(is_within, ray.area_per_pi, none);
            }
        }
    }

    /// A vector of samples from the one numbered `at` on.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn samples<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, at: usize) -> SampleLanes<L> {
        SampleLanes::load(cpu, self.samples, at)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn begin<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        approach: Approach,
        ray: &FilmRays<L>,
    ) -> (Start<L>, L) {
        (from_plane(cpu, approach, self.body.film_z, ray.point, ray.slopes), ray.area_per_pi)
    }
}

impl<S: Turns, I: SampleStore, R: RayStore> Batch<S> for Job<'_, S, I, R> {
    /// The slope area that a ray stands for, over π.
    type Carry<L: Lanes<Scalar = S>> = L;
    /// Where they leave the film and in which direction.
    type Ready<L: Lanes<Scalar = S>> = FilmRays<L>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        self.samples.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn prepare<L: Lanes<Scalar = S>, const N: usize>(&self, cpu: Cpu<L>, first: usize) -> [FilmRays<L>; N] {
        let mut samples = [self.samples(cpu, first); N];
        for (u, samples) in samples.iter_mut().enumerate().skip(1) {
            *samples = self.samples(cpu, first + u * L::WIDTH);
        }
        let mut rays = self.body.film.lanes(cpu, &samples);
        self.check_range(cpu, &mut rays);
        rays
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        approach: Approach,
        ready: FilmRays<L>,
    ) -> (Start<L>, L) {
        self.begin(cpu, approach, &ready)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn finish<L: Lanes<Scalar = S>>(&mut self, cpu: Cpu<L>, at: usize, cos2: L, area: L, end: End<L>) {
        let passed = L::both(end.passed, area.less_equal(area));
        let weight = match self.body.weight {
            // However small, the weight of a ray that passes is not that of a blocked one.
            Some(weight) => ((cos2 * cos2) * (area * L::splat(cpu, weight)))
                .larger(L::splat(cpu, S::from_f64(f32::MIN_POSITIVE.into()))),
            None => L::splat(cpu, S::ONE),
        };
        let passed = L::both(passed, weight.less_equal(L::splat(cpu, S::from_f64(f32::MAX.into()))));
        let placed = self.body.to_world.lanes(cpu, end.origin, end.direction, &self.samples.array(4)[at..]);
        self.rays.store(cpu, at, placed, None, weight, passed);
    }
}

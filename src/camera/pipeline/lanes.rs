//! A camera's whole arithmetic in one precision: film ray, trace, weight and world ray in one pass of vectors.
//!
//! One sample, four and many take the same way, in vectors of another width.

use super::{
    arrays::{OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore},
    body::{CameraBody, LaneBody},
    film_sampling::{FilmSource, SampleLanes, WithinRange},
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
        let Some((fit, within)) = &self.fit else { return self.trace_exactly(grouping, samples, rays) };
        let film = WithinRange::new(&self.body.film, *within);
        trace(fit.available(), grouping, &self.body, &film, fit, samples, rays);
        if film.is_exceeded() {
            self.trace_out_of_range(*within, samples, rays);
        }
    }

    /// By the whole lens.
    #[inline(always)]
    fn trace_exactly(&self, grouping: Grouping, samples: &impl SampleStore, rays: &mut impl RayStore) {
        let (simd, table) = (self.whole.available(), self.whole.table());
        trace(simd, grouping, &self.body, &self.body.film, table, samples, rays);
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
                self.trace_exactly(Grouping::One, &sample, &mut one);
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
            1..=4 => by_four(samples, rays, |four, found| {
                self.four(four, found);
            }),
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

/// Makes the rays of up to four samples as those of four, which takes less time than vectors of the widest kind. What `trace`
/// makes of samples beyond the last is dropped.
#[inline(always)]
pub(super) fn by_four(
    samples: &SampleArrays<'_>,
    rays: &mut RayArrays<'_>,
    trace: impl FnOnce(&SampleBlock<4>, &mut RayBlock<4>),
) {
    let mut found = RayBlock::new();
    trace(&SampleBlock::first_of(samples), &mut found);
    (0..samples.len()).for_each(|i| rays.copy(i, &mut found, i));
}

/// Takes samples, however many they are, from a film through optics to world rays. In portable vectors all are arrays, so
/// that those are compiled for one kind of samples.
#[inline(always)]
pub(super) fn trace<S: Turns>(
    simd: Available,
    grouping: Grouping,
    body: &LaneBody<S>,
    film: &impl FilmSource<Scalar = S>,
    optics: &impl Optics<S>,
    samples: &impl SampleStore,
    rays: &mut impl RayStore,
) {
    let mut job = Job { body, film, samples, rays: &mut *rays };
    if !in_registers(simd, grouping, &mut Through { optics, batch: &mut job }) {
        trace_arrays(body, film, optics, &samples.as_arrays(), &mut rays.as_arrays());
    }
}

/// [`trace`] in portable vectors. Not inlined, so that single rays by other instructions do not pay for it.
#[cold]
#[inline(never)]
fn trace_arrays<S: Turns>(
    body: &LaneBody<S>,
    film: &impl FilmSource<Scalar = S>,
    optics: &impl Optics<S>,
    samples: &SampleArrays<'_>,
    rays: &mut RayArrays<'_>,
) {
    portable(&mut Through { optics, batch: &mut Job { body, film, samples, rays } });
}

/// Samples on their way to world rays.
struct Job<'a, S, F, I, R> {
    body: &'a LaneBody<S>,
    film: &'a F,
    samples: &'a I,
    rays: &'a mut R,
}

impl<S: Turns, F: FilmSource<Scalar = S>, I: SampleStore, R: RayStore> Batch<S> for Job<'_, S, F, I, R> {
    /// [`FilmRays::area_per_pi`]: it waits here while the ray is traced.
    type Carry<L: Lanes<Scalar = S>> = L;
    /// Where they leave the film and in which direction.
    type Ready<L: Lanes<Scalar = S>> = FilmRays<L>;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        self.samples.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn prepare<L: Lanes<Scalar = S>, const N: usize>(&self, cpu: Cpu<L>, first: usize) -> [FilmRays<L>; N] {
        let mut samples = [SampleLanes::load(cpu, self.samples, first); N];
        for (u, samples) in samples.iter_mut().enumerate().skip(1) {
            *samples = SampleLanes::load(cpu, self.samples, first + u * L::WIDTH);
        }
        self.film.lanes(cpu, first, &samples)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        approach: Approach,
        ray: FilmRays<L>,
    ) -> (Start<L>, L) {
        (from_plane(cpu, approach, self.body.film_z, ray.point, ray.slopes), ray.area_per_pi)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn finish<L: Lanes<Scalar = S>>(&mut self, cpu: Cpu<L>, at: usize, cos2: L, area_per_pi: L, end: End<L>) {
        // A number, not NaN.
        let passed = L::both(end.passed, area_per_pi.less_equal(area_per_pi));
        let weight = match self.body.weight {
            // However small, the weight of a ray that passes is not that of a blocked one.
            Some(weight) => ((cos2 * cos2) * (area_per_pi * L::splat(cpu, weight)))
                .larger(L::splat(cpu, S::from_f64(f32::MIN_POSITIVE.into()))),
            None => L::splat(cpu, S::ONE),
        };
        let passed = L::both(passed, weight.less_equal(L::splat(cpu, S::from_f64(f32::MAX.into()))));
        let placed = self.body.to_world.lanes(cpu, end.origin, end.direction, &self.samples.array(4)[at..]);
        self.rays.store(cpu, at, placed, None, weight, passed);
    }
}

//! A camera's loop in one precision: film ray, pupil, lens, weight and world ray, one vector of samples after the
//! other.
//!
//! ```text
//! for each group of vectors
//!     film and pupil    samples to points on film, slopes and areas
//!     lens              first surface, all others for the whole group, last surface
//!     finish            weight, world ray, and into the caller's columns
//! ```

use std::sync::Arc;

use super::{
    body::LaneBody,
    film_sampling::SampleLanes,
    tracer::{LensTracer, Tracer},
};
use crate::{
    rays::Rays,
    samples::{Sample, Samples},
    sampling::film_rays::FilmRays,
    vectors::in_vectors,
};
use realistic_simd::{Available, Cpu, Lanes};
use realistic_trace::kernel::{Group, Grouping, InVectors, KernelScalar, Optics, from_plane};

/// A camera compiled for one precision and one tracer: a kernel's table of surfaces (with or without a
/// wavelength per ray), polynomials, or an ideal lens. The number of samples in a call does not change any
/// bit of the results.
pub struct Pipeline<S, O> {
    body: LaneBody<S>,
    lens: O,
    simd: Available,
    /// The tracer for film points outside the range of `lens`, and the square of the film radius, mm², beyond
    /// which it is used.
    beyond: Option<(Arc<dyn LensTracer>, S)>,
}

impl<S: KernelScalar, O: Optics<S>> Pipeline<S, O> {
    /// Returns a pipeline whose lens accepts rays from every film point.
    pub fn new(body: LaneBody<S>, lens: O, simd: Available) -> Self {
        Self { body, lens, simd, beyond: None }
    }

    /// Limits the lens to rays from film points within the radius `reach`, mm; `beyond` traces rays from
    /// farther out.
    pub fn within(self, reach: f64, beyond: Arc<dyn LensTracer>) -> Self {
        Self { beyond: Some((beyond, S::from_f64(reach * reach))), ..self }
    }

    /// Traces again the samples whose film points lie outside the lens's range.
    #[cold]
    fn trace_beyond(&self, samples: &Samples<'_>, rays: &mut Rays<'_>) {
        let Some((beyond, most)) = &self.beyond else { return };
        for i in 0..samples.len() {
            if self.body.film.radius_squared(&samples.get(i)) > *most {
                beyond.trace(&samples.part(i), &mut rays.part(i, 1));
            }
        }
    }
}

impl<S, O> Tracer for Pipeline<S, O>
where
    S: KernelScalar + Send + Sync,
    O: Optics<S> + Send + Sync,
{
    fn trace(&self, samples: &Samples<'_>, rays: &mut Rays<'_>) {
        let mut pass = PipelinePass { pipeline: self, samples, rays, has_left_range: false };
        in_vectors(self.simd, Grouping::of(samples.len()), &mut pass);
        if pass.has_left_range {
            self.trace_beyond(samples, rays);
        }
    }
}

impl<S, O> LensTracer for Pipeline<S, O>
where
    S: KernelScalar + Send + Sync,
    O: Optics<S> + Send + Sync,
{
    fn film_ray(&self, sample: &Sample, wavelength: Option<f32>) -> FilmRays<f64> {
        self.body.film.one(sample, wavelength)
    }
}

/// The state of one call: the samples, and the columns of their world rays.
struct PipelinePass<'a, 'b, 'c, S, O> {
    pipeline: &'a Pipeline<S, O>,
    samples: &'a Samples<'b>,
    rays: &'a mut Rays<'c>,
    /// Whether any film point lay outside the lens's range.
    has_left_range: bool,
}

impl<S: KernelScalar, O: Optics<S>> PipelinePass<'_, '_, '_, S, O> {
    /// Returns the film rays of `U` vectors, from sample `first` on. Rays from outside the lens's range get a
    /// NaN area.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn film_rays<L: Lanes<Scalar = S>, const U: usize>(
        &mut self,
        cpu: Cpu<L>,
        first: usize,
    ) -> ([FilmRays<L>; U], [L; U]) {
        let one = SampleLanes::load(cpu, self.samples, first);
        let (mut samples, mut wavelengths) = ([one; U], [one.wavelength; U]);
        for u in 1..U {
            samples[u] = SampleLanes::load(cpu, self.samples, first + u * L::WIDTH);
            wavelengths[u] = samples[u].wavelength;
        }
        let mut rays = self.pipeline.body.film.lanes(cpu, &samples);
        if let Some((_, most)) = &self.pipeline.beyond {
            let most = L::splat(cpu, *most);
            for ray in &mut rays {
                // This comparison is false for NaN, which has no ray in any case.
                let is_beyond = most.less(ray.radius_squared());
                if L::bits(is_beyond) != 0 {
                    self.has_left_range = true;
                    let none = L::splat(cpu, S::from_f64(f64::NAN));
                    ray.area_per_pi = L::select(is_beyond, none, ray.area_per_pi);
                }
            }
        }
        (rays, wavelengths)
    }

    /// Traces film rays into the lens, up to the surfaces that a group of vectors traverses side by side.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn enter<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        ray: FilmRays<L>,
        wavelength: L,
    ) -> (O::OnWay<L>, O::State<L>) {
        let Pipeline { body, lens, .. } = self.pipeline;
        lens.enter(cpu, wavelength, from_plane(cpu, lens.approach(), body.film_z, ray.point, ray.slopes))
    }

    /// Computes the weights of rays, transforms the rays to the world and stores them in the caller's
    /// columns, from index `at` on.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn finish<L: Lanes<Scalar = S>>(
        &mut self,
        cpu: Cpu<L>,
        at: usize,
        rays: O::OnWay<L>,
        state: &O::State<L>,
        area_per_pi: L,
    ) {
        let Pipeline { body, lens, .. } = self.pipeline;
        let end = lens.leave(cpu, rays, state);
        let (weight, passed) = body.weights(cpu, &end, area_per_pi);
        let placed = body.to_world.lanes(cpu, end.origin, end.direction, &self.samples.column(4)[at..]);
        self.rays.store(cpu, at, placed, None, weight, passed);
    }
}

impl<S: KernelScalar, O: Optics<S>> InVectors<S> for PipelinePass<'_, '_, '_, S, O> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        self.samples.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        let pipeline = self.pipeline;
        let lens = &pipeline.lens;
        // A single vector stays in registers.
        if U == 1 || count == 1 || !O::SIDE_BY_SIDE {
            for u in 0..count {
                let at = first + u * L::WIDTH;
                let ([ray], [wavelength]) = self.film_rays(cpu, at);
                let (entered, state) = self.enter(cpu, ray, wavelength);
                let (mut rays, mut states) = ([entered], [state]);
                lens.through(cpu, &mut rays, &mut states, 1);
                self.finish(cpu, at, rays[0], &states[0], ray.area_per_pi);
            }
            return;
        }
        let (mut rays, mut states, mut areas) =
            (Group::<_, U>::default(), Group::<_, U>::default(), Group::<_, U>::default());
        let prepared =
            if L::PREPARED_TOGETHER && count == U { Some(self.film_rays::<L, U>(cpu, first)) } else { None };
        for u in 0..count {
            let (ray, wavelength) = match &prepared {
                Some((all, wavelengths)) => (all[u], wavelengths[u]),
                None => {
                    let ([ray], [wavelength]) = self.film_rays(cpu, first + u * L::WIDTH);
                    (ray, wavelength)
                }
            };
            let (entered, state) = self.enter(cpu, ray, wavelength);
            rays.push(entered);
            states.push(state);
            areas.push(ray.area_per_pi);
        }
        let (rays, states) = (rays.filled(), states.filled());
        lens.through(cpu, rays, states, count);
        for (u, (rays, state)) in rays.iter().zip(states).enumerate().take(count) {
            self.finish(cpu, first + u * L::WIDTH, *rays, state, areas.get(u));
        }
    }
}

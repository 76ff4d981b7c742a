//! A camera's whole arithmetic in one precision: film ray, trace, weight and world ray in one pass of vectors.

use crate::sampling::film_rays::FilmRays;
use std::{cell::Cell, f64::consts::PI};

use super::film_rays::{Asked, Drawing, Sampler};
use crate::trace::kernel::{Approach, Batch, Cpu, End, Grouping, Lanes, Start, from_plane};
use crate::{
    camera::{
        Film, RayArrays, Sample, SampleArrays,
        placement::{Placement, ToWorld},
    },
    plan::shortened::Shortened,
    sampling::{DiskMapping, disk::Turns},
};

/// A camera compiled for a precision. The shape of a call does not change a bit of its results.
#[derive(Clone, Debug)]
pub(crate) struct Pipeline<S> {
    drawing: Drawing<S>,
    lens: Shortened<S>,
    film_z: f64,
    /// The weight of a ray is this times cos⁴ and the slope area it stands for, over π; `None`: it is 1.
    weight: Option<S>,
    to_world: ToWorld<S>,
}

impl<S: Turns> Pipeline<S> {
    pub fn new(
        (lens, film_z): (Shortened<S>, f64),
        (film, mapping, sampler): (&Film, DiskMapping, &Sampler),
        weight: Option<f64>,
        (placement, units_per_mm): (&Placement, f64),
    ) -> Self {
        Self {
            drawing: Drawing::new(film, mapping, sampler),
            lens,
            film_z,
            weight: weight.map(|weight| S::from_f64(PI * weight)),
            to_world: ToWorld::new(placement, units_per_mm),
        }
    }

    pub fn drawing(&self) -> &Drawing<S> {
        &self.drawing
    }

    pub fn lens(&self) -> &Shortened<S> {
        &self.lens
    }

    /// Origins, directions and weights of many rays, in arrays that all have one length. Of one that is blocked only the
    /// weight is written, 0.
    pub fn many(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        let mut job = Job { pipeline: self, samples, rays: &mut *rays, strays: Cell::new(false) };
        self.lens.trace(Grouping::Wide, &mut job);
        if job.strays.get() {
            self.trace_strays(samples, rays);
        }
    }

    /// Writes those of the samples anew that lie beyond what the lens is shortened for.
    #[cold]
    fn trace_strays(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        self.strays(
            rays.weight.len(),
            |i| samples.get(i),
            |i, [origin @ .., weight]| {
                rays.weight[i] = weight;
                if weight > 0.0 {
                    for (array, number) in rays.origin.iter_mut().chain(&mut rays.direction).zip(origin) {
                        array[i] = number;
                    }
                }
            },
        );
    }

    /// Traces by the whole lens those of `n` samples whose film points lie beyond what it is shortened for, and hands on
    /// the place, origin, direction and weight of each.
    pub fn strays(&self, n: usize, sample: impl Fn(usize) -> Sample, mut take: impl FnMut(usize, [f32; 7])) {
        let Some(within) = self.lens.within() else { return };
        for i in 0..n {
            let sample = sample(i);
            // Not "greater": a film point that is not a number is beyond, too.
            if !(self.drawing.radius_squared(&sample) <= within) {
                take(i, self.whole(&sample));
            }
        }
    }

    /// The film rays of samples, ready for the lens, each with the slope area that it stands for, over π. Film points of
    /// which the square of the radius is not `within` have no ray yet, and `strays` is told of them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn starts<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        approach: Approach,
        asked: &[Asked<L>; U],
        within: Option<S>,
        strays: &Cell<bool>,
    ) -> [(Start<L>, L); U] {
        let mut rays = self.drawing.lanes(cpu, asked);
        if let Some(within) = within {
            let within = L::splat(cpu, within);
            for ray in &mut rays {
                let is_within = ray.radius_squared().less_equal(within);
                if !L::all(is_within) {
                    strays.set(true);
                    // The short way must not write what the whole lens may block.
                    let none = L::splat(cpu, S::from_f64(f64::NAN));
                    ray.area_per_pi = L::select(is_within, ray.area_per_pi, none);
                }
            }
        }
        let mut starts = [self.start(cpu, approach, &rays[0]); U];
        for u in 1..U {
            starts[u] = self.start(cpu, approach, &rays[u]);
        }
        starts
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        approach: Approach,
        ray: &FilmRays<L>,
    ) -> (Start<L>, L) {
        (from_plane(cpu, approach, self.film_z, ray.point, ray.slopes), ray.area_per_pi)
    }

    /// The rays behind the lens: which there are, their weights, and what they are in the world.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn ends<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        cos2: L,
        area: L,
        end: End<L>,
        time_numbers: &[f32],
    ) -> (L::Mask, L, [[L; 3]; 2]) {
        let passed = L::both(end.passed, area.less_equal(area));
        let weight = match self.weight {
            // However small, the weight of a ray that passes is not that of a blocked one.
            Some(weight) => ((cos2 * cos2) * (area * L::splat(cpu, weight)))
                .larger(L::splat(cpu, S::from_f64(f32::MIN_POSITIVE.into()))),
            None => L::splat(cpu, S::ONE),
        };
        (passed, weight.or_zero(passed), self.to_world.lanes(cpu, end.origin, end.direction, time_numbers))
    }
}

/// Samples on their way to world rays.
struct Job<'a, 'b, 'c, S> {
    pipeline: &'a Pipeline<S>,
    samples: &'a SampleArrays<'b>,
    rays: &'a mut RayArrays<'c>,
    /// Set where a film point lies beyond what the lens is shortened for.
    strays: Cell<bool>,
}

impl<S: Turns> Job<'_, '_, '_, S> {
    /// A vector of samples.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn asked<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, at: usize) -> Asked<L> {
        let SampleArrays { image_x, image_y, lens_u, lens_v, .. } = *self.samples;
        Asked {
            image: [L::load_single(cpu, &image_x[at..]), L::load_single(cpu, &image_y[at..])],
            numbers: [L::load_single(cpu, &lens_u[at..]), L::load_single(cpu, &lens_v[at..])],
        }
    }
}

impl<S: Turns> Batch<S> for Job<'_, '_, '_, S> {
    /// The slope area that a ray stands for, over π.
    type Carry<L: Lanes<Scalar = S>> = L;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        self.samples.image_x.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, approach: Approach, at: usize) -> (Start<L>, L) {
        let [start] = self.start_all(cpu, approach, at);
        start
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start_all<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        approach: Approach,
        first: usize,
    ) -> [(Start<L>, L); U] {
        let mut asked = [self.asked(cpu, first); U];
        for (u, asked) in asked.iter_mut().enumerate().skip(1) {
            *asked = self.asked(cpu, first + u * L::WIDTH);
        }
        self.pipeline.starts(cpu, approach, &asked, self.pipeline.lens.within(), &self.strays)
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn finish<L: Lanes<Scalar = S>>(&mut self, cpu: Cpu<L>, at: usize, cos2: L, area: L, end: End<L>) {
        let (passed, weight, world) = self.pipeline.ends(cpu, cos2, area, end, &self.samples.time[at..]);
        weight.store_single(&mut self.rays.weight[at..]);
        let all = L::all(passed);
        let [origin, direction] = &world;
        if all {
            for axis in 0..3 {
                origin[axis].store_single(&mut self.rays.origin[axis][at..]);
                direction[axis].store_single(&mut self.rays.direction[axis][at..]);
            }
        } else {
            for axis in 0..3 {
                origin[axis].store_single_where(passed, &mut self.rays.origin[axis][at..]);
                direction[axis].store_single_where(passed, &mut self.rays.direction[axis][at..]);
            }
        }
    }
}

//! A few samples that share their lens and time numbers, for the latency of one.

use std::cell::Cell;

use super::{compiled::Pipeline, film_rays::Asked};
use crate::trace::kernel::{Approach, Batch, Cpu, End, Grouping, Lanes, Start};
use crate::{
    camera::{Sample, WorldRay},
    sampling::disk::Turns,
};

/// Samples that share their lens and time numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Together<const N: usize> {
    pub image_x: [f32; N],
    pub image_y: [f32; N],
    /// Lens numbers.
    pub lens: [f32; 2],
    /// Time numbers, all the same.
    pub time: [f32; N],
}

/// Origins, directions and weights; of weight 0 where there is no ray, whose other numbers mean nothing.
pub(crate) type Numbers<const N: usize> = [[f32; N]; 7];

/// The rays of three image points with the same lens and time numbers.
#[derive(Clone, Copy, Debug)]
pub struct Three {
    /// The fourth of each is nobody's.
    pub(crate) numbers: Numbers<4>,
    pub(crate) clip: [f32; 2],
    pub(crate) time: f32,
}

impl Three {
    /// No rays.
    pub const NONE: Self = Self { numbers: [[0.0; 4]; 7], clip: [0.0; 2], time: 0.0 };

    /// The ray at a place below 3, with its weight.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Option<(WorldRay, f32)> {
        let [ox, oy, oz, dx, dy, dz, weight] = self.numbers.each_ref().map(|array| array[i]);
        let ([mint, maxt], time) = (self.clip, self.time);
        let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
        (weight > 0.0).then_some((WorldRay { origin, direction, mint, maxt, time }, weight))
    }

    pub(crate) fn set(&mut self, i: usize, ray: Option<(WorldRay, f32)>) {
        let ([ox, oy, oz], [dx, dy, dz], weight) =
            ray.map_or(([0.0; 3], [0.0; 3], 0.0), |(ray, weight)| (ray.origin, ray.direction, weight));
        for (array, number) in self.numbers.iter_mut().zip([ox, oy, oz, dx, dy, dz, weight]) {
            array[i] = number;
        }
    }
}

impl<const N: usize> Together<N> {
    fn sample(&self, i: usize) -> Sample {
        let Self { image_x, image_y, lens: [lens_u, lens_v], time } = *self;
        Sample { image_x: image_x[i], image_y: image_y[i], lens_u, lens_v, time: time[i] }
    }
}

impl From<&Sample> for Together<1> {
    #[inline(always)]
    fn from(sample: &Sample) -> Self {
        let Sample { image_x, image_y, lens_u, lens_v, time } = *sample;
        Self { image_x: [image_x], image_y: [image_y], lens: [lens_u, lens_v], time: [time] }
    }
}

impl<S: Turns> Pipeline<S> {
    /// The rays of a few samples, as one or side by side, written over `rays`.
    #[inline(always)]
    pub fn few<const N: usize>(&self, grouping: Grouping, asked: &Together<N>, rays: &mut Numbers<N>) {
        let within = self.lens().within();
        let mut job = Job { pipeline: self, asked, rays: &mut *rays, within, strays: Cell::new(false) };
        self.lens().trace(grouping, &mut job);
        if job.strays.get() {
            self.few_strays(asked, rays);
        }
    }

    /// Writes those of the samples anew that lie beyond what the lens is shortened for.
    #[cold]
    fn few_strays<const N: usize>(&self, asked: &Together<N>, rays: &mut Numbers<N>) {
        self.strays(
            N,
            |i| asked.sample(i),
            |i, ray| {
                for (array, number) in rays.iter_mut().zip(ray) {
                    array[i] = number;
                }
            },
        );
    }

    /// Origin, direction and weight of one sample's ray by the whole lens.
    pub fn whole(&self, sample: &Sample) -> [f32; 7] {
        let mut ray = [[0.0]; 7];
        let (asked, strays) = (&sample.into(), Cell::new(false));
        let mut job = Job { pipeline: self, asked, rays: &mut ray, within: None, strays };
        self.lens().trace_whole(Grouping::One, &mut job);
        ray.map(|[number]| number)
    }
}

/// A few samples on their way to world rays.
struct Job<'a, S, const N: usize> {
    pipeline: &'a Pipeline<S>,
    asked: &'a Together<N>,
    rays: &'a mut Numbers<N>,
    /// The square of the film radius up to which the lens serves; `None` for any.
    within: Option<S>,
    /// Set where a film point lies beyond what the lens is shortened for.
    strays: Cell<bool>,
}

impl<S: Turns, const N: usize> Batch<S> for Job<'_, S, N> {
    /// The slope area that a ray stands for, over π.
    type Carry<L: Lanes<Scalar = S>> = L;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        N
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn start<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, approach: Approach, at: usize) -> (Start<L>, L) {
        let Together { image_x, image_y, lens: [u, v], .. } = self.asked;
        let asked = Asked {
            image: [L::load_fresh(cpu, &image_x[at..]), L::load_fresh(cpu, &image_y[at..])],
            numbers: [L::splat_fresh(cpu, u), L::splat_fresh(cpu, v)],
        };
        let [start] = self.pipeline.starts(cpu, approach, &[asked], self.within, &self.strays);
        start
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn finish<L: Lanes<Scalar = S>>(&mut self, cpu: Cpu<L>, at: usize, cos2: L, area: L, end: End<L>) {
        let (_, weight, [origin, direction]) =
            self.pipeline.ends(cpu, cos2, area, end, &self.asked.time[at..]);
        for axis in 0..3 {
            origin[axis].store_single(&mut self.rays[axis][at..]);
            direction[axis].store_single(&mut self.rays[3 + axis][at..]);
        }
        weight.store_single(&mut self.rays[6][at..]);
    }
}

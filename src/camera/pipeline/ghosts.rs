//! Ghosts in a camera's rays: a share of the lens samples goes along paths with two reflections, and the rest along the direct
//! one, each with its probability in the weight.
//!
//! The lens sample u chooses: below the share a pair of surfaces, above it the direct path. What is left of u after each choice
//! is stretched to [0, 1] again and is the sample's u from there on, so that no further random number is needed, and samples
//! that differ by their film points alone, as those of a pbrt host and of ray differentials, choose alike.
//!
//! The direct path is the camera's own tracer. Ghosts are walked one ray at a time in double precision: a batch has its direct
//! rays from the tracer's batch, and the others one by one, so that it has the bits of single calls.

use std::{f64::consts::PI, sync::Arc};

use super::{
    arrays::{BLOCK, OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore},
    body::CameraBody,
    tracer::{LensTracer, Tracer},
};
use crate::{
    camera::ray::{Outcome, Sample, WorldRay},
    lens::{cos4, film_ray},
    light::{FilmGhosts, PairChoice},
    numeric::STEPS,
    sampling::{PupilDisk, film_rays::FilmRays},
    trace::{Blocked, Ray},
};

/// Where a sample goes.
pub(super) enum Choice {
    /// Along the direct path, as this sample.
    Direct(Sample),
    /// Along the path of a pair.
    Ghost(PairChoice),
}

/// What makes the rays of a camera's ghosts.
#[derive(Debug)]
pub(crate) struct GhostRays {
    /// The share of the samples.
    share: f64,
    pub(super) ghosts: FilmGhosts,
    /// The disk that holds all rays through the rear surface.
    cover: PupilDisk,
    body: CameraBody,
    /// The weight of a ray is this times cos⁴, the slope area it stands for and what is left of its light.
    weight: f64,
}

impl GhostRays {
    /// For a share of the samples, more than 0; `weight` is the factor of the direct rays' weights.
    pub fn new(share: f64, ghosts: FilmGhosts, cover: PupilDisk, body: &CameraBody, weight: f64) -> Self {
        Self { share, ghosts, cover, body: body.clone(), weight }
    }

    /// Where a sample goes.
    pub(super) fn choose(&self, sample: &Sample) -> Choice {
        let u = f64::from(sample.lens_u).clamp(0.0, 1.0);
        // What is no number is none along the direct path.
        if u < self.share || self.share == 1.0 && u == 1.0 {
            return Choice::Ghost(self.ghosts.choose(u / self.share));
        }
        let lens_u = ((u - self.share) / (1.0 - self.share)) as f32;
        Choice::Direct(Sample { lens_u, ..*sample })
    }

    /// The weight of a direct ray, of which there are fewer.
    fn direct(&self, weight: f32) -> f32 {
        ((f64::from(weight) / (1.0 - self.share)) as f32).clamp(f32::MIN_POSITIVE, f32::MAX)
    }

    /// Makes the weight of the camera's own ray, 0 of a blocked one, that of a direct ray.
    pub(super) fn rescale(&self, weight: &mut f32) {
        if *weight > 0.0 {
            *weight = self.direct(*weight);
        }
    }

    /// The film ray of a sample along a pair's path. Without an area where the sample asks for another one.
    pub(super) fn film_ray(&self, sample: &Sample, pair: &PairChoice) -> FilmRays<f64> {
        let side = &self.body.film_side;
        let point = side.film.point(sample.image_x.into(), sample.image_y.into());
        let chosen = self.ghosts.slopes(pair, point, self.cover.seen_from(point));
        let none = [f64::NAN; 2];
        match side.mapping.map(chosen.rest, sample.lens_v.into()) {
            None => FilmRays { point, disk: none, slopes: none, area_per_pi: f64::NAN },
            Some(disk) => {
                let (slopes, area_per_pi) = chosen.at(disk);
                FilmRays { point, disk, slopes, area_per_pi }
            }
        }
    }

    /// The ray of a sample along a pair's path, by `trace` from the film ray to the ray behind the lens and what is left
    /// of its light.
    pub(super) fn ray(
        &self,
        sample: &Sample,
        pair: &PairChoice,
        trace: impl Fn(Ray) -> Result<(Ray, f64), Blocked>,
    ) -> Option<(WorldRay, f32)> {
        let FilmRays { point, slopes, area_per_pi, .. } = self.film_ray(sample, pair);
        if area_per_pi.is_nan() {
            return None;
        }
        let (ray, left) = trace(film_ray(point, self.body.film_side.z, slopes)).ok()?;
        let weight = self.weight * (PI * area_per_pi * cos4(slopes)) * left / (self.share * pair.probability);
        let CameraBody { placement, units_per_mm, .. } = &self.body;
        let ray = placement.world_ray(ray, *units_per_mm, sample.time);
        let weight = weight as f32;
        // However small, the weight is not that of a blocked ray.
        (left > 0.0 && ray.is_sound() && weight.is_finite()).then_some((ray, weight.max(f32::MIN_POSITIVE)))
    }

    fn own_ray(&self, sample: &Sample, pair: &PairChoice) -> Option<(WorldRay, f32)> {
        self.ray(sample, pair, |ray| self.ghosts.trace(pair, ray))
    }

    /// Why a sample has no ray along the path of its pair, by `trace` as of [`GhostRays::ray`].
    pub(super) fn why_none(
        &self,
        sample: &Sample,
        pair: &PairChoice,
        trace: impl Fn(Ray) -> Result<(Ray, f64), Blocked>,
    ) -> Outcome {
        let FilmRays { point, slopes, area_per_pi, .. } = self.film_ray(sample, pair);
        if area_per_pi.is_nan() {
            return Outcome::Redraw;
        }
        Outcome::Blocked(reason(trace(film_ray(point, self.body.film_side.z, slopes))))
    }

    /// The share of a pair's samples that get through, over all pairs and the film.
    pub fn acceptance(&self) -> f64 {
        // Fewer through many surfaces: the share is for a message.
        const SAMPLES: [usize; 2] = [64, 2048];
        const WORK: usize = 400_000;
        let samples = (WORK / self.ghosts.work_per_ray()).clamp(SAMPLES[0], SAMPLES[1]) as u32;
        let [width, height] = self.body.film_side.film.middle().map(|middle| 2.0 * middle);
        let passes = |i: &u32| {
            let [x, y, u, v] = STEPS.map(|step| (0.5 + f64::from(*i) * step).fract());
            let [image_x, image_y, lens_u, lens_v] =
                [x * width, y * height, u, v].map(|number| number as f32);
            let sample = Sample { image_x, image_y, lens_u, lens_v, time: 0.5 };
            self.own_ray(&sample, &self.ghosts.choose(u)).is_some()
        };
        (0..samples).filter(passes).count() as f64 / f64::from(samples)
    }
}

fn reason(traced: Result<(Ray, f64), Blocked>) -> Blocked {
    traced.err().unwrap_or(Blocked::Clipped)
}

/// A camera's own tracer, with a share of the samples for ghosts.
pub(crate) struct GhostTracer {
    direct: Arc<dyn LensTracer>,
    ghosts: Arc<GhostRays>,
}

impl GhostTracer {
    pub fn new(direct: Arc<dyn LensTracer>, ghosts: Arc<GhostRays>) -> Self {
        Self { direct, ghosts }
    }
}

impl Tracer for GhostTracer {
    fn one(&self, sample: &Sample, ray: &mut OneRay<'_>) {
        match self.ghosts.choose(sample) {
            Choice::Direct(sample) => {
                self.direct.one(&sample, ray);
                self.ghosts.rescale(ray.weight);
            }
            Choice::Ghost(pair) => ray.put(0, self.ghosts.own_ray(sample, &pair)),
        }
    }

    fn four(&self, samples: &SampleBlock<4>, rays: &mut RayBlock<4>) -> bool {
        let choices = [0, 1, 2, 3].map(|i| self.ghosts.choose(&samples.sample(i)));
        let mut block = SampleBlock::new();
        for (i, choice) in choices.iter().enumerate() {
            // Samples of one u, as a host's three, choose alike: ghosts gain nothing side by side.
            let Choice::Direct(sample) = choice else { return false };
            block.set(i, sample);
        }
        let made = self.direct.four(&block, rays);
        if made {
            rays.arrays(4).weight.iter_mut().for_each(|weight| self.ghosts.rescale(weight));
        }
        made
    }

    fn many(&self, samples: &SampleArrays<'_>, rays: &mut RayArrays<'_>) {
        in_blocks(
            &self.ghosts,
            samples,
            rays,
            |_, block, found| self.direct.many(block, found),
            |i, pair| self.ghosts.own_ray(&samples.get(i), pair),
        );
    }
}

/// Many samples in blocks: those of the direct path by `direct`, from the sample of a number on, and each of the others by
/// `ghost` of its number and pair.
pub(super) fn in_blocks(
    ghosts: &GhostRays,
    samples: &SampleArrays<'_>,
    rays: &mut RayArrays<'_>,
    direct: impl Fn(usize, &SampleArrays<'_>, &mut RayArrays<'_>),
    ghost: impl Fn(usize, &PairChoice) -> Option<(WorldRay, f32)>,
) {
    let (mut block, mut found) = (SampleBlock::<BLOCK>::new(), RayBlock::<BLOCK>::new());
    let mut pairs: [Option<PairChoice>; BLOCK] = [None; BLOCK];
    let n = samples.len();
    for first in (0..n).step_by(BLOCK) {
        let count = BLOCK.min(n - first);
        for (i, pair) in pairs.iter_mut().enumerate().take(count) {
            let sample = samples.get(first + i);
            // A ghost's sample stands in its place, and its direct ray is not taken.
            match ghosts.choose(&sample) {
                Choice::Direct(sample) => {
                    block.set(i, &sample);
                    *pair = None;
                }
                Choice::Ghost(chosen) => {
                    block.set(i, &sample);
                    *pair = Some(chosen);
                }
            }
        }
        direct(first, &block.arrays(count), &mut found.arrays(count));
        for (i, pair) in pairs.iter().enumerate().take(count) {
            let ray = match pair {
                None => found.get(i).map(|(ray, weight)| (ray, ghosts.direct(weight))),
                Some(pair) => ghost(first + i, pair),
            };
            rays.put(first + i, ray);
        }
    }
}

impl LensTracer for GhostTracer {
    fn film_ray(&self, sample: &Sample) -> FilmRays<f64> {
        match self.ghosts.choose(sample) {
            Choice::Direct(sample) => self.direct.film_ray(&sample),
            Choice::Ghost(pair) => self.ghosts.film_ray(sample, &pair),
        }
    }

    fn reason(&self, sample: &Sample, ray: Ray) -> Blocked {
        match self.ghosts.choose(sample) {
            Choice::Direct(sample) => self.direct.reason(&sample, ray),
            Choice::Ghost(pair) => reason(self.ghosts.ghosts.trace(&pair, ray)),
        }
    }
}

//! A camera's whole arithmetic in one precision at a wavelength per ray: film ray, trace, weight and world ray in one pass of
//! vectors. One sample, four and many take the same way, in vectors of another width.

use std::{ops::RangeInclusive, slice};

use super::tracer::SpectralTracer;
use crate::{
    camera::{
        pipeline::{
            arrays::{OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore},
            body::{CameraBody, LaneBody},
            film_sampling::{SampleLanes, lane},
            lanes::Job,
        },
        ray::Sample,
    },
    light::{LaneTransmission, TransmissionFit},
    sampling::{
        disk::Turns,
        film_rays::FilmRays,
        warped::{LaneSpectralPupil, SpectralPupil},
    },
    trace::kernel::{
        Batch, Compiled, Cpu, Group, Grouping, InVectors, Lanes, Portable, Simd, SpectralKernel,
        in_registers, portable,
    },
};

/// A camera compiled for a precision and for wavelengths within a range, nm.
pub(super) struct SpectralPipeline<S> {
    body: LaneBody<S>,
    kernel: SpectralKernel<S>,
    /// The true pupil at every wavelength; `None`: the body's disk is sampled, the same at every wavelength.
    pupil: Option<(SpectralPupil, LaneSpectralPupil<S>)>,
    transmission: Option<LaneTransmission<S>>,
    range: [S; 2],
}

impl<S: Turns> SpectralPipeline<S> {
    /// `body` samples a disk, unless there is a `pupil`.
    pub fn new(
        kernel: SpectralKernel<S>,
        pupil: Option<SpectralPupil>,
        transmission: Option<&TransmissionFit>,
        body: &CameraBody,
        range: &RangeInclusive<f32>,
    ) -> Self {
        let pupil = pupil.map(|pupil| {
            let constants = pupil.lane_pupil();
            (pupil, constants)
        });
        let range = [range.start(), range.end()].map(|end| S::from_f64((*end).into()));
        let transmission = transmission.map(TransmissionFit::lane_transmission);
        Self { body: body.lane_body(), kernel, pupil, transmission, range }
    }

    /// The film rays of `U` vectors of samples; without an area at wavelengths out of range.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn film_rays<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        samples: &[SampleLanes<L>; U],
        wavelengths: &[L; U],
    ) -> [FilmRays<L>; U] {
        let mut rays = match &self.pupil {
            Some((pupil, constants)) => {
                let mut rays = [self.body.film.unaimed(cpu, &samples[0]); U];
                for u in 1..U {
                    rays[u] = self.body.film.unaimed(cpu, &samples[u]);
                }
                pupil.lanes(cpu, constants, wavelengths, &mut rays);
                rays
            }
            None => self.body.film.on_disk(cpu, samples),
        };
        if let Some(transmission) = &self.transmission {
            for u in 0..U {
                let left = transmission.lanes(cpu, rays[u].point, rays[u].slopes, wavelengths[u]);
                rays[u].area_per_pi = rays[u].area_per_pi * left;
            }
        }
        let none = L::splat(cpu, S::from_f64(f64::NAN));
        let [from, to] = [L::splat(cpu, self.range[0]), L::splat(cpu, self.range[1])];
        for u in 0..U {
            let inside = L::both(from.less_equal(wavelengths[u]), wavelengths[u].less_equal(to));
            rays[u].area_per_pi = L::select(inside, rays[u].area_per_pi, none);
        }
        rays
    }

    /// The way of every sample, however many they are.
    #[inline(always)]
    fn trace(
        &self,
        grouping: Grouping,
        samples: &impl SampleStore,
        wavelengths: &[f32],
        rays: &mut impl RayStore,
    ) {
        let job = Job::new(&self.body, samples, &mut *rays, None);
        let simd = self.kernel.available();
        if !in_registers(simd, grouping, &mut AtWavelengths { pipeline: self, wavelengths, job }) {
            let (samples, mut rays) = (samples.as_arrays(), rays.as_arrays());
            let job = Job::new(&self.body, &samples, &mut rays, None);
            portable(&mut AtWavelengths { pipeline: self, wavelengths, job });
        }
    }
}

impl<S: Turns + Send + Sync> SpectralTracer for SpectralPipeline<S> {
    fn one(&self, sample: &Sample, wavelength: f32, ray: &mut OneRay<'_>) {
        self.trace(Grouping::One, sample, slice::from_ref(&wavelength), ray);
    }

    fn four(&self, samples: &SampleBlock<4>, wavelengths: &[f32; 4], rays: &mut RayBlock<4>) {
        self.trace(Grouping::Quad, samples, wavelengths, rays);
    }

    fn many(&self, samples: &SampleArrays<'_>, wavelengths: &[f32], rays: &mut RayArrays<'_>) {
        match samples.len() {
            n @ 1..=4 => {
                let mut found = RayBlock::<4>::new();
                let last = wavelengths[n - 1];
                let four = [0, 1, 2, 3].map(|i| wavelengths.get(i).copied().unwrap_or(last));
                self.four(&SampleBlock::first_of(samples), &four, &mut found);
                (0..n).for_each(|i| rays.copy(i, &mut found, i));
            }
            _ => self.trace(Grouping::Wide, samples, wavelengths, rays),
        }
    }

    fn film_ray(&self, sample: &Sample, wavelength: f32) -> FilmRays<f64> {
        let none = [f64::NAN; 2];
        let mut ray = FilmRays { point: none, disk: none, slopes: none, area_per_pi: f64::NAN };
        Simd::best().run(OneFilmRay { pipeline: self, sample, wavelength, ray: &mut ray });
        ray
    }
}

/// Samples with their wavelengths on the way to world rays.
struct AtWavelengths<'a, S, I, R> {
    pipeline: &'a SpectralPipeline<S>,
    wavelengths: &'a [f32],
    job: Job<'a, S, I, R>,
}

impl<S: Turns, I: SampleStore, R: RayStore> InVectors<S> for AtWavelengths<'_, S, I, R> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn len(&self) -> usize {
        self.wavelengths.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vectors<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize) {
        self.group::<L, U>(cpu, first, U);
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = S>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        if U == 1 || count == 1 {
            return self.vector::<L>(cpu, first);
        }
        let (mut rays, mut light, mut areas) =
            (Group::<_, U>::new(), Group::<_, U>::new(), Group::<_, U>::new());
        let together: Option<[(FilmRays<L>, L); U]> =
            if L::PREPARED_TOGETHER && count == U { Some(self.film_rays(cpu, first)) } else { None };
        for u in 0..count {
            let (film_ray, nanometres) = match &together {
                Some(all) => all[u],
                None => {
                    let [one] = self.film_rays(cpu, first + u * L::WIDTH);
                    one
                }
            };
            let Self { pipeline: SpectralPipeline { kernel, .. }, job, .. } = self;
            let (start, area) = job.begin(cpu, kernel.approach(), &film_ray);
            let (entered, of_rays) = kernel.enter(cpu, nanometres, start);
            rays.push(entered);
            light.push(of_rays);
            areas.push(area);
        }
        let Self { pipeline: SpectralPipeline { kernel, .. }, job, .. } = self;
        let (rays, light) = (rays.filled(), light.filled());
        kernel.through(cpu, light, rays, count);
        for (u, rays) in rays.iter().enumerate().take(count) {
            let (end, cos2) = kernel.leave(cpu, *rays);
            job.finish(cpu, first + u * L::WIDTH, cos2, areas.get(u), end);
        }
    }
}

impl<S: Turns, I: SampleStore, R: RayStore> AtWavelengths<'_, S, I, R> {
    /// `N` vectors of film rays from the sample numbered `first` on, with their wavelengths, nm.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn film_rays<L: Lanes<Scalar = S>, const N: usize>(
        &self,
        cpu: Cpu<L>,
        first: usize,
    ) -> [(FilmRays<L>, L); N] {
        let mut samples = [self.job.samples(cpu, first); N];
        let mut nanometres = [L::load_single(cpu, &self.wavelengths[first..]); N];
        for u in 1..N {
            samples[u] = self.job.samples(cpu, first + u * L::WIDTH);
            nanometres[u] = L::load_single(cpu, &self.wavelengths[first + u * L::WIDTH..]);
        }
        let rays = self.pipeline.film_rays(cpu, &samples, &nanometres);
        let mut found = [(rays[0], nanometres[0]); N];
        for u in 1..N {
            found[u] = (rays[u], nanometres[u]);
        }
        found
    }

    /// One vector from the sample numbered `at` on.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes<Scalar = S>>(&mut self, cpu: Cpu<L>, at: usize) {
        let [(film_ray, nanometres)] = self.film_rays(cpu, at);
        let Self { pipeline: SpectralPipeline { kernel, .. }, job, .. } = self;
        let (start, area) = job.begin(cpu, kernel.approach(), &film_ray);
        let (entered, light) = kernel.enter(cpu, nanometres, start);
        let (mut rays, mut light) = ([entered], [light]);
        kernel.through(cpu, &mut light, &mut rays, 1);
        let (end, cos2) = kernel.leave(cpu, rays[0]);
        job.finish(cpu, at, cos2, area, end);
    }
}

/// One film ray by the processor's own fused multiplications.
struct OneFilmRay<'a, S> {
    pipeline: &'a SpectralPipeline<S>,
    sample: &'a Sample,
    wavelength: f32,
    ray: &'a mut FilmRays<f64>,
}

impl<S: Turns> Compiled for OneFilmRay<'_, S> {
    #[inline(always)]
    fn run(self) {
        let wavelength = Portable([S::from_f64(self.wavelength.into())]);
        let [ray] = self.pipeline.film_rays(Portable::cpu(), &[lane(self.sample)], &[wavelength]);
        *self.ray = ray.widened();
    }
}

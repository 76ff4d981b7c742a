//! A camera's whole arithmetic in one precision at a wavelength per ray: film ray, trace, weight and world ray in one pass of
//! vectors. One sample, four and many take the same way, in vectors of another width.

use std::{ops::RangeInclusive, slice};

use crate::{
    camera::{
        pipeline::{
            arrays::{OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore, padded},
            body::{CameraBody, LaneBody},
            film_sampling::{FilmSource, SampleLanes, dim},
            lanes::{by_four, trace},
            tracer::SpectralTracer,
        },
        ray::Sample,
    },
    light::{FilmTransmission, LaneTransmission},
    sampling::{
        disk::Turns,
        film_rays::FilmRays,
        pupil_map::{LaneSpectralPupil, SpectralPupil},
    },
    trace::kernel::{Cpu, Grouping, Lanes, SpectralKernel},
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
        transmission: Option<&FilmTransmission>,
        body: &CameraBody,
        range: &RangeInclusive<f32>,
    ) -> Self {
        let pupil = pupil.map(|pupil| {
            let constants = pupil.lane_pupil();
            (pupil, constants)
        });
        let range = [range.start(), range.end()].map(|end| S::from_f64((*end).into()));
        let transmission = transmission.map(FilmTransmission::lane_transmission);
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
                let mut rays = self.body.film.all_unaimed(cpu, samples);
                pupil.lanes(cpu, constants, wavelengths, &mut rays);
                rays
            }
            None => self.body.film.on_disk(cpu, samples),
        };
        if let Some(transmission) = &self.transmission {
            dim(cpu, transmission, &mut rays, wavelengths);
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
        let (film, optics) = (SpectralFilm { pipeline: self, wavelengths }, self.kernel.at(wavelengths));
        trace(self.kernel.available(), grouping, &self.body, &film, &optics, samples, rays);
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
            1..=4 => by_four(samples, rays, |four, found| self.four(four, &padded(wavelengths), found)),
            _ => self.trace(Grouping::Wide, samples, wavelengths, rays),
        }
    }

    fn film_ray(&self, sample: &Sample, wavelength: f32) -> FilmRays<f64> {
        SpectralFilm { pipeline: self, wavelengths: &[wavelength] }.one(sample)
    }
}

/// Film rays of samples with their wavelengths, nm.
struct SpectralFilm<'a, S> {
    pipeline: &'a SpectralPipeline<S>,
    wavelengths: &'a [f32],
}

impl<S: Turns> FilmSource for SpectralFilm<'_, S> {
    type Scalar = S;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        first: usize,
        samples: &[SampleLanes<L>; U],
    ) -> [FilmRays<L>; U] {
        let mut wavelengths = [L::load_single(cpu, &self.wavelengths[first..]); U];
        for (u, wavelengths) in wavelengths.iter_mut().enumerate().skip(1) {
            *wavelengths = L::load_single(cpu, &self.wavelengths[first + u * L::WIDTH..]);
        }
        self.pipeline.film_rays(cpu, samples, &wavelengths)
    }
}

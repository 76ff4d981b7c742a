//! From samples to rays that leave the film, in lanes of either precision: raster point to film point, lens sample to
//! the unit disk, and that to the pupil.

use std::{cell::Cell, sync::Arc};

use super::arrays::SampleStore;
use crate::{
    camera::ray::Sample,
    light::{FilmTransmission, LaneTransmission},
    plan::FilmSide,
    sampling::{
        DiskMapping, PupilSampler, WarpedPupil, disk::Turns, film_rays::FilmRays, pupil_disk::LaneDisk,
        pupil_map::LanePupil,
    },
    trace::kernel::{Compiled, Cpu, Lanes, Portable, Simd},
};

/// A film and its pupil, ready for sampling in the precision `S`.
#[derive(Clone, Debug)]
pub(crate) struct FilmSampling<S> {
    /// Raster coordinates of the axis, in mm.
    middle: [S; 2],
    pixel: S,
    mapping: DiskMapping,
    pupil: LanePupilSampler<S>,
    transmission: Option<LaneTransmission<S>>,
}

/// [`PupilSampler`], with what the precision computes with.
#[derive(Clone, Debug)]
enum LanePupilSampler<S> {
    Disk(LaneDisk<S>),
    Warped(Arc<WarpedPupil>, LanePupil<S>),
}

/// What makes film rays of samples.
pub(super) trait FilmSource {
    /// The precision that it computes in.
    type Scalar: Turns;

    /// The film rays of `U` vectors of samples, those from the one numbered `first` on, side by side, so that one's look-ups
    /// overlap another's arithmetic.
    fn lanes<L: Lanes<Scalar = Self::Scalar>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        first: usize,
        samples: &[SampleLanes<L>; U],
    ) -> [FilmRays<L>; U];

    /// The film ray of one sample.
    fn one(&self, sample: &Sample) -> FilmRays<f64> {
        let none = [f64::NAN; 2];
        let mut ray = FilmRays { point: none, disk: none, slopes: none, area_per_pi: f64::NAN };
        Simd::best().run(One { film: self, sample, ray: &mut ray });
        ray
    }
}

/// Raster points and lens samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SampleLanes<L> {
    pub image: [L; 2],
    pub lens: [L; 2],
}

impl<L: Lanes> SampleLanes<L> {
    /// A vector of samples from the one numbered `at` on.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn load(cpu: Cpu<L>, samples: &impl SampleStore, at: usize) -> Self {
        Self {
            image: [
                L::load_single(cpu, &samples.array(0)[at..]),
                L::load_single(cpu, &samples.array(1)[at..]),
            ],
            lens: [
                L::load_single(cpu, &samples.array(2)[at..]),
                L::load_single(cpu, &samples.array(3)[at..]),
            ],
        }
    }
}

impl<S: Turns> FilmSampling<S> {
    /// With a transmission, the area that a ray stands for is multiplied by its own.
    pub fn new(
        FilmSide { film, mapping, sampler, .. }: &FilmSide,
        transmission: Option<&FilmTransmission>,
    ) -> Self {
        let pupil = match sampler {
            PupilSampler::Disk(disk) => LanePupilSampler::Disk(disk.lane_disk()),
            PupilSampler::Warped(pupil) => LanePupilSampler::Warped(pupil.clone(), pupil.lane_pupil()),
        };
        Self {
            middle: film.middle().map(|x| S::from_f64(x * film.pixel())),
            pixel: S::from_f64(film.pixel()),
            mapping: *mapping,
            pupil,
            transmission: transmission.map(FilmTransmission::lane_transmission),
        }
    }

    /// Film rays where a disk is sampled.
    ///
    /// # Panics
    /// The pupil is warped.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn on_disk<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        samples: &[SampleLanes<L>; U],
    ) -> [FilmRays<L>; U] {
        let LanePupilSampler::Disk(pupil) = &self.pupil else { panic!("a disk is to be sampled") };
        let mut rays = self.all_unaimed(cpu, samples);
        for ray in &mut rays {
            (ray.slopes, ray.area_per_pi) = pupil.lanes(cpu, ray.point, ray.disk);
        }
        rays
    }

    /// All of a film ray but its direction.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn unaimed<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, samples: &SampleLanes<L>) -> FilmRays<L> {
        let (point, disk) = (self.point(cpu, samples.image), self.mapping.lanes(cpu, samples.lens));
        FilmRays { point, disk, slopes: disk, area_per_pi: point[0] }
    }

    /// The same of `U` vectors.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn all_unaimed<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        samples: &[SampleLanes<L>; U],
    ) -> [FilmRays<L>; U] {
        let mut rays = [self.unaimed(cpu, &samples[0]); U];
        for u in 1..U {
            rays[u] = self.unaimed(cpu, &samples[u]);
        }
        rays
    }

    /// [`Film::point`](crate::sampling::film::Film::point).
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn point<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, [x, y]: [L; 2]) -> [L; 2] {
        let pixel = L::splat(cpu, self.pixel);
        [x.neg_mul_add(pixel, L::splat(cpu, self.middle[0])), y.mul_sub(pixel, L::splat(cpu, self.middle[1]))]
    }

    /// The square of a sample's film radius, mm², as [`FilmRays::radius_squared`] has it in lanes of any width.
    pub fn radius_squared(&self, sample: &Sample) -> S {
        let point = self.point(Portable::cpu(), lane(sample).image);
        let ray = FilmRays { point, disk: point, slopes: point, area_per_pi: point[0] };
        let Portable([square]) = ray.radius_squared();
        square
    }
}

impl<S: Turns> FilmSource for FilmSampling<S> {
    type Scalar = S;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        _: usize,
        samples: &[SampleLanes<L>; U],
    ) -> [FilmRays<L>; U] {
        let mut rays = self.all_unaimed(cpu, samples);
        match &self.pupil {
            LanePupilSampler::Disk(pupil) => {
                for ray in &mut rays {
                    (ray.slopes, ray.area_per_pi) = pupil.lanes(cpu, ray.point, ray.disk);
                }
            }
            LanePupilSampler::Warped(pupil, frame) => pupil.lanes(cpu, frame, &mut rays),
        }
        if let Some(transmission) = &self.transmission {
            // At one wavelength, so that none is asked.
            let none = [rays[0].area_per_pi; U];
            dim(cpu, transmission, &mut rays, &none);
        }
        rays
    }
}

/// Multiplies the areas that rays stand for by what the lens leaves of their light. Their wavelengths, nm, are asked where that
/// depends on them.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(super) fn dim<L: Lanes, const U: usize>(
    cpu: Cpu<L>,
    transmission: &LaneTransmission<L::Scalar>,
    rays: &mut [FilmRays<L>; U],
    wavelengths: &[L; U],
) {
    let (mut points, mut slopes) = ([rays[0].point; U], [rays[0].slopes; U]);
    for u in 1..U {
        (points[u], slopes[u]) = (rays[u].point, rays[u].slopes);
    }
    let left = transmission.lanes(cpu, &points, &slopes, wavelengths);
    for u in 0..U {
        rays[u].area_per_pi = rays[u].area_per_pi * left[u];
    }
}

/// Film rays for optics that serve film points up to a radius only: those beyond have no area, so that they make no ray, and
/// are noticed.
pub(super) struct WithinRange<'a, S> {
    film: &'a FilmSampling<S>,
    /// The square of the radius, mm².
    most: S,
    is_exceeded: Cell<bool>,
}

impl<'a, S: Turns> WithinRange<'a, S> {
    /// `most` is the square of the radius, mm².
    #[inline(always)]
    pub fn new(film: &'a FilmSampling<S>, most: S) -> Self {
        Self { film, most, is_exceeded: Cell::new(false) }
    }

    /// Whether there have been film points beyond.
    #[inline(always)]
    pub fn is_exceeded(&self) -> bool {
        self.is_exceeded.get()
    }
}

impl<S: Turns> FilmSource for WithinRange<'_, S> {
    type Scalar = S;

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn lanes<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        first: usize,
        samples: &[SampleLanes<L>; U],
    ) -> [FilmRays<L>; U] {
        let mut rays = self.film.lanes(cpu, first, samples);
        let most = L::splat(cpu, self.most);
        for ray in &mut rays {
            let is_within = ray.radius_squared().less_equal(most);
            if !L::all(is_within) {
                self.is_exceeded.set(true);
                let none = L::splat(cpu, S::from_f64(f64::NAN));
                ray.area_per_pi = L::select(is_within, ray.area_per_pi, none);
            }
        }
        rays
    }
}

/// A sample as vectors of one lane.
fn lane<S: Turns>(sample: &Sample) -> SampleLanes<Portable<S, 1>> {
    let Sample { image_x, image_y, lens_u, lens_v, .. } = *sample;
    let [x, y, u, v] =
        [image_x, image_y, lens_u, lens_v].map(|number| Portable([S::from_f64(number.into())]));
    SampleLanes { image: [x, y], lens: [u, v] }
}

/// One film ray by the processor's own fused multiplications.
struct One<'a, F: ?Sized> {
    film: &'a F,
    sample: &'a Sample,
    ray: &'a mut FilmRays<f64>,
}

impl<F: FilmSource + ?Sized> Compiled for One<'_, F> {
    #[inline(always)]
    fn run(self) {
        let [ray] = self.film.lanes(Portable::cpu(), 0, &[lane(self.sample)]);
        *self.ray = ray.widened();
    }
}

//! Turns samples into rays that leave the film, in lanes of either precision. It maps raster points to film
//! points, lens samples to the unit disk, and the unit disk to the pupil.

use std::{ops::RangeInclusive, sync::Arc};

use crate::{
    plan::FilmSide,
    samples::{Sample, Samples, WAVELENGTH},
    sampling::{
        DiskMapping, PosedPupil, PupilSampler, WarpedPupil,
        film_rays::FilmRays,
        posed_pupil::LanePosed,
        pupil_disk::LaneDisk,
        pupil_map::{LanePupil, LaneSpectralPupil, SpectralPupil},
    },
};
use realistic_simd::{Compiled, Cpu, Lanes, Portable, Simd};
use realistic_trace::kernel::KernelScalar;

/// A film and its pupil, ready for sampling in the precision `S`.
#[derive(Clone, Debug)]
pub struct FilmSampling<S> {
    /// Position of the axis relative to the raster's corner, to the right and down, mm; for tilted or curved
    /// film, the position of the film's centre.
    axis: [S; 2],
    pixel: S,
    mapping: DiskMapping,
    pupil: LanePupilSampler<S>,
    /// The range of wavelengths, nm, at which there are rays; `None` if rays have no wavelengths of their
    /// own.
    wavelengths: Option<[S; 2]>,
}

/// A [`PupilSampler`] with the constants of the precision.
#[derive(Clone, Debug)]
enum LanePupilSampler<S> {
    Disk(LaneDisk<S>),
    Warped(Arc<WarpedPupil>, LanePupil<S>),
    Spectral(Arc<SpectralPupil>, LaneSpectralPupil<S>),
    Posed(Arc<PosedPupil>, LanePosed<S>),
}

/// Raster points, lens samples and wavelengths.
#[derive(Clone, Copy, Debug)]
pub struct SampleLanes<L> {
    pub image: [L; 2],
    pub lens: [L; 2],
    /// Wavelengths, nm; arbitrary if rays have none of their own.
    pub wavelength: L,
}

impl<L: Lanes> SampleLanes<L> {
    /// Loads a vector of samples, from sample `at` on.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn load(cpu: Cpu<L>, samples: &Samples<'_>, at: usize) -> Self {
        let image = [samples.load(cpu, 0, at), samples.load(cpu, 1, at)];
        let lens = [samples.load(cpu, 2, at), samples.load(cpu, 3, at)];
        let wavelength =
            if samples.have_wavelengths() { samples.load(cpu, WAVELENGTH, at) } else { image[0] };
        Self { image, lens, wavelength }
    }
}

impl<S: KernelScalar> FilmSampling<S> {
    /// Prepares a film and its pupil.
    pub fn new(FilmSide { film, mapping, sampler, .. }: &FilmSide) -> Self {
        let pupil = match sampler {
            PupilSampler::Disk(disk) => LanePupilSampler::Disk(disk.lane_disk()),
            PupilSampler::Warped(pupil) => LanePupilSampler::Warped(pupil.clone(), pupil.lane_pupil()),
            PupilSampler::Posed(pupil) => LanePupilSampler::Posed(pupil.clone(), pupil.constants()),
        };
        let ([x, y], [right, up]) = (film.half_size(), film.sampled_center());
        Self {
            axis: [x + right, y - up].map(S::from_f64),
            pixel: S::from_f64(film.pixel()),
            mapping: *mapping,
            pupil,
            wavelengths: None,
        }
    }

    /// Adds the range of the rays' wavelengths, nm, and the true pupil at every wavelength, if that is
    /// sampled.
    pub fn spectral(self, pupil: Option<SpectralPupil>, range: &RangeInclusive<f32>) -> Self {
        let wavelengths = Some([range.start(), range.end()].map(|end| S::from_f64((*end).into())));
        let pupil = pupil.map(|pupil| {
            let constants = pupil.lane_pupil();
            LanePupilSampler::Spectral(Arc::new(pupil), constants)
        });
        Self { pupil: pupil.unwrap_or(self.pupil), wavelengths, ..self }
    }

    /// Returns the film rays of `U` vectors of samples. The vectors are processed side by side, so that the
    /// table look-ups of one overlap the arithmetic of another.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        samples: &[SampleLanes<L>; U],
    ) -> [FilmRays<L>; U] {
        let (mut rays, mut wavelengths) = ([self.unaimed(cpu, &samples[0]); U], [samples[0].wavelength; U]);
        for u in 1..U {
            rays[u] = self.unaimed(cpu, &samples[u]);
            wavelengths[u] = samples[u].wavelength;
        }
        match &self.pupil {
            LanePupilSampler::Disk(pupil) => {
                for ray in &mut rays {
                    (ray.slopes, ray.area_per_pi) = pupil.lanes(cpu, ray.point, ray.disk);
                }
            }
            LanePupilSampler::Warped(pupil, frame) => pupil.lanes(cpu, frame, &mut rays),
            LanePupilSampler::Spectral(pupil, constants) => {
                pupil.lanes(cpu, constants, &wavelengths, &mut rays);
            }
            // Apart, so that it is compiled once and not in the loop of every camera.
            LanePupilSampler::Posed(pupil, constants) => {
                L::apart(cpu, PosedRays { cpu, pupil, constants, rays: &mut rays });
            }
        }
        if let Some([from, to]) = self.wavelengths {
            let none = L::splat(cpu, S::from_f64(f64::NAN));
            let [from, to] = [L::splat(cpu, from), L::splat(cpu, to)];
            for u in 0..U {
                let inside = L::both(from.less_equal(wavelengths[u]), wavelengths[u].less_equal(to));
                rays[u].area_per_pi = L::select(inside, rays[u].area_per_pi, none);
            }
        }
        rays
    }

    /// Returns the film ray of one sample, at the wavelength `wavelength`, nm, if rays have wavelengths of
    /// their own.
    pub fn one(&self, sample: &Sample, wavelength: Option<f32>) -> FilmRays<f64> {
        let none = [f64::NAN; 2];
        let mut ray = FilmRays { point: none, disk: none, slopes: none, area_per_pi: f64::NAN };
        Simd::best().run(OneFilmRay { film: self, sample, wavelength, ray: &mut ray });
        ray
    }

    /// Returns film rays whose slopes and areas are not set yet.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn unaimed<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, samples: &SampleLanes<L>) -> FilmRays<L> {
        let (point, disk) = (self.point(cpu, samples.image), self.mapping.lanes(cpu, samples.lens));
        FilmRays { point, disk, slopes: disk, area_per_pi: point[0] }
    }

    /// Computes [`Film::point`](crate::sampling::film::Film::point) in lanes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn point<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, [x, y]: [L; 2]) -> [L; 2] {
        let pixel = L::splat(cpu, self.pixel);
        [x.neg_mul_add(pixel, L::splat(cpu, self.axis[0])), y.mul_sub(pixel, L::splat(cpu, self.axis[1]))]
    }

    /// Returns the square of a sample's film radius, mm², with the same bits as [`FilmRays::radius_squared`]
    /// in lanes of any width.
    pub fn radius_squared(&self, sample: &Sample) -> S {
        let point = self.point(Portable::cpu(), lane(sample, None).image);
        let ray = FilmRays { point, disk: point, slopes: point, area_per_pi: point[0] };
        let Portable([square]) = ray.radius_squared();
        square
    }
}

/// Film rays that start on tilted or curved film, packed so that [`Lanes::apart`] can sample them in a
/// separate function.
struct PosedRays<'a, L: Lanes, const U: usize> {
    cpu: Cpu<L>,
    pupil: &'a PosedPupil,
    constants: &'a LanePosed<L::Scalar>,
    rays: &'a mut [FilmRays<L>; U],
}

impl<L: Lanes, const U: usize> Compiled for PosedRays<'_, L, U> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn run(self) {
        self.pupil.lanes(self.cpu, self.constants, self.rays);
    }
}

/// Returns a sample as vectors of one lane.
fn lane<S: KernelScalar>(sample: &Sample, wavelength: Option<f32>) -> SampleLanes<Portable<S, 1>> {
    let Sample { image_x, image_y, lens_u, lens_v, .. } = *sample;
    let [x, y, u, v, wavelength] = [image_x, image_y, lens_u, lens_v, wavelength.unwrap_or(image_x)]
        .map(|number| Portable([S::from_f64(number.into())]));
    SampleLanes { image: [x, y], lens: [u, v], wavelength }
}

/// Makes one film ray with the processor's own fused multiply-add instructions.
struct OneFilmRay<'a, S> {
    film: &'a FilmSampling<S>,
    sample: &'a Sample,
    wavelength: Option<f32>,
    ray: &'a mut FilmRays<f64>,
}

impl<S: KernelScalar> Compiled for OneFilmRay<'_, S> {
    #[inline(always)]
    fn run(self) {
        let [ray] = self.film.lanes(Portable::cpu(), &[lane(self.sample, self.wavelength)]);
        *self.ray = ray.widened();
    }
}

//! A camera's rays at wavelengths of their own: a sample and a wavelength in, the ray and its weight through the lens that
//! the glasses make at that wavelength out.
//!
//! What a camera keeps for it is the media between its surfaces ([`Spectral`]); everything else is made at the first
//! request. Lens, film and stop stand where the camera's own wavelength put them, and the factor of its weights is that of
//! its own wavelength, so that brightness at two wavelengths differs by what the lens does and nothing else.

mod lanes;
mod tracer;

use std::{fmt, ops::RangeInclusive};

use self::lanes::SpectralPipeline;
pub(crate) use self::tracer::SpectralTracer;
use super::{body::CameraBody, on_demand::OnDemand};
use crate::{
    camera::ray::{Outcome, Sample},
    lens::{Lens, film_ray, refraction::Refraction},
    light::{Coating, LitPath, Surfaces, TransmissionFit},
    plan::{FilmSide, Precision},
    prescription::{Blades, Medium, glass::refractive_index},
    sampling::{
        DiskMapping, PupilDisk, PupilSampler,
        disk::Turns,
        film_rays::FilmRays,
        warped::{FilmPencils, SpectralPupil},
    },
    trace::{Blocked, Direction, Path, kernel::SpectralKernel},
};

/// The wavelengths that may be asked for, nm.
pub(crate) const WAVELENGTHS: RangeInclusive<f32> = 380.0..=780.0;

/// What the rays of a camera are traced by at wavelengths that are not its own.
pub(crate) struct Spectral {
    optics: LensOfMedia,
    body: CameraBody,
    precision: Precision,
    built: OnDemand<Built>,
}

/// A lens with the media between its surfaces, from which it is made at any wavelength.
#[derive(Clone, Debug)]
pub(crate) struct LensOfMedia {
    /// At the camera's own wavelength and stop.
    pub lens: Lens,
    /// The medium on the film's side of each surface.
    pub media: Vec<Medium>,
    /// Those in its stop, if it is not round.
    pub blades: Option<Blades>,
    /// That of its surfaces, where what they leave of the light counts.
    pub coating: Option<Coating>,
}

/// What the first request makes.
struct Built {
    tracer: Box<dyn SpectralTracer>,
    range: RangeInclusive<f32>,
}

impl Spectral {
    /// For a camera with this lens, whose rays are traced in a precision.
    pub fn new(optics: LensOfMedia, body: CameraBody, precision: Precision) -> Self {
        Self { optics, body, precision, built: OnDemand::new() }
    }

    fn built(&self) -> &Built {
        self.built.get_or_make(|| {
            let range = self.optics.range();
            let tracer: Box<dyn SpectralTracer> = match self.precision {
                Precision::F64 => Box::new(self.pipeline::<f64>(&range)),
                Precision::F32 => Box::new(self.pipeline::<f32>(&range)),
            };
            Built { tracer, range }
        })
    }

    fn pipeline<S: Turns>(&self, range: &RangeInclusive<f32>) -> SpectralPipeline<S> {
        let LensOfMedia { lens, media, .. } = &self.optics;
        let kernel = SpectralKernel::new(&self.optics.path(lens.wavelength), media, lens.wavelength);
        let pupil = self.pupil(range);
        let side = &self.body.film_side;
        let sampler = match &side.sampler {
            PupilSampler::Warped(pupil) => PupilSampler::Disk(pupil.cover_disk()),
            disk @ PupilSampler::Disk(_) => disk.clone(),
        };
        let film_side = FilmSide { sampler, ..side.clone() };
        let transmission = self.transmission(range);
        let body = CameraBody { film_side, transmission: None, ..self.body.clone() };
        SpectralPipeline::new(kernel, pupil, transmission.as_ref(), &body, range)
    }

    /// What of the light the lens leaves at all wavelengths, where that counts.
    fn transmission(&self, range: &RangeInclusive<f32>) -> Option<TransmissionFit> {
        let (FilmSide { film, z, .. }, coating) = (&self.body.film_side, self.optics.coating?);
        // With weights of 1 there is none at the camera's own wavelength, either.
        self.body.weight?;
        if range.is_empty() {
            return None;
        }
        let at = |wavelength| {
            let lens = self.optics.at(wavelength);
            let cover = PupilDisk::rear(&lens, *z, film.reach())?;
            let path = Path::new(&lens, Direction::FilmToScene, Refraction::Fused);
            let lit = LitPath::new(path, &Surfaces::new(&lens, coating));
            Some((lit, move |point: [f64; 2]| cover.seen_from(point)))
        };
        TransmissionFit::spectral([range.start(), range.end()].map(|end| (*end).into()), *z, film.reach(), at)
    }

    /// The true pupil at all wavelengths, where that is sampled.
    fn pupil(&self, range: &RangeInclusive<f32>) -> Option<SpectralPupil> {
        let FilmSide { film, z, sampler: PupilSampler::Warped(_), .. } = &self.body.film_side else {
            return None;
        };
        if range.is_empty() {
            return None;
        }
        let side = |wavelength, reach| {
            let lens = self.optics.at(wavelength);
            let path = Path::new(&lens, Direction::FilmToScene, Refraction::Fused);
            let cover = PupilDisk::rear(&lens, *z, reach)?;
            let shift = PupilDisk::exit(&lens, *z).seen_from([1.0, 0.0]).center[0];
            Some(FilmPencils::new(&path, *z, reach, cover, shift))
        };
        SpectralPupil::new([range.start(), range.end()].map(|end| (*end).into()), film.reach(), side)
    }

    /// Whether a first request has been made.
    pub fn is_built(&self) -> bool {
        self.built.get().is_some()
    }

    /// What traces the rays; made by the first call.
    pub fn tracer(&self) -> &dyn SpectralTracer {
        &*self.built().tracer
    }

    /// The wavelengths, nm, at which the lens has rays: those of [`WAVELENGTHS`] at which every medium has an index.
    pub fn range(&self) -> &RangeInclusive<f32> {
        &self.built().range
    }

    /// What becomes of a sample that has no ray at a wavelength within the range.
    pub fn why_none(&self, sample: &Sample, wavelength: f32) -> Outcome {
        let FilmRays { point, disk, slopes, area_per_pi } = self.tracer().film_ray(sample, wavelength);
        let side = &self.body.film_side;
        if side.mapping == DiskMapping::Rejection && disk.iter().any(|x| x.is_nan()) {
            return Outcome::Redraw;
        }
        if area_per_pi.is_nan() {
            return Outcome::Blocked(Blocked::Clipped);
        }
        let walk = self.optics.path(wavelength.into()).walk(film_ray(point, side.z, slopes));
        Outcome::Blocked(walk.blocked.unwrap_or(Blocked::Clipped))
    }
}

impl LensOfMedia {
    /// The lens at a wavelength, nm: the same surfaces and stop, and the indices there.
    pub fn at(&self, wavelength: f64) -> Lens {
        let mut lens = Lens { wavelength, ..self.lens.clone() };
        let mut n_scene = 1.0;
        for (surface, medium) in lens.surfaces.iter_mut().zip(&self.media) {
            surface.n_scene = n_scene;
            n_scene = refractive_index(*medium, wavelength);
            surface.n_film = n_scene;
        }
        lens
    }

    /// Rays from the film through the lens at a wavelength, nm.
    pub fn path(&self, wavelength: f64) -> Path {
        let lens = self.at(wavelength);
        Path::new(&lens, Direction::FilmToScene, Refraction::Fused).with_blades(&lens, self.blades)
    }

    /// The wavelengths, nm, at which every medium has an index of 1 or more: the widest stretch of whole numbers. Most
    /// glasses have one everywhere; a formula that was fitted elsewhere may not.
    fn range(&self) -> RangeInclusive<f32> {
        let has_index = |medium: &Medium, nm: f32| {
            let index = refractive_index(*medium, nm.into());
            (1.0..=MOST_INDEX).contains(&index)
        };
        let (first, last) = (*WAVELENGTHS.start() as u16, *WAVELENGTHS.end() as u16);
        let mut widest = 1.0..=0.0;
        let mut start = None;
        for nm in (first..=last).map(f32::from) {
            if !self.media.iter().all(|medium| has_index(medium, nm)) {
                start = None;
                continue;
            }
            let from = *start.get_or_insert(nm);
            if nm - from > widest.end() - widest.start() {
                widest = from..=nm;
            }
        }
        widest
    }
}

/// The largest index that is believed.
const MOST_INDEX: f64 = 5.0;

impl fmt::Debug for Spectral {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Spectral").field("optics", &self.optics).finish_non_exhaustive()
    }
}

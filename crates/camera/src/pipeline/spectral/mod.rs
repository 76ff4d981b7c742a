//! A camera's rays with wavelengths of their own: for a sample and a wavelength, the ray and its weight
//! through the lens with the refractive indices at that wavelength.
//!
//! For such rays a camera keeps the media between its surfaces ([`Spectral`]); everything else is built on
//! the first request. The lens, the film and the stop keep the positions for the camera's own wavelength, and
//! the factor of the weights stays the same, so that only the effect of the lens makes the brightness at two
//! wavelengths differ.

mod optics;

use std::{fmt, ops::RangeInclusive, sync::Arc};

pub(crate) use self::optics::{LensOfMedia, WAVELENGTHS};
use super::{
    body::{CameraBody, LaneBody},
    film_sampling::FilmSampling,
    ghosts::{GhostRays, GhostTracer, SpectralGhosts},
    lanes::Pipeline,
    on_demand::OnDemand,
    tracer::LensTracer,
};
use crate::{
    plan::{FilmSide, Precision},
    rays::Outcome,
    samples::Sample,
    sampling::{
        PupilDisk, PupilSampler,
        pupil_map::{self, SpectralPupil},
    },
};
use realistic_light::{Absorbers, PairChoice, SpectralPaths, Transmission};
use realistic_optics::{
    lens::refraction::Refraction,
    trace::{Direction, Path},
};
use realistic_simd::Available;
use realistic_trace::kernel::{KernelScalar, LensSteps};

/// The tracer of a camera's rays at wavelengths other than its own.
pub struct Spectral {
    optics: LensOfMedia,
    body: CameraBody,
    precision: Precision,
    ghosts: Option<Arc<GhostRays>>,
    built: OnDemand<BuiltOptics>,
}

/// The data that the first request builds.
struct BuiltOptics {
    tracer: Arc<dyn LensTracer>,
    /// The lens for rays that are traced one at a time: ghosts, and rays whose transmission or outcome is
    /// requested.
    paths: Arc<SpectralPaths>,
    range: RangeInclusive<f32>,
}

impl Spectral {
    /// Prepares a camera with this lens, its ghosts if it has any, and the precision in which its rays are
    /// traced.
    pub fn new(
        optics: LensOfMedia,
        body: CameraBody,
        precision: Precision,
        ghosts: Option<Arc<GhostRays>>,
    ) -> Self {
        Self { optics, body, precision, ghosts, built: OnDemand::new() }
    }

    fn built(&self) -> &BuiltOptics {
        self.built.get_or_make(|| {
            let range = self.optics.range();
            let paths = Arc::new(self.optics.paths(&range, self.body.coatings.as_deref()));
            let direct = match self.precision {
                Precision::F64 => self.pipeline::<f64>(&range),
                Precision::F32 => self.pipeline::<f32>(&range),
            };
            let tracer = match &self.ghosts {
                Some(ghosts) => {
                    let own = self.optics.lens.radiance_factor();
                    let spectral = SpectralGhosts { paths: paths.clone(), range: range.clone(), own };
                    Arc::new(GhostTracer::new(direct, ghosts.clone(), Some(spectral)))
                }
                None => direct,
            };
            BuiltOptics { tracer, paths, range }
        })
    }

    fn pipeline<S: KernelScalar + Send + Sync>(&self, range: &RangeInclusive<f32>) -> Arc<dyn LensTracer> {
        let LensOfMedia { lens, media, transmittances, .. } = &self.optics;
        let steps = LensSteps::dispersed(&self.optics.path(lens.wavelength), media, lens.wavelength);
        let (pupil, side) = (self.pupil(range), &self.body.film_side);
        let sampler = match &side.sampler {
            PupilSampler::Warped(own) if pupil.is_none() => PupilSampler::Disk(own.cover_disk()),
            // A table over x, y and wavelength would take a minute to build; the disk that contains every
            // pupil is correct but noisier.
            PupilSampler::Posed(own) => PupilSampler::Posed(Arc::new(own.over_disk())),
            sampler => sampler.clone(),
        };
        let film = FilmSampling::<S>::new(&FilmSide { sampler, ..side.clone() }).spectral(pupil, range);
        let (body, simd) = (LaneBody { film, ..self.body.lane_body() }, Available::best());
        match &self.body.coatings {
            Some(coatings) if !range.is_empty() => {
                let absorbers = Absorbers::new(transmittances);
                let range = [range.start(), range.end()].map(|end| (*end).into());
                let lit = Transmission::steps_at_wavelengths(steps, lens, coatings, &absorbers, range);
                Arc::new(Pipeline::new(body, lit, simd))
            }
            _ => Arc::new(Pipeline::new(body, steps, simd)),
        }
    }

    /// Returns the true pupil at all wavelengths; `None` if the true pupil is not sampled.
    fn pupil(&self, range: &RangeInclusive<f32>) -> Option<SpectralPupil> {
        let FilmSide { film, z, sampler: PupilSampler::Warped(_), .. } = &self.body.film_side else {
            return None;
        };
        if range.is_empty() {
            return None;
        }
        let side = |wavelength| {
            let lens = self.optics.at(wavelength);
            let path = Path::new(&lens, Direction::FilmToScene, Refraction::Fused).with_apertures(&lens);
            let (cover, exit) = (
                PupilDisk::rear_of_depth(&lens, *z, film.reach(), film.depth())?,
                PupilDisk::exit(&lens, *z),
            );
            Some((pupil_map::PupilFilmSide::new(&path, *z, [cover, exit]), cover))
        };
        SpectralPupil::new([range.start(), range.end()].map(|end| (*end).into()), film.reach(), side)
    }

    /// Whether a first request has been made.
    pub fn is_built(&self) -> bool {
        self.built.get().is_some()
    }

    /// Returns the tracer of the rays; the first call builds it.
    pub fn tracer(&self) -> &dyn LensTracer {
        &*self.built().tracer
    }

    /// Returns the range of wavelengths, nm, at which the lens has rays: those in [`WAVELENGTHS`] at which
    /// every medium has a refractive index.
    pub fn range(&self) -> &RangeInclusive<f32> {
        &self.built().range
    }

    /// Returns the outcome of a sample that has no ray at a wavelength within the range.
    pub fn why_none(&self, sample: &Sample, wavelength: f32) -> Outcome {
        let paths = &self.built().paths;
        let ghost = |pair: &PairChoice, ray| paths.trace(Some(pair.pair), wavelength.into(), ray);
        if let Some(outcome) = self.ghosts.as_ref().and_then(|ghosts| ghosts.why_none(sample, ghost)) {
            return outcome;
        }
        let ray = self.tracer().film_ray(sample, Some(wavelength));
        self.body.why_none(ray, |ray| paths.trace(None, wavelength.into(), ray))
    }
}

impl fmt::Debug for Spectral {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Spectral").field("optics", &self.optics).finish_non_exhaustive()
    }
}

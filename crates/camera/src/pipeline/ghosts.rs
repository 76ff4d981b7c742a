//! Ghosts in a camera's rays: a share of the lens samples follows paths with two reflections, the rest
//! follows the direct path, and each weight accounts for the probability of its path.
//!
//! The lens sample u selects the path: below the share a path of a pair of surfaces, above it the direct
//! path. After each selection, the interval of u that led to it is stretched to [0, 1] and gives the u of the
//! following steps. So no further random number is needed, and samples that differ only in their film points,
//! as those of a pbrt host and of ray differentials do, select the same path.
//!
//! The direct path is traced by the camera's own tracer. Ghosts are traced one ray at a time in double
//! precision: the direct tracer receives the samples of ghosts with NaN image points, for which it makes no
//! rays, and the rays of the ghosts are written afterwards. For rays with wavelengths of their own, the
//! refractive indices and the reflectances of the coatings are exactly those at the ray's wavelength.

use std::{ops::RangeInclusive, sync::Arc};

use super::{
    body::CameraBody,
    tracer::{LensTracer, Tracer},
};
use crate::{
    columns::{BLOCK, Columns},
    rays::{Outcome, Rays, WorldRay},
    samples::{Sample, Samples},
    sampling::{PupilDisk, film_rays::FilmRays},
};
use realistic_base::numeric::STEPS;
use realistic_light::{FilmGhosts, PairChoice, SpectralPaths};
use realistic_optics::{
    lens::{self, film_ray},
    trace::{Blocked, Ray},
};

/// The path that a sample follows.
enum GhostChoice {
    /// The direct path, for this sample with its stretched u.
    Direct(Sample),
    /// The path with reflections at a pair of surfaces.
    Ghost(PairChoice),
}

/// Makes the rays of a camera's ghosts.
#[derive(Debug)]
pub struct GhostRays {
    /// Share of the samples that follow ghost paths.
    share: f64,
    ghosts: FilmGhosts,
    /// The disk that contains all rays through the rear surface.
    cover: PupilDisk,
    /// The camera's body; the rays of its film have weights.
    body: CameraBody,
}

impl GhostRays {
    /// Prepares ghosts for a share of the samples, which is greater than 0.
    pub fn new(share: f64, ghosts: FilmGhosts, cover: PupilDisk, body: &CameraBody) -> Self {
        Self { share, ghosts, cover, body: body.clone() }
    }

    /// Chooses the path of a sample.
    fn choose(&self, sample: &Sample) -> GhostChoice {
        let u = f64::from(sample.lens_u).clamp(0.0, 1.0);
        // A sample that is NaN has no ray along the direct path.
        if u < self.share || self.share == 1.0 && u == 1.0 {
            return GhostChoice::Ghost(self.ghosts.choose(u / self.share));
        }
        let lens_u = ((u - self.share) / (1.0 - self.share)) as f32;
        GhostChoice::Direct(Sample { lens_u, ..*sample })
    }

    /// Returns the weight of a direct ray, divided by the share of direct rays.
    fn direct(&self, weight: f32) -> f32 {
        ((f64::from(weight) / (1.0 - self.share)) as f32).clamp(f32::MIN_POSITIVE, f32::MAX)
    }

    /// Returns the film ray of a sample along a pair's path. The ray's area is NaN if the sample requests
    /// another lens sample.
    fn film_ray(&self, sample: &Sample, pair: &PairChoice) -> FilmRays<f64> {
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

    /// Returns the ray of a sample along a pair's path. `trace` traces the film ray and returns the ray in
    /// front of the lens and its transmission.
    fn ray(
        &self,
        sample: &Sample,
        pair: &PairChoice,
        trace: impl Fn(Ray) -> Result<(Ray, f64), Blocked>,
    ) -> Option<(WorldRay, f32)> {
        let film_ray = self.film_ray(sample, pair);
        if film_ray.area_per_pi.is_nan() {
            return None;
        }
        let from = lens::film_ray(film_ray.point, self.body.film_side.z, film_ray.slopes);
        let (ray, left) = trace(from).ok()?;
        self.body.world_ray(&film_ray, ray, left / (self.share * pair.probability), sample.time)
    }

    fn own_ray(&self, sample: &Sample, pair: &PairChoice) -> Option<(WorldRay, f32)> {
        self.ray(sample, pair, |ray| self.ghosts.trace(pair, ray))
    }

    /// Returns the reason why a sample of a ghost has no ray, with `trace` as in [`GhostRays::ray`]; `None`
    /// if the sample follows the direct path.
    pub fn why_none(
        &self,
        sample: &Sample,
        trace: impl Fn(&PairChoice, Ray) -> Result<(Ray, f64), Blocked>,
    ) -> Option<Outcome> {
        let GhostChoice::Ghost(pair) = self.choose(sample) else { return None };
        let FilmRays { point, slopes, area_per_pi, .. } = self.film_ray(sample, &pair);
        if area_per_pi.is_nan() {
            return Some(Outcome::Redraw);
        }
        let traced = trace(&pair, film_ray(point, self.body.film_side.z, slopes));
        Some(Outcome::Blocked(traced.err().unwrap_or(Blocked::Clipped)))
    }

    /// Traces a ghost at the camera's own wavelength.
    pub fn trace(&self, pair: &PairChoice, ray: Ray) -> Result<(Ray, f64), Blocked> {
        self.ghosts.trace(pair, ray)
    }

    /// Returns the share of ghost samples that pass the lens, over all pairs and the whole film.
    pub fn acceptance(&self) -> f64 {
        // Lenses with many surfaces get fewer samples; the result only appears in a message.
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

/// The lens paths at any wavelength.
pub struct SpectralGhosts {
    pub paths: Arc<SpectralPaths>,
    /// Range of wavelengths, nm.
    pub range: RangeInclusive<f32>,
    /// The radiance factor (n'/n)² of the media at both ends at the camera's own wavelength, which the weights contain.
    pub own: f64,
}

impl SpectralGhosts {
    /// Traces a ghost at a wavelength, nm. The share of the light contains the change of the radiance factor.
    fn trace(&self, pair: &PairChoice, wavelength: f64, ray: Ray) -> Result<(Ray, f64), Blocked> {
        let (ray, share) = self.paths.trace(Some(pair.pair), wavelength, ray)?;
        Ok((ray, share * (self.paths.radiance_factor(wavelength) / self.own)))
    }
}

/// The camera's own tracer, with a share of the samples traced as ghosts.
pub struct GhostTracer {
    direct: Arc<dyn LensTracer>,
    ghosts: Arc<GhostRays>,
    /// The lens paths at any wavelength; `None` if rays have no wavelengths of their own.
    spectral: Option<SpectralGhosts>,
}

impl GhostTracer {
    pub fn new(
        direct: Arc<dyn LensTracer>,
        ghosts: Arc<GhostRays>,
        spectral: Option<SpectralGhosts>,
    ) -> Self {
        Self { direct, ghosts, spectral }
    }

    /// Returns the ray of a sample along a pair's path, at a wavelength, nm, if rays have wavelengths of their own.
    fn ghost(&self, sample: &Sample, pair: &PairChoice, wavelength: Option<f32>) -> Option<(WorldRay, f32)> {
        match (&self.spectral, wavelength) {
            (Some(spectral), Some(wavelength)) => {
                let trace = |ray| spectral.trace(pair, wavelength.into(), ray);
                spectral.range.contains(&wavelength).then(|| self.ghosts.ray(sample, pair, trace))?
            }
            _ => self.ghosts.own_ray(sample, pair),
        }
    }
}

impl Tracer for GhostTracer {
    fn trace(&self, samples: &Samples<'_>, rays: &mut Rays<'_>) {
        let n = samples.len();
        let mut block = Columns::<6>::zeros(n);
        for first in (0..n).step_by(BLOCK) {
            let count = BLOCK.min(n - first);
            let mut columns = block.first_mut(count);
            samples.copy(first, &mut columns);
            let [x, _, u, ..] = columns;
            for i in 0..count {
                match self.ghosts.choose(&samples.get(first + i)) {
                    GhostChoice::Direct(sample) => u[i] = sample.lens_u,
                    GhostChoice::Ghost(_) => x[i] = f32::NAN,
                }
            }
            let mut part = rays.part(first, count);
            let requested = block.samples(count, samples.have_wavelengths());
            self.direct.trace(&requested, &mut part);
            for weight in part.weights().iter_mut().filter(|weight| **weight > 0.0) {
                *weight = self.ghosts.direct(*weight);
            }
            for i in (0..count).filter(|&i| requested.column(0)[i].is_nan()) {
                let sample = samples.get(first + i);
                // Repeats the selection, which takes far less time than tracing the path.
                if let GhostChoice::Ghost(pair) = self.ghosts.choose(&sample) {
                    part.put(i, self.ghost(&sample, &pair, samples.wavelength(first + i)));
                }
            }
        }
    }

    fn gains_by_four(&self) -> bool {
        self.direct.gains_by_four()
    }
}

impl LensTracer for GhostTracer {
    fn film_ray(&self, sample: &Sample, wavelength: Option<f32>) -> FilmRays<f64> {
        match self.ghosts.choose(sample) {
            GhostChoice::Direct(sample) => self.direct.film_ray(&sample, wavelength),
            GhostChoice::Ghost(pair) => self.ghosts.film_ray(sample, &pair),
        }
    }
}

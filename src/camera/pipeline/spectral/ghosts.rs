//! Ghosts at wavelengths. A ghost's indices, and what its coatings reflect, are those of the ray's own wavelength, exactly.

use std::{ops::RangeInclusive, sync::Arc};

use crate::{
    camera::{
        pipeline::{
            arrays::{OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore},
            ghosts::{Choice, GhostRays, in_blocks},
            tracer::SpectralTracer,
        },
        ray::{Outcome, Sample, WorldRay},
    },
    light::{PairChoice, SpectralPaths},
    sampling::film_rays::FilmRays,
};

/// Why a sample has no ray at a wavelength, nm; `None` where it goes along the direct path.
pub(super) fn why_none(
    ghosts: &GhostRays,
    sample: &Sample,
    wavelength: f32,
    paths: &SpectralPaths,
) -> Option<Outcome> {
    let Choice::Ghost(pair) = ghosts.choose(sample) else { return None };
    let trace = |ray| paths.trace(Some(pair.pair), wavelength.into(), ray);
    Some(ghosts.why_none(sample, &pair, trace))
}

/// A camera's own tracer at wavelengths, with a share of the samples for ghosts.
pub(super) struct SpectralGhosts {
    direct: Box<dyn SpectralTracer>,
    ghosts: Arc<GhostRays>,
    paths: Arc<SpectralPaths>,
    range: RangeInclusive<f32>,
}

impl SpectralGhosts {
    pub fn new(
        direct: Box<dyn SpectralTracer>,
        ghosts: Arc<GhostRays>,
        paths: Arc<SpectralPaths>,
        range: &RangeInclusive<f32>,
    ) -> Self {
        Self { direct, ghosts, paths, range: range.clone() }
    }

    fn ghost(&self, sample: &Sample, pair: &PairChoice, wavelength: f32) -> Option<(WorldRay, f32)> {
        if !self.range.contains(&wavelength) {
            return None;
        }
        self.ghosts.ray(sample, pair, |ray| self.paths.trace(Some(pair.pair), wavelength.into(), ray))
    }
}

impl SpectralTracer for SpectralGhosts {
    fn one(&self, sample: &Sample, wavelength: f32, ray: &mut OneRay<'_>) {
        match self.ghosts.choose(sample) {
            Choice::Direct(sample) => {
                self.direct.one(&sample, wavelength, ray);
                self.ghosts.rescale(ray.weight);
            }
            Choice::Ghost(pair) => ray.put(0, self.ghost(sample, &pair, wavelength)),
        }
    }

    fn four(&self, samples: &SampleBlock<4>, wavelengths: &[f32; 4], rays: &mut RayBlock<4>) {
        self.many(&samples.arrays(4), wavelengths, &mut rays.arrays(4));
    }

    fn many(&self, samples: &SampleArrays<'_>, wavelengths: &[f32], rays: &mut RayArrays<'_>) {
        let direct = |first: usize, block: &SampleArrays<'_>, found: &mut RayArrays<'_>| {
            self.direct.many(block, &wavelengths[first..first + block.len()], found);
        };
        in_blocks(&self.ghosts, samples, rays, direct, |i, pair| {
            self.ghost(&samples.get(i), pair, wavelengths[i])
        });
    }

    fn film_ray(&self, sample: &Sample, wavelength: f32) -> FilmRays<f64> {
        match self.ghosts.choose(sample) {
            Choice::Direct(sample) => self.direct.film_ray(&sample, wavelength),
            Choice::Ghost(pair) => self.ghosts.film_ray(sample, &pair),
        }
    }
}

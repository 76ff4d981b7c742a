//! Ghosts at wavelengths. The lens of a ghost is made anew for each ray: its indices and what its coatings reflect are those
//! of the ray's own wavelength, exactly.

use std::{ops::RangeInclusive, sync::Arc};

use super::optics::LensOfMedia;
use crate::{
    camera::{
        pipeline::{
            arrays::{OneRay, RayArrays, RayBlock, RayStore, SampleArrays, SampleBlock, SampleStore},
            ghosts::{Choice, GhostRays, in_blocks},
            tracer::SpectralTracer,
        },
        ray::{Outcome, Sample, WorldRay},
    },
    light::{LitPath, PairChoice, Surfaces},
    sampling::film_rays::FilmRays,
};

/// The path of a pair at a wavelength, nm, at which the lens has rays; exact rays alone may be asked of it.
fn path(ghosts: &GhostRays, pair: &PairChoice, wavelength: f32, optics: &LensOfMedia) -> Option<LitPath> {
    let lens = optics.at(wavelength.into());
    let surfaces = Surfaces::untabulated(&lens, optics.coatings.as_ref()?);
    Some(ghosts.ghosts.path_through(pair, &lens, optics.blades, &surfaces))
}

/// Why a sample has no ray at a wavelength, nm; `None` where it goes along the direct path.
pub(super) fn why_none(
    ghosts: &GhostRays,
    sample: &Sample,
    wavelength: f32,
    optics: &LensOfMedia,
) -> Option<Outcome> {
    let Choice::Ghost(pair) = ghosts.choose(sample) else { return None };
    let lit = path(ghosts, &pair, wavelength, optics)?;
    Some(ghosts.why_none(sample, &pair, lit.path()))
}

/// A camera's own tracer at wavelengths, with a share of the samples for ghosts.
pub(super) struct SpectralGhosts {
    direct: Box<dyn SpectralTracer>,
    ghosts: Arc<GhostRays>,
    optics: LensOfMedia,
    range: RangeInclusive<f32>,
}

impl SpectralGhosts {
    pub fn new(
        direct: Box<dyn SpectralTracer>,
        ghosts: Arc<GhostRays>,
        optics: &LensOfMedia,
        range: &RangeInclusive<f32>,
    ) -> Self {
        Self { direct, ghosts, optics: optics.clone(), range: range.clone() }
    }

    fn ghost(&self, sample: &Sample, pair: &PairChoice, wavelength: f32) -> Option<(WorldRay, f32)> {
        if !self.range.contains(&wavelength) {
            return None;
        }
        let lit = path(&self.ghosts, pair, wavelength, &self.optics)?;
        self.ghosts.ray(sample, pair, |ray| lit.trace_exactly(ray).ok())
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

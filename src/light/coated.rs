//! A lens with what its surfaces do to light, and paths through it: a ray in; the ray behind the lens and what is left of its
//! power out.

use std::sync::Arc;

use super::{boundary::Boundary, polarization::Light, stack::Share};
use crate::{
    lens::{Lens, Ray},
    numeric::dot,
    prescription::{Layer, SurfaceCoating},
    trace::{Blocked, Path},
};

/// What the surfaces of a lens do to light, at the lens's wavelength.
#[derive(Clone, Debug)]
pub struct Surfaces {
    /// One for each distinct surface, so that a ray's tables stay in the first cache; all paths of a lens share them.
    boundaries: Arc<[Boundary]>,
    /// Which of them each surface is, from the scene side.
    of_surface: Vec<usize>,
    /// The absorption coefficient of the medium behind each, 1/mm.
    absorption: Vec<f64>,
}

impl Surfaces {
    /// Of a lens all of whose surfaces between air and glass have one coating.
    pub fn new(lens: &Lens, coating: impl Into<SurfaceCoating>) -> Self {
        let coating = coating.into();
        Self::with(lens, |_| &coating, Boundary::new)
    }

    /// Of a lens whose surfaces, from the scene on, have these coatings.
    pub fn of_each(lens: &Lens, coatings: &[SurfaceCoating]) -> Self {
        Self::with(lens, |surface| &coatings[surface], Boundary::new)
    }

    /// [`Surfaces::of_each`] for few rays, which do without tables: [`LitPath::trace_exactly`] alone may be asked.
    pub fn untabulated(lens: &Lens, coatings: &[SurfaceCoating]) -> Self {
        Self::with(lens, |surface| &coatings[surface], Boundary::untabulated)
    }

    /// Of a lens whose surfaces, counted from the scene, have coatings of their own.
    fn with<'a>(
        lens: &Lens,
        coating: impl Fn(usize) -> &'a SurfaceCoating,
        boundary: impl Fn([f64; 2], &[Layer], f64) -> Boundary,
    ) -> Self {
        let mut boundaries: Vec<Boundary> = Vec::new();
        let number = |(i, surface): (usize, &crate::lens::Surface)| {
            let media = [surface.n_scene, surface.n_film];
            let layers = coating(i).layers(media);
            let known = boundaries.iter().position(|boundary| boundary.is(media, &layers));
            known.unwrap_or_else(|| {
                boundaries.push(boundary(media, &layers, lens.wavelength));
                boundaries.len() - 1
            })
        };
        let of_surface = lens.surfaces.iter().enumerate().map(number).collect();
        let absorption = lens.surfaces.iter().map(|surface| surface.absorption).collect();
        Self { boundaries: boundaries.into(), of_surface, absorption }
    }

    /// The same where no glass absorbs.
    #[must_use]
    pub fn without_absorption(mut self) -> Self {
        self.absorption.fill(0.0);
        self
    }

    /// What the surface of this number, counted from the scene, is.
    pub fn boundary(&self, surface: usize) -> &Boundary {
        &self.boundaries[self.of_surface[surface]]
    }

    /// The numbers of the surfaces that reflect, from the scene side.
    pub fn reflecting(&self) -> Vec<usize> {
        (0..self.of_surface.len()).filter(|&surface| !self.boundary(surface).is_none()).collect()
    }
}

/// A path with what its surfaces do to light.
#[derive(Clone, Debug)]
pub struct LitPath {
    path: Path,
    boundaries: Arc<[Boundary]>,
    steps: Vec<LitStep>,
}

/// What a step of a path asks of light.
#[derive(Clone, Copy, Debug)]
struct LitStep {
    boundary: usize,
    /// Index before.
    n: f64,
    per_n: f64,
    is_mirror: bool,
    /// The surface, counted from the scene, behind which the medium before is, where the path has been in one.
    before: Option<usize>,
    /// Absorption coefficient before, 1/mm.
    absorption: f64,
}

impl LitPath {
    /// A path of the lens that `surfaces` are of.
    pub fn new(path: Path, surfaces: &Surfaces) -> Self {
        // Two neighbours have the medium between them that is behind the one nearer to the scene.
        let mut last: Option<usize> = None;
        let steps = path.step_kinds().map(|kind| {
            let before = last.replace(kind.surface).map(|last| last.min(kind.surface));
            LitStep {
                boundary: surfaces.of_surface[kind.surface],
                n: kind.n,
                per_n: kind.n.recip(),
                is_mirror: kind.is_mirror,
                before,
                absorption: before.map_or(0.0, |surface| surfaces.absorption[surface]),
            }
        });
        Self { steps: steps.collect(), boundaries: surfaces.boundaries.clone(), path }
    }

    /// The same path without edges: light of the rays just outside of what is lit is that of those within, continued.
    #[must_use]
    pub(super) fn without_edges(&self) -> Self {
        Self { path: self.path.clone().without_edges(), ..self.clone() }
    }

    /// The path itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// A ray as it leaves the lens and the share of its power that is left, of unpolarised light, summed over both
    /// polarisations at the end.
    ///
    /// # Errors
    /// The reason why it does not get through.
    #[inline]
    pub fn trace(&self, ray: Ray) -> Result<(Ray, f64), Blocked> {
        self.trace_by(ray, Boundary::share, |_, _| ())
    }

    /// [`LitPath::trace`], where `through` gets each stretch of the ray between two surfaces: the surface, counted from the scene,
    /// behind which its medium is, and its length, mm.
    ///
    /// # Errors
    /// As [`LitPath::trace`].
    pub(super) fn trace_with_ways(
        &self,
        ray: Ray,
        through: impl FnMut(usize, f64),
    ) -> Result<(Ray, f64), Blocked> {
        self.trace_by(ray, Boundary::share, through)
    }

    /// [`LitPath::trace`] without tables: the transfer matrix itself at every surface.
    ///
    /// # Errors
    /// As [`LitPath::trace`].
    pub fn trace_exactly(&self, ray: Ray) -> Result<(Ray, f64), Blocked> {
        let share = |boundary: &Boundary, n, cosine, is_mirror| boundary.computed(n, cosine).share(is_mirror);
        self.trace_by(ray, share, |_, _| ())
    }

    #[inline]
    fn trace_by(
        &self,
        ray: Ray,
        share: impl Fn(&Boundary, f64, f64, bool) -> Share,
        mut through: impl FnMut(usize, f64),
    ) -> Result<(Ray, f64), Blocked> {
        let mut light = Light::UNPOLARISED;
        let ray = self.path.meetings(ray, |met| {
            let step = &self.steps[met.step];
            if let Some(surface) = step.before {
                through(surface, met.way);
            }
            if step.absorption > 0.0 {
                light.dim((-step.absorption * met.way).exp());
            }
            let boundary = &self.boundaries[step.boundary];
            if boundary.is_none() {
                return;
            }
            let cosine = (dot(met.v, met.normal) * step.per_n).min(1.0);
            light.meet(met.v, met.normal, share(boundary, step.n, cosine, step.is_mirror));
            if step.is_mirror {
                light.turn_round();
            }
        })?;
        Ok((ray, light.power))
    }
}

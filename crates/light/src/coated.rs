//! Lenses with coated surfaces, and paths through them. A ray that is traced along a path gives the ray behind the lens
//! and the remaining share of its power.

use std::{borrow::Borrow, sync::Arc};

use super::{
    boundary::Boundary,
    polarization::Light,
    stack::{Share, split_from_behind},
};
use realistic_base::numeric::dot;
use realistic_optics::{
    lens::{Lens, Ray, refraction::Refraction},
    prescription::{AirSide, Layer, SurfaceCoating},
    trace::{Blocked, Direction, FoldedPaths, Meeting, Path, PathSurface},
};

/// Optical properties of the surfaces of a lens, at the lens's wavelength.
#[derive(Clone, Debug)]
pub struct Surfaces {
    /// The distinct boundaries, which all paths of a lens share. They are so few that the tables that a ray needs stay
    /// in the first-level cache.
    boundaries: Arc<[Boundary]>,
    /// Index of the boundary of each surface; surfaces are counted from the scene.
    of_surface: Arc<[usize]>,
    /// Absorption coefficient, 1/mm, of the medium behind each surface.
    absorption: Arc<[f64]>,
}

/// Maximum number of table entries per lens, some 4 MB. The remaining surfaces have no tables: they are computed for
/// each ray.
const ENTRIES: u64 = 40_000;
/// Maximum number of transfer matrices computed for the tables of a lens, some 60 ms. A mirror of fifty layers takes a
/// twelfth of them.
const MATRICES: u64 = 1_000_000;

impl Surfaces {
    /// Builds the surfaces of a lens with one coating on all surfaces between air and glass.
    pub fn new(lens: &Lens, coating: impl Into<SurfaceCoating>) -> Self {
        let coating = coating.into();
        Self::with(lens, |_| &coating, true)
    }

    /// Builds the surfaces of a lens with these coatings, listed from the scene on.
    pub fn of_each(lens: &Lens, coatings: &[SurfaceCoating]) -> Self {
        Self::with(lens, |surface| &coatings[surface], true)
    }

    /// Returns the surfaces of a lens that loses light nowhere but at a picture in its stop.
    pub fn lossless(lens: &Lens) -> Self {
        let count = lens.surfaces.len();
        let boundary = Boundary::untabulated([1.0; 2], &[], lens.wavelength);
        Self {
            boundaries: [boundary].into(),
            of_surface: vec![0; count].into(),
            absorption: vec![0.0; count].into(),
        }
    }

    /// Builds the surfaces as [`Surfaces::of_each`] does, but without tables, for a small number of rays.
    pub fn untabulated(lens: &Lens, coatings: &[SurfaceCoating]) -> Self {
        Self::with(lens, |surface| &coatings[surface], false)
    }

    /// Builds the surfaces with tables or without them; `coating` returns the coating of a surface, counted from the
    /// scene.
    fn with<'a>(lens: &Lens, coating: impl Fn(usize) -> &'a SurfaceCoating, has_tables: bool) -> Self {
        let mut boundaries: Vec<Boundary> = Vec::new();
        let (mut entries, mut matrices) = (0, 0);
        let index_of = |(i, surface): (usize, &realistic_optics::lens::Surface)| {
            let media = [surface.n_scene, surface.n_film];
            let layers = coating(i).layers(media);
            let known = boundaries.iter().position(|boundary| boundary.is(media, &layers));
            known.unwrap_or_else(|| {
                let boundary = Boundary::untabulated(media, &layers, lens.wavelength);
                let size = boundary.table_size();
                let added = [size, size.saturating_mul(2 * boundary.matrices())];
                let sums = [0, 1].map(|k| added[k].saturating_add([entries, matrices][k]));
                boundaries.push(if has_tables && sums[0] <= ENTRIES && sums[1] <= MATRICES {
                    [entries, matrices] = sums;
                    boundary.tabulated()
                } else {
                    boundary
                });
                boundaries.len() - 1
            })
        };
        let of_surface = lens.surfaces.iter().enumerate().map(index_of).collect();
        let absorption = lens.surfaces.iter().map(|surface| surface.absorption).collect();
        Self { boundaries: boundaries.into(), of_surface, absorption }
    }

    /// Returns the boundary at a surface, counted from the scene.
    pub fn boundary(&self, surface: usize) -> &Boundary {
        &self.boundaries[self.of_surface[surface]]
    }

    /// Returns the number of transfer matrices that are computed for each ray at a surface.
    fn matrices(&self, surface: usize) -> u64 {
        let boundary = self.boundary(surface);
        if boundary.is_untabulated() { boundary.matrices() } else { 0 }
    }

    /// Returns the indices of the surfaces that reflect, counted from the scene.
    pub fn reflecting(&self) -> Vec<usize> {
        (0..self.of_surface.len()).filter(|&surface| !self.boundary(surface).is_none()).collect()
    }
}

/// A path with the optical properties of its surfaces.
#[derive(Clone, Debug)]
pub struct LitPath {
    path: Path,
    surfaces: Surfaces,
}

impl LitPath {
    /// Builds a path of the lens to which `surfaces` belong.
    pub fn new(path: Path, surfaces: &Surfaces) -> Self {
        Self { path, surfaces: surfaces.clone() }
    }

    /// Returns the path without its clear apertures, so that the light just outside the lit area continues the light
    /// within it.
    #[must_use]
    pub(super) fn without_edges(&self) -> Self {
        Self { path: self.path.clone().without_edges(), ..self.clone() }
    }

    /// Returns the path itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the cost of a ray, in units of [`Work`](super::work::Work): the number of surfaces that it meets plus
    /// the number of transfer matrices that are computed for it.
    pub(super) fn work(&self) -> u64 {
        let last = self.surfaces.count() - 1;
        let surface = |step: &PathSurface<f64>| from_scene(&self.path, last, step.along);
        let matrices = |step| self.surfaces.matrices(surface(step));
        self.path.work() as u64 + self.path.steps().iter().map(matrices).sum::<u64>()
    }

    /// Traces a ray of unpolarised light. Returns the ray behind the lens and the remaining share of its power, summed
    /// over both polarisations at the end.
    ///
    /// # Errors
    /// Returns the reason if the ray is blocked.
    #[inline]
    pub fn trace(&self, ray: Ray) -> Result<(Ray, f64), Blocked> {
        carry(&self.path, self.path.steps(), ray, &self.surfaces)
    }
}

/// All paths from the film that have no reflection or two reflections ([`FoldedPaths`]), with the optical properties of
/// the surfaces.
#[derive(Clone, Debug)]
pub struct LitPaths {
    paths: FoldedPaths,
    surfaces: Surfaces,
}

impl LitPaths {
    /// Builds the paths of a lens to which `surfaces` belong, with its apertures.
    pub fn new(lens: &Lens, surfaces: &Surfaces) -> Self {
        let paths = FoldedPaths::new(lens, Direction::FilmToScene, Refraction::Fused);
        Self { paths, surfaces: surfaces.clone() }
    }

    /// Returns the number of surfaces of the lens.
    pub(super) fn surfaces(&self) -> usize {
        self.surfaces.of_surface.len()
    }

    /// Returns the cost of a ray that meets every surface once, as [`LitPath::work`] does.
    pub(super) fn work(&self) -> u64 {
        let matrices = (0..self.surfaces()).map(|surface| self.surfaces.matrices(surface));
        self.paths.direct().work() as u64 + matrices.sum::<u64>()
    }

    /// Returns the path of a pair as a separate [`Path`].
    pub fn path(&self, pair: Pair) -> Path {
        self.paths.path(Some(self.mirrors(pair)))
    }

    /// Traces a ray as [`LitPath::trace`] does, along the path of a pair.
    ///
    /// # Errors
    /// See [`LitPath::trace`].
    pub fn trace(&self, pair: Pair, ray: Ray) -> Result<(Ray, f64), Blocked> {
        let steps = self.paths.steps(Some(self.mirrors(pair)));
        carry(self.paths.direct(), steps, ray, &self.surfaces)
    }

    /// Converts a pair to the indices of its mirrors along the direction of travel.
    fn mirrors(&self, [near, far]: Pair) -> [usize; 2] {
        let last = self.surfaces() - 1;
        [last - far, last - near]
    }
}

/// The indices of two surfaces, counted from the scene: `[nearer the scene, nearer the film]`.
pub type Pair = [usize; 2];

/// Function of the index of a medium, counted from the scene's medium, and a wavelength, nm. It returns the refractive
/// index and the absorption coefficient, 1/mm, of the medium, which is in front of the surface with the same index.
pub type MediumAt = Arc<dyn Fn(usize, f64) -> [f64; 2] + Send + Sync>;

/// `LitPaths` at any wavelength. Indices and coatings are computed during the trace, so the trace of a ray allocates no
/// memory.
#[derive(Clone)]
pub struct SpectralPaths {
    paths: FoldedPaths,
    /// Layers of each surface, listed from the air on; surfaces are counted from the scene.
    layers: Arc<[Vec<Layer>]>,
    medium: MediumAt,
}

impl SpectralPaths {
    /// Builds the paths of a lens with its apertures and these coatings, listed from the scene on. The media of
    /// `lens` must have the largest refractive indices of all wavelengths, because bounds of aspheres are derived from
    /// these indices.
    pub fn new(lens: &Lens, coatings: &[SurfaceCoating], medium: MediumAt) -> Self {
        let paths = FoldedPaths::new(lens, Direction::FilmToScene, Refraction::Fused);
        let layers = coatings.iter().map(SurfaceCoating::from_air).collect();
        Self { paths, layers, medium }
    }

    /// Returns the factor (n'/n)² from the radiance in front of the lens to that behind it at a wavelength, nm.
    pub fn radiance_factor(&self, wavelength: f64) -> f64 {
        let [n_scene, n_film] = [0, self.layers.len()].map(|medium| (self.medium)(medium, wavelength)[0]);
        (n_film / n_scene).powi(2)
    }

    /// Traces light as [`LitPath::trace`] does, without tables, at a wavelength, nm. The light follows the path of the
    /// pair or, if `pair` is `None`, the direct path.
    ///
    /// # Errors
    /// See [`LitPath::trace`].
    pub fn trace(&self, pair: Option<Pair>, wavelength: f64, ray: Ray) -> Result<(Ray, f64), Blocked> {
        let last = self.layers.len() - 1;
        let mirrors = pair.map(|[near, far]| [last - far, last - near]);
        let index = |medium: usize| (self.medium)(medium, wavelength)[0];
        let steps = self.paths.steps(mirrors).map(|step| {
            let surface = last - step.along;
            // Rays from the film meet a surface from behind, except between two mirrors.
            let media = [index(surface + 1), index(surface)];
            step.between(if step.is_backward { [media[1], media[0]] } else { media })
        });
        carry(self.paths.direct(), steps, ray, &AtWavelength { paths: self, wavelength })
    }
}

impl std::fmt::Debug for SpectralPaths {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SpectralPaths").field("paths", &self.paths).finish_non_exhaustive()
    }
}

/// Optical properties of surfaces; surfaces are counted from the scene.
trait CoatedOptics {
    /// Returns the number of surfaces.
    fn count(&self) -> usize;
    /// Returns the absorption coefficient, 1/mm, of the medium behind a surface.
    fn absorption(&self, surface: usize) -> f64;
    /// Returns the share of the light that remains after an intersection with this cosine of incidence; `None` where
    /// there is no boundary.
    fn share(&self, surface: usize, met: &Meeting, cosine: f64) -> Option<Share>;
}

impl CoatedOptics for Surfaces {
    fn count(&self) -> usize {
        self.of_surface.len()
    }

    fn absorption(&self, surface: usize) -> f64 {
        self.absorption[surface]
    }

    #[inline]
    fn share(&self, surface: usize, met: &Meeting, cosine: f64) -> Option<Share> {
        let boundary = self.boundary(surface);
        (!boundary.is_none()).then(|| boundary.share(met.n, cosine, met.is_mirror))
    }
}

/// Surfaces at a wavelength, nm.
struct AtWavelength<'a> {
    paths: &'a SpectralPaths,
    wavelength: f64,
}

impl CoatedOptics for AtWavelength<'_> {
    fn count(&self) -> usize {
        self.paths.layers.len()
    }

    fn absorption(&self, surface: usize) -> f64 {
        (self.paths.medium)(surface + 1, self.wavelength)[1]
    }

    fn share(&self, surface: usize, met: &Meeting, cosine: f64) -> Option<Share> {
        let (layers, media) = (&self.paths.layers[surface], [met.n, met.n_behind]);
        let split = match AirSide::of(media) {
            None if met.n == met.n_behind => return None,
            None => split_from_behind([].iter(), media, cosine, self.wavelength),
            Some(AirSide::First) => split_from_behind(layers.iter().rev(), media, cosine, self.wavelength),
            Some(AirSide::Second) => split_from_behind(layers.iter(), media, cosine, self.wavelength),
        };
        Some(split.share(met.is_mirror))
    }
}

/// Converts the index of a surface along a path to its index counted from the scene; `last` is the index of the last
/// surface.
fn from_scene(path: &Path, last: usize, along: usize) -> usize {
    match path.direction() {
        Direction::FilmToScene => last - along,
        Direction::SceneToFilm => along,
    }
}

/// Traces a ray, and unpolarised light along it, through the surfaces `steps` of the lens of `path`.
#[inline]
fn carry<S: Borrow<PathSurface<f64>>>(
    path: &Path,
    steps: impl IntoIterator<Item = S>,
    ray: Ray,
    optics: &impl CoatedOptics,
) -> Result<(Ray, f64), Blocked> {
    let mut light = Light::UNPOLARISED;
    let last = optics.count() - 1;
    let mut before: Option<usize> = None;
    let ray = path.meetings(steps, ray, |met| {
        let surface = from_scene(path, last, met.along);
        // The medium between two neighbouring surfaces is the one behind the surface nearer to the scene.
        if let Some(before) = before.replace(surface) {
            let medium = before.min(surface);
            let absorption = optics.absorption(medium);
            if absorption > 0.0 {
                light.dim((-absorption * met.distance).exp());
            }
        }
        if let Some(rotation) = &met.turned {
            light.enter_frame(rotation);
        }
        light.dim(met.transmission);
        let cosine = (dot(met.v, met.normal) * met.n.recip()).min(1.0);
        if let Some(share) = optics.share(surface, &met, cosine) {
            light.meet(met.v, met.normal, share);
        }
        // A mirror of the lens, which has one medium on both sides, loses no light.
        if met.is_mirror {
            light.turn_round();
        }
    })?;
    Ok((ray, light.power))
}

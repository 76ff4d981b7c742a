//! A lens with what its surfaces do to light, and paths through it: a ray in; the ray behind the lens and what is left of its
//! power out.

use std::{borrow::Borrow, sync::Arc};

use super::{
    boundary::Boundary,
    coating::AirSide,
    polarization::Light,
    stack::{Share, split_from_behind},
};
use crate::{
    lens::{Lens, Ray, refraction::Refraction},
    numeric::dot,
    prescription::{Blades, Layer, SurfaceCoating},
    trace::{Blocked, Direction, FoldedPaths, Meeting, Path, PathSurface},
};

/// What the surfaces of a lens do to light, at the lens's wavelength.
#[derive(Clone, Debug)]
pub struct Surfaces {
    /// One for each distinct surface, so that a ray's tables stay in the first cache; all paths of a lens share them.
    boundaries: Arc<[Boundary]>,
    /// Which of them each surface is, from the scene side.
    of_surface: Arc<[usize]>,
    /// The absorption coefficient of the medium behind each, 1/mm.
    absorption: Arc<[f64]>,
}

/// The entries that all tables of a lens may have together: some 4 MB. Surfaces beyond that are computed for each ray.
const ENTRIES: u64 = 40_000;
/// The transfer matrices that making them may take: some 60 ms. A mirror of fifty layers takes a twelfth.
const MATRICES: u64 = 1_000_000;

impl Surfaces {
    /// Of a lens all of whose surfaces between air and glass have one coating.
    pub fn new(lens: &Lens, coating: impl Into<SurfaceCoating>) -> Self {
        let coating = coating.into();
        Self::with(lens, |_| &coating, true)
    }

    /// Of a lens whose surfaces, from the scene on, have these coatings.
    pub fn of_each(lens: &Lens, coatings: &[SurfaceCoating]) -> Self {
        Self::with(lens, |surface| &coatings[surface], true)
    }

    /// [`Surfaces::of_each`] for few rays, which do without tables.
    pub fn untabulated(lens: &Lens, coatings: &[SurfaceCoating]) -> Self {
        Self::with(lens, |surface| &coatings[surface], false)
    }

    /// Of a lens whose surfaces, counted from the scene, have coatings of their own, with tables or without.
    fn with<'a>(lens: &Lens, coating: impl Fn(usize) -> &'a SurfaceCoating, has_tables: bool) -> Self {
        let mut boundaries: Vec<Boundary> = Vec::new();
        let (mut entries, mut matrices) = (0, 0);
        let number = |(i, surface): (usize, &crate::lens::Surface)| {
            let media = [surface.n_scene, surface.n_film];
            let layers = coating(i).layers(media);
            let known = boundaries.iter().position(|boundary| boundary.is(media, &layers));
            known.unwrap_or_else(|| {
                let boundary = Boundary::untabulated(media, &layers, lens.wavelength);
                let size = boundary.table_size();
                let with = [size, size.saturating_mul(2 * boundary.matrices())];
                let with = [0, 1].map(|k| with[k].saturating_add([entries, matrices][k]));
                boundaries.push(if has_tables && with[0] <= ENTRIES && with[1] <= MATRICES {
                    [entries, matrices] = with;
                    boundary.tabulated()
                } else {
                    boundary
                });
                boundaries.len() - 1
            })
        };
        let of_surface = lens.surfaces.iter().enumerate().map(number).collect();
        let absorption = lens.surfaces.iter().map(|surface| surface.absorption).collect();
        Self { boundaries: boundaries.into(), of_surface, absorption }
    }

    /// The same where no glass absorbs.
    #[must_use]
    pub fn without_absorption(self) -> Self {
        Self { absorption: self.absorption.iter().map(|_| 0.0).collect(), ..self }
    }

    /// What the surface of this number, counted from the scene, is.
    pub fn boundary(&self, surface: usize) -> &Boundary {
        &self.boundaries[self.of_surface[surface]]
    }

    /// Returns how many transfer matrices are computed for light at a surface.
    fn matrices(&self, surface: usize) -> u64 {
        let boundary = self.boundary(surface);
        if boundary.is_untabulated() { boundary.matrices() } else { 0 }
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
    surfaces: Surfaces,
}

impl LitPath {
    /// A path of the lens that `surfaces` are of.
    pub fn new(path: Path, surfaces: &Surfaces) -> Self {
        Self { path, surfaces: surfaces.clone() }
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

    /// Returns what a ray takes and the transfer matrices that are computed for it: its share of a [`Work`].
    pub(super) fn work(&self) -> u64 {
        let last = self.surfaces.count() - 1;
        let surface = |step: &PathSurface<f64>| from_scene(&self.path, last, step.along);
        let matrices = |step| self.surfaces.matrices(surface(step));
        self.path.work() as u64 + self.path.steps().iter().map(matrices).sum::<u64>()
    }

    /// A ray as it leaves the lens and the share of its power that is left, of unpolarised light, summed over both
    /// polarisations at the end.
    ///
    /// # Errors
    /// The reason why it does not get through.
    #[inline]
    pub fn trace(&self, ray: Ray) -> Result<(Ray, f64), Blocked> {
        self.trace_with_ways(ray, |_, _| ())
    }

    /// [`LitPath::trace`], where `through` gets each stretch of the ray between two surfaces: the surface, counted from the scene,
    /// behind which its medium is, and its length, mm.
    ///
    /// # Errors
    /// As [`LitPath::trace`].
    #[inline]
    pub(super) fn trace_with_ways(
        &self,
        ray: Ray,
        through: impl FnMut(usize, f64),
    ) -> Result<(Ray, f64), Blocked> {
        carry(&self.path, self.path.steps(), ray, &self.surfaces, through)
    }

    /// [`LitPath::trace`] without tables: the transfer matrix itself at every surface.
    ///
    /// # Errors
    /// As [`LitPath::trace`].
    pub fn trace_exactly(&self, ray: Ray) -> Result<(Ray, f64), Blocked> {
        carry(&self.path, self.path.steps(), ray, &Exactly(&self.surfaces), |_, _| ())
    }
}

/// All paths from the film with no reflection or with two, with what the surfaces do to light: those of [`FoldedPaths`].
#[derive(Clone, Debug)]
pub struct LitPaths {
    paths: FoldedPaths,
    surfaces: Surfaces,
}

impl LitPaths {
    /// Returns the paths of a lens, which `surfaces` are of, with blades in its stop.
    pub fn new(lens: &Lens, blades: Option<Blades>, surfaces: &Surfaces) -> Self {
        let paths = FoldedPaths::new(lens, Direction::FilmToScene, Refraction::Fused, blades);
        Self { paths, surfaces: surfaces.clone() }
    }

    /// Returns how many surfaces the lens has.
    pub(super) fn surfaces(&self) -> usize {
        self.surfaces.of_surface.len()
    }

    /// Returns the work of light at every surface once, as of [`LitPath::work`].
    pub(super) fn work(&self) -> u64 {
        let matrices = (0..self.surfaces()).map(|surface| self.surfaces.matrices(surface));
        self.paths.direct().work() as u64 + matrices.sum::<u64>()
    }

    /// The path of a pair by itself.
    pub fn path(&self, pair: Pair) -> Path {
        self.paths.path(Some(self.turns(pair)))
    }

    /// [`LitPath::trace`] along the path of a pair.
    ///
    /// # Errors
    /// As [`LitPath::trace`].
    pub fn trace(&self, pair: Pair, ray: Ray) -> Result<(Ray, f64), Blocked> {
        let steps = self.paths.steps(Some(self.turns(pair)));
        carry(self.paths.direct(), steps, ray, &self.surfaces, |_, _| ())
    }

    /// A pair, counted along the travel.
    fn turns(&self, [near, far]: Pair) -> [usize; 2] {
        let last = self.surfaces() - 1;
        [last - far, last - near]
    }
}

/// Two surfaces, counted from the scene, `[nearer the scene, nearer the film]`.
pub type Pair = [usize; 2];

/// The refractive index, and the absorption coefficient in 1/mm, behind a surface, counted from the scene, at a wavelength, nm.
pub type MediumAt = Arc<dyn Fn(usize, f64) -> [f64; 2] + Send + Sync>;

/// `LitPaths` at any wavelength. A ray's indices and coatings are computed on its way, so that a ray allocates nothing.
#[derive(Clone)]
pub struct SpectralPaths {
    paths: FoldedPaths,
    /// The coatings of the surfaces, counted from the scene, and the layers of each from the air on.
    coatings: Arc<[SurfaceCoating]>,
    layers: Arc<[Vec<Layer>]>,
    medium: MediumAt,
}

impl SpectralPaths {
    /// Returns the paths of a lens with blades in its stop, whose surfaces, from the scene on, have these coatings. Its indices are to be the
    /// largest of all wavelengths: bounds of aspheres are made with them.
    pub fn new(lens: &Lens, blades: Option<Blades>, coatings: &[SurfaceCoating], medium: MediumAt) -> Self {
        let paths = FoldedPaths::new(lens, Direction::FilmToScene, Refraction::Fused, blades);
        let layers = coatings.iter().map(SurfaceCoating::from_air).collect();
        Self { paths, coatings: coatings.into(), layers, medium }
    }

    /// Returns the surfaces of the lens at its wavelength.
    pub(super) fn surfaces(&self, lens: &Lens) -> Surfaces {
        Surfaces::of_each(lens, &self.coatings)
    }

    /// [`LitPath::trace_exactly`] at a wavelength, nm, along the path of a pair, or along the one without a reflection.
    ///
    /// # Errors
    /// As [`LitPath::trace`].
    pub fn trace(&self, pair: Option<Pair>, wavelength: f64, ray: Ray) -> Result<(Ray, f64), Blocked> {
        let last = self.layers.len() - 1;
        let turns = pair.map(|[near, far]| [last - far, last - near]);
        let index = |surface: usize| (self.medium)(surface, wavelength)[0];
        let steps = self.paths.steps(turns).map(|step| {
            let surface = last - step.along;
            let before = surface.checked_sub(1).map_or(1.0, index);
            // Rays from the film come from behind, but between two mirrors.
            let media = [index(surface), before];
            step.between(if step.is_backward { [media[1], media[0]] } else { media })
        });
        carry(self.paths.direct(), steps, ray, &AtWavelength { paths: self, wavelength }, |_, _| ())
    }
}

impl std::fmt::Debug for SpectralPaths {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SpectralPaths").field("paths", &self.paths).finish_non_exhaustive()
    }
}

/// The optics of surfaces, counted from the scene: their action on light that meets them.
trait CoatedOptics {
    /// Returns how many there are.
    fn count(&self) -> usize;
    /// The absorption coefficient behind a surface, 1/mm.
    fn absorption(&self, surface: usize) -> f64;
    /// Returns the share that light keeps at a meeting with this cosine of incidence; `None` where there is no boundary.
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

/// The same without tables.
struct Exactly<'a>(&'a Surfaces);

impl CoatedOptics for Exactly<'_> {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn absorption(&self, surface: usize) -> f64 {
        self.0.absorption(surface)
    }

    fn share(&self, surface: usize, met: &Meeting, cosine: f64) -> Option<Share> {
        let boundary = self.0.boundary(surface);
        (!boundary.is_none()).then(|| boundary.computed(met.n, cosine).share(met.is_mirror))
    }
}

/// The same at a wavelength, nm.
struct AtWavelength<'a> {
    paths: &'a SpectralPaths,
    wavelength: f64,
}

impl CoatedOptics for AtWavelength<'_> {
    fn count(&self) -> usize {
        self.paths.layers.len()
    }

    fn absorption(&self, surface: usize) -> f64 {
        (self.paths.medium)(surface, self.wavelength)[1]
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

/// Counts a surface of a path from the scene, of which the last has this number.
fn from_scene(path: &Path, last: usize, along: usize) -> usize {
    match path.direction() {
        Direction::FilmToScene => last - along,
        Direction::SceneToFilm => along,
    }
}

/// Takes a ray through the surfaces of `steps`, which are those of the lens of `path`, and unpolarised light along it. `through` is
/// as of [`LitPath::trace_with_ways`].
#[inline]
fn carry<S: Borrow<PathSurface<f64>>>(
    path: &Path,
    steps: impl IntoIterator<Item = S>,
    ray: Ray,
    optics: &impl CoatedOptics,
    mut through: impl FnMut(usize, f64),
) -> Result<(Ray, f64), Blocked> {
    let mut light = Light::UNPOLARISED;
    let last = optics.count() - 1;
    let mut before: Option<usize> = None;
    let ray = path.meetings_over(steps, ray, |met| {
        let surface = from_scene(path, last, met.along);
        // Two neighbours have the medium between them that is behind the one nearer to the scene.
        if let Some(before) = before.replace(surface) {
            let medium = before.min(surface);
            through(medium, met.way);
            let absorption = optics.absorption(medium);
            if absorption > 0.0 {
                light.dim((-absorption * met.way).exp());
            }
        }
        let cosine = (dot(met.v, met.normal) * met.n.recip()).min(1.0);
        if let Some(share) = optics.share(surface, &met, cosine) {
            light.meet(met.v, met.normal, share);
            if met.is_mirror {
                light.turn_round();
            }
        }
    })?;
    Ok((ray, light.power))
}

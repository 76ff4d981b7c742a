//! Ghosts: light that reaches the film after reflection at two surfaces. This module finds the path of each pair of
//! surfaces and, for a lamp, the power, W, along that path and the distribution of this power on the film.
//!
//! The path of a ghost is an ordinary sequence of surfaces, except that n' = -n at the two mirrors
//! ([`Path::reflected`]). It leads to the mirror farther from the light, back to the nearer mirror, and on to the film.
//! k reflecting surfaces have k (k - 1)/2 pairs. Light reflected four times or more is left out; `docs/light.md` states
//! the amount of this light.
//!
//! A lamp sends rays through a grid of cells in front of the front surface; each ray has the power of its cell. A
//! search finds the part of the grid whose rays reach the film, among the rays that reach the farther mirror. The cells
//! are then laid over that part alone: of the wide front surface of a fisheye, a ghost needs a thousandth. The result
//! is a [`Spray`].

use super::{
    coated::{LitPath, Pair, Surfaces},
    lamp::{Lamp, front_sphere},
    pairs::{Estimate, Pairs},
    spray::{Mixture, PairTracers, Spray, ends, sprays},
};
use realistic_optics::{
    lens::{Lens, Ray, refraction::Refraction},
    prescription::SurfaceCoating,
    trace::{Direction, Path},
};
use realistic_trace::kernel::ClearanceTracer;

/// Maximum number of surfaces that all paths of a [`Ghosts`] intersect in total. This suffices for all pairs of a lens
/// with 45 reflecting surfaces.
const MET: usize = 100_000;

/// The paths through a lens from the scene to the film that have no reflection or two reflections. If there are too
/// many pairs, only the brightest pairs, by first-order optics, are kept.
#[derive(Clone, Debug)]
pub struct Ghosts {
    lens: Lens,
    surfaces: Surfaces,
    direct: LitPath,
    pairs: Vec<Pair>,
    left_out: LeftOut,
    /// Sphere that contains the front surface; see [`front_sphere`].
    front: [f64; 2],
    film: f64,
}

/// The pairs that are left out if a lens has too many of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeftOut {
    /// Number of pairs left out.
    pub pairs: usize,
    /// Share of these pairs in the light that a uniform sky sends along all pairs to the middle of the film, by
    /// first-order optics.
    pub share: f64,
}

impl Ghosts {
    /// Finds the ghosts of a lens with the film at z = `film`, mm.
    pub fn new(lens: &Lens, surfaces: &Surfaces, film: f64) -> Self {
        let direct = LitPath::new(path(lens, None), surfaces);
        let all = Pairs::of(surfaces).brightest(lens, surfaces, film);
        let mut met = 0;
        let fits = |estimate: &&Estimate| {
            let [near, far] = estimate.pair();
            met += lens.surfaces.len() + 2 * (far - near);
            met <= MET
        };
        let mut pairs: Vec<Pair> = all.iter().take_while(fits).map(Estimate::pair).collect();
        let light = |part: &[Estimate]| part.iter().map(|own| f64::from(own.light)).sum::<f64>();
        let (whole, rest) = (light(&all), light(&all[pairs.len()..]));
        let share = if whole > 0.0 { rest / whole } else { 0.0 };
        let left_out = LeftOut { pairs: all.len() - pairs.len(), share };
        pairs.sort_unstable();
        let (lens, surfaces, front) = (lens.clone(), surfaces.clone(), front_sphere(lens));
        Self { lens, surfaces, direct, pairs, left_out, front, film }
    }

    /// Iterates over the pairs and their paths; each path is built when the iteration reaches it.
    pub fn pairs(&self) -> impl Iterator<Item = (Pair, LitPath)> {
        self.pairs.iter().map(|pair| (*pair, self.lit(*pair)))
    }

    /// Returns the pairs, each as the indices of its surfaces.
    pub fn chosen(&self) -> &[Pair] {
        &self.pairs
    }

    /// Returns the pairs that are left out.
    pub fn left_out(&self) -> LeftOut {
        self.left_out
    }

    /// Returns the path of a pair.
    pub fn lit(&self, pair: Pair) -> LitPath {
        LitPath::new(path(&self.lens, Some(pair)), &self.surfaces)
    }

    /// Returns the path without a reflection.
    pub fn direct(&self) -> &LitPath {
        &self.direct
    }

    /// Traces the light of a lamp along a path, by a grid of `side` x `side` cells over the part of the light that gets
    /// through. The spray is empty if no such part is found, and for lamps that [`Lamp::check`] rejects.
    pub fn spray(&self, path: &LitPath, lamp: Lamp, side: usize) -> Spray {
        let tracers = [ClearanceTracer::new(path.path(), self.film)];
        let approaches: Vec<_> = approach(path.path()).into_iter().collect();
        let light = [path.without_edges()];
        let pair_tracers =
            PairTracers { tracers: &tracers, approaches: &approaches, nodes: &[0], light: &light };
        let mut only = Spray::default();
        sprays(&pair_tracers, lamp, self.front, side, &[Mixture::own()], |_, spray| only.clone_from(spray));
        only
    }
}

/// Returns the path of a pair through a lens or, if `pair` is `None`, the path without a reflection.
fn path(lens: &Lens, pair: Option<Pair>) -> Path {
    let path = match pair {
        Some(pair) => Path::reflected(lens, Direction::SceneToFilm, Refraction::Fused, pair),
        None => Path::scene_to_film(lens),
    };
    path.with_apertures(lens)
}

/// Returns the tracer of a path up to the first mirror; `None` if the path has no mirror. The film is infinitely far
/// away, so no ray can miss it.
fn approach(path: &Path) -> Option<ClearanceTracer> {
    path.up_to_mirror().map(|path| ClearanceTracer::new(&path, f64::NEG_INFINITY))
}

/// The ghosts of a lens at many wavelengths. Whole grids are traced at some wavelengths, and the edges of the grids at
/// all wavelengths (`spray.rs`).
#[derive(Clone, Debug)]
pub struct GhostSpectrum {
    /// The lens at each wavelength.
    lenses: Vec<Lens>,
    /// Indices of the wavelengths at which whole grids are traced.
    nodes: Vec<usize>,
    /// The ghosts at the wavelengths at which light is traced.
    light: Vec<Ghosts>,
    /// Interpolation weights for each wavelength.
    mixtures: Vec<Mixture>,
}

/// Number of wavelengths at which whole grids are traced. At the other wavelengths, the interpolated points at which
/// rays land are then within a hundredth of a pixel of the exact points.
const LANDING_NODES: usize = 3;
/// Candidate numbers of wavelengths at which light is traced; the first number that suffices is used. A quarter-wave
/// coating needs the second.
const LIGHT_NODES: [usize; 4] = [5, 7, 9, 13];
/// Tolerated error of the interpolated product of two reflectances, relative to its maximum.
const TOLERANCE: f64 = 1e-3;

impl GhostSpectrum {
    /// Builds the ghosts at these wavelengths, nm. `lens_at` returns the lens at a wavelength, `coatings` lists the
    /// coatings of its surfaces from the scene on, and the film is at z = `film`, mm.
    pub fn new(
        wavelengths: &[f64],
        lens_at: impl Fn(f64) -> Lens,
        coatings: &[SurfaceCoating],
        film: f64,
    ) -> Self {
        let lenses = wavelengths.iter().map(|nm| lens_at(*nm)).collect();
        let nodes = nearest(wavelengths, &nodes(wavelengths, LANDING_NODES));
        let at_nodes: Vec<f64> = nodes.iter().map(|k| wavelengths[*k]).collect();
        let of_light = light_nodes(wavelengths, &lens_at, coatings);
        let light = of_light.iter().map(|nm| {
            let lens = lens_at(*nm);
            Ghosts::new(&lens, &Surfaces::of_each(&lens, coatings), film)
        });
        let light = light.collect();
        let mixture =
            |nm: &f64| Mixture { landing: lagrange(&at_nodes, *nm), light: lagrange(&of_light, *nm) };
        Self { lenses, nodes, light, mixtures: wavelengths.iter().map(mixture).collect() }
    }

    /// Iterates over the pairs.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> {
        self.light.iter().take(1).flat_map(|ghosts| ghosts.chosen().iter().copied())
    }

    /// Traces the light of a lamp along the path of a pair, or the direct path, as [`Ghosts::spray`] does. `found` is
    /// called with the index of each wavelength and the spray at that wavelength.
    pub fn sprays(&self, pair: Option<Pair>, lamp: Lamp, side: usize, found: impl FnMut(usize, &Spray)) {
        let Some(ghosts) = self.light.first() else { return };
        let lit_path = |ghosts: &Ghosts| pair.map_or_else(|| ghosts.direct.clone(), |pair| ghosts.lit(pair));
        let paths: Vec<Path> = self.lenses.iter().map(|lens| path(lens, pair)).collect();
        let tracers: Vec<_> = paths.iter().map(|path| ClearanceTracer::new(path, ghosts.film)).collect();
        let approaches: Vec<_> = ends(&paths).filter_map(approach).collect();
        let light: Vec<_> = self.light.iter().map(|ghosts| lit_path(ghosts).without_edges()).collect();
        let pair_tracers =
            PairTracers { tracers: &tracers, approaches: &approaches, nodes: &self.nodes, light: &light };
        sprays(&pair_tracers, lamp, ghosts.front, side, &self.mixtures, found);
    }
}

/// Returns the interpolation variable of a wavelength, nm: refractive indices and phases are smooth functions of it.
fn variable(nm: f64) -> f64 {
    (1000.0 / nm).powi(2)
}

/// Returns `count` interpolation nodes, nm, over the range of `wavelengths`: Chebyshev's extrema, including both ends.
/// Returns `wavelengths` itself if it has no more than `count` elements.
fn nodes(wavelengths: &[f64], count: usize) -> Vec<f64> {
    if wavelengths.len() <= count {
        return wavelengths.to_vec();
    }
    let ends = wavelengths.iter().map(|nm| variable(*nm));
    let [low, high] =
        ends.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], at| [low.min(at), high.max(at)]);
    let node = |k: usize| {
        let cosine = (std::f64::consts::PI * k as f64 / (count - 1) as f64).cos();
        1000.0 / (f64::midpoint(low, high) + cosine * (high - low) / 2.0).sqrt()
    };
    (0..count).map(node).collect()
}

/// Returns the index of the wavelength nearest to each target, without repetitions.
fn nearest(wavelengths: &[f64], targets: &[f64]) -> Vec<usize> {
    let off = |k: &usize, nm: f64| (wavelengths[*k] - nm).abs();
    let best =
        |nm: &f64| (0..wavelengths.len()).min_by(|one, other| off(one, *nm).total_cmp(&off(other, *nm)));
    let mut nearest: Vec<usize> = targets.iter().filter_map(best).collect();
    nearest.dedup();
    nearest
}

/// Returns the weight of each node in the interpolation at a wavelength, by Lagrange's polynomials.
fn lagrange(nodes: &[f64], nm: f64) -> Vec<f64> {
    let at = variable(nm);
    let share = |k: usize| {
        let others = (0..nodes.len()).filter(|j| *j != k).map(|j| variable(nodes[j]));
        others.map(|other| (at - other) / (variable(nodes[k]) - other)).product()
    };
    (0..nodes.len()).map(share).collect()
}

/// Returns the fewest wavelengths from which the light at the others can be interpolated: the errors of the squared
/// reflectance of each surface and of the transmission of the glass behind it must be within [`TOLERANCE`].
fn light_nodes(wavelengths: &[f64], lens_at: &impl Fn(f64) -> Lens, coatings: &[SurfaceCoating]) -> Vec<f64> {
    let at = |nm: f64| -> Vec<f64> {
        let lens = lens_at(nm);
        let surfaces = Surfaces::untabulated(&lens, coatings);
        let reflected = |i: usize| {
            let own = &lens.surfaces[i];
            let straight = surfaces.boundary(i).computed(own.n_scene, 1.0).reflected.mean();
            // A ghost passes a glass up to three times.
            [straight * straight, (-3.0 * own.absorption * own.thickness).exp()]
        };
        (0..lens.surfaces.len()).flat_map(reflected).collect()
    };
    let truth: Vec<Vec<f64>> = wavelengths.iter().map(|nm| at(*nm)).collect();
    let suffices = |nodes: &Vec<f64>| {
        let known: Vec<Vec<f64>> = nodes.iter().map(|nm| at(*nm)).collect();
        (0..truth[0].len()).all(|i| {
            let most = truth.iter().fold(0.0_f64, |most, own| most.max(own[i]));
            wavelengths.iter().zip(&truth).all(|(nm, own)| {
                let sum: f64 =
                    lagrange(nodes, *nm).iter().zip(&known).map(|(share, node)| share * node[i]).sum();
                (sum - own[i]).abs() <= TOLERANCE * most
            })
        })
    };
    let counts = LIGHT_NODES.into_iter().filter(|count| *count < wavelengths.len());
    counts.map(|count| nodes(wavelengths, count)).find(suffices).unwrap_or_else(|| wavelengths.to_vec())
}

/// Returns the ratio of the light that is reflected four times or more to the light that is not reflected, in a stack
/// of plates with the reflectances of a lens's surfaces at normal incidence. It is computed as the total light, by the
/// adding formula T = T1 T2/(1 - R1' R2), minus the direct light and the light of the pairs. For a lens the ratio is an
/// estimate: in the stack, no light spreads and misses the film.
pub fn beyond_pairs(surfaces: &Surfaces, lens: &Lens) -> f64 {
    let reflectances: Vec<f64> = surfaces
        .reflecting()
        .iter()
        .map(|&surface| {
            let boundary = surfaces.boundary(surface);
            boundary.split(lens.surfaces[surface].n_scene, 1.0).reflected.mean()
        })
        .collect();
    let mut whole = [1.0, 0.0];
    for r in &reflectances {
        let [t, back] = whole;
        let below = 1.0 - back * r;
        // The reflectance seen from the film: the reflectance of the surface itself, plus the light that passes it, is
        // reflected by the surfaces before it, and returns.
        whole = [t * (1.0 - r) / below, r + (1.0 - r).powi(2) * back / below];
    }
    let direct: f64 = reflectances.iter().map(|r| 1.0 - r).product();
    let mut pairs = 0.0;
    for (i, r) in reflectances.iter().enumerate() {
        let mut between = 1.0;
        for other in &reflectances[i + 1..] {
            pairs += r * other * between;
            between *= (1.0 - other).powi(2);
        }
    }
    whole[0] / direct - 1.0 - pairs
}

/// Returns the z coordinate, lens space, mm, at which paraxial rays from infinity cross the axis behind the last
/// surface of a path from the scene; `None` if these rays stay parallel to the axis or are blocked.
pub fn paraxial_focus(path: &Path, front: f64) -> Option<f64> {
    // The height is small enough for first-order optics, and leaves half of the digits.
    let height = 1e-6 * front;
    let ray = Ray { origin: [height, 0.0, front], direction: [0.0, 0.0, -1.0] };
    let after = path.trace(ray).ok()?;
    let slope = after.direction[0] / after.direction[2];
    let focus = after.origin[2] - after.origin[0] / slope;
    focus.is_finite().then_some(focus)
}

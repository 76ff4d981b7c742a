//! Ghosts: light that is reflected at two surfaces and reaches the film all the same. A lens with what its surfaces do to light
//! in; for each pair of surfaces the path, and for a lamp the watts that go along it and where they land, out.
//!
//! A ghost is the ordinary walk over a list of surfaces in which n' = -n at two of them ([`Path::reflected`]): up to the one
//! farther from the light, back to the nearer, and on. Of k surfaces that reflect there are k (k - 1)/2 pairs. What is
//! reflected four times or more is left out; `docs/light.md` has what that is.
//!
//! From the light: a lamp sends rays through a grid of cells before the front surface, each with the watts of its cell. The
//! part of the grid from which a pair's rays reach the film is looked for first, in what reaches the farther mirror, and the
//! cells are those of that part: of a fisheye's wide front surface a ghost needs a thousandth. [`Spray`] is what becomes of them.

use super::{
    coated::{LitPath, Pair, Surfaces},
    lamp::{Lamp, front_sphere},
    pairs::{Estimate, Pairs},
    spray::{Mixture, PairTracers, Spray, ends, sprays},
};
use crate::{
    lens::{Lens, Ray, refraction::Refraction},
    prescription::{Blades, SurfaceCoating},
    trace::{Direction, Path, kernel::ClearanceTracer},
};

/// The surfaces that all paths of a [`Ghosts`] may meet together. A lens of 45 surfaces that reflect has all its pairs.
const MET: usize = 100_000;

/// Ways through a lens from the scene to the film with no reflection or with two: all of them, or where those are too many the
/// brightest by first-order optics.
#[derive(Clone, Debug)]
pub struct Ghosts {
    lens: Lens,
    blades: Option<Blades>,
    surfaces: Surfaces,
    direct: LitPath,
    pairs: Vec<Pair>,
    left_out: LeftOut,
    /// [`front_sphere`].
    front: [f64; 2],
    film: f64,
}

/// The pairs of a lens that has too many.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeftOut {
    /// How many there are.
    pub pairs: usize,
    /// Their share of the light of all pairs, by first-order optics, from an even sky to the middle of the film.
    pub share: f64,
}

impl Ghosts {
    /// Of a lens with film at z = `film`, mm.
    pub fn new(lens: &Lens, blades: Option<Blades>, surfaces: &Surfaces, film: f64) -> Self {
        let direct = LitPath::new(path(lens, blades, None), surfaces);
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
        Self { lens, blades, surfaces, direct, pairs, left_out, front, film }
    }

    /// The pairs, each with its path, which is made as it is asked for.
    pub fn pairs(&self) -> impl Iterator<Item = (Pair, LitPath)> {
        self.pairs.iter().map(|pair| (*pair, self.lit(*pair)))
    }

    /// The surfaces of each pair.
    pub fn chosen(&self) -> &[Pair] {
        &self.pairs
    }

    /// The pairs that are none of these.
    pub fn left_out(&self) -> LeftOut {
        self.left_out
    }

    /// The path of a pair.
    pub fn lit(&self, pair: Pair) -> LitPath {
        LitPath::new(path(&self.lens, self.blades, Some(pair)), &self.surfaces)
    }

    /// The path without a reflection.
    pub fn direct(&self) -> &LitPath {
        &self.direct
    }

    /// What a lamp sends along a path, by a grid of `side` x `side` cells over the part of it that gets through; nothing where
    /// that is found to be empty, and for lamps that [`Lamp::check`] refuses.
    pub fn spray(&self, path: &LitPath, lamp: Lamp, side: usize) -> Spray {
        let tracers = [ClearanceTracer::new(path.path(), self.film)];
        let approaches: Vec<_> = approach(path.path()).into_iter().collect();
        let light = [path.without_edges()];
        let way = PairTracers { tracers: &tracers, approaches: &approaches, nodes: &[0], light: &light };
        let mut only = Spray::default();
        sprays(&way, lamp, self.front, side, &[Mixture::own()], |_, spray| only.clone_from(spray));
        only
    }
}

/// The path of a pair through a lens, or the one without a reflection.
fn path(lens: &Lens, blades: Option<Blades>, pair: Option<Pair>) -> Path {
    let path = match pair {
        Some(pair) => Path::reflected(lens, Direction::SceneToFilm, Refraction::Fused, pair),
        None => Path::scene_to_film(lens),
    };
    path.with_blades(lens, blades)
}

/// What takes rays along a path up to its first mirror, if it has one. Whether they land is not asked: before a film infinitely
/// far away all do.
fn approach(path: &Path) -> Option<ClearanceTracer> {
    path.up_to_mirror().map(|path| ClearanceTracer::new(&path, f64::NEG_INFINITY))
}

/// The ghosts of a lens at many wavelengths, of which whole grids are traced at few, and their edges at each (`spray.rs`).
#[derive(Clone, Debug)]
pub struct GhostSpectrum {
    /// By wavelength.
    lenses: Vec<Lens>,
    blades: Option<Blades>,
    /// The wavelengths at which whole grids are traced.
    nodes: Vec<usize>,
    /// By the nodes of light.
    light: Vec<Ghosts>,
    /// By wavelength.
    mixtures: Vec<Mixture>,
}

/// Wavelengths at which whole grids are traced: where others land is off by less than a hundredth of a pixel then.
const PLACES: usize = 3;
/// Nodes at which light is carried, of which the first that suffices is taken: a quarter wave takes the first but one.
const LIGHT: [usize; 4] = [5, 7, 9, 13];
/// What a product of two reflectances may be off between those, of the greatest of it.
const OFF: f64 = 1e-3;

impl GhostSpectrum {
    /// At these wavelengths, nm, of `lens_at` a wavelength, whose surfaces have these coatings, from the scene on, with film at z
    /// = `film`, mm.
    pub fn new(
        wavelengths: &[f64],
        lens_at: impl Fn(f64) -> Lens,
        blades: Option<Blades>,
        coatings: &[SurfaceCoating],
        film: f64,
    ) -> Self {
        let lenses = wavelengths.iter().map(|nm| lens_at(*nm)).collect();
        let nodes = nearest(wavelengths, &nodes(wavelengths, PLACES));
        let at_nodes: Vec<f64> = nodes.iter().map(|k| wavelengths[*k]).collect();
        let of_light = light_nodes(wavelengths, &lens_at, coatings);
        let light = of_light.iter().map(|nm| {
            let lens = lens_at(*nm);
            Ghosts::new(&lens, None, &Surfaces::of_each(&lens, coatings), film)
        });
        let light = light.collect();
        let mixture =
            |nm: &f64| Mixture { places: lagrange(&at_nodes, *nm), light: lagrange(&of_light, *nm) };
        Self { lenses, blades, nodes, light, mixtures: wavelengths.iter().map(mixture).collect() }
    }

    /// The pairs.
    pub fn pairs(&self) -> impl Iterator<Item = Pair> {
        self.light.iter().take(1).flat_map(|ghosts| ghosts.chosen().iter().copied())
    }

    /// What a lamp sends along the path of a pair, or along the one without a reflection, at each wavelength, of which `found`
    /// gets the number: as [`Ghosts::spray`].
    pub fn sprays(&self, pair: Option<Pair>, lamp: Lamp, side: usize, found: impl FnMut(usize, &Spray)) {
        let Some(ghosts) = self.light.first() else { return };
        let way = |ghosts: &Ghosts| pair.map_or_else(|| ghosts.direct.clone(), |pair| ghosts.lit(pair));
        let paths: Vec<Path> = self.lenses.iter().map(|lens| path(lens, self.blades, pair)).collect();
        let tracers: Vec<_> = paths.iter().map(|path| ClearanceTracer::new(path, ghosts.film)).collect();
        let approaches: Vec<_> = ends(&paths).filter_map(approach).collect();
        let light: Vec<_> = self.light.iter().map(|ghosts| way(ghosts).without_edges()).collect();
        let way =
            PairTracers { tracers: &tracers, approaches: &approaches, nodes: &self.nodes, light: &light };
        sprays(&way, lamp, ghosts.front, side, &self.mixtures, found);
    }
}

/// What indices and phases are smooth functions of.
fn variable(nm: f64) -> f64 {
    (1000.0 / nm).powi(2)
}

/// So many wavelengths, nm, for polynomials between the ends of others: Chebyshev's extrema, which hold the ends. The others
/// themselves where those are no more.
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

/// The wavelength that is nearest to each of some, each once.
fn nearest(wavelengths: &[f64], wanted: &[f64]) -> Vec<usize> {
    let off = |k: &usize, nm: f64| (wavelengths[*k] - nm).abs();
    let best =
        |nm: &f64| (0..wavelengths.len()).min_by(|one, other| off(one, *nm).total_cmp(&off(other, *nm)));
    let mut nearest: Vec<usize> = wanted.iter().filter_map(best).collect();
    nearest.dedup();
    nearest
}

/// How much each of the nodes adds to a wavelength: Lagrange's polynomials.
fn lagrange(nodes: &[f64], nm: f64) -> Vec<f64> {
    let at = variable(nm);
    let share = |k: usize| {
        let others = (0..nodes.len()).filter(|j| *j != k).map(|j| variable(nodes[j]));
        others.map(|other| (at - other) / (variable(nodes[k]) - other)).product()
    };
    (0..nodes.len()).map(share).collect()
}

/// Wavelengths at which light is to be carried, so that the others are made of them: the fewest from which the product of any
/// surface's reflectance with itself, and what its glass leaves, come out right.
fn light_nodes(wavelengths: &[f64], lens_at: &impl Fn(f64) -> Lens, coatings: &[SurfaceCoating]) -> Vec<f64> {
    let at = |nm: f64| -> Vec<f64> {
        let lens = lens_at(nm);
        let surfaces = Surfaces::untabulated(&lens, coatings);
        let reflected = |i: usize| {
            let own = &lens.surfaces[i];
            let straight = surfaces.boundary(i).computed(own.n_scene, 1.0).reflected.mean();
            // A ghost goes through a glass up to three times.
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
                (sum - own[i]).abs() <= OFF * most
            })
        })
    };
    let few = LIGHT.into_iter().filter(|count| *count < wavelengths.len());
    few.map(|count| nodes(wavelengths, count)).find(suffices).unwrap_or_else(|| wavelengths.to_vec())
}

/// What the light that is reflected four times or more comes to, over the light without a reflection, in a stack of plates with
/// the reflectances of a lens's surfaces at normal incidence: the whole by the adding formula, T = T1 T2/(1 - R1' R2), less the
/// light without a reflection and the pairs. An estimate for a lens, of which no light spreads out on its way and leaves past
/// the film.
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
        // From the film's side: what the surface reflects, and what goes through it, is reflected by those before, and returns.
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

/// Where rays near the axis from infinitely far away meet it behind the last surface of a path from the scene, z in lens space,
/// mm; `None` where they stay parallel or do not get through.
pub fn paraxial_focus(path: &Path, front: f64) -> Option<f64> {
    // As near as leaves half the digits.
    let height = 1e-6 * front;
    let ray = Ray { origin: [height, 0.0, front], direction: [0.0, 0.0, -1.0] };
    let after = path.trace(ray).ok()?;
    let slope = after.direction[0] / after.direction[2];
    let focus = after.origin[2] - after.origin[0] / slope;
    focus.is_finite().then_some(focus)
}

//! Ghosts: light that is reflected at two surfaces and reaches the film all the same. A lens with what its surfaces do to light
//! in; for each pair of surfaces the path, and for a lamp the watts that go along it and where they land, out.
//!
//! A ghost is the ordinary walk over a list of surfaces in which n' = -n at two of them ([`Path::reflected`]): up to the one
//! farther from the light, back to the nearer, and on. Of k surfaces that reflect there are k (k - 1)/2 pairs. What is
//! reflected four times or more is left out; `docs/light.md` has what that is.
//!
//! From the light: a lamp sends rays through a grid of cells before the front surface, each with the watts of its cell. The
//! part of the grid from which a pair's rays reach the film is looked for first, coarsely, and the cells are those of that
//! part: of a fisheye's wide front surface a ghost needs a thousandth. Cells along the edge of what is lit are divided, and
//! have the watts of their lit part. The kernel traces the rays, by mirrors as without; `shares` has what is left of their
//! light.

use super::{
    coated::{LitPath, Surfaces},
    lamp::{Lamp, front_sphere},
    shares::shares,
};
use crate::{
    lens::{Lens, Ray, refraction::Refraction},
    numeric::{cross, dot, unit},
    prescription::Blades,
    trace::{
        Direction, Path,
        kernel::{Kernel, LensRays, RayBuffer},
    },
};

/// Two surfaces, counted from the scene, `[nearer the scene, nearer the film]`.
pub type Pair = [usize; 2];

/// Every way through a lens from the scene to the film with no reflection or with two.
#[derive(Clone, Debug)]
pub struct Ghosts {
    direct: LitPath,
    pairs: Vec<(Pair, LitPath)>,
    /// [`front_sphere`].
    front: [f64; 2],
    film: f64,
}

/// Where the light of a grid's cell lands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landing {
    /// The film point, mm; of a cell that is lit in part, the mean of that part's.
    pub point: [f64; 2],
    /// Its watts, where the lamp makes 1 W/m² at the lens, across the light.
    pub watts: f64,
}

/// What a lamp sends along one path: rows of cells, of which some reach the plane of the film.
#[derive(Clone, Debug)]
pub struct Spray {
    /// Cells along a side.
    pub side: usize,
    /// By cell, `side` rows of `side`.
    pub cells: Vec<Option<Landing>>,
}

impl Spray {
    /// The watts that reach the plane of the film.
    pub fn watts(&self) -> f64 {
        self.landings().fold(0.0, |sum, landing| sum + landing.watts)
    }

    /// Those that do.
    pub fn landings(&self) -> impl Iterator<Item = &Landing> {
        self.cells.iter().flatten()
    }

    /// The middle of the light on the plane of the film, and the root of its mean squared distance from there, mm.
    pub fn spot(&self) -> Option<([f64; 2], f64)> {
        let watts = self.watts();
        if watts <= 0.0 {
            return None;
        }
        let mean = |of: &dyn Fn(&Landing) -> f64| {
            self.landings().map(|landing| landing.watts * of(landing)).sum::<f64>() / watts
        };
        let middle = [0, 1].map(|axis| mean(&|landing| landing.point[axis]));
        let square = mean(&|landing| (0..2).map(|axis| (landing.point[axis] - middle[axis]).powi(2)).sum());
        Some((middle, square.sqrt()))
    }
}

/// Cells along a side of the grid that is looked through for a path's part of it.
const COARSE: usize = 40;
/// The same where nothing is lit: an entrance pupil a 150th as wide as the front is still seen.
const FINEST: usize = 160;
/// Cells of such a grid that say well enough where the part is.
const ENOUGH: usize = 60;
/// Parts of a side of a cell along the edge of what is lit: its watts are within a hundredth of a cell's or so.
const EDGE: usize = 4;
/// How often it is looked for anew in what was found.
const ROUNDS: usize = 4;

/// A part of the plane through the middle of the front sphere, across the light, in units of the radius of the disk there that
/// all light for the sphere passes.
type Part = [[f64; 2]; 2];

impl Ghosts {
    /// Of a lens with film at z = `film`, mm.
    pub fn new(lens: &Lens, blades: Option<Blades>, surfaces: &Surfaces, film: f64) -> Self {
        let lit = |path: Path| LitPath::new(path.with_blades(lens, blades), surfaces);
        let reflected = |pair| lit(Path::reflected(lens, Direction::SceneToFilm, Refraction::Fused, pair));
        let all = surfaces.reflecting();
        let pairs = all.iter().enumerate().flat_map(|(at, near)| {
            let beyond = &all[at + 1..];
            beyond.iter().map(|far| ([*near, *far], reflected([*near, *far])))
        });
        Self {
            direct: lit(Path::scene_to_film(lens)),
            pairs: pairs.collect(),
            front: front_sphere(lens),
            film,
        }
    }

    /// The pairs, each with its path.
    pub fn pairs(&self) -> impl Iterator<Item = (Pair, &LitPath)> {
        self.pairs.iter().map(|(pair, path)| (*pair, path))
    }

    /// The path without a reflection.
    pub fn direct(&self) -> &LitPath {
        &self.direct
    }

    /// What a lamp sends along a path, by a grid of `side` x `side` cells over the part of it that gets through; nothing where
    /// that is found to be empty, and for lamps that [`Lamp::check`] refuses.
    pub fn spray(&self, path: &LitPath, lamp: Lamp, side: usize) -> Spray {
        let kernel = Kernel::along(path.path());
        let beam = Beam::new(lamp, self.front);
        let mut part: Part = [[-1.0, 1.0]; 2];
        for _ in 0..ROUNDS {
            let mut cells = COARSE;
            // Before wide fronts a pupil is a small part: finer where nothing is lit.
            let lit = loop {
                let coarse = self.landings(&kernel, &beam, &middles(cells, part));
                let lit: Vec<usize> = (0..coarse.len()).filter(|i| coarse[*i].is_some()).collect();
                if !lit.is_empty() {
                    break lit;
                }
                if cells >= FINEST {
                    return Spray { side: 0, cells: Vec::new() };
                }
                cells *= 2;
            };
            let rows = bounds(lit.iter().map(|i| i / cells));
            let columns = bounds(lit.iter().map(|i| i % cells));
            let size = part.map(|[from, to]| (to - from) / cells as f64);
            // A cell more on every side: what is lit of it may pass between its neighbours' middles.
            let narrowed = |axis: usize, [from, to]: [usize; 2]| {
                let at = |cell: f64| (part[axis][0] + cell * size[axis]).clamp(-1.0, 1.0);
                [at(from as f64 - 1.0), at(to as f64 + 2.0)]
            };
            part = [narrowed(0, columns), narrowed(1, rows)];
            if lit.len() >= ENOUGH {
                break;
            }
        }
        let places = middles(side, part);
        let landings = self.landings(&kernel, &beam, &places);
        let area = part.iter().map(|[from, to]| (to - from) * beam.radius / side as f64).product::<f64>();
        // From mm² to m².
        let area = area * 1e-6;
        let mut cells: Vec<Option<Lit>> = landings
            .into_iter()
            .zip(places)
            .map(|(landing, place)| landing.map(|(point, watts)| Lit { place, point, watts: watts * area }))
            .collect();
        self.refine_edges(&kernel, &beam, part, side, &mut cells);
        let places: Vec<[f64; 2]> = cells.iter().flatten().map(|lit| lit.place).collect();
        let mut shares = shares(path, &places, |place| beam.ray(place).0).into_iter();
        let mut landing = |lit: Lit| {
            let share = shares.next().unwrap_or_default();
            (share > 0.0).then_some(Landing { point: lit.point, watts: lit.watts * share })
        };
        Spray { side, cells: cells.into_iter().map(|lit| lit.and_then(&mut landing)).collect() }
    }

    /// Gives the cells along the edge of what is lit the watts and the place of their lit part.
    fn refine_edges(
        &self,
        kernel: &Kernel<f64>,
        beam: &Beam,
        part: Part,
        side: usize,
        cells: &mut [Option<Lit>],
    ) {
        let is_edge = |i: &usize| {
            let around = |at: usize| at.saturating_sub(1)..=(at + 1).min(side - 1);
            let mut near =
                around(i / side).flat_map(|row| around(i % side).map(move |column| row * side + column));
            near.any(|other| cells[other].is_some() != cells[*i].is_some())
        };
        let edges: Vec<usize> = (0..side * side).filter(is_edge).collect();
        let size = part.map(|[from, to]| (to - from) / side as f64);
        let within = |i: &usize| {
            let at = [i % side, i / side];
            let own = std::array::from_fn(|axis| {
                let from = part[axis][0] + at[axis] as f64 * size[axis];
                [from, from + size[axis]]
            });
            middles(EDGE, own)
        };
        let places: Vec<[f64; 2]> = edges.iter().flat_map(within).collect();
        let landings = self.landings(kernel, beam, &places);
        // From mm² to m².
        let area = size.iter().map(|size| size * beam.radius / EDGE as f64).product::<f64>() * 1e-6;
        let parts = landings.chunks_exact(EDGE * EDGE).zip(places.chunks_exact(EDGE * EDGE));
        for (i, (landings, places)) in edges.into_iter().zip(parts) {
            let lit = || {
                landings.iter().zip(places).filter_map(|(landing, place)| Some((landing.as_ref()?, place)))
            };
            let watts: f64 = lit().map(|((_, watts), _)| watts).sum();
            let mean = |of: &dyn Fn(&[f64; 2], &[f64; 2]) -> f64| {
                lit().map(|((point, own), place)| own * of(point, place)).sum::<f64>() / watts
            };
            let middle = [0, 1].map(|axis| mean(&|_, place| place[axis]));
            let distance = |place: &[f64; 2]| -> f64 {
                (0..2).map(|axis| ((place[axis] - middle[axis]) / size[axis]).powi(2)).sum()
            };
            // A part's own middle need not be lit.
            let nearest = lit().map(|(_, place)| *place).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            cells[i] = nearest.map(|place| Lit {
                place,
                point: [0, 1].map(|axis| mean(&|point, _| point[axis])),
                watts: watts * area,
            });
        }
    }

    /// Where the rays of a beam through these places land, by the light for 1 m² across it, W.
    fn landings(
        &self,
        kernel: &Kernel<f64>,
        beam: &Beam,
        places: &[[f64; 2]],
    ) -> Vec<Option<([f64; 2], f64)>> {
        let mut rays = RayBuffer::new(places.len());
        let sent: Vec<f64> = (0..places.len())
            .map(|i| {
                let (ray, watts) = beam.ray(places[i]);
                rays.put(i, ray.origin, ray.direction);
                let [x, y] = places[i];
                if x * x + y * y <= 1.0 { watts } else { 0.0 }
            })
            .collect();
        kernel.trace_in_place(&mut rays.rays());
        let LensRays { origin: [x, y, z], direction: [dx, dy, dz], weight } = rays.rays();
        let landing = |i: usize| {
            // Toward the film.
            let along = (self.film - z[i]) / dz[i];
            (weight[i] > 0.0 && sent[i] > 0.0 && dz[i] < 0.0 && along >= 0.0)
                .then(|| ([x[i] + along * dx[i], y[i] + along * dy[i]], sent[i]))
        };
        (0..places.len()).map(landing).collect()
    }
}

/// A cell that is lit, wholly or in part, before the lens takes its share of the light.
#[derive(Clone, Copy)]
struct Lit {
    /// Of a ray through the lit part.
    place: [f64; 2],
    /// Where it lands.
    point: [f64; 2],
    watts: f64,
}

/// The middles of the cells of a part, row by row.
fn middles(side: usize, part: Part) -> Vec<[f64; 2]> {
    let at = |axis: usize, i: usize| {
        let [from, to] = part[axis];
        from + (i as f64 + 0.5) * (to - from) / side as f64
    };
    (0..side * side).map(|i| [at(0, i % side), at(1, i / side)]).collect()
}

/// The light that a lamp sends to the front sphere.
struct Beam {
    /// The sphere's middle.
    middle: [f64; 3],
    /// From there to the lamp, a unit vector, and how far, mm, if it is not infinitely far away.
    toward: [f64; 3],
    distance: Option<f64>,
    /// Two directions across the light, of which one lies across the axis.
    across: [f64; 3],
    up: [f64; 3],
    /// Of the disk in the plane through the middle, across the light, that all light for the sphere passes, mm.
    radius: f64,
}

impl Beam {
    /// `front` is a [`front_sphere`].
    fn new(lamp: Lamp, [z, sphere]: [f64; 2]) -> Self {
        let (toward, distance) = match lamp {
            Lamp::Distant(toward) => (unit(toward), None),
            Lamp::Point(at) => {
                let away = [at[0], at[1], at[2] - z];
                (unit(away), Some(dot(away, away).sqrt()))
            }
        };
        // A point sees more of the plane behind the sphere than the sphere is wide. A lamp within it has nothing of that
        // kind (`Lamp::check`).
        let radius = distance.map_or(sphere, |distance| sphere / (1.0 - (sphere / distance).powi(2)).sqrt());
        let across = if toward[0].hypot(toward[1]) > 1e-9 {
            unit([-toward[1], toward[0], 0.0])
        } else {
            [1.0, 0.0, 0.0]
        };
        let up = cross(toward, across);
        Self { middle: [0.0, 0.0, z], toward, distance, across, up, radius }
    }

    /// The ray through a place of the disk, in units of its radius, and the light there, W/m².
    fn ray(&self, [x, y]: [f64; 2]) -> (Ray, f64) {
        let (x, y) = (x * self.radius, y * self.radius);
        let point: [f64; 3] = std::array::from_fn(|k| self.middle[k] + x * self.across[k] + y * self.up[k]);
        let Some(distance) = self.distance else {
            let origin = std::array::from_fn(|k| point[k] + 2.0 * self.radius * self.toward[k]);
            return (Ray { origin, direction: self.toward.map(|part| -part) }, 1.0);
        };
        let origin: [f64; 3] = std::array::from_fn(|k| self.middle[k] + distance * self.toward[k]);
        let direction: [f64; 3] = std::array::from_fn(|k| point[k] - origin[k]);
        // The same intensity everywhere: that of 1 W/m² in the middle.
        (Ray { origin, direction }, (distance / dot(direction, direction).sqrt()).powi(3))
    }
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

/// The least and the greatest.
fn bounds(places: impl Iterator<Item = usize>) -> [usize; 2] {
    places.fold([usize::MAX, 0], |[least, greatest], place| [least.min(place), greatest.max(place)])
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

//! Ghosts from the film: for each pair of surfaces the path from the film to the scene, how often a sample takes it, and the
//! slopes from which it is sampled. A lens in; a film ray with the slope area that it stands for, and the way of the ray, out.
//!
//! The radiance along a ghost's path is that of the scene times what its surfaces leave, so that its irradiance is the integral
//! of L cos⁴θ' over the same slopes as without a reflection: those of all rays through the rear surface, the *cover*. Most
//! ghosts come from a small part of it. A survey looks for that part at radii of the film, as a disk of slopes, and measures
//! what an even sky sends along each pair: pairs are chosen by that.
//!
//! No survey is certain to find all. So one sample in eight is taken in the whole cover, and its area counts both disks where
//! they overlap (the balance heuristic of E. Veach and L. J. Guibas, "Optimally Combining Sampling Techniques for Monte Carlo
//! Rendering", 1995); and each pair has a least probability. What is sampled is then right whatever the survey says, and nothing
//! is left out.

use super::{
    coated::{LitPath, Surfaces},
    ghosts::Pair,
};
use crate::{
    lens::{Lens, cos4, film_ray, pupil::SlopeDisk, refraction::Refraction},
    prescription::Blades,
    trace::{Direction, Path},
};

/// Intervals between the film radii at which the survey looks.
const INTERVALS: usize = 16;
/// Slopes across a disk in which it looks for rays, and where it finds none there.
const GRID: [usize; 2] = [24, 48];
/// Rays that show well enough where the part is.
const ENOUGH: usize = 40;
/// How often it looks anew in what it found.
const ROUNDS: usize = 3;
/// The share of a pair's samples that are taken in the whole cover.
const WHOLE: f64 = 0.125;
/// The share of all samples that go to every pair alike.
const ALIKE: f64 = 0.05;

/// All pairs of a lens, from the film.
#[derive(Clone, Debug)]
pub struct FilmGhosts {
    /// Between the film radii of the survey, mm.
    step: f64,
    pairs: Vec<FilmPair>,
    /// Where each pair's part of [0, 1] ends.
    ends: Vec<f64>,
}

/// One pair.
#[derive(Clone, Debug)]
struct FilmPair {
    pair: Pair,
    path: LitPath,
    /// By the film's radii, for a film point on +x; `None` where no ray was found.
    disks: Vec<Option<SlopeDisk>>,
}

/// The pair that a number chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairChoice {
    /// Which of the pairs.
    index: usize,
    /// The probability with which a number chooses it.
    pub probability: f64,
    /// What is left of the number, in [0, 1] again.
    pub rest: f64,
}

/// From which disk a pair's slopes are sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeChoice {
    disk: SlopeDisk,
    /// The disk of the survey, where there is one, and the cover.
    found: Option<SlopeDisk>,
    cover: SlopeDisk,
    /// What is left of the number, in [0, 1] again.
    pub rest: f64,
}

impl FilmGhosts {
    /// Of a lens with film at z = `film`, asked for rays out to `reach`, mm; `cover` holds the slopes of all rays from a film
    /// point through the rear surface. `None` where fewer than two surfaces reflect.
    pub fn new(
        lens: &Lens,
        blades: Option<Blades>,
        surfaces: &Surfaces,
        film: f64,
        reach: f64,
        cover: impl Fn([f64; 2]) -> SlopeDisk,
    ) -> Option<Self> {
        let all = surfaces.reflecting();
        let step = reach / INTERVALS as f64;
        let (mut pairs, mut energies) = (Vec::new(), Vec::new());
        for (at, near) in all.iter().enumerate() {
            for far in &all[at + 1..] {
                let pair = [*near, *far];
                let path = path(lens, pair);
                // The round stop holds what blades leave open.
                let round = LitPath::new(path.clone(), surfaces);
                let mut energy = 0.0;
                let disks = (0..=INTERVALS)
                    .map(|i| {
                        let radius = i as f64 * step;
                        let (disk, here) = survey(&round, film, radius, cover([radius, 0.0]))?;
                        // The ring of the film that the radius stands for.
                        let [low, high] =
                            [-0.5, 0.5].map(|half| (i as f64 + half).clamp(0.0, INTERVALS as f64) * step);
                        energy += here * (high * high - low * low);
                        Some(disk)
                    })
                    .collect();
                let path = LitPath::new(path.with_blades(lens, blades), surfaces);
                pairs.push(FilmPair { pair, path, disks });
                energies.push(energy);
            }
        }
        let (count, whole) = (pairs.len() as f64, energies.iter().sum::<f64>());
        let mut end = 0.0;
        let ends = energies.iter().map(|energy| {
            let own = if whole > 0.0 { energy / whole } else { count.recip() };
            end += ALIKE / count + (1.0 - ALIKE) * own;
            end
        });
        let ends = ends.collect();
        (!pairs.is_empty()).then_some(Self { step, pairs, ends })
    }

    /// How many pairs there are.
    pub fn count(&self) -> usize {
        self.pairs.len()
    }

    /// The pair that a number from 0 to 1 chooses.
    pub fn choose(&self, number: f64) -> PairChoice {
        let last = self.ends.len() - 1;
        let whole = self.ends[last];
        let index = self.ends.partition_point(|end| *end <= number * whole).min(last);
        let start = index.checked_sub(1).map_or(0.0, |before| self.ends[before]);
        let own = self.ends[index] - start;
        let rest = ((number * whole - start) / own).clamp(0.0, 1.0);
        PairChoice { index, probability: own / whole, rest }
    }

    /// The disk that what is left of the number chooses at a film point, of which `cover` holds the slopes of all rays.
    pub fn slopes(&self, chosen: &PairChoice, point: [f64; 2], cover: SlopeDisk) -> SlopeChoice {
        let found = self.pairs[chosen.index].disk(point, self.step);
        let of = |disk, rest: f64| SlopeChoice { disk, found, cover, rest: rest.clamp(0.0, 1.0) };
        match found {
            None => of(cover, chosen.rest),
            Some(_) if chosen.rest < WHOLE => of(cover, chosen.rest / WHOLE),
            Some(disk) => of(disk, (chosen.rest - WHOLE) / (1.0 - WHOLE)),
        }
    }

    /// The path of a chosen pair, from the film to the scene.
    pub fn path(&self, chosen: &PairChoice) -> &LitPath {
        &self.pairs[chosen.index].path
    }

    /// [`FilmGhosts::path`] through the same lens at another wavelength, with `surfaces` that are of it.
    pub fn path_through(
        &self,
        chosen: &PairChoice,
        lens: &Lens,
        blades: Option<Blades>,
        surfaces: &Surfaces,
    ) -> LitPath {
        LitPath::new(path(lens, self.pairs[chosen.index].pair).with_blades(lens, blades), surfaces)
    }
}

impl FilmPair {
    /// The disk at a film point, between those of the radii beside it.
    fn disk(&self, [x, y]: [f64; 2], step: f64) -> Option<SlopeDisk> {
        let radius = x.hypot(y);
        let at = (radius / step).min(INTERVALS as f64);
        let i = (at as usize).min(INTERVALS - 1);
        let SlopeDisk { center: [along, _], radius: wide } = match (self.disks[i], self.disks[i + 1]) {
            (Some(a), Some(b)) => {
                let t = at - i as f64;
                let between = |a: f64, b: f64| a + t * (b - a);
                let along = between(a.center[0], b.center[0]);
                SlopeDisk { center: [along, 0.0], radius: between(a.radius, b.radius) }
            }
            (a, b) => a.or(b)?,
        };
        // Turned with the film point; on the axis there is nothing to turn.
        let turned = if radius > 0.0 { along / radius } else { 0.0 };
        Some(SlopeDisk { center: [turned * x, turned * y], radius: wide })
    }
}

impl SlopeChoice {
    /// The slopes that a point of the unit disk stands for, and the slope area, over π, that they stand for.
    pub fn at(&self, [u, v]: [f64; 2]) -> ([f64; 2], f64) {
        let SlopeDisk { center: [x, y], radius } = self.disk;
        let slopes = [x + radius * u, y + radius * v];
        let Some(found) = self.found else { return (slopes, radius * radius) };
        // What both disks send there.
        let density = |disk: &SlopeDisk, share: f64| {
            let away = (slopes[0] - disk.center[0]).hypot(slopes[1] - disk.center[1]);
            if away <= disk.radius * (1.0 + 1e-12) { share / (disk.radius * disk.radius) } else { 0.0 }
        };
        (slopes, (density(&self.cover, WHOLE) + density(&found, 1.0 - WHOLE)).recip())
    }
}

/// From the film to the scene, reflected at a pair of surfaces that is counted from the scene.
fn path(lens: &Lens, [near, far]: Pair) -> Path {
    let last = lens.surfaces.len() - 1;
    Path::reflected(lens, Direction::FilmToScene, Refraction::Fused, [last - far, last - near])
}

/// The disk that holds the slopes of rays from a film radius through a path, as far as a grid shows, and the integral of cos⁴
/// and what is left of the light over them.
fn survey(lit: &LitPath, film: f64, radius: f64, cover: SlopeDisk) -> Option<(SlopeDisk, f64)> {
    let mut within = cover;
    for round in 0..ROUNDS {
        let mut found = look(lit, film, radius, within, GRID[0]);
        if found.is_none() && round == 0 {
            found = look(lit, film, radius, within, GRID[1]);
        }
        let (disk, energy, count) = found?;
        if count >= ENOUGH || round + 1 == ROUNDS {
            return Some((disk, energy));
        }
        within = disk;
    }
    None
}

/// The same by one grid of slopes in a disk, and how many rays got through. What lies on one side of the film's radius stands
/// for both.
fn look(
    lit: &LitPath,
    film: f64,
    radius: f64,
    SlopeDisk { center: [middle, _], radius: wide }: SlopeDisk,
    grid: usize,
) -> Option<(SlopeDisk, f64, usize)> {
    let step = 2.0 * wide / grid as f64;
    let mut passed: Vec<[f64; 2]> = Vec::new();
    let mut energy = 0.0;
    for i in 0..grid {
        let x = (i as f64 + 0.5) * step - wide;
        for j in 0..grid / 2 {
            let y = (j as f64 + 0.5) * step;
            if x.hypot(y) > wide {
                continue;
            }
            let slopes = [middle + x, y];
            if let Ok((_, left)) = lit.trace(film_ray([radius, 0.0], film, slopes)) {
                passed.push(slopes);
                energy += 2.0 * step * step * cos4(slopes) * left;
            }
        }
    }
    let ends = passed
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [x, _]| [low.min(*x), high.max(*x)]);
    let center = [f64::midpoint(ends[0], ends[1]), 0.0];
    let away = passed.iter().fold(0.0_f64, |most, [x, y]| most.max((x - center[0]).hypot(*y)));
    // What passes between two slopes of the grid.
    let disk = SlopeDisk { center, radius: away + step };
    (!passed.is_empty()).then_some((disk, energy, passed.len()))
}

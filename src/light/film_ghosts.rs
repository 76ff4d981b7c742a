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
//! Rendering", 1995); and a share of the samples goes to all pairs alike. What is sampled is then right whatever the survey says,
//! and nothing is left out.
//!
//! The survey has a bound on its work ([`Work`]) and takes the pairs in the order of what first-order optics expects of them
//! ([`Pairs`]). A pair that it does not come to is sampled in the whole cover, and the pairs of that kind together get the share of
//! the samples that the same estimate gives them. All pairs share one set of surfaces ([`LitPaths`]).

use super::{
    coated::{LitPath, LitPaths, Pair, Surfaces},
    pairs::Pairs,
    work::Work,
};
use crate::{
    lens::{Lens, Ray, cos4, film_ray, pupil::SlopeDisk},
    prescription::Blades,
    trace::{
        Blocked,
        kernel::{ClearanceTracer, FilmRay},
    },
};

/// Intervals between the film radii at which the survey looks.
const INTERVALS: usize = 16;
/// Slopes across a disk in which it looks for rays, and where it finds none there.
const GRID: [usize; 2] = [24, 48];
/// Rays that show well enough where the part is.
const ENOUGH: usize = 40;
/// How often it looks anew in what it found.
const ROUNDS: usize = 3;
/// Rays of those that get through whose light is carried: it is much the same along all.
const LIT: usize = 6;
/// The work of the survey: some 0.2 s.
const WORK: u64 = 4_000_000;
/// Units of it in which a step of a path is made ready.
const PER_STEP: u64 = 4;
/// The share of a pair's samples that are taken in the whole cover.
const WHOLE: f64 = 0.125;
/// The share of all samples that go to every pair alike, at least.
const ALIKE: f64 = 0.05;

/// All pairs of a lens, from the film.
#[derive(Clone, Debug)]
pub struct FilmGhosts {
    /// Between the film radii of the survey, mm.
    step: f64,
    paths: LitPaths,
    all: Pairs,
    /// The surveyed pairs, in the order of their surfaces.
    surveyed: Vec<Surveyed>,
    /// The end of each of them in [0, 1].
    ends: Vec<f64>,
    /// The share of the samples that go to all pairs alike.
    alike: f64,
}

/// One pair of the survey.
#[derive(Clone, Debug)]
struct Surveyed {
    pair: Pair,
    /// By the film's radii, for a film point on +x; `None` where no ray was found.
    disks: [Option<SlopeDisk>; INTERVALS + 1],
}

/// The pair that a number chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairChoice {
    /// The pair.
    pub pair: Pair,
    /// Its number in the survey.
    surveyed: Option<usize>,
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
        let all = Pairs::of(surfaces);
        if all.count() == 0 {
            return None;
        }
        let step = reach / INTERVALS as f64;
        let paths = LitPaths::new(lens, blades, surfaces);
        // The round stop holds what blades leave open.
        let round = LitPaths::new(lens, None, surfaces);
        let work = Work::new(WORK);
        let mut found: Vec<(Surveyed, f64)> = Vec::new();
        let (mut known, mut estimated) = (0.0, 0.0);
        for estimate in all.brightest(lens, surfaces, film) {
            let light = f64::from(estimate.light);
            estimated += light;
            let pair = estimate.pair();
            if work.is_left()
                && let Some(own) = PairSurvey::of(&round, pair, surfaces, film, &work)
                && let Some(own) = own.pair(pair, step, &cover)
            {
                known += light;
                found.push(own);
            }
        }
        found.sort_by_key(|(own, _)| own.pair);
        let whole: f64 = found.iter().map(|(_, energy)| energy).sum();
        let alike = if whole > 0.0 && known > 0.0 { 1.0 - (1.0 - ALIKE) * known / estimated } else { 1.0 };
        let mut end = 0.0;
        let ends = found.iter().map(|(_, energy)| {
            end += if whole > 0.0 { energy / whole } else { 0.0 };
            end
        });
        let ends = ends.collect();
        let surveyed = found.into_iter().map(|(own, _)| own).collect();
        Some(Self { step, paths, all, surveyed, ends, alike })
    }

    /// How many pairs there are.
    pub fn count(&self) -> usize {
        self.all.count()
    }

    /// Returns how many of them the survey came to.
    pub fn surveyed(&self) -> usize {
        self.surveyed.len()
    }

    /// The share of the samples that go to all pairs alike.
    pub fn alike(&self) -> f64 {
        self.alike
    }

    /// Returns the work of a ray along the longest path: the surfaces that it meets, and the layers that are computed for it.
    pub fn work_per_ray(&self) -> usize {
        3 * self.paths.work() as usize
    }

    /// The pair that a number from 0 to 1 chooses.
    pub fn choose(&self, number: f64) -> PairChoice {
        // The number is one of [0, 1) that is stretched, so that rounding may put it anywhere in [0, 1].
        let part = |number: f64, from: f64, to: f64| ((number - from) / (to - from)).clamp(0.0, 1.0);
        let (pair, surveyed, rest) = if number < self.alike || self.alike >= 1.0 {
            let at = part(number, 0.0, self.alike) * self.count() as f64;
            let index = (at as usize).min(self.count() - 1);
            let pair = self.all.nth(index);
            let known = self.surveyed.binary_search_by_key(&pair, |own| own.pair).ok();
            (pair, known, part(at, index as f64, index as f64 + 1.0))
        } else {
            let last = self.ends.len() - 1;
            let at = part(number, self.alike, 1.0) * self.ends[last];
            let index = self.ends.partition_point(|end| *end <= at).min(last);
            let start = index.checked_sub(1).map_or(0.0, |before| self.ends[before]);
            (self.surveyed[index].pair, Some(index), part(at, start, self.ends[index]))
        };
        let own = surveyed.map_or(0.0, |index| {
            self.ends[index] - index.checked_sub(1).map_or(0.0, |before| self.ends[before])
        });
        let probability = self.alike / self.count() as f64 + (1.0 - self.alike) * own;
        PairChoice { pair, surveyed, probability, rest }
    }

    /// The disk that what is left of the number chooses at a film point, of which `cover` holds the slopes of all rays.
    pub fn slopes(&self, chosen: &PairChoice, point: [f64; 2], cover: SlopeDisk) -> SlopeChoice {
        let found = chosen.surveyed.and_then(|index| self.surveyed[index].disk(point, self.step));
        let of = |disk, rest: f64| SlopeChoice { disk, found, cover, rest: rest.clamp(0.0, 1.0) };
        match found {
            None => of(cover, chosen.rest),
            Some(_) if chosen.rest < WHOLE => of(cover, chosen.rest / WHOLE),
            Some(disk) => of(disk, (chosen.rest - WHOLE) / (1.0 - WHOLE)),
        }
    }

    /// A ray from the film along the path of a chosen pair, as it leaves the lens, and what is left of its light.
    ///
    /// # Errors
    /// The reason why it does not get through.
    pub fn trace(&self, chosen: &PairChoice, ray: Ray) -> Result<(Ray, f64), Blocked> {
        self.paths.trace(chosen.pair, ray)
    }
}

impl Surveyed {
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

/// The rays of a grid that get through, by their slopes.
struct FoundPair {
    /// A disk that holds them.
    disk: SlopeDisk,
    passed: Vec<[f64; 2]>,
    /// Between two slopes of the grid.
    step: f64,
}

/// A search for the rays of one pair.
struct PairSurvey<'a> {
    lit: LitPath,
    /// Tells whether rays get through, many at once.
    tracer: ClearanceTracer,
    film: f64,
    work: &'a Work,
}

impl<'a> PairSurvey<'a> {
    /// Returns the search for a pair; `None` where no work is left for it.
    fn of(round: &LitPaths, pair: Pair, surfaces: &Surfaces, film: f64, work: &'a Work) -> Option<Self> {
        let lit = LitPath::new(round.path(pair), surfaces);
        if !work.spend(PER_STEP * lit.path().work() as u64) {
            return None;
        }
        let tracer = ClearanceTracer::new(lit.path(), film);
        Some(Self { lit, tracer, film, work })
    }

    /// The disks of a pair at all radii, and what an even sky sends along it to the film; `None` where no work is left for it.
    fn pair(&self, pair: Pair, step: f64, cover: impl Fn([f64; 2]) -> SlopeDisk) -> Option<(Surveyed, f64)> {
        let (mut disks, mut energy) = ([None; INTERVALS + 1], 0.0);
        for (i, disk) in disks.iter_mut().enumerate() {
            let radius = i as f64 * step;
            let Some((found, here)) = self.radius(radius, cover([radius, 0.0])) else { continue };
            // The ring of the film that the radius stands for.
            let [low, high] = [-0.5, 0.5].map(|half| (i as f64 + half).clamp(0.0, INTERVALS as f64) * step);
            energy += here * (high * high - low * low);
            *disk = Some(found);
        }
        self.work.is_left().then_some((Surveyed { pair, disks }, energy))
    }

    /// The disk that holds the slopes of rays from a film radius, as far as a grid shows, and the integral of cos⁴ and what is left
    /// of the light over them.
    fn radius(&self, radius: f64, cover: SlopeDisk) -> Option<(SlopeDisk, f64)> {
        let mut within = cover;
        for round in 0..ROUNDS {
            let mut found = self.look(radius, within, GRID[0]);
            if found.is_none() && round == 0 {
                found = self.look(radius, within, GRID[1]);
            }
            let found = found?;
            if found.passed.len() >= ENOUGH || round + 1 == ROUNDS {
                return Some((found.disk, self.energy(radius, &found)));
            }
            within = found.disk;
        }
        None
    }

    /// Returns the rays of one grid of slopes in a disk that get through. Slopes on one side of the film's radius stand for both.
    fn look(
        &self,
        radius: f64,
        SlopeDisk { center: [middle, _], radius: wide }: SlopeDisk,
        grid: usize,
    ) -> Option<FoundPair> {
        let step = 2.0 * wide / grid as f64;
        let at = |k: usize| [(k / (grid / 2)) as f64, (k % (grid / 2)) as f64].map(|at| (at + 0.5) * step);
        let slopes = (0..grid * grid / 2).map(at).map(|[x, y]| [x - wide, y]);
        let slopes: Vec<[f64; 2]> =
            slopes.filter(|[x, y]| x.hypot(*y) <= wide).map(|[x, y]| [middle + x, y]).collect();
        if !self.work.spend_rays(slopes.len(), self.lit.path().work()) {
            return None;
        }
        let (mut passed, mut all) = (Vec::new(), slopes.iter());
        let rays = slopes.iter().map(|slopes| FilmRay { point: [radius, 0.0], slopes: *slopes });
        self.tracer.trace(rays, |found| {
            let slopes = all.next().filter(|_| found.is_some_and(|found| found.ratio <= 1.0));
            passed.extend(slopes.copied());
        });
        let ends = passed
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [x, _]| [low.min(*x), high.max(*x)]);
        let center = [f64::midpoint(ends[0], ends[1]), 0.0];
        let away = passed.iter().fold(0.0_f64, |most, [x, y]| most.max((x - center[0]).hypot(*y)));
        // What passes between two slopes of the grid.
        let disk = SlopeDisk { center, radius: away + step };
        (!passed.is_empty()).then_some(FoundPair { disk, passed, step })
    }

    /// The integral over the slopes of a grid that passed.
    fn energy(&self, radius: f64, FoundPair { passed, step, .. }: &FoundPair) -> f64 {
        let every = passed.len().div_ceil(LIT);
        let left = |slopes: &[f64; 2]| {
            let is_there = self.work.spend(self.lit.work());
            let traced = is_there.then(|| self.lit.trace(film_ray([radius, 0.0], self.film, *slopes)));
            traced.and_then(Result::ok).map_or(0.0, |(_, left)| left)
        };
        let lit: Vec<f64> = passed.iter().step_by(every).map(left).collect();
        let mean = lit.iter().sum::<f64>() / lit.len() as f64;
        2.0 * step * step * mean * passed.iter().map(|slopes| cos4(*slopes)).sum::<f64>()
    }
}

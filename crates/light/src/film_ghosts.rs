//! Ghosts sampled from the film. For each pair of surfaces, this module has the path from film to scene, the
//! probability of sampling that path, and the slopes to sample. A sample is a film ray with its slope area and its
//! path.
//!
//! The radiance at the film along the path of a ghost is the radiance of the scene times the share of the light that
//! the surfaces of the path leave. The irradiance of a ghost is therefore the integral of L cos⁴θ' over the same slopes
//! as without a reflection: the slopes of all rays through the rear surface, called the *cover*. Most ghosts come from
//! a small part of the cover. A survey searches for that part at several film radii, as a disk of slopes, and measures
//! the light that a uniform sky sends along each pair. Pairs are chosen in proportion to that light.
//!
//! No survey is certain to find every ray. One sample in eight of a pair is therefore taken from the whole cover, and
//! the slope area of a sample accounts for the sampling densities of both disks where they overlap (the balance
//! heuristic of E. Veach and L. J. Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", 1995).
//! In addition, a share of the samples is distributed uniformly over all pairs. The estimate is thus unbiased whatever
//! the survey finds, and no ghost is left out.
//!
//! The work of the survey is bounded ([`Work`]). The survey examines the pairs in the order of first-order estimates of
//! their light ([`Pairs`]), the brightest first. A pair that the survey does not reach is sampled from the whole cover.
//! The share of the samples that is distributed uniformly over all pairs grows with the estimated share of the light of
//! such pairs. All pairs use one set of surfaces ([`LitPaths`]).

use super::{
    coated::{LitPath, LitPaths, Pair, Surfaces},
    pairs::Pairs,
    work::Work,
};
use realistic_optics::{
    lens::{Lens, Ray, cos4, film_ray, pupil::SlopeDisk},
    trace::Blocked,
};
use realistic_trace::kernel::{ClearanceTracer, FilmRay};

/// Intervals between the film radii of the survey.
const INTERVALS: usize = 16;
/// Number of slopes along the diameter of a disk in the first search, and in a second search if the first finds no ray.
const GRID: [usize; 2] = [24, 48];
/// Number of transmitted rays that suffice to locate the part of the cover that a ghost comes from.
const ENOUGH: usize = 40;
/// Maximum number of searches; each is confined to the disk that the previous search found.
const ROUNDS: usize = 3;
/// Maximum number of transmitted rays whose light is traced. A few suffice, because the light is nearly the same along
/// all rays.
const LIT: usize = 6;
/// Maximum work of the survey, some 0.2 s.
const WORK: u64 = 4_000_000;
/// Units of work that the preparation of one step of a path takes.
const PER_STEP: u64 = 4;
/// Share of a pair's samples that is taken from the whole cover.
const WHOLE: f64 = 0.125;
/// Minimum share of the samples that is distributed uniformly over all pairs.
const UNIFORM: f64 = 0.05;

/// All pairs of a lens, sampled from the film.
#[derive(Clone, Debug)]
pub struct FilmGhosts {
    /// Step between the film radii of the survey, mm.
    step: f64,
    paths: LitPaths,
    all: Pairs,
    /// The surveyed pairs, in the order of their surfaces.
    surveyed: Vec<Surveyed>,
    /// Cumulative probabilities of the surveyed pairs, in [0, 1].
    ends: Vec<f64>,
    /// Share of the samples that is distributed uniformly over all pairs.
    alike: f64,
}

/// One pair of the survey.
#[derive(Clone, Debug)]
struct Surveyed {
    pair: Pair,
    /// Slope disk at each film radius, for a film point on the positive x axis; `None` if no ray was found.
    disks: [Option<SlopeDisk>; INTERVALS + 1],
}

/// The pair that a random number chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairChoice {
    /// The pair.
    pub pair: Pair,
    /// Index among the surveyed pairs; `None` if the pair was not surveyed.
    surveyed: Option<usize>,
    /// Probability of the choice.
    pub probability: f64,
    /// The random number rescaled to [0, 1] for further use.
    pub rest: f64,
}

/// The disk from which a pair's slopes are sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeChoice {
    disk: SlopeDisk,
    /// The disk that the survey found, if any, and the cover.
    found: Option<SlopeDisk>,
    cover: SlopeDisk,
    /// The random number rescaled to [0, 1] for further use.
    pub rest: f64,
}

impl FilmGhosts {
    /// Surveys a lens with the film at z = `film`, mm, for rays from film points up to the distance `reach`, mm, from
    /// the axis. `cover` returns the slopes of all rays from a film point through the rear surface. Returns `None` if
    /// fewer than two surfaces reflect.
    pub fn new(
        lens: &Lens,
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
        let paths = LitPaths::new(lens, surfaces);
        // The clear apertures contain all other apertures.
        let round = LitPaths::new(&lens.without_apertures(), surfaces);
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
        let alike = if whole > 0.0 && known > 0.0 { 1.0 - (1.0 - UNIFORM) * known / estimated } else { 1.0 };
        let mut end = 0.0;
        let ends = found.iter().map(|(_, energy)| {
            end += if whole > 0.0 { energy / whole } else { 0.0 };
            end
        });
        let ends = ends.collect();
        let surveyed = found.into_iter().map(|(own, _)| own).collect();
        Some(Self { step, paths, all, surveyed, ends, alike })
    }

    /// Returns the number of pairs.
    pub fn count(&self) -> usize {
        self.all.count()
    }

    /// Returns the number of surveyed pairs.
    pub fn surveyed(&self) -> usize {
        self.surveyed.len()
    }

    /// Returns the fraction of the samples that are distributed uniformly over all pairs.
    pub fn alike(&self) -> f64 {
        self.alike
    }

    /// Returns the work of a ray along the longest path: the number of surfaces that the ray intersects plus the number
    /// of transfer matrices that are computed for it.
    pub fn work_per_ray(&self) -> usize {
        3 * self.paths.work() as usize
    }

    /// Chooses a pair by a random number from 0 to 1.
    pub fn choose(&self, number: f64) -> PairChoice {
        // Rescales a number in [from, to) to [0, 1); rounding may give 1.
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

    /// Chooses the disk of slopes to sample at a film point, by the rescaled number in `chosen`. `cover` contains the
    /// slopes of all rays from that point through the rear surface.
    pub fn slopes(&self, chosen: &PairChoice, point: [f64; 2], cover: SlopeDisk) -> SlopeChoice {
        let found = chosen.surveyed.and_then(|index| self.surveyed[index].disk(point, self.step));
        let of = |disk, rest: f64| SlopeChoice { disk, found, cover, rest: rest.clamp(0.0, 1.0) };
        match found {
            None => of(cover, chosen.rest),
            Some(_) if chosen.rest < WHOLE => of(cover, chosen.rest / WHOLE),
            Some(disk) => of(disk, (chosen.rest - WHOLE) / (1.0 - WHOLE)),
        }
    }

    /// Traces a ray from the film along the path of a chosen pair. Returns the ray behind the lens and the remaining
    /// share of its light.
    ///
    /// # Errors
    /// Returns the reason if the ray is blocked.
    pub fn trace(&self, chosen: &PairChoice, ray: Ray) -> Result<(Ray, f64), Blocked> {
        self.paths.trace(chosen.pair, ray)
    }
}

impl Surveyed {
    /// Returns the slope disk at a film point, interpolated between the neighbouring film radii.
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
        // The disk has the azimuth of the film point; on the axis there is no azimuth.
        let turned = if radius > 0.0 { along / radius } else { 0.0 };
        Some(SlopeDisk { center: [turned * x, turned * y], radius: wide })
    }
}

impl SlopeChoice {
    /// Maps a point of the unit disk to slopes. Also returns the slope area that the sample represents, divided by π.
    pub fn at(&self, [u, v]: [f64; 2]) -> ([f64; 2], f64) {
        let SlopeDisk { center: [x, y], radius } = self.disk;
        let slopes = [x + radius * u, y + radius * v];
        let Some(found) = self.found else { return (slopes, radius * radius) };
        // The sampling density of a disk at these slopes, times π.
        let density = |disk: &SlopeDisk, share: f64| {
            let away = (slopes[0] - disk.center[0]).hypot(slopes[1] - disk.center[1]);
            if away <= disk.radius * (1.0 + 1e-12) { share / (disk.radius * disk.radius) } else { 0.0 }
        };
        (slopes, (density(&self.cover, WHOLE) + density(&found, 1.0 - WHOLE)).recip())
    }
}

/// The result of a search: the slopes of a grid whose rays get through the lens.
struct FoundPair {
    /// A disk that contains these slopes.
    disk: SlopeDisk,
    passed: Vec<[f64; 2]>,
    /// Step between neighbouring slopes of the grid.
    step: f64,
}

/// A search for the rays of one pair.
struct PairSurvey<'a> {
    lit: LitPath,
    /// Tests, in batches, whether rays get through.
    tracer: ClearanceTracer,
    film: f64,
    work: &'a Work,
}

impl<'a> PairSurvey<'a> {
    /// Prepares the search for a pair; `None` if too little work is left for it.
    fn of(round: &LitPaths, pair: Pair, surfaces: &Surfaces, film: f64, work: &'a Work) -> Option<Self> {
        let lit = LitPath::new(round.path(pair), surfaces);
        if !work.spend(PER_STEP * lit.path().work() as u64) {
            return None;
        }
        let tracer = ClearanceTracer::new(lit.path(), film);
        Some(Self { lit, tracer, film, work })
    }

    /// Returns the slope disks of a pair at all film radii, and the light that a uniform sky sends along the path of
    /// the pair to the film; `None` if no work is left.
    fn pair(&self, pair: Pair, step: f64, cover: impl Fn([f64; 2]) -> SlopeDisk) -> Option<(Surveyed, f64)> {
        let (mut disks, mut energy) = ([None; INTERVALS + 1], 0.0);
        for (i, disk) in disks.iter_mut().enumerate() {
            let radius = i as f64 * step;
            let Some((found, here)) = self.radius(radius, cover([radius, 0.0])) else { continue };
            // The annulus of the film that the radius represents.
            let [low, high] = [-0.5, 0.5].map(|half| (i as f64 + half).clamp(0.0, INTERVALS as f64) * step);
            energy += here * (high * high - low * low);
            *disk = Some(found);
        }
        self.work.is_left().then_some((Surveyed { pair, disks }, energy))
    }

    /// Returns a disk that contains the slopes of the transmitted rays from a film point at this radius, to the
    /// accuracy of a grid, and the integral of cos⁴ times the remaining light over these slopes.
    fn radius(&self, radius: f64, cover: SlopeDisk) -> Option<(SlopeDisk, f64)> {
        let mut within = cover;
        for round in 0..ROUNDS {
            let mut found = self.search_grid(radius, within, GRID[0]);
            if found.is_none() && round == 0 {
                found = self.search_grid(radius, within, GRID[1]);
            }
            let found = found?;
            if found.passed.len() >= ENOUGH || round + 1 == ROUNDS {
                return Some((found.disk, self.energy(radius, &found)));
            }
            within = found.disk;
        }
        None
    }

    /// Searches a grid of slopes in a disk for rays that get through. By symmetry, the slopes on one side of the plane
    /// through the axis and the film point represent those on both sides.
    fn search_grid(
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
        // Rays may also get through between two slopes of the grid.
        let disk = SlopeDisk { center, radius: away + step };
        (!passed.is_empty()).then_some(FoundPair { disk, passed, step })
    }

    /// Returns the integral of cos⁴ times the remaining light over the slopes of a grid whose rays get through.
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

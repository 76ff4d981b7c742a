//! The transmission of a lens for rays from the film, as a polynomial. Rays traced through the lens with their light in; a
//! polynomial of its own measured error out, or none where the error is too large.
//!
//! Transmission is a smooth function of a ray, and on a lens of surfaces of revolution one of the ray's three invariants
//! x·x, x·p and p·p alone (x its place on the film, p its slope about the pupil's centre; see
//! [`polynomial`](crate::trace::polynomial)). It has none of the high orders that the ray's own way through the lens has: of
//! the catalogue's lenses total degree 2 to 7 leaves less than 7e-5. At a wavelength per ray, 1/λ is a fourth
//! variable: the phases of films are proportional to it, and what glass absorbs then stands apart ([`Absorbers`]). The fit
//! minimises relative errors at the rays that get through, and the degree is the least whose largest error at others of them is
//! below [`GOAL`].

use std::{
    f64::consts::{FRAC_PI_2, PI},
    ops::Range,
    sync::Arc,
};

use super::{
    absorption::{Absorbers, LaneAbsorption, NOTHING},
    coated::LitPath,
    ray_polynomials::{HIGHEST_OF_FOUR, Polynomials, RayPolynomial, RayVariables},
    work::Work,
};
use crate::{
    lens::{film_ray, pupil::SlopeDisk},
    numeric::{STEPS, edge},
    trace::{
        Real,
        kernel::{ClearanceTracer, Cpu, FilmRay, Lanes, Scalar},
        polynomial::{LaneScaling, Scaling},
    },
};

/// The largest relative error that a polynomial may have at the rays that are looked at. What is promised is 1e-4, of which what
/// glass absorbs has a part, and rays between them the rest.
const GOAL: f64 = 7e-5;
/// The same of the exponent of what glass absorbs, whose error comes on top.
const GOAL_OF_EXPONENT: f64 = 2e-5;
/// Less than this counts as this: the squares of what divides equations stay finite.
const DARKEST: f64 = 1e-30;
/// Radii of film, and slopes across the pupil at each, that polynomials are fitted at.
const FITTED: [usize; 2] = [14, 26];
/// The same where each wavelength has its own.
const FITTED_PER_WAVELENGTH: [usize; 2] = [10, 16];
/// Those at which they are looked at, from the axis to the edge of the film: no radius of the fit is among them.
const CHECKED: [usize; 2] = [11, 21];
/// Where between two of its neighbours a slope of the check lies: no slope of the fit does.
const BETWEEN: f64 = 0.23;
/// Directions, from the middle of a pupil to one side of the film's radius and round to the other, in which its edge is looked
/// at, to within this of the way there. Polynomials err most there.
const RIM: usize = 16;
const AT_RIM: f64 = 1e-3;
/// Rays over the whole film and all slopes, of which at most one in so many is looked at, if it gets through. A part of a pupil
/// apart from the rest shows that way, where one in some thousand samples meets it.
const ANYWHERE: usize = 16_000;
const ONE_OF: usize = 5;
/// Film radii and slopes at which light is looked for.
const SCAN: [usize; 2] = [32, 24];
/// Rays that show where a pupil is, and that are the fewest to tell an error by.
const ENOUGH: usize = 16;
/// Grids of slopes in which they are looked for, each finer than the one before: 192 slopes across the cover in the last, where
/// no ray gets through.
const GRIDS: usize = 4;
/// The work that the rays of a fit may take, some 0.2 s. Lenses of 300 spheres take less at one wavelength, of 100 at all.
const WORK: u64 = 4_000_000;

/// A lens's transmission at one wavelength, or over a range of them.
#[derive(Clone, Debug)]
pub struct TransmissionFit {
    scaling: Scaling,
    /// The first wavelength and the last, nm, where it is a variable.
    wavelengths: Option<[f64; 2]>,
    value: Polynomials,
    absorption: Option<Absorption>,
}

/// What glass absorbs, where the wavelength is a variable.
#[derive(Clone, Debug)]
struct Absorption {
    absorbers: Absorbers,
    /// The ways in them, mm.
    ways: Polynomials,
    /// The largest exponent that was seen.
    largest: f64,
}

/// A ray that gets through, with 1/λ scaled to -1 … 1.
struct Probe {
    point: [f64; 2],
    slopes: [f64; 2],
    wavelength: f64,
    transmission: f64,
    /// The way in each of the glasses that absorb apart, mm, and their absorption coefficients, 1/mm.
    ways: Vec<f64>,
    coefficients: Arc<[f64]>,
}

impl Probe {
    /// Σ α l for such ways.
    fn exponent(&self, ways: impl Iterator<Item = f64>) -> f64 {
        self.coefficients.iter().zip(ways).map(|(coefficient, way)| coefficient * way).sum()
    }
}

/// Where light reaches the film.
#[derive(Clone, Copy)]
struct Lit {
    /// The greatest radius of the film that is lit from the axis on, mm.
    radius: f64,
    /// That of the whole film.
    reach: f64,
}

impl TransmissionFit {
    /// That of a path from the film to the scene, for film at z = `film` out to `reach`, mm; `cover` holds the slopes of all
    /// rays that get through from a film point. `None` where no polynomial is near enough, too few rays get through to tell, or
    /// the rays take more work than they may.
    pub fn new(lit: &LitPath, film: f64, reach: f64, cover: impl Fn([f64; 2]) -> SlopeDisk) -> Option<Self> {
        let (none, work) = (Absorbers::default(), Work::new(WORK));
        let at = FittedFilm::new(lit, &none, film, 0.0, cover, &work);
        let lit = at.lit(reach)?;
        let [fitted, checked] = [at.fitted(lit, FITTED), at.checked(lit, 0..ANYWHERE)];
        if !work.is_left() {
            return None;
        }
        Self::fit(film, None, &fitted, &checked)
    }

    /// The same with a wavelength per ray, in nm within `range`; `at` makes the path and the cover at a wavelength, of which
    /// the path absorbs nothing: that is what `absorbers` do.
    pub fn spectral<C: Fn([f64; 2]) -> SlopeDisk>(
        range: [f64; 2],
        film: f64,
        reach: f64,
        absorbers: &Absorbers,
        at: impl Fn(f64) -> Option<(LitPath, C)>,
    ) -> Option<Self> {
        let [from, to] = range.map(f64::recip);
        let (middle, half) = (f64::midpoint(from, to), (to - from) / 2.0);
        let work = Work::new(WORK);
        let (path, cover) = at(middle.recip())?;
        let lit = FittedFilm::new(&path, absorbers, film, 0.0, cover, &work).lit(reach)?;
        let degree = HIGHEST_OF_FOUR;
        let (mut fitted, mut checked) = (Vec::new(), Vec::new());
        for (is_check, count) in [(false, degree + 2), (true, degree - 1)] {
            for k in 0..count {
                // The nodes of a fit are not among those of the check, which has the ends.
                let share =
                    if is_check { k as f64 / (count - 1) as f64 } else { (k as f64 + 0.5) / count as f64 };
                let scaled = -(PI * share).cos();
                let wavelength = 1.0 / (middle + scaled * half);
                let (path, cover) = at(wavelength)?;
                let coefficients: Arc<[f64]> = absorbers.coefficients(wavelength).collect();
                if !work.is_left() {
                    return None;
                }
                let at = FittedFilm::new(&path, absorbers, film, scaled, cover, &work);
                let (into, found) = if is_check {
                    let anywhere = k * ANYWHERE / count..(k + 1) * ANYWHERE / count;
                    (&mut checked, at.checked(lit, anywhere))
                } else {
                    (&mut fitted, at.fitted(lit, FITTED_PER_WAVELENGTH))
                };
                let with = |probe| Probe { coefficients: coefficients.clone(), ..probe };
                into.extend(found.into_iter().map(with));
            }
        }
        if !work.is_left() {
            return None;
        }
        Self::fit(film, Some((range, absorbers)), &fitted, &checked)
    }

    fn fit(
        film: f64,
        spectral: Option<([f64; 2], &Absorbers)>,
        fitted: &[Probe],
        checked: &[Probe],
    ) -> Option<Self> {
        if fitted.len().min(checked.len()) < ENOUGH {
            return None;
        }
        let at: Vec<_> = fitted.iter().map(|probe| (probe.point, probe.slopes)).collect();
        let scaling = Scaling::of(film, &at);
        let variables = |probes: &[Probe]| -> Vec<[f64; 4]> {
            let of = |probe: &Probe| {
                let (_, _, [u, v, w]) = scaling.variables(probe.point, probe.slopes);
                [u, v, w, probe.wavelength]
            };
            probes.iter().map(of).collect()
        };
        let is_spectral = spectral.is_some();
        let rays = [fitted, checked].map(variables);
        // Each equation over its transmission, so that errors are relative.
        let over: Vec<f64> = fitted.iter().map(|probe| probe.transmission.recip()).collect();
        let error = |values: &[Vec<f64>]| {
            let pairs = values[0].iter().zip(checked);
            pairs.fold(0.0_f64, |most, (value, probe)| most.max((value / probe.transmission - 1.0).abs()))
        };
        let value =
            Polynomials::fit(&rays, is_spectral, vec![vec![1.0; fitted.len()]], Some(&over), GOAL, error)?;
        let absorbing = spectral.filter(|(_, absorbers)| absorbers.count() > 0);
        let absorption = match absorbing {
            None => None,
            Some((_, absorbers)) => Some(Absorption::fit(absorbers, &rays, fitted, checked)?),
        };
        Some(Self { scaling, wavelengths: spectral.map(|(range, _)| range), value, absorption })
    }

    /// For rays in lanes of a precision.
    pub fn lane_fit<S: Scalar>(&self) -> LaneFit<S> {
        let range = self.wavelengths.unwrap_or([1.0, -1.0]);
        let [from, to] = range.map(f64::recip);
        let absorption = self.absorption.as_ref().map(|Absorption { absorbers, ways, largest }| {
            LaneAbsorption::new(absorbers, ways.in_lanes(), range, *largest)
        });
        LaneFit {
            value: self.value.in_lanes().swap_remove(0),
            absorption,
            scaling: self.scaling.lane_scaling(),
            wavelength: [2.0 / (to - from), -(from + to) / (to - from)].map(S::from_f64),
        }
    }
}

impl Absorption {
    fn fit(
        absorbers: &Absorbers,
        rays: &[Vec<[f64; 4]>; 2],
        fitted: &[Probe],
        checked: &[Probe],
    ) -> Option<Self> {
        let of_glass = |glass: usize| fitted.iter().map(|probe| probe.ways[glass]).collect();
        let error = |values: &[Vec<f64>]| {
            let off = |(i, probe): (usize, &Probe)| {
                if probe.exponent(probe.ways.iter().copied()) > NOTHING {
                    return 0.0;
                }
                let ways = values.iter().zip(&probe.ways).map(|(values, way)| values[i] - way);
                probe.exponent(ways).abs()
            };
            checked.iter().enumerate().map(off).fold(0.0, f64::max)
        };
        let sides = (0..absorbers.count()).map(of_glass).collect();
        let ways = Polynomials::fit(rays, true, sides, None, GOAL_OF_EXPONENT, error)?;
        let exponents = fitted.iter().chain(checked).map(|probe| probe.exponent(probe.ways.iter().copied()));
        Some(Self { absorbers: absorbers.clone(), ways, largest: exponents.fold(0.0, f64::max) })
    }
}

/// What rays from a film are traced by at one of the wavelengths.
struct FittedFilm<'a, C> {
    path: &'a LitPath,
    /// What tells whether rays get through, many at once.
    tracer: ClearanceTracer,
    absorbers: &'a Absorbers,
    /// z of the film, mm.
    film: f64,
    /// As [`Probe::wavelength`].
    wavelength: f64,
    /// What holds the slopes of all rays that get through from a film point.
    cover: C,
    work: &'a Work,
    /// Of one ray with its light.
    work_per_ray: u64,
}

impl<'a, C: Fn([f64; 2]) -> SlopeDisk> FittedFilm<'a, C> {
    fn new(
        path: &'a LitPath,
        absorbers: &'a Absorbers,
        film: f64,
        wavelength: f64,
        cover: C,
        work: &'a Work,
    ) -> Self {
        let (tracer, work_per_ray) = (ClearanceTracer::new(path.path(), film), path.work());
        Self { path, tracer, absorbers, film, wavelength, cover, work, work_per_ray }
    }

    fn lit(&self, reach: f64) -> Option<Lit> {
        let at = |i: usize| reach * i as f64 / SCAN[0] as f64;
        if self.box_of_slopes(at(SCAN[0]), None).is_some() {
            return Some(Lit { radius: reach, reach });
        }
        // The lit radii are one interval, or the check sees to it. From the axis on, because a dark radius takes as many rays
        // as a hundred lit ones.
        let (mut near, mut last) = (None, None);
        for i in 0..SCAN[0] {
            near = self.box_of_slopes(at(i), near);
            if near.is_some() {
                last = Some(i);
            } else if last.is_some() {
                break;
            }
        }
        last.map(|last| Lit { radius: at(last + 1), reach })
    }

    /// Rays that get through, for a fit: from film points on one radius, and of slopes on one side of it, which stand for all.
    fn fitted(&self, lit: Lit, counts: [usize; 2]) -> Vec<Probe> {
        let mut found = Vec::new();
        let mut near = None;
        for k in 0..counts[0] {
            // Closer together toward the edges, as Chebyshev's nodes are.
            let radius = lit.radius * (FRAC_PI_2 * (k as f64 + 0.5) / counts[0] as f64).sin();
            near = self.box_of_slopes(radius, near);
            found.extend(near.into_iter().flat_map(|within| self.grid(radius, within, counts[1], 0.5)));
        }
        found
    }

    /// Others, for the error: between those, on the edges of pupils, and those of the numbers `anywhere` over the whole film and
    /// all slopes.
    fn checked(&self, lit: Lit, anywhere: Range<usize>) -> Vec<Probe> {
        let [radii, slopes] = CHECKED;
        let mut found = Vec::new();
        let mut near = None;
        for k in 0..radii {
            let radius = lit.radius * (FRAC_PI_2 * k as f64 / (radii - 1) as f64).sin();
            near = self.box_of_slopes(radius, near);
            let Some(within) = near else { continue };
            let inside = self.grid(radius, within, slopes, BETWEEN);
            found.extend(self.rim(radius, within, &inside));
            found.extend(inside);
        }
        let most = anywhere.len() / ONE_OF;
        let at = |k: usize| {
            let [area, share, angle] = [0, 1, 2].map(|axis| (k as f64 * STEPS[axis]).fract());
            let height = lit.reach * area.sqrt();
            let SlopeDisk { center, radius } = (self.cover)([height, 0.0]);
            let (sin, cos) = (PI * angle).sin_cos();
            let away = radius * share.sqrt();
            FilmRay { point: [height, 0.0], slopes: [center[0] + away * cos, center[1] + away * sin] }
        };
        let passing = self.passing(anywhere.map(at));
        found.extend(passing.iter().take(most).filter_map(|ray| self.probe(ray.point[0], ray.slopes)));
        found
    }

    /// Those of the rays that get through, as long as there is work left for them.
    fn passing(&self, rays: impl Iterator<Item = FilmRay>) -> Vec<FilmRay> {
        let (rays, mut passing): (Vec<FilmRay>, _) = (rays.collect(), Vec::new());
        if !self.work.spend_rays(rays.len(), self.path.path().work()) {
            return passing;
        }
        let mut all = rays.iter();
        self.tracer.trace(rays.iter().copied(), |found| {
            let ray = all.next().filter(|_| found.is_some_and(|found| found.ratio <= 1.0));
            passing.extend(ray.copied());
        });
        passing
    }

    /// A ray from a film radius, as long as there is work left for it.
    fn probe(&self, radius: f64, slopes: [f64; 2]) -> Option<Probe> {
        if !self.work.spend(self.work_per_ray) {
            return None;
        }
        let (transmission, ways) =
            self.absorbers.trace(self.path, film_ray([radius, 0.0], self.film, slopes)).ok()?;
        Some(Probe {
            point: [radius, 0.0],
            slopes,
            wavelength: self.wavelength,
            transmission: transmission.max(DARKEST),
            ways,
            coefficients: Arc::new([]),
        })
    }

    /// Those of so many slopes along the film's radius in a box, and half as many across.
    fn grid(&self, radius: f64, [low, high, side]: [f64; 3], slopes: usize, between: f64) -> Vec<Probe> {
        let mut found = Vec::new();
        for i in 0..slopes {
            let across = -(PI * (i as f64 + between) / slopes as f64).cos();
            let x = f64::midpoint(low, high) + across * (high - low) / 2.0;
            for j in 0..slopes / 2 {
                let y = side * (PI * (j as f64 + between) / slopes as f64).sin();
                found.extend(self.probe(radius, [x, y]));
            }
        }
        found
    }

    /// Those on the edge of a pupil in a box, of which some `inside` are known.
    fn rim(&self, radius: f64, [low, high, side]: [f64; 3], inside: &[Probe]) -> Vec<Probe> {
        let sum: f64 = inside.iter().map(|probe| probe.slopes[0]).sum();
        let middle = sum / inside.len() as f64;
        let along = |direction: usize, share: f64| {
            let (sin, cos) = (PI * (direction as f64 + 0.5) / RIM as f64).sin_cos();
            [middle + share * (high - low) * cos, share * 2.0 * side * sin]
        };
        let passes = |slopes| self.path.path().trace(film_ray([radius, 0.0], self.film, slopes)).is_ok();
        let last = |direction| edge(0.0, 1.0, AT_RIM, |share| passes(along(direction, share)));
        (0..RIM).filter_map(|direction| self.probe(radius, along(direction, last(direction)))).collect()
    }

    /// The least slope along the film's radius, the greatest, and the greatest across it, of rays that get through from a film
    /// radius. `near` is the box of a radius close by, if one is known: its surroundings are searched first. A pupil may be a
    /// small part of the disk that holds it: a grid over the disk becomes finer until a ray gets through, and then the grid
    /// covers the part of the disk where rays do.
    fn box_of_slopes(&self, radius: f64, near: Option<[f64; 3]>) -> Option<[f64; 3]> {
        // The box in a window with so many slopes along the radius, and how many rays of the grid get through.
        let grid = |[low, high, side]: [f64; 3], slopes: usize| {
            let step = [(high - low) / slopes as f64, 2.0 * side / slopes as f64];
            let half = slopes / 2;
            let at = |k: usize| [low + ((k / half) as f64 + 0.5) * step[0], (k % half) as f64 * step[1]];
            let rays = (0..slopes * half).map(|k| FilmRay { point: [radius, 0.0], slopes: at(k) });
            let passing = self.passing(rays);
            let found = passing.iter().fold(None, |found: Option<[f64; 3]>, ray| {
                let [x, y] = ray.slopes;
                let [low, high, side] = found.unwrap_or([x, x, y]);
                Some([low.min(x), high.max(x), side.max(y)])
            });
            (found.map(|[low, high, side]| [low - step[0], high + step[0], side + step[1]]), passing.len())
        };
        if let Some([low, high, side]) = near {
            let window = [2.0 * low - high, 2.0 * high - low, 2.0 * side];
            if let (Some(found), ENOUGH..) = grid(window, SCAN[1])
                && found[0] >= window[0]
                && found[1] <= window[1]
                && found[2] <= window[2]
            {
                return Some(found);
            }
        }
        let SlopeDisk { center, radius: wide } = (self.cover)([radius, 0.0]);
        let mut window = [center[0] - wide, center[0] + wide, wide];
        let mut slopes = SCAN[1];
        let mut best = None;
        for _ in 0..GRIDS {
            let (found, passing) = grid(window, slopes);
            match found {
                Some(found) => (window, best, slopes) = (found, Some(found), SCAN[1]),
                None => slopes *= 2,
            }
            if passing >= ENOUGH {
                break;
            }
        }
        best
    }
}

/// [`TransmissionFit`], for lanes of a precision.
#[derive(Clone, Debug)]
pub struct LaneFit<S> {
    value: RayPolynomial<S>,
    absorption: Option<LaneAbsorption<S>>,
    scaling: LaneScaling<S>,
    /// From 1/nm to -1 … 1: factor and constant.
    wavelength: [S; 2],
}

impl<S: Scalar> LaneFit<S> {
    /// Of `U` vectors of rays from these film points, mm, with these slopes. The wavelengths, nm, are asked where it depends on
    /// them.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = S>, const U: usize>(
        &self,
        cpu: Cpu<L>,
        points: &[[L; 2]; U],
        slopes: &[[L; 2]; U],
        wavelengths: &[L; U],
    ) -> [L; U] {
        let mut rays = [RayVariables { invariants: [wavelengths[0]; 3], wavelength: wavelengths[0] }; U];
        for u in 0..U {
            let (_, _, invariants) = self.scaling.variables(cpu, points[u], slopes[u]);
            rays[u] = RayVariables { invariants, wavelength: wavelengths[u] };
            if self.value.is_spectral {
                let [factor, constant] = self.wavelength.map(|number| L::splat(cpu, number));
                rays[u].wavelength = factor.mul_add(L::splat(cpu, S::ONE) / wavelengths[u], constant);
            }
        }
        let mut values = self.value.lanes(cpu, &rays);
        for u in 0..U {
            values[u] = share(cpu, values[u]);
            if let Some(absorption) = &self.absorption {
                values[u] = values[u] * absorption.lanes(cpu, rays[u], wavelengths[u]);
            }
        }
        values
    }
}

/// Far outside the film, where polynomials mean nothing, they still are a share.
#[cfg_attr(not(debug_assertions), inline(always))]
fn share<L: Lanes>(cpu: Cpu<L>, value: L) -> L {
    value.larger(L::splat(cpu, L::Scalar::ZERO)).smaller(L::splat(cpu, L::Scalar::ONE))
}

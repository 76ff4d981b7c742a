//! Transmission of a lens for rays from the film, as a polynomial. Rays and their light are traced through the lens;
//! the result is a polynomial with a measured error, or `None` if the error is too large.
//!
//! Transmission is a smooth function of a ray, and on a lens of surfaces of revolution one of the ray's three
//! invariants x·x, x·p and p·p alone (x is the film point, p the slope about the pupil's centre; see
//! [`polynomial`](crate::trace::polynomial)). It lacks the high orders of the ray's own path: for the catalogue's
//! lenses total degree 2 to 7 leaves errors below 7e-5. With a wavelength per ray, 1/λ is a fourth variable: the phases
//! of films are proportional to it, and the absorption of glass is separate ([`Absorbers`]). The fit minimises relative
//! errors at transmitted rays. The degree is the least whose largest error at other rays is below [`GOAL`].

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

/// Largest relative error of a polynomial at the checked rays. The documented error is 1e-4, which leaves room for
/// absorption and for rays in between.
const GOAL: f64 = 7e-5;
/// Largest error of the exponent of absorption, which adds to [`GOAL`].
const GOAL_OF_EXPONENT: f64 = 2e-5;
/// Minimum transmission used: the squares of its reciprocal stay finite in the equations.
const DARKEST: f64 = 1e-30;
/// Number of film radii, and of slopes across the pupil at each, for the fit.
const FITTED: [usize; 2] = [14, 26];
/// Number of film radii and slopes per wavelength.
const FITTED_PER_WAVELENGTH: [usize; 2] = [10, 16];
/// Number of film radii, from the axis to the edge, and of slopes for the check; no radius of the fit is among them.
const CHECKED: [usize; 2] = [11, 21];
/// Position of a slope of the check between two neighbours, different from that of the fit.
const BETWEEN: f64 = 0.23;
/// Number of directions from the middle of a pupil, over half a turn, in which its edge is checked, and the accuracy of
/// the edge relative to the distance. Polynomials err most there.
const RIM: usize = 16;
const AT_RIM: f64 = 1e-3;
/// Number of rays over the whole film and all slopes, and the divisor for how many of them are checked at most, if they
/// get through. They find a separate part of a pupil that one in some thousand samples hits.
const ANYWHERE: usize = 16_000;
const ONE_OF: usize = 5;
/// Number of film radii and slopes in the search for light.
const SCAN: [usize; 2] = [32, 24];
/// Minimum number of rays to locate a pupil, and to measure an error.
const ENOUGH: usize = 16;
/// Number of search grids of slopes, each finer than the one before: the last has 192 slopes across the cover if no ray
/// got through.
const GRIDS: usize = 4;
/// Maximum work on the rays of a fit, some 0.2 s. Lenses of 300 spheres take less at one wavelength, of 100 at all.
const WORK: u64 = 4_000_000;

/// A lens's transmission at one wavelength, or over a range of them.
#[derive(Clone, Debug)]
pub struct TransmissionFit {
    scaling: Scaling,
    /// First and last wavelength, nm, if it is a variable.
    wavelengths: Option<[f64; 2]>,
    value: Polynomials,
    absorption: Option<Absorption>,
}

/// Absorption of the glasses, if the wavelength is a variable.
#[derive(Clone, Debug)]
struct Absorption {
    absorbers: Absorbers,
    /// Path lengths in the glasses, mm.
    ways: Polynomials,
    /// Largest exponent found.
    largest: f64,
}

/// A ray that gets through, with 1/λ scaled to -1 … 1.
struct Probe {
    point: [f64; 2],
    slopes: [f64; 2],
    wavelength: f64,
    transmission: f64,
    /// Path length in each glass that absorbs, mm, and the absorption coefficients, 1/mm.
    ways: Vec<f64>,
    coefficients: Arc<[f64]>,
}

impl Probe {
    /// Returns Σ α l for these path lengths.
    fn exponent(&self, ways: impl Iterator<Item = f64>) -> f64 {
        self.coefficients.iter().zip(ways).map(|(coefficient, way)| coefficient * way).sum()
    }
}

/// The lit part of the film.
#[derive(Clone, Copy)]
struct Lit {
    /// Largest radius of the film that is lit from the axis on, mm.
    radius: f64,
    /// Radius of the whole film, mm.
    reach: f64,
}

impl TransmissionFit {
    /// Fits the transmission of a path from film to scene, for film at z = `film` out to `reach`, mm; `cover` returns
    /// the slopes of all rays that get through from a film point. `None` if no polynomial is accurate enough, too few
    /// rays get through to measure an error, or the rays exceed the work.
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

    /// Fits the transmission with a wavelength per ray, in nm within `range`. `at` returns the path and the cover at a
    /// wavelength; the path absorbs nothing, because `absorbers` do.
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
                // The nodes of the fit are not among those of the check, which has the ends.
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
        // Dividing each equation by its transmission makes errors relative.
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

    /// Returns the fit for rays in lanes of a precision.
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

/// Tracers of rays from a film at one of the wavelengths.
struct FittedFilm<'a, C> {
    path: &'a LitPath,
    /// Tests rays in batches for whether they get through.
    tracer: ClearanceTracer,
    absorbers: &'a Absorbers,
    /// z of the film, mm.
    film: f64,
    /// Scaled 1/λ, see [`Probe::wavelength`].
    wavelength: f64,
    /// Returns the slopes of all rays that get through from a film point.
    cover: C,
    work: &'a Work,
    /// Work of one ray with its light.
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
        // The lit radii are assumed to be one interval, which the check verifies. The search begins at the axis,
        // because a dark radius takes as many rays as a hundred lit ones.
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

    /// Returns rays that get through, for a fit: by symmetry from film points on one radius, and with slopes on one
    /// side of it.
    fn fitted(&self, lit: Lit, counts: [usize; 2]) -> Vec<Probe> {
        let mut found = Vec::new();
        let mut near = None;
        for k in 0..counts[0] {
            // Denser toward the edges, like Chebyshev nodes.
            let radius = lit.radius * (FRAC_PI_2 * (k as f64 + 0.5) / counts[0] as f64).sin();
            near = self.box_of_slopes(radius, near);
            found.extend(near.into_iter().flat_map(|within| self.grid(radius, within, counts[1], 0.5)));
        }
        found
    }

    /// Returns rays for the check: between those of the fit, on the edges of pupils, and those with the indices
    /// `anywhere` over the whole film and all slopes.
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

    /// Returns the rays that get through, as long as work is left.
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

    /// Traces a ray from a film radius with its light, as long as work is left.
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

    /// Traces a grid in a box, of `slopes` along the film's radius and half as many across.
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

    /// Traces rays on the edge of a pupil in a box; the probes `inside` the pupil are known.
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

    /// Returns the box of the rays that get through from a film radius: the minimum and maximum slope along the radius,
    /// and the maximum across. `near` is the box of a neighbouring radius, if known: its surroundings are searched
    /// first. A pupil may be a small part of the disk that holds it, so a grid over the disk becomes finer until a ray
    /// gets through, and then covers only the part where rays do.
    fn box_of_slopes(&self, radius: f64, near: Option<[f64; 3]>) -> Option<[f64; 3]> {
        // Returns the box in a window with `slopes` along the radius, and the number of rays of the grid that get
        // through.
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
    /// Maps 1/nm to -1 … 1: factor and constant.
    wavelength: [S; 2],
}

impl<S: Scalar> LaneFit<S> {
    /// Returns the transmission of `U` vectors of rays from these film points, mm, with these slopes. The wavelengths,
    /// nm, are used only if it depends on them.
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

/// Clamps to a share: far outside the film the polynomials are meaningless.
#[cfg_attr(not(debug_assertions), inline(always))]
fn share<L: Lanes>(cpu: Cpu<L>, value: L) -> L {
    value.larger(L::splat(cpu, L::Scalar::ZERO)).smaller(L::splat(cpu, L::Scalar::ONE))
}

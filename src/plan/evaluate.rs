//! How far off a way to trace is, on rays all over a film and its pupil, against the exact trace in double precision.

use std::ops::Range;

use super::{
    cost,
    quantile::{upper_bound, worst},
    strata,
    task::{FilmSide, Task},
    tracing::Precision,
};
use crate::{
    imaging::image_scale::ImageScale,
    lens::film_ray,
    numeric::quasirandom::STEPS,
    sampling::PupilSample,
    trace::{
        Blocked, Ray,
        kernel::{KernelScalar, LensRays, PlaneRays, RayBuffer},
        polynomial::{Fits, Polynomial, PolynomialLens},
    },
};

/// The measured errors of a way to trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Bound of the 99.9 % quantile, pixels.
    pub pixels: f64,
    /// Rays looked at.
    pub rays: usize,
    /// Rays that exactly one of it and the lens lets through.
    pub mismatches: usize,
    /// Sum of the errors of the weights over the sum of the weights.
    pub light: f64,
}

/// Rays of which so many are further off than is tolerated that more of them do not matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooFarOff {
    /// Those that are.
    pub beyond: usize,
    /// Rays looked at.
    pub of: usize,
}

impl Errors {
    /// Of what the others are measured by.
    pub(super) const NONE: Self = Self { pixels: 0.0, rays: 0, mismatches: 0, light: 0.0 };
}

/// Rays that get through which suffice for a bound.
const ENOUGH: usize = 9000;
/// Sets of rays sampled for them at most.
const MOST_SEEDS: usize = 4;
/// Rays that a candidate traces before it is asked whether more are worth it.
const PART: usize = 1024;
/// Apertures that polynomials may test besides the front's.
const APERTURES: usize = 4;
/// Part of the rays that may be blocked by apertures that the polynomials do not know.
const OVERLOOKED: f64 = 5e-5;

/// Why the image has no scale.
const DARK: &str =
    "the film is dark in the middle, or so little of it lit that the image's scale cannot be measured";

/// Rays at the film and what they stand for, as structure of arrays.
struct Rays {
    /// x, y, dx/dz, dy/dz.
    columns: [Vec<f64>; 4],
    area: Vec<f64>,
}

impl Rays {
    fn with_capacity(count: usize) -> Self {
        let column = || Vec::with_capacity(count);
        Self { columns: [column(), column(), column(), column()], area: column() }
    }

    fn push(&mut self, [x, y]: [f64; 2], PupilSample { slopes: [sx, sy], area }: PupilSample) {
        for (column, number) in self.columns.iter_mut().zip([x, y, sx, sy]) {
            column.push(number);
        }
        self.area.push(area);
    }

    fn len(&self) -> usize {
        self.area.len()
    }

    fn ray(&self, i: usize, film: f64) -> Ray {
        let [x, y, sx, sy] = [0, 1, 2, 3].map(|column: usize| self.columns[column][i]);
        film_ray([x, y], film, [sx, sy])
    }

    /// Some of them traced.
    fn traced<S: KernelScalar>(
        &self,
        film: f64,
        part: Range<usize>,
        trace: impl Fn(&PlaneRays<'_, S>, &mut LensRays<'_, S>),
    ) -> RayBuffer<S> {
        let round =
            |column: &Vec<f64>| column[part.clone()].iter().map(|&x| S::from_f64(x)).collect::<Vec<S>>();
        let [x, y, slope_x, slope_y] = &self.columns.each_ref().map(round);
        let mut out = RayBuffer::new(part.len());
        trace(&PlaneRays { plane: film, x, y, slope_x, slope_y }, &mut out.rays());
        out
    }
}

/// Everything that candidates are evaluated with.
pub(super) struct Evaluation<'a> {
    task: &'a Task<'a>,
    scale: ImageScale,
    rays: Rays,
    exact: RayBuffer<f64>,
    /// Surfaces other than the front whose apertures block rays, counted from the scene.
    pub blocking: Vec<usize>,
}

impl<'a> Evaluation<'a> {
    /// Samples the film and traces its rays.
    ///
    /// # Errors
    /// Why nothing can be measured.
    pub fn new(task: &'a Task<'a>) -> Result<Self, String> {
        let side = task.film_side;
        let kernel = task.kernels.double();
        let mut rays = Rays::with_capacity(strata::COUNT as usize);
        let mut exact = RayBuffer::new(0);
        let (mut seed, mut passing) = (0, 0);
        loop {
            seed += 1;
            let known = rays.len();
            for sample in strata::numbers(seed as u64) {
                if let Some((point, sample)) = side.sample(sample) {
                    rays.push(point, sample);
                }
            }
            exact.append(rays.traced(side.z, known..rays.len(), |from, to| kernel.trace_batch(from, to)));
            passing += (known..rays.len()).filter(|&i| exact.get(i).is_some()).count();
            let hopeless = passing < ENOUGH / MOST_SEEDS;
            if passing >= ENOUGH || hopeless || seed == MOST_SEEDS {
                break;
            }
        }
        if passing < ENOUGH {
            let axis = film_ray([0.0; 2], side.z, [0.0; 2]);
            if task.path.trace(axis).is_err() {
                return Err(DARK.to_owned());
            }
            if 2 * passing > rays.len() {
                let share = 100.0 * passing as f64 / f64::from(seed as u32 * strata::COUNT);
                return Err(format!(
                    "only {share:.1} % of the film's rays get through, too few to tell: most of it is dark"
                ));
            }
            let share = 100.0 * passing as f64 / rays.len() as f64;
            return Err(format!(
                "only {share:.1} % of the rays that are sampled get through, too few to tell; with \"pupil\" \
                 \"warped\" nearly all do"
            ));
        }
        let scale = ImageScale::new(task.lens, side.z, side.film.reach(), task.in_focus)
            .ok_or_else(|| DARK.to_owned())?;
        let blocking = blocking(task, &rays, &exact);
        Ok(Self { task, scale, rays, exact, blocking })
    }

    /// The errors of a model that traces the rays.
    ///
    /// # Errors
    /// So many of them are off by more than the tolerance, pixels, that the bound of their quantile is, too.
    fn errors<S: KernelScalar>(
        &self,
        tolerance: f64,
        trace: impl Fn(&PlaneRays<'_, S>, &mut LensRays<'_, S>),
    ) -> Result<Errors, TooFarOff> {
        let FilmSide { film, z, .. } = self.task.film_side;
        // Film points in single precision are rounded to it.
        let rounding = if S::EPSILON > f64::EPSILON { 2.0 * S::EPSILON } else { 0.0 };
        let rounding = rounding * film.reach() / film.pixel();
        // Of fewer rays even fewer may.
        let too_many = worst(self.rays.len());
        let (mut mismatches, mut light, mut wrong, mut beyond) = (0, 0.0, 0.0, 0);
        let mut errors = Vec::with_capacity(self.rays.len());
        // By parts: of what is far off, the first has enough.
        for first in (0..self.rays.len()).step_by(PART) {
            let part = first..self.rays.len().min(first + PART);
            let model = self.rays.traced(*z, part.clone(), &trace);
            for i in part {
                let (exact, other) = (self.exact.get(i), model.get(i - first));
                let weight = exact.map_or(0.0, |ray| ray.weight);
                let others = other.map_or(0.0, |ray| ray.weight.to_f64());
                light += weight * self.rays.area[i];
                wrong += (others - weight).abs() * self.rays.area[i];
                let error = match (exact, other) {
                    (Some(exact), Some(other)) => {
                        let point = [self.rays.columns[0][i], self.rays.columns[1][i]];
                        self.scale.film_error(point, &exact.ray(), &other.ray()) / film.pixel()
                    }
                    (None, None) => continue,
                    _ => {
                        mismatches += 1;
                        f64::INFINITY
                    }
                };
                errors.push(if error.is_nan() { f64::INFINITY } else { error });
                if error.is_nan() || error + rounding > tolerance {
                    beyond += 1;
                    if beyond >= too_many {
                        return Err(TooFarOff { beyond, of: errors.len() });
                    }
                }
            }
        }
        let (rays, pixels) = (errors.len(), upper_bound(&mut errors) + rounding);
        if pixels > tolerance {
            return Err(TooFarOff { beyond, of: rays });
        }
        Ok(Errors { rays, pixels, mismatches, light: wrong / light })
    }

    /// Polynomials of every order, to be fitted to so many rays.
    pub fn fits(&self, rays: usize) -> Fits {
        let Task { lens, path, film_side, .. } = self.task;
        Fits::new(lens, path, film_side.z, &fit_rays(film_side, rays), &self.blocking)
    }

    /// The errors of polynomials.
    ///
    /// # Errors
    /// They are beyond the tolerance, pixels.
    pub fn polynomials(
        &self,
        fit: &Polynomial,
        precision: Precision,
        tolerance: f64,
    ) -> Result<Errors, TooFarOff> {
        match precision {
            Precision::F64 => self.errors_of::<f64>(fit, tolerance),
            Precision::F32 => self.errors_of::<f32>(fit, tolerance),
        }
    }

    fn errors_of<S: KernelScalar>(&self, fit: &Polynomial, tolerance: f64) -> Result<Errors, TooFarOff> {
        let lens = PolynomialLens::<S>::new(fit);
        self.errors(tolerance, |from, to| lens.trace_batch(from, to))
    }

    /// The errors of the exact trace in single precision.
    ///
    /// # Errors
    /// They are beyond the tolerance, pixels.
    pub fn single(&self, tolerance: f64) -> Result<Errors, TooFarOff> {
        let kernel = self.task.kernels.single();
        self.errors(tolerance, |from, to| kernel.trace_batch(from, to))
    }
}

/// The surfaces whose apertures block more of the rays than may be overlooked.
fn blocking(task: &Task<'_>, rays: &Rays, exact: &RayBuffer<f64>) -> Vec<usize> {
    /// Blocked rays looked at, and surfaces that they may meet in all, aspheres counted as what they cost.
    const RAYS: usize = 2000;
    const MEETINGS: usize = 100_000;
    let most = RAYS.min(MEETINGS / cost::in_spheres(task.lens));
    let last = task.lens.surfaces.len() - 1;
    let mut counts: Vec<(usize, usize)> = (0..=last).map(|surface| (0, surface)).collect();
    let blocked = (0..rays.len()).filter(|&i| exact.get(i).is_none());
    let looked_at = blocked.clone().take(most).count();
    for i in blocked.take(most) {
        let walk = task.path.walk(rays.ray(i, task.film_side.z));
        if walk.blocked == Some(Blocked::Clipped) && walk.surfaces_met > 0 {
            counts[last + 1 - walk.surfaces_met].0 += 1;
        }
    }
    // The front's costs nothing to know.
    counts.remove(0);
    counts.sort_unstable();
    let mut overlooked = OVERLOOKED * rays.len() as f64;
    if looked_at == most {
        overlooked = 0.0;
    }
    let mut left_out = 0.0;
    let blocking = counts.into_iter().filter(|&(count, _)| {
        left_out += count as f64;
        count > 0 && left_out > overlooked
    });
    let mut blocking: Vec<usize> = blocking.map(|(_, surface)| surface).collect();
    blocking.reverse();
    blocking.truncate(APERTURES);
    blocking
}

/// Rays to fit polynomials to: denser toward the film's and the pupil's edge, where errors of a fit are
/// largest, as Chebyshev's nodes are.
fn fit_rays(side: &FilmSide, count: usize) -> Vec<Ray> {
    use std::f64::consts::{FRAC_PI_2, TAU};
    (0..count)
        .filter_map(|number| {
            let [h, turn, r, phi] = STEPS.map(|step| (0.5 + (number as f64 + 1.0) * step).fract());
            let polar = |radius: f64, turn: f64| {
                let (sin, cos) = (TAU * turn).sin_cos();
                [radius * cos, radius * sin]
            };
            let point = polar(side.film.reach() * (FRAC_PI_2 * h).sin(), turn);
            let slopes = side.sampler.sample(point, polar((FRAC_PI_2 * r).sin(), phi))?.slopes;
            Some(film_ray(point, side.z, slopes))
        })
        .collect()
}

//! Measures the error of a method of tracing against the exact trace in double precision. The result is [`Errors`]
//! or [`TooFarOff`].
//!
//! **Rays.** A film point and a lens sample together form a point of the four-dimensional unit cube.
//! [`stratified`] divides this cube into equal cells and samples one random point in each: the points are
//! independent, and no part of the film or the pupil is left out. Further sets of rays are traced until
//! enough rays pass the lens.
//!
//! **Error of a ray.** The error is a distance on the film, in pixels
//! ([`ImageScale::film_error`](realistic_trace::image_scale::ImageScale::film_error)); it is infinite if
//! either the lens or its model, but not both, blocks the ray. The errors of the weights are summed
//! separately.
//!
//! **Bound.** An order statistic of the sample bounds the 99.9 % quantile of the errors from above, with
//! known confidence ([`upper_bound`]). A model is rejected as soon as so many rays exceed the tolerance that
//! the bound must exceed it, too.

use std::ops::Range;

use rand_xoshiro::{
    SplitMix64,
    rand_core::{Rng, SeedableRng},
};

use super::{
    cost,
    task::{FilmSide, Precision, Task},
};
use crate::sampling::PupilSample;
use realistic_base::numeric::STEPS;
use realistic_optics::{
    lens::film_ray,
    trace::{Blocked, Ray},
};
use realistic_trace::{
    image_scale::ImageScale,
    kernel::{KernelScalar, LensRays, PlaneRays, RayBuffer},
    polynomial::{Fits, Polynomial, PolynomialLens},
};

/// Measured errors of a method of tracing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Upper bound of the 99.9 % quantile of the rays' errors, pixels.
    pub pixels: f64,
    /// Number of rays compared.
    pub rays: usize,
    /// Number of rays that either the lens or its model, but not both, lets through.
    pub mismatches: usize,
    /// Sum of the absolute errors of the weights, divided by the sum of the weights.
    pub light: f64,
}

/// Number of rays beyond the tolerance at the time when a model was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooFarOff {
    /// Number of rays beyond the tolerance.
    pub beyond: usize,
    /// Number of rays compared until then.
    pub of: usize,
}

impl Errors {
    /// Errors of the reference itself.
    pub(super) const NONE: Self = Self { pixels: 0.0, rays: 0, mismatches: 0, light: 0.0 };
}

/// Number of transmitted rays that suffice for a bound.
const ENOUGH: usize = 9000;
/// Maximum number of sets of rays.
const MOST_SEEDS: usize = 4;
/// Number of rays that a candidate traces before its errors are checked again.
const PART: usize = 1024;
/// Maximum number of apertures that polynomials test besides that of the front surface.
const APERTURES: usize = 4;
/// Fraction of the rays that apertures which are not tested may block.
const OVERLOOKED: f64 = 5e-5;

/// Reason reported if the scale of the image is unknown.
const DARK: &str =
    "the film is dark in the middle, or so little of it lit that the image's scale cannot be measured";

/// Rays at the film and the areas that they represent, as a structure of arrays.
struct EvaluationRays {
    /// x, y, dx/dz, dy/dz.
    columns: [Vec<f64>; 4],
    area: Vec<f64>,
}

impl EvaluationRays {
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

    /// Traces a range of the rays.
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

/// Rays, their exact traces and the image scale, shared by all candidates.
pub(super) struct Evaluation<'a> {
    task: &'a Task<'a>,
    scale: ImageScale,
    rays: EvaluationRays,
    exact: RayBuffer<f64>,
    /// Indices, counted from the scene, of the surfaces other than the front whose apertures block rays.
    pub blocking: Vec<usize>,
}

impl<'a> Evaluation<'a> {
    /// Samples the film and traces its rays.
    ///
    /// # Errors
    /// Returns the reason if nothing can be measured.
    pub fn new(task: &'a Task<'a>) -> Result<Self, String> {
        let side = task.film_side;
        let kernel = task.kernels.double();
        let mut rays = EvaluationRays::with_capacity(CELLS as usize);
        let mut exact = RayBuffer::new(0);
        let (mut seed, mut passing) = (0, 0);
        loop {
            seed += 1;
            let known = rays.len();
            for sample in stratified(seed as u64) {
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
                let share = 100.0 * passing as f64 / f64::from(seed as u32 * CELLS);
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

    /// Returns the errors of a model that traces the rays.
    ///
    /// Returns [`TooFarOff`] as soon as so many rays exceed the tolerance, in pixels, that the bound of the
    /// quantile must exceed it.
    fn errors<S: KernelScalar>(
        &self,
        tolerance: f64,
        trace: impl Fn(&PlaneRays<'_, S>, &mut LensRays<'_, S>),
    ) -> Result<Errors, TooFarOff> {
        let FilmSide { film, z, .. } = self.task.film_side;
        // Single precision rounds the film points, too.
        let rounding = if S::EPSILON > f64::EPSILON { 2.0 * S::EPSILON } else { 0.0 };
        let rounding = rounding * film.reach() / film.pixel();
        // An upper limit, because rays that both block are not counted and the bound's rank grows with the
        // number of rays.
        let too_many = worst(self.rays.len());
        let (mut mismatches, mut light, mut wrong, mut beyond) = (0, 0.0, 0.0, 0);
        let mut errors = Vec::with_capacity(self.rays.len());
        // Traces in parts, so that a poor model is rejected after the first.
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

    /// Prepares fits of polynomials of every order to `rays` rays.
    pub fn fits(&self, rays: usize) -> Fits {
        let Task { lens, path, film_side, .. } = self.task;
        Fits::new(lens, path, film_side.z, &fit_rays(film_side, rays), &self.blocking)
    }

    /// Returns the errors of polynomials.
    ///
    /// # Errors
    /// Returns [`TooFarOff`] if they exceed the tolerance, pixels.
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

    /// Returns the errors of the exact trace in single precision.
    ///
    /// # Errors
    /// Returns [`TooFarOff`] if they exceed the tolerance, pixels.
    pub fn single(&self, tolerance: f64) -> Result<Errors, TooFarOff> {
        let kernel = self.task.kernels.single();
        self.errors(tolerance, |from, to| kernel.trace_batch(from, to))
    }
}

/// Returns the surfaces whose apertures block more rays than may be overlooked.
fn blocking(task: &Task<'_>, rays: &EvaluationRays, exact: &RayBuffer<f64>) -> Vec<usize> {
    /// Maximum number of blocked rays that are traced again, and of surfaces that these rays intersect in
    /// total; an asphere counts as the number of spheres that cost the same.
    const RAYS: usize = 2000;
    const MEETINGS: usize = 100_000;
    let most = RAYS.min(MEETINGS / cost::in_spheres(task.lens));
    let last = task.lens.surfaces.len() - 1;
    let mut counts: Vec<(usize, usize)> = (0..=last).map(|surface| (0, surface)).collect();
    let blocked = (0..rays.len()).filter(|&i| exact.get(i).is_none());
    let retraced = blocked.clone().take(most).count();
    for i in blocked.take(most) {
        let walk = task.path.walk(rays.ray(i, task.film_side.z));
        if walk.blocked == Some(Blocked::Clipped) && walk.surfaces_met > 0 {
            counts[last + 1 - walk.surfaces_met].0 += 1;
        }
    }
    // The clear aperture of the front surface is always tested.
    if task.lens.front().apertures.is_empty() {
        counts.remove(0);
    }
    counts.sort_unstable();
    let mut overlooked = OVERLOOKED * rays.len() as f64;
    if retraced == most {
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

/// Samples rays for a fit. Like Chebyshev nodes, they are denser toward the edges of the film and the pupil,
/// where the errors of a fit are largest.
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
            let slopes = side.sampler.sample(point, polar((FRAC_PI_2 * r).sin(), phi))?.1.slopes;
            Some(film_ray(point, side.z, slopes))
        })
        .collect()
}

/// Number of cells of the unit cube along each of its four axes.
const PER_AXIS: u32 = 11;
/// Total number of cells.
const CELLS: u32 = PER_AXIS * PER_AXIS * PER_AXIS * PER_AXIS;

/// Returns a random point in each cell of the four-dimensional unit cube; another seed returns other points.
fn stratified(seed: u64) -> impl Iterator<Item = [f64; 4]> {
    let mut random = SplitMix64::seed_from_u64(seed);
    let mut unit = move || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    (0..CELLS).map(move |cell| {
        let mut rest = cell;
        [0; 4].map(|_: u8| {
            let along = rest % PER_AXIS;
            rest /= PER_AXIS;
            (f64::from(along) + unit()) / f64::from(PER_AXIS)
        })
    })
}

/// Quantile of the errors that must lie below the tolerance; one ray in a thousand may have a larger error.
pub const QUANTILE: f64 = 0.999;
/// Probability that a bound is too low.
const RISK: f64 = 2e-3;

/// Returns an upper bound of the [`QUANTILE`] of the distribution from which independent samples are drawn;
/// infinity if there are too few samples. The quantile exceeds the bound with a probability of at most 1/500.
/// Reorders the samples.
///
/// The bound is the k-th largest sample. k is the largest number such that, with at most that probability,
/// fewer than k of n samples lie beyond the quantile (H. A. David and H. N. Nagaraja, *Order Statistics*,
/// 2003, §7.1). The number of samples beyond the quantile is binomial. Its lower tail is no heavier than that
/// of a Poisson distribution (T. Anderson and S. Samuels, "Some Inequalities Among Binomial and Poisson
/// Probabilities", 1967), and lighter still for stratified samples (W. Hoeffding, "On the Distribution of the
/// Number of Successes in Independent Trials", 1956).
fn upper_bound(samples: &mut [f64]) -> f64 {
    let Some(from_the_top) = worst(samples.len()).checked_sub(1) else {
        return f64::INFINITY;
    };
    let index = samples.len() - 1 - from_the_top;
    *samples.select_nth_unstable_by(index, f64::total_cmp).1
}

/// Returns the rank k of the bound in [`upper_bound`], counted from the largest sample; 0 if there are too
/// few samples.
fn worst(samples: usize) -> usize {
    rare_counts(samples as f64 * (1.0 - QUANTILE))
}

/// Returns the largest k such that a Poisson variable with this mean is less than k with a probability of at
/// most [`RISK`]: P(fewer than k) = Σ e^-mean mean^i/i! over i < k. The mean must not exceed about 700,
/// because e^-mean underflows beyond.
fn rare_counts(mean: f64) -> usize {
    let (mut term, mut sum, mut k) = ((-mean).exp(), 0.0, 0);
    while sum + term <= RISK {
        sum += term;
        k += 1;
        term *= mean / k as f64;
    }
    k
}

#[cfg(test)]
mod tests {
    use rand_xoshiro::{
        SplitMix64,
        rand_core::{Rng, SeedableRng},
    };

    use super::*;

    #[test]
    fn every_cell_holds_one_point_and_seeds_differ() {
        let cell = |point: [f64; 4]| point.map(|x| (x * f64::from(PER_AXIS)) as u32);
        let mut cells: Vec<_> = stratified(3).map(cell).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), CELLS as usize);
        assert!(stratified(3).zip(stratified(4)).all(|(a, b)| a != b));
    }

    #[test]
    fn the_bound_is_the_order_statistic_of_the_tables() {
        // Poisson's P(fewer than 9 | 20) = 0.00209, P(fewer than 8 | 20) = 0.00078.
        let mut samples: Vec<f64> = (0..20_000).map(f64::from).collect();
        samples.reverse();
        assert_eq!(upper_bound(&mut samples), 19_992.0);
    }

    #[test]
    fn few_samples_bound_nothing() {
        assert_eq!(upper_bound(&mut [0.0; 6000]), f64::INFINITY);
        assert_eq!(upper_bound(&mut []), f64::INFINITY);
    }

    #[test]
    fn the_bound_is_too_low_as_rarely_as_stated() {
        // The quantile of uniform numbers is known.
        let mut random = SplitMix64::seed_from_u64(1);
        let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let too_low = (0..1000)
            .filter(|_| {
                let mut samples: Vec<f64> = (0..9000).map(|_| uniform()).collect();
                upper_bound(&mut samples) < QUANTILE
            })
            .count();
        assert!(too_low <= 8, "{too_low} of 1000");
    }
}

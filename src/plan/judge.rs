//! Rays all over a film and its pupil, and how far a model of the lens is off on them.

use super::{
    choice::{Drawn, Errors, Task},
    quantile::upper_bound,
    strata,
};
use crate::{
    imaging::image_scale::ImageScale,
    numeric::quasirandom::STEPS,
    trace::{
        Blocked, Direction, Path, Ray,
        kernel::{Kernel, LensRays, PlaneRays, Precision, RayArrays},
        polynomial::{Polynomial, PolynomialLens},
    },
};

/// What the weights' errors may sum up to, as a part of the light.
const LIGHT: f64 = 1e-3;
/// Rays that get through which suffice for a bound.
const ENOUGH: usize = 9000;
/// Sets of rays drawn for them at most.
const MOST_SEEDS: usize = 4;
/// Rims that polynomials may decide about besides the front's.
const RIMS: usize = 4;
/// Part of the rays that may be blocked by rims that the polynomials do not know.
const OVERLOOKED: f64 = 5e-5;

/// Rays at the film and what they stand for, as structure of arrays.
#[derive(Default)]
struct Rays {
    /// x, y, dx/dz, dy/dz.
    columns: [Vec<f64>; 4],
    area: Vec<f64>,
}

impl Rays {
    fn push(&mut self, [x, y]: [f64; 2], ([sx, sy], area): Drawn) {
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
        Ray { origin: [x, y, film], direction: [sx, sy, 1.0] }
    }

    fn traced<S: Precision>(
        &self,
        film: f64,
        trace: impl FnOnce(&PlaneRays<'_, S>, &mut LensRays<'_, S>),
    ) -> RayArrays<S> {
        let columns =
            self.columns.each_ref().map(|column| column.iter().map(|&x| S::from_f64(x)).collect::<Vec<S>>());
        let [x, y, slope_x, slope_y] = &columns;
        let mut out = RayArrays::new(self.len());
        trace(&PlaneRays { plane: film, x, y, slope_x, slope_y }, &mut out.rays());
        out
    }
}

/// Everything that the candidates are judged with.
pub(super) struct Judge<'a> {
    task: &'a Task<'a>,
    scale: ImageScale,
    rays: Rays,
    exact: RayArrays<f64>,
    /// Rims other than the front's that block rays, counted from the scene.
    pub rims: Vec<usize>,
}

impl<'a> Judge<'a> {
    /// Why not, where nothing can be told.
    pub fn new(task: &'a Task<'a>) -> Result<Self, String> {
        let scale = ImageScale::new(task.lens, task.film, task.reach, task.in_focus).ok_or(
            "the film is dark in the middle, or so little of it lit that the image's scale cannot be told",
        )?;
        let kernel = Kernel::<f64>::new(task.lens, Direction::FilmToScene);
        let mut rays = Rays::default();
        let mut seed = 0;
        let (exact, passing) = loop {
            seed += 1;
            for numbers in strata::numbers(seed as u64) {
                if let Some((point, disk)) = (task.sample)(numbers)
                    && let Some(drawn) = (task.draw)(point, disk)
                {
                    rays.push(point, drawn);
                }
            }
            let exact = rays.traced(task.film, |from, to| kernel.trace_batch(from, to));
            let passing = (0..rays.len()).filter(|&i| exact.get(i).is_some()).count();
            let hopeless = passing < ENOUGH / MOST_SEEDS;
            if passing >= ENOUGH || hopeless || seed == MOST_SEEDS {
                break (exact, passing);
            }
        };
        if passing < ENOUGH {
            let share = 100.0 * passing as f64 / rays.len() as f64;
            return Err(format!(
                "only {share:.1} % of the rays that are drawn get through, too few to tell; with \"pupil\" \
                 \"warped\" nearly all do"
            ));
        }
        let rims = blocking(task, &rays, &exact);
        Ok(Self { task, scale, rays, exact, rims })
    }

    fn errors<S: Precision>(&self, model: &RayArrays<S>) -> Errors {
        let (mut mismatches, mut light, mut wrong) = (0, 0.0, 0.0);
        let mut errors = Vec::with_capacity(self.rays.len());
        for i in 0..self.rays.len() {
            let (exact, other) = (self.exact.get(i), model.get(i));
            let weight = exact.map_or(0.0, |ray| ray.weight);
            let others = other.map_or(0.0, |ray| ray.weight.to_f64());
            light += weight * self.rays.area[i];
            wrong += (others - weight).abs() * self.rays.area[i];
            match (exact, other) {
                (Some(exact), Some(other)) => {
                    let point = [self.rays.columns[0][i], self.rays.columns[1][i]];
                    let error = self.scale.film_error(point, &exact.ray(), &other.ray()) / self.task.pixel;
                    errors.push(if error.is_nan() { f64::INFINITY } else { error });
                }
                (None, None) => {}
                _ => {
                    mismatches += 1;
                    errors.push(f64::INFINITY);
                }
            }
        }
        // Film points drawn in the model's precision are rounded to it.
        let rounding = if S::EPSILON > f64::EPSILON { 2.0 * S::EPSILON } else { 0.0 };
        let pixels = upper_bound(&mut errors) + rounding * self.task.reach / self.task.pixel;
        Errors { rays: errors.len(), pixels, mismatches, light: wrong / light }
    }

    pub fn is_enough(&self, errors: &Errors) -> bool {
        errors.pixels <= self.task.tolerance && errors.light <= LIGHT
    }

    pub fn polynomials(
        &self,
        order: usize,
        fitted: &[Ray],
        single: bool,
    ) -> Result<(Polynomial, Errors), String> {
        let Task { lens, film, .. } = *self.task;
        let polynomial = Polynomial::with_apertures(lens, film, fitted, order, &self.rims)
            .map_err(|error| error.to_string())?;
        let errors = if single {
            let lens = PolynomialLens::<f32>::new(&polynomial);
            self.errors(&self.rays.traced::<f32>(film, |from, to| lens.trace_batch(from, to)))
        } else {
            let lens = PolynomialLens::<f64>::new(&polynomial);
            self.errors(&self.rays.traced::<f64>(film, |from, to| lens.trace_batch(from, to)))
        };
        Ok((polynomial, errors))
    }

    pub fn single(&self) -> Errors {
        let kernel = Kernel::<f32>::new(self.task.lens, Direction::FilmToScene);
        self.errors(&self.rays.traced::<f32>(self.task.film, |from, to| kernel.trace_batch(from, to)))
    }
}

/// The rims that block more of the rays than may be overlooked.
fn blocking(task: &Task<'_>, rays: &Rays, exact: &RayArrays<f64>) -> Vec<usize> {
    /// Blocked rays looked at.
    const MOST: usize = 2000;
    let path = Path::<f64>::film_to_scene(task.lens);
    let last = task.lens.surfaces.len() - 1;
    let mut counts: Vec<(usize, usize)> = (0..=last).map(|surface| (0, surface)).collect();
    let blocked = (0..rays.len()).filter(|&i| exact.get(i).is_none());
    let looked_at = blocked.clone().take(MOST).count();
    for i in blocked.take(MOST) {
        let walk = path.walk(rays.ray(i, task.film));
        if walk.blocked == Some(Blocked::Clipped) && walk.surfaces_met > 0 {
            counts[last + 1 - walk.surfaces_met].0 += 1;
        }
    }
    // The front's costs nothing to know.
    counts.remove(0);
    counts.sort_unstable();
    let mut overlooked = OVERLOOKED * rays.len() as f64;
    if looked_at == MOST {
        overlooked = 0.0;
    }
    let mut left_out = 0.0;
    let rims = counts.into_iter().filter(|&(count, _)| {
        left_out += count as f64;
        count > 0 && left_out > overlooked
    });
    let mut rims: Vec<usize> = rims.map(|(_, surface)| surface).collect();
    rims.reverse();
    rims.truncate(RIMS);
    rims
}

/// Rays to fit polynomials to: denser toward the film's and the pupil's edge, where errors of a fit are
/// largest, as Chebyshev's nodes are.
pub(super) fn fit_rays(task: &Task<'_>, count: usize) -> Vec<Ray> {
    use std::f64::consts::{FRAC_PI_2, TAU};
    (0..count)
        .filter_map(|number| {
            let [h, turn, r, phi] = STEPS.map(|step| (0.5 + (number as f64 + 1.0) * step).fract());
            let polar = |radius: f64, turn: f64| {
                let (sin, cos) = (TAU * turn).sin_cos();
                [radius * cos, radius * sin]
            };
            let point = polar(task.reach * (FRAC_PI_2 * h).sin(), turn);
            let (slopes, _) = (task.draw)(point, polar((FRAC_PI_2 * r).sin(), phi))?;
            Some(Ray { origin: [point[0], point[1], task.film], direction: [slopes[0], slopes[1], 1.0] })
        })
        .collect()
}

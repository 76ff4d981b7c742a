//! Comparison of the refraction formulas by the number of operations, counted by evaluating each formula on a counting
//! type; by the run time; and by the error against the reference.

use std::cell::Cell;
use std::hint::black_box;
use std::ops::{Add, Div, Mul, Neg, Sub};

use realistic_optics::{
    lens::refraction::{Refraction, fused, heckbert, other, whitted},
    trace::Real,
};

use crate::{
    reference::DoubleDouble,
    results::statistics::quantile,
    subject::quasirandom::spread,
    timing::{Effort, interleaved},
};

/// Operations in one refraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Square roots.
    pub square_roots: u32,
    /// Divisions.
    pub divisions: u32,
    /// Multiplications.
    pub multiplications: u32,
    /// Additions and subtractions.
    pub additions: u32,
}

thread_local! {
    static COUNT: Cell<Operations> = Cell::default();
}

/// A double that counts its operations.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct Counted(f64);

fn count(one: impl FnOnce(&mut Operations)) {
    COUNT.with(|cell| {
        let mut operations = cell.get();
        one(&mut operations);
        cell.set(operations);
    });
}

macro_rules! counted {
    ($($trait:ident $method:ident $member:ident),*) => {$(
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                count(|operations| operations.$member += 1);
                Self($trait::$method(self.0, other.0))
            }
        }
    )*};
}

counted!(Add add additions, Sub sub additions, Mul mul multiplications, Div div divisions);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for Counted {
    const ZERO: Self = Self(0.0);
    const ONE: Self = Self(1.0);
    const EPSILON: f64 = f64::EPSILON;
    fn from_f64(number: f64) -> Self {
        Self(number)
    }
    fn to_f64(self) -> f64 {
        self.0
    }
    fn sqrt(self) -> Self {
        count(|operations| operations.square_roots += 1);
        Self(self.0.sqrt())
    }
}

/// A ray at a surface: unit direction, unit normal on the side ahead, and the two indices.
#[derive(Clone, Copy, Debug)]
struct Incidence<R> {
    direction: [R; 3],
    normal: [R; 3],
    n: R,
    n_after: R,
}

impl Incidence<f64> {
    fn to<R: Real>(self) -> Incidence<R> {
        Incidence {
            direction: self.direction.map(R::from_f64),
            normal: self.normal.map(R::from_f64),
            n: R::from_f64(self.n),
            n_after: R::from_f64(self.n_after),
        }
    }
}

impl<R: Real> Incidence<R> {
    /// Returns the method's input vector: the direction, or n times the direction for the fused form.
    fn start(&self, method: Refraction) -> [R; 3] {
        match method {
            Refraction::Fused => self.direction.map(|d| self.n * d),
            Refraction::Heckbert | Refraction::Whitted | Refraction::Other => self.direction,
        }
    }

    /// Refracts once, from the method's input vector to its output vector. `index_step` is a constant of the
    /// surface.
    fn refract(&self, method: Refraction, start: [R; 3], index_step: R) -> [R; 3] {
        match method {
            Refraction::Fused => {
                let [x, y, z] = [0, 1, 2].map(|i| self.normal[i] * start[i]);
                fused(start, self.normal, x + y + z, index_step)
            }
            Refraction::Heckbert => heckbert(start, self.normal, self.n, self.n_after),
            Refraction::Whitted => whitted(start, self.normal, self.n, self.n_after),
            Refraction::Other => other(start, self.normal, self.n, self.n_after),
        }
    }

    fn index_step(&self) -> R {
        (self.n_after - self.n) * (self.n_after + self.n)
    }

    /// Returns the unit direction after refraction, in double-double numbers.
    fn direction_after(&self, method: Refraction) -> [DoubleDouble; 3] {
        let after = self.refract(method, self.start(method), self.index_step());
        let wide = after.map(|part| DoubleDouble::from_f64(part.to_f64()));
        match method {
            Refraction::Fused => wide.map(|part| part / DoubleDouble::from_f64(self.n_after.to_f64())),
            Refraction::Heckbert | Refraction::Whitted | Refraction::Other => wide,
        }
    }
}

/// Counts the operations of one refraction by a method. The fused form receives V = n D and n'² - n²
/// precomputed, as in a trace.
pub fn operations(method: Refraction) -> Operations {
    let incidence = EXAMPLE.to::<Counted>();
    let (start, index_step) = (incidence.start(method), incidence.index_step());
    COUNT.set(Operations::default());
    incidence.refract(method, start, index_step);
    COUNT.take()
}

const EXAMPLE: Incidence<f64> =
    Incidence { direction: [0.36, 0.48, 0.8], normal: [0.0, 0.0, 1.0], n: 1.0, n_after: 1.5 };

/// Errors of a method's direction, rad, over many incidences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// The median.
    pub median: f64,
    /// The largest.
    pub largest: f64,
}

/// Incidences in the error statistics.
const INCIDENCES: usize = 4000;

/// Returns the errors of a method in number type `R`, relative to the same refraction in double-double numbers. The
/// angles of incidence are at most 60 degrees and short of total reflection; the indices are from 1 to 2.
pub fn errors<R: Real>(method: Refraction) -> Errors {
    let errors: Vec<f64> = incidences()
        .map(|incidence| {
            // The reference starts from the same rounded input as the method.
            let given = incidence.to::<R>();
            let exact = Incidence::<DoubleDouble> {
                direction: given.direction.map(widen),
                normal: given.normal.map(widen),
                n: widen(given.n),
                n_after: widen(given.n_after),
            };
            let truth = exact.refract(Refraction::Fused, exact.start(Refraction::Fused), exact.index_step());
            let truth = truth.map(|part| part / exact.n_after);
            let got = given.direction_after(method);
            (0..3).map(|i| (got[i] - truth[i]).to_f64().powi(2)).sum::<f64>().sqrt()
        })
        .collect();
    Errors { median: quantile(&errors, 0.5), largest: quantile(&errors, 1.0) }
}

fn widen<R: Real>(number: R) -> DoubleDouble {
    DoubleDouble::from_f64(number.to_f64())
}

/// Returns incidences that are nearly evenly spread and the same in every run.
fn incidences() -> impl Iterator<Item = Incidence<f64>> {
    spread::<4>(0.0).take(INCIDENCES).map(|[n, n_after, height, turn]| {
        let (n, n_after) = (1.0 + n, 1.0 + n_after);
        let sine = (n_after / n).min(1.0) * 0.866 * height;
        let (s, c) = (std::f64::consts::TAU * turn).sin_cos();
        let direction = [sine * s, sine * c, (1.0 - sine * sine).sqrt()];
        Incidence { direction, normal: [0.0, 0.0, 1.0], n, n_after }
    })
}

/// Refractions in a chain, in which each starts from the result of the previous one.
const CHAIN: u32 = 64;

/// Returns the latency of one refraction in double precision, seconds, when each refraction waits for the previous one;
/// the methods are in the order of [`Refraction::NAMES`].
pub fn times(effort: Effort) -> Vec<f64> {
    let chain = |method: Refraction| {
        move || {
            let mut there = black_box(EXAMPLE);
            // The ray returns from the other side of the surface, so that the chain can go on indefinitely.
            let back = Incidence { n: there.n_after, n_after: there.n, ..there };
            let steps = [there.index_step(), back.index_step()];
            there.direction = there.start(method);
            for _ in 0..CHAIN / 2 {
                there.direction = there.refract(method, there.direction, steps[0]);
                there.direction = back.refract(method, there.direction, steps[1]);
            }
            black_box(there.direction);
        }
    };
    let tasks = Refraction::NAMES.iter().map(|&(_, method)| Box::new(chain(method)) as Box<dyn FnMut()>);
    interleaved(tasks, effort).iter().map(|timing| timing.median / f64::from(CHAIN)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_counts_are_those_of_the_published_comparison() {
        // Square roots, divisions, multiplications and additions, as in the lecture's table.
        for (method, expected) in [
            (Refraction::Whitted, [2, 8, 17, 15]),
            (Refraction::Heckbert, [1, 1, 13, 8]),
            (Refraction::Other, [1, 4, 8, 8]),
        ] {
            let Operations { square_roots, divisions, multiplications, additions } = operations(method);
            assert_eq!([square_roots, divisions, multiplications, additions], expected, "{method:?}");
        }
        let fused = operations(Refraction::Fused);
        assert_eq!((fused.square_roots, fused.divisions), (1, 1));
    }

    #[test]
    fn every_method_is_as_exact_as_its_arithmetic() {
        for (name, method) in Refraction::NAMES {
            let (double, single) = (errors::<f64>(method), errors::<f32>(method));
            assert!(double.largest < 8.0 * f64::EPSILON, "{name}: {double:?}");
            assert!(single.largest < 8.0 * f64::from(f32::EPSILON), "{name}: {single:?}");
            assert!(double.median > 0.0 && single.median > 1e3 * double.median, "{name}");
        }
    }

    #[test]
    fn every_method_gets_a_time() {
        let effort = Effort { rounds: 1, least: Duration::from_micros(20) };
        let times = times(effort);
        assert_eq!(times.len(), Refraction::NAMES.len());
        assert!(times.iter().all(|&time| time > 0.0));
    }
}

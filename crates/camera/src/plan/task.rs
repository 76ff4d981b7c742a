//! Types of the input and output of a plan.
//!
//! The input is a [`Task`]: a lens, the film behind it, the sampling of its pupil, and the tolerated error.
//! The output is a [`Tracing`], the method of tracing rays through the lens. The type is defined here, the
//! plan chooses its value, and a camera matches on it once, where it compiles its tracers.

use std::{cell::OnceCell, fmt};

use crate::sampling::{DiskMapping, PupilSample, PupilSampler, film::Film};
use realistic_optics::{
    lens::{Lens, refraction::Refraction},
    trace::Path,
};
use realistic_trace::kernel::Kernel;

/// The film, and the sampling of rays from it.
#[derive(Clone, Debug)]
pub struct FilmSide {
    /// The film.
    pub film: Film,
    /// z of the film, lens space, mm.
    pub z: f64,
    /// Maps lens samples (u, v) to the unit disk.
    pub mapping: DiskMapping,
    /// Maps the unit disk to slopes.
    pub sampler: PupilSampler,
}

/// The whole lens from film to scene, compiled once in each requested precision.
pub struct Kernels<'a> {
    path: &'a Path,
    double: OnceCell<Kernel<f64>>,
    single: OnceCell<Kernel<f32>>,
}

impl<'a> Kernels<'a> {
    /// Returns the kernels of the lens from film to scene; nothing is compiled yet.
    pub fn new(path: &'a Path) -> Self {
        Self { path, double: OnceCell::new(), single: OnceCell::new() }
    }

    /// Returns the kernel in double precision.
    pub fn double(&self) -> &Kernel<f64> {
        self.double.get_or_init(|| Kernel::along(self.path))
    }

    /// Returns the kernel in single precision.
    pub fn single(&self) -> &Kernel<f32> {
        self.single.get_or_init(|| Kernel::along(self.path))
    }
}

/// Input of a plan.
pub struct Task<'a> {
    /// The lens.
    pub lens: &'a Lens,
    /// The path through the lens from film to scene, with the method `refraction`.
    pub path: &'a Path,
    /// The compiled kernels of `path`.
    pub kernels: &'a Kernels<'a>,
    /// The film and its sampling.
    pub film_side: &'a FilmSide,
    /// z of the plane in focus, lens space, mm; may be infinite.
    pub in_focus: f64,
    /// The requested method of refraction.
    pub refraction: Refraction,
    /// The requested precision; `None` leaves it to the tolerance.
    pub precision: Option<Precision>,
    /// The tolerated error, pixels; 0 if no error is tolerated.
    pub tolerance: f64,
    /// Whether anything may be left out.
    pub leave_out: bool,
    /// Whether rays carry their light from surface to surface; if so, polynomials cannot replace the
    /// surfaces.
    pub carries_light: bool,
}

impl FilmSide {
    /// Maps four numbers in [0, 1] to a ray: the point where the ray crosses the plane through the film's
    /// centre perpendicular to the axis, mm, and the ray's pupil sample; `None` if there is no such sample.
    pub fn sample(&self, [x, y, u, v]: [f64; 4]) -> Option<([f64; 2], PupilSample)> {
        let half = self.film.half_size();
        let [right, up] = self.film.sampled_center();
        let point = [(1.0 - 2.0 * x) * half[0] + right, (1.0 - 2.0 * y) * -half[1] + up];
        self.sampler.sample(point, self.mapping.map(u, v)?)
    }
}

/// Precision in which rays are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Double precision.
    F64,
    /// Single precision.
    F32,
}

impl Precision {
    /// Names that a parameter may have; `None` leaves the precision to the plan. A precision is written as
    /// the first of its names.
    pub const NAMES: [(&'static str, Option<Self>); 5] = [
        ("auto", None),
        ("f64", Some(Self::F64)),
        ("f32", Some(Self::F32)),
        ("double", Some(Self::F64)),
        ("single", Some(Self::F32)),
    ];
}

/// The kind of call; it does not depend on the number of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// A call for one ray, or for one ray and its differentials.
    One,
    /// A call for many rays.
    Many,
}

impl Entry {
    /// Both kinds of call.
    pub const ALL: [Self; 2] = [Self::One, Self::Many];
}

/// Writes the kind of call in the words of a plan.
impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::One => "one by one",
            Self::Many => "in batches",
        })
    }
}

/// A method of tracing rays through a lens. `Fit` is the type of the fitted polynomials; a candidate has not
/// been fitted yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tracing<Fit = ()> {
    /// Intersection with every surface, by the compiled kernel.
    Exact(Precision),
    /// Polynomials for the whole lens.
    Polynomials {
        /// Order, an odd number; order 1 is the thick lens.
        order: usize,
        /// Precision of the evaluation.
        precision: Precision,
        /// Coefficients.
        fit: Fit,
    },
    /// Surface by surface with a named method of refraction, one ray at a time.
    Refracted(Refraction, Precision),
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let own = Self::NAMES.iter().find(|(_, precision)| *precision == Some(*self));
        f.pad(own.map_or("", |(name, _)| name))
    }
}

/// Writes the name that reports use.
impl<Fit> fmt::Display for Tracing<Fit> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self {
            Self::Exact(precision) => format!("exact, {precision}"),
            Self::Polynomials { order: 1, precision, .. } => format!("thick lens, {precision}"),
            Self::Polynomials { order, precision, .. } => {
                format!("polynomials of order {order}, {precision}")
            }
            Self::Refracted(refraction, precision) => format!("{refraction:?}, {precision}"),
        };
        f.pad(&name)
    }
}

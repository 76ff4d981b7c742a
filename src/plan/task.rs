//! What goes into a plan and what comes out of it.
//!
//! In goes a [`Task`]: a lens, the film behind it, how its pupil is sampled, and the error that is tolerated. Out comes a
//! [`Tracing`], how rays are taken through the lens: defined here, chosen by the plan, and matched once, where a camera
//! compiles what traces its rays.

use std::{cell::OnceCell, fmt};

use crate::{
    lens::{Lens, refraction::Refraction},
    sampling::{DiskMapping, PupilSample, PupilSampler, film::Film},
    trace::{Path, kernel::Kernel},
};

/// Where rays begin and how they are sampled.
#[derive(Clone, Debug)]
pub(crate) struct FilmSide {
    /// The film.
    pub film: Film,
    /// Its z, lens space, mm.
    pub z: f64,
    /// From lens samples to the unit disk.
    pub mapping: DiskMapping,
    /// From the unit disk to slopes.
    pub sampler: PupilSampler,
}

/// The whole lens from film to scene, compiled once in each precision that is asked for.
pub(crate) struct Kernels<'a> {
    path: &'a Path,
    double: OnceCell<Kernel<f64>>,
    single: OnceCell<Kernel<f32>>,
}

impl<'a> Kernels<'a> {
    /// Of the lens from film to scene; nothing is compiled yet.
    pub fn new(path: &'a Path) -> Self {
        Self { path, double: OnceCell::new(), single: OnceCell::new() }
    }

    /// In double precision.
    pub fn double(&self) -> &Kernel<f64> {
        self.double.get_or_init(|| Kernel::along(self.path))
    }

    /// In single precision.
    pub fn single(&self) -> &Kernel<f32> {
        self.single.get_or_init(|| Kernel::along(self.path))
    }
}

/// What rays are wanted for.
pub(crate) struct Task<'a> {
    /// The lens.
    pub lens: &'a Lens,
    /// The lens from film to scene, by `refraction`.
    pub path: &'a Path,
    /// The same, compiled.
    pub kernels: &'a Kernels<'a>,
    /// The film's side.
    pub film_side: &'a FilmSide,
    /// z of the plane in focus, lens space, mm; may be infinite.
    pub in_focus: f64,
    /// The method of refraction asked for.
    pub refraction: Refraction,
    /// The precision asked for; `None` leaves it to the tolerance.
    pub precision: Option<Precision>,
    /// The error that is tolerated, pixels; 0 for none.
    pub tolerance: f64,
    /// Whether anything may be left out.
    pub leave_out: bool,
}

impl FilmSide {
    /// The film point, mm, and the pupil sample that four numbers in [0, 1] stand for; `None` where there is none.
    pub fn sample(&self, [x, y, u, v]: [f64; 4]) -> Option<([f64; 2], PupilSample)> {
        let corner = self.film.point(0.0, 0.0);
        let point = [(1.0 - 2.0 * x) * corner[0], (1.0 - 2.0 * y) * corner[1]];
        let sample = self.sampler.sample(point, self.mapping.map(u, v)?)?;
        Some((point, sample))
    }
}

/// What rays are computed in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Double precision.
    F64,
    /// Single precision.
    F32,
}

impl Precision {
    /// What may be asked for, by name; `None` leaves the precision to the plan. A precision is written by its first name.
    pub const NAMES: [(&'static str, Option<Self>); 5] = [
        ("auto", None),
        ("f64", Some(Self::F64)),
        ("f32", Some(Self::F32)),
        ("double", Some(Self::F64)),
        ("single", Some(Self::F32)),
    ];
}

/// How rays are asked for: the call, not their number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// By a call for one ray, or for one and its differentials.
    One,
    /// By a call for many.
    Many,
}

impl Entry {
    /// Each of them.
    pub const ALL: [Self; 2] = [Self::One, Self::Many];
}

/// In the words of a plan.
impl fmt::Display for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::One => "one by one",
            Self::Many => "in batches",
        })
    }
}

/// A way to take rays through a lens. `Fit` is what polynomials are once they are fitted; a candidate has none yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tracing<Fit = ()> {
    /// Every surface, by the compiled kernel.
    Exact(Precision),
    /// The whole lens by polynomials.
    Polynomials {
        /// Their order: odd; of order 1, the thick lens.
        order: usize,
        /// What they are evaluated in.
        precision: Precision,
        /// Their coefficients.
        fit: Fit,
    },
    /// Surface after surface by a named method of refraction, one ray at a time.
    Refracted(Refraction, Precision),
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let own = Self::NAMES.iter().find(|(_, precision)| *precision == Some(*self));
        f.pad(own.map_or("", |(name, _)| name))
    }
}

/// Its name, as reports have it.
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

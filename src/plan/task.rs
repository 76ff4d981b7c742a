//! What a plan is made for: a lens, the film behind it, where its pupil is sampled, and the error that is tolerated.

use std::cell::OnceCell;

use super::tracing::Precision;
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

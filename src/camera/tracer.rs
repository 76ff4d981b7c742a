//! The lens as a camera traces it: compiled for speed, or walked where a method of refraction is named.

use super::irradiance::{cos4, film_ray};
use crate::{
    optics::{Lens, refraction::Refraction},
    trace::{
        Blocked, Direction, Path, Ray, Real,
        kernel::{Kernel, LensRays, PlaneRays, Precision, Traced},
    },
};

/// A lens for rays from the film in the precision and by the refraction asked for.
#[derive(Clone, Debug)]
pub(super) enum Tracer {
    Double(Kernel<f64>),
    Single(Kernel<f32>),
    Walk(Path<f64>),
    WalkSingle(Path<f32>),
}

impl Tracer {
    /// Makes a lens ready. The library's own refraction is the kernel's; any other is walked.
    pub fn new(lens: &Lens, refraction: Refraction, single: bool) -> Self {
        let direction = Direction::FilmToScene;
        match (refraction, single) {
            (Refraction::Fused, false) => Self::Double(Kernel::new(lens, direction)),
            (Refraction::Fused, true) => Self::Single(Kernel::new(lens, direction)),
            (_, false) => Self::Walk(Path::new(lens, direction, refraction)),
            (_, true) => Self::WalkSingle(Path::new(lens, direction, refraction)),
        }
    }

    /// The ray from a point of the film at z = `film` with the given slopes.
    #[inline]
    pub fn one(&self, film: f64, point: [f64; 2], slopes: [f64; 2]) -> Option<Traced<f64>> {
        match self {
            Self::Double(kernel) => kernel.trace_one(film, point, slopes),
            Self::Single(kernel) => kernel.trace_one(film, narrow(point), narrow(slopes)).map(widen),
            Self::Walk(path) => walk(path, film, point, slopes),
            Self::WalkSingle(path) => walk(path, film, point, slopes),
        }
    }

    /// Three rays in little more than the time of one.
    #[inline]
    pub fn three(&self, film: f64, points: [[f64; 2]; 3], slopes: [[f64; 2]; 3]) -> [Option<Traced<f64>>; 3] {
        match self {
            Self::Double(kernel) => kernel.trace_triple(film, points, slopes),
            Self::Single(kernel) => kernel
                .trace_triple(film, points.map(narrow), slopes.map(narrow))
                .map(|traced| traced.map(widen)),
            Self::Walk(_) | Self::WalkSingle(_) => {
                std::array::from_fn(|i| self.one(film, points[i], slopes[i]))
            }
        }
    }

    /// Why a ray that does not get through is blocked.
    pub fn reason(&self, film: f64, point: [f64; 2], slopes: [f64; 2]) -> Blocked {
        let ray = film_ray(point, film, slopes);
        match self {
            Self::Double(kernel) => kernel.reason(ray),
            Self::Single(kernel) => kernel.reason(ray),
            Self::Walk(path) => path.trace(ray).err().unwrap_or(Blocked::Clipped),
            Self::WalkSingle(path) => path.trace(ray).err().unwrap_or(Blocked::Clipped),
        }
    }
}

fn narrow(pair: [f64; 2]) -> [f32; 2] {
    pair.map(|number| number as f32)
}

fn widen(traced: Traced<f32>) -> Traced<f64> {
    let Traced { origin, direction, weight } = traced;
    Traced { origin: origin.map(f64::from), direction: direction.map(f64::from), weight: weight.into() }
}

fn walk<R: Real>(path: &Path<R>, film: f64, point: [f64; 2], slopes: [f64; 2]) -> Option<Traced<f64>> {
    let Ray { origin, direction } = path.trace(film_ray(point, film, slopes)).ok()?;
    // However small, the weight of a ray that passes is not that of a blocked one.
    Some(Traced { origin, direction, weight: cos4(slopes).max(f64::MIN_POSITIVE) })
}

/// The film rays of a block of `N`, and what becomes of them, as structure of arrays.
pub(super) struct Bundle<S, const N: usize> {
    pub point: [[S; N]; 2],
    pub slopes: [[S; N]; 2],
    pub origin: [[S; N]; 3],
    pub direction: [[S; N]; 3],
    /// cos⁴ before the lens; 0 for a blocked ray.
    pub weight: [S; N],
}

impl<S: Real + Precision, const N: usize> Bundle<S, N> {
    pub fn new() -> Self {
        let zero = [<S as Real>::ZERO; N];
        Self { point: [zero; 2], slopes: [zero; 2], origin: [zero; 3], direction: [zero; 3], weight: zero }
    }

    /// Traces the first `n` rays.
    pub fn trace(&mut self, kernel: &Kernel<S>, film: f64, n: usize) {
        let [x, y] = &self.point;
        let [slope_x, slope_y] = &self.slopes;
        let from =
            PlaneRays { plane: film, x: &x[..n], y: &y[..n], slope_x: &slope_x[..n], slope_y: &slope_y[..n] };
        let mut to = LensRays {
            origin: self.origin.each_mut().map(|array| &mut array[..n]),
            direction: self.direction.each_mut().map(|array| &mut array[..n]),
            weight: &mut self.weight[..n],
        };
        kernel.trace_batch(&from, &mut to);
    }
}

//! Methods applied to a block of rays of a [`Subject`]. Each method holds the block in its own form; it is prepared
//! once, and runs as often as the timing needs.

use realistic_optics::{
    lens::{first_order::FirstOrder, refraction::Refraction},
    trace::{Direction, Path, Ray, Real},
};
use realistic_simd::Simd;
use realistic_trace::{
    kernel::{Kernel, KernelScalar, LensRays, PlaneRays, Traced},
    polynomial::{Polynomial, PolynomialLens},
};

use super::list::{Algorithm, Method, Number};
use crate::{
    BLOCK,
    reference::DoubleDouble,
    subject::{FilmRays, Subject},
};

/// A method prepared for a block of rays.
pub trait Runner {
    /// Traces the whole block through the lens.
    fn run(&mut self);
    /// Returns a ray of the last run; `None` if it was blocked.
    fn ray(&self, index: usize) -> Option<Ray>;
}

/// A method prepared for a block of rays; `None` if the processor lacks the instructions, `REALISTIC_SIMD` disables
/// them, or the method does not apply to rays from a film.
pub type Prepared = Option<Box<dyn Runner>>;

/// Prepares a method for a block of rays. Polynomials test the given apertures, numbered from the scene; first-order
/// optics tests no apertures.
pub fn prepare(method: &Method, subject: &Subject, apertures: &[usize], rays: &[Ray]) -> Prepared {
    match (method.number, method.algorithm) {
        (Number::F32, algorithm) => prepare_in::<f32>(algorithm, subject, apertures, rays),
        (Number::DoubleDouble, Algorithm::Walk(refraction)) => {
            walk::<DoubleDouble>(subject, rays, refraction)
        }
        (_, algorithm) => prepare_in::<f64>(algorithm, subject, apertures, rays),
    }
}

fn prepare_in<S: KernelScalar + Real + 'static>(
    algorithm: Algorithm,
    subject: &Subject,
    apertures: &[usize],
    rays: &[Ray],
) -> Prepared {
    let optics = subject.first_order;
    match algorithm {
        Algorithm::Walk(refraction) => walk::<S>(subject, rays, refraction),
        Algorithm::ThinLens => first_order(optics.thin_at(optics.rear_principal_plane), rays),
        Algorithm::ThickLens => first_order(optics, rays),
        Algorithm::Polynomial(order) => polynomial::<S>(subject, rays, &subject.fit(order, apertures)),
        Algorithm::PolynomialBatch(order) => polynomials::<S>(subject, rays, &subject.fit(order, apertures)),
        Algorithm::One => one::<S>(subject, rays),
        Algorithm::Three => three::<S>(subject, rays),
        Algorithm::Batch(simd) => kernels::<S>(subject, rays, simd),
        // `Widest` is another name for one of the batches; `Anywhere` does not trace rays from a film.
        Algorithm::Widest | Algorithm::Anywhere => None,
    }
}

/// A function that maps `N` rays at once from the method's input form to its output form, applied to a block.
struct Groups<const N: usize, I, O, F> {
    map: F,
    rays: Vec<[I; N]>,
    out: Vec<[Option<O>; N]>,
    read: fn(&O) -> Ray,
}

impl<const N: usize, I: Copy, O, F: Fn([I; N]) -> [Option<O>; N]> Runner for Groups<N, I, O, F> {
    fn run(&mut self) {
        for (rays, out) in self.rays.iter().zip(&mut self.out) {
            *out = (self.map)(*rays);
        }
    }

    fn ray(&self, index: usize) -> Option<Ray> {
        self.out[index / N][index % N].as_ref().map(self.read)
    }
}

/// Builds a map of `N` rays for a block; the last group is padded with the last ray.
fn groups<const N: usize, I: Copy + 'static, O: 'static>(
    rays: &[I],
    map: impl Fn([I; N]) -> [Option<O>; N] + 'static,
    read: fn(&O) -> Ray,
) -> Prepared {
    let group = |part: &[I]| std::array::from_fn(|i| part[i.min(part.len() - 1)]);
    let rays: Vec<[I; N]> = rays.chunks(N).map(group).collect();
    let out = rays.iter().map(|_| std::array::from_fn(|_| None)).collect();
    Some(Box::new(Groups { map, rays, out, read }))
}

fn first_order(lens: FirstOrder, rays: &[Ray]) -> Prepared {
    groups(rays, move |[ray]| [Some(lens.transfer(ray))], |ray| *ray)
}

fn walk<R: Real + 'static>(subject: &Subject, rays: &[Ray], refraction: Refraction) -> Prepared {
    let path = Path::<R>::new(&subject.lens, Direction::FilmToScene, refraction);
    groups(rays, move |[ray]| [path.trace(ray).ok()], |ray| *ray)
}

/// Returns rays in the kernels' form for a film: point and slopes.
fn at_film<S: Real>(subject: &Subject, rays: &[Ray]) -> Vec<([S; 2], [S; 2])> {
    let film_rays = FilmRays::new(subject.film_z, rays);
    (0..rays.len()).map(|i| film_rays.at_film(i)).collect()
}

fn one<S: KernelScalar + Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    let (kernel, plane) = (Kernel::<S>::new(&subject.lens, Direction::FilmToScene), subject.film_z);
    let trace = move |[(point, slopes)]: [([S; 2], [S; 2]); 1]| [kernel.trace_one(plane, point, slopes)];
    groups(&at_film(subject, rays), trace, Traced::ray)
}

/// Prepares the trace of a ray together with its two differentials.
fn three<S: KernelScalar + Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    let (kernel, plane) = (Kernel::<S>::new(&subject.lens, Direction::FilmToScene), subject.film_z);
    let trace = move |three: [([S; 2], [S; 2]); 3]| {
        kernel.trace_triple(plane, three.map(|ray| ray.0), three.map(|ray| ray.1))
    };
    groups(&at_film(subject, rays), trace, Traced::ray)
}

fn polynomial<S: KernelScalar + Real + 'static>(
    subject: &Subject,
    rays: &[Ray],
    fit: &Polynomial,
) -> Prepared {
    let lens = PolynomialLens::<S>::new(fit);
    let trace = move |[(point, slopes)]: [([S; 2], [S; 2]); 1]| [lens.trace_one(point, slopes)];
    groups(&at_film(subject, rays), trace, Traced::ray)
}

/// A method that traces many rays per call.
struct Batches<S, F> {
    trace: F,
    rays: FilmRays<S>,
}

impl<S: Real, F: Fn(&PlaneRays<'_, S>, &mut LensRays<'_, S>)> Runner for Batches<S, F> {
    fn run(&mut self) {
        self.rays.trace(BLOCK, &self.trace);
    }

    fn ray(&self, index: usize) -> Option<Ray> {
        self.rays.traced(index)
    }
}

fn kernels<S: KernelScalar + Real + 'static>(subject: &Subject, rays: &[Ray], simd: Simd) -> Prepared {
    // Instructions that `REALISTIC_SIMD` disables are omitted, as everywhere in the laboratory.
    let allowed = (simd <= Simd::best()).then_some(simd)?;
    let kernel = Kernel::<S>::with_simd(&subject.lens, Direction::FilmToScene, allowed)?;
    let trace = move |from: &PlaneRays<'_, S>, to: &mut LensRays<'_, S>| kernel.trace_batch(from, to);
    Some(Box::new(Batches { trace, rays: FilmRays::new(subject.film_z, rays) }))
}

fn polynomials<S: KernelScalar + Real + 'static>(
    subject: &Subject,
    rays: &[Ray],
    fit: &Polynomial,
) -> Prepared {
    let lens = PolynomialLens::<S>::new(fit);
    let trace = move |from: &PlaneRays<'_, S>, to: &mut LensRays<'_, S>| lens.trace_batch(from, to);
    Some(Box::new(Batches { trace, rays: FilmRays::new(subject.film_z, rays) }))
}

//! The ways to take rays through a lens that are compared: first-order optics, polynomials, the compiled kernels in
//! every instance, and the walk with each refraction. Each is made ready for a block of rays of a [`Subject`],
//! which it holds in a form of its own, and is then run as often as its time needs.

use realistic::{
    lens::{first_order::FirstOrder, refraction::Refraction},
    trace::{
        Direction, Path, Ray, Real,
        kernel::{Kernel, KernelScalar, LensRays, PlaneRays, Simd, Traced},
        polynomial::PolynomialLens,
    },
};

use crate::{
    BLOCK,
    reference::DoubleDouble,
    subject::{FilmRays, Subject},
};

/// What kind of map a method is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// First-order optics.
    Gaussian,
    /// Polynomials, one ray at a time.
    Polynomial,
    /// Polynomials, many rays at once.
    PolynomialBatch,
    /// The compiled kernels: one ray or three.
    Kernel,
    /// The compiled kernels in batches.
    KernelBatch,
    /// Every surface, with any of the lecture's refractions, and the reference.
    Walk,
}

impl Family {
    /// Every family with its name.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("first-order optics", Self::Gaussian),
        ("polynomials", Self::Polynomial),
        ("polynomials in batches", Self::PolynomialBatch),
        ("kernel, single rays", Self::Kernel),
        ("kernel in batches", Self::KernelBatch),
        ("walk", Self::Walk),
    ];

    /// The name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, family)| *family == self).map_or("", |(name, _)| name)
    }

    /// Whether it needs many rays at once.
    pub fn in_batches(self) -> bool {
        matches!(self, Self::PolynomialBatch | Self::KernelBatch)
    }
}

/// A method at work on a block of rays.
pub trait Runner {
    /// Takes the whole block through the lens.
    fn run(&mut self);
    /// A ray of the last run, if it got through.
    fn ray(&self, index: usize) -> Option<Ray>;
}

/// A method ready for a block of rays; `None` where the processor lacks the instructions.
pub type Prepared = Option<Box<dyn Runner>>;

/// A way to take rays through a lens.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Short name.
    pub name: &'static str,
    /// What kind it is.
    pub family: Family,
    /// Makes it ready for a block of rays.
    pub prepare: fn(&Subject, &[Ray]) -> Prepared,
}

const fn method(name: &'static str, family: Family, prepare: fn(&Subject, &[Ray]) -> Prepared) -> Method {
    Method { name, family, prepare }
}

/// Every method that is compared; the first is the exact walk, which all others are timed against.
pub const METHODS: &[Method] = &[
    YARDSTICK,
    method("walk f32", Family::Walk, |s, r| walk::<f32>(s, r, Refraction::Fused)),
    method("heckbert", Family::Walk, |s, r| walk::<f64>(s, r, Refraction::Heckbert)),
    method("whitted", Family::Walk, |s, r| walk::<f64>(s, r, Refraction::Whitted)),
    method("other", Family::Walk, |s, r| walk::<f64>(s, r, Refraction::Other)),
    method("reference", Family::Walk, |s, r| walk::<DoubleDouble>(s, r, Refraction::Fused)),
    // The thick lens with both principal planes where the film's is.
    method("thin lens", Family::Gaussian, |s, r| {
        first_order(s.first_order.thin_at(s.first_order.rear_principal_plane), r)
    }),
    method("thick lens", Family::Gaussian, |s, r| first_order(s.first_order, r)),
    method("order 3", Family::Polynomial, |s, r| polynomial(s, r, 3)),
    method("order 5", Family::Polynomial, |s, r| polynomial(s, r, 5)),
    method("order 7", Family::Polynomial, |s, r| polynomial(s, r, 7)),
    method("order 9", Family::Polynomial, |s, r| polynomial(s, r, 9)),
    method("order 11", Family::Polynomial, |s, r| polynomial(s, r, 11)),
    method("order 3, f32", Family::PolynomialBatch, |s, r| polynomials::<f32>(s, r, 3)),
    method("order 5, f32", Family::PolynomialBatch, |s, r| polynomials::<f32>(s, r, 5)),
    method("order 7, f32", Family::PolynomialBatch, |s, r| polynomials::<f32>(s, r, 7)),
    method("order 9, f32", Family::PolynomialBatch, |s, r| polynomials::<f32>(s, r, 9)),
    method("order 11, f32", Family::PolynomialBatch, |s, r| polynomials::<f32>(s, r, 11)),
    method("order 11, f64", Family::PolynomialBatch, |s, r| polynomials::<f64>(s, r, 11)),
    method("one f32", Family::Kernel, one::<f32>),
    method("one f64", Family::Kernel, one::<f64>),
    method("three f32", Family::Kernel, three::<f32>),
    method("three f64", Family::Kernel, three::<f64>),
    method("f32 portable", Family::KernelBatch, |s, r| kernels::<f32>(s, r, Simd::Portable)),
    method("f64 portable", Family::KernelBatch, |s, r| kernels::<f64>(s, r, Simd::Portable)),
    method("f32x8", Family::KernelBatch, |s, r| kernels::<f32>(s, r, Simd::Avx2)),
    method("f64x4", Family::KernelBatch, |s, r| kernels::<f64>(s, r, Simd::Avx2)),
    method("f32x16", Family::KernelBatch, |s, r| kernels::<f32>(s, r, Simd::Avx512)),
    method("f64x8", Family::KernelBatch, |s, r| kernels::<f64>(s, r, Simd::Avx512)),
];

/// The walk in double precision.
const YARDSTICK: Method = method("walk f64", Family::Walk, |s, r| walk::<f64>(s, r, Refraction::Fused));

/// A map of `N` rays at once, over a block: from the form in which it takes rays to the one in which it gives them.
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

/// A map of `N` rays for a block of them; the last group is filled up with its last ray.
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

/// Rays as the kernels take them from a film: point and slopes.
fn at_film<S: Real>(subject: &Subject, rays: &[Ray]) -> Vec<([S; 2], [S; 2])> {
    let film_rays = FilmRays::new(subject.film_z, rays);
    (0..rays.len()).map(|i| film_rays.at_film(i)).collect()
}

fn one<S: KernelScalar + Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    let (kernel, plane) = (Kernel::<S>::new(&subject.lens, Direction::FilmToScene), subject.film_z);
    let trace = move |[(point, slopes)]: [([S; 2], [S; 2]); 1]| [kernel.trace_one(plane, point, slopes)];
    groups(&at_film(subject, rays), trace, Traced::ray)
}

/// A ray and its two differentials at a time.
fn three<S: KernelScalar + Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    let (kernel, plane) = (Kernel::<S>::new(&subject.lens, Direction::FilmToScene), subject.film_z);
    let trace = move |three: [([S; 2], [S; 2]); 3]| {
        kernel.trace_triple(plane, three.map(|ray| ray.0), three.map(|ray| ray.1))
    };
    groups(&at_film(subject, rays), trace, Traced::ray)
}

fn polynomial(subject: &Subject, rays: &[Ray], order: usize) -> Prepared {
    let lens = PolynomialLens::<f64>::new(&subject.fit(order));
    let trace = move |[(point, slopes)]: [([f64; 2], [f64; 2]); 1]| [lens.trace_one(point, slopes)];
    groups(&at_film(subject, rays), trace, Traced::ray)
}

/// Many rays in a call.
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
    let kernel = Kernel::<S>::with_simd(&subject.lens, Direction::FilmToScene, simd)?;
    let trace = move |from: &PlaneRays<'_, S>, to: &mut LensRays<'_, S>| kernel.trace_batch(from, to);
    Some(Box::new(Batches { trace, rays: FilmRays::new(subject.film_z, rays) }))
}

fn polynomials<S: KernelScalar + Real + 'static>(subject: &Subject, rays: &[Ray], order: usize) -> Prepared {
    let lens = PolynomialLens::<S>::new(&subject.fit(order));
    let trace = move |from: &PlaneRays<'_, S>, to: &mut LensRays<'_, S>| lens.trace_batch(from, to);
    Some(Box::new(Batches { trace, rays: FilmRays::new(subject.film_z, rays) }))
}

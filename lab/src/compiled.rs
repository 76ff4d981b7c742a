//! The compiled kernels in every instance, and lenses of polynomials, as methods of the ray map.

use crate::{
    ray_map::{Prepared, Runner, fit, single},
    subject::Subject,
};
use realistic::trace::{
    Direction, Ray, Real,
    kernel::{Kernel, LensRays, PlaneRays, Precision, RayArrays, Simd, Traced},
    polynomial::PolynomialLens,
};

/// A ray as the kernel takes it from a film: point and slopes.
type FilmRay<S> = ([S; 2], [S; 2]);

fn at_film<S: Real>(rays: &[Ray]) -> Vec<FilmRay<S>> {
    let narrow = |pair: [f64; 2]| pair.map(S::from_f64);
    rays.iter()
        .map(|Ray { origin: [x, y, _], direction: [dx, dy, dz] }| {
            (narrow([*x, *y]), narrow([dx / dz, dy / dz]))
        })
        .collect()
}

fn kernel<S: Precision>(subject: &Subject, simd: Simd) -> Option<Kernel<S>> {
    Kernel::with_simd(&subject.lens, Direction::FilmToScene, simd)
}

/// Ray after ray.
pub fn one<S: Precision + Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    let (kernel, plane) = (kernel::<S>(subject, Simd::best())?, subject.film_z);
    let trace = move |(point, slopes): FilmRay<S>| kernel.trace_one(plane, point, slopes);
    Some(single(at_film(rays), trace, Traced::ray))
}

/// Three rays at once: a ray and its two differentials.
struct Triples<S> {
    kernel: Kernel<S>,
    plane: f64,
    rays: Vec<FilmRay<S>>,
    out: Vec<Option<Traced<S>>>,
}

impl<S: Precision + Real> Runner for Triples<S> {
    fn run(&mut self) {
        for (rays, out) in self.rays.chunks(3).zip(self.out.chunks_mut(3)) {
            let at = |i: usize| rays[i.min(rays.len() - 1)];
            let three = [at(0), at(1), at(2)];
            let traced = self.kernel.trace_triple(self.plane, three.map(|r| r.0), three.map(|r| r.1));
            out.copy_from_slice(&traced[..out.len()]);
        }
    }

    fn ray(&self, index: usize) -> Option<Ray> {
        self.out[index].as_ref().map(Traced::ray)
    }
}

/// Three at a time.
pub fn three<S: Precision + Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    let kernel = kernel::<S>(subject, Simd::best())?;
    let out = vec![None; rays.len()];
    Some(Box::new(Triples { kernel, plane: subject.film_z, rays: at_film(rays), out }))
}

/// A whole block, as structure of arrays.
struct Batch<S, F> {
    trace: F,
    plane: f64,
    from: [Vec<S>; 4],
    to: RayArrays<S>,
}

/// Rays a call: what a camera's block has.
const CALL: usize = realistic::camera::BLOCK;

impl<S, F> Runner for Batch<S, F>
where
    S: Precision + Real,
    F: Fn(&PlaneRays<'_, S>, &mut LensRays<'_, S>),
{
    fn run(&mut self) {
        let count = self.from[0].len();
        for start in (0..count).step_by(CALL) {
            let part = start..count.min(start + CALL);
            let [x, y, slope_x, slope_y] = self.from.each_ref().map(|column| &column[part.clone()]);
            let from = PlaneRays { plane: self.plane, x, y, slope_x, slope_y };
            (self.trace)(&from, &mut self.to.part(part));
        }
    }

    fn ray(&self, index: usize) -> Option<Ray> {
        self.to.get(index).as_ref().map(Traced::ray)
    }
}

fn batch<S: Precision + Real + 'static>(
    subject: &Subject,
    rays: &[Ray],
    trace: impl Fn(&PlaneRays<'_, S>, &mut LensRays<'_, S>) + 'static,
) -> Prepared {
    let rays = at_film::<S>(rays);
    let column = |of: &dyn Fn(&FilmRay<S>) -> S| rays.iter().map(of).collect();
    let from = [column(&|r| r.0[0]), column(&|r| r.0[1]), column(&|r| r.1[0]), column(&|r| r.1[1])];
    let to = RayArrays::new(rays.len());
    Some(Box::new(Batch { trace, plane: subject.film_z, from, to }))
}

fn kernels<S: Precision + Real + 'static>(subject: &Subject, rays: &[Ray], simd: Simd) -> Prepared {
    let kernel = kernel::<S>(subject, simd)?;
    batch::<S>(subject, rays, move |from, to| kernel.trace_batch(from, to))
}

/// Ray after ray through polynomials.
pub fn polynomial<const ORDER: usize>(subject: &Subject, rays: &[Ray]) -> Prepared {
    let lens = PolynomialLens::<f64>::new(&fit(subject, ORDER));
    Some(single(at_film(rays), move |(point, slopes)| lens.trace_one(point, slopes), Traced::ray))
}

/// Blocks through polynomials, on the processor's widest registers.
pub fn polynomials<S, const ORDER: usize>(subject: &Subject, rays: &[Ray]) -> Prepared
where
    S: Precision + Real + 'static,
{
    let lens = PolynomialLens::<S>::new(&fit(subject, ORDER));
    batch::<S>(subject, rays, move |from, to| lens.trace_batch(from, to))
}

/// Blocks on registers of any processor.
pub fn portable<S: Precision + Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    kernels::<S>(subject, rays, Simd::Portable)
}

/// Blocks on registers of 256 bits.
pub fn avx2<S: Precision + Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    kernels::<S>(subject, rays, Simd::Avx2)
}

/// Blocks on registers of 512 bits.
pub fn avx512<S: Precision + Real + 'static>(subject: &Subject, rays: &[Ray]) -> Prepared {
    kernels::<S>(subject, rays, Simd::Avx512)
}

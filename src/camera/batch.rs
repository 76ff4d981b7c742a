//! Rays of whole blocks: drawn, traced, weighed and put into the world, each in a loop of its own.

use super::{
    DiskMapping, Drawn, RealisticCamera, Sample,
    block::{BLOCK, RayBlock, SampleBlock},
    disk::concentric,
    realistic::{FilmSide, Sampler},
    tracer::{Bundle, Tracer},
};
use crate::trace::{
    Real,
    kernel::{Compiled, Kernel, Precision},
};

impl RealisticCamera {
    /// [`RealisticCamera::ray`] of the first `n` samples, the same to the last bit.
    ///
    /// # Panics
    /// `n` is more than [`BLOCK`].
    pub fn rays(&self, samples: &SampleBlock, n: usize, rays: &mut RayBlock) {
        match &self.tracer {
            Tracer::Double(kernel) => self.traced(kernel, samples, n, rays),
            Tracer::Single(kernel) => self.traced(kernel, samples, n, rays),
            Tracer::Walk(_) | Tracer::WalkSingle(_) => {
                (0..n).for_each(|i| rays.set(i, self.ray(&samples.get(i))));
            }
        }
    }

    fn traced<S: Real + Precision>(
        &self,
        kernel: &Kernel<S>,
        samples: &SampleBlock,
        n: usize,
        rays: &mut RayBlock,
    ) {
        let mut bundle = Bundle::<S, BLOCK>::new();
        let mut area = [0.0; BLOCK];
        let simd = kernel.simd();
        simd.run(Draw { camera: self, samples, n, bundle: &mut bundle, area: &mut area });
        bundle.trace(kernel, self.film_z, n);
        simd.run(Finish { camera: self, samples, n, bundle: &bundle, area: &area, rays });
    }
}

/// Film points and slopes of a block.
struct Draw<'a, S> {
    camera: &'a RealisticCamera,
    samples: &'a SampleBlock,
    n: usize,
    bundle: &'a mut Bundle<S, BLOCK>,
    /// NaN where there is nothing to trace.
    area: &'a mut [f64; BLOCK],
}

impl<S: Real + Precision> Compiled for Draw<'_, S> {
    #[inline(always)]
    fn run(self) {
        let Self { camera, samples, n, bundle, area } = self;
        let n = n.min(BLOCK);
        if let (Sampler::Warped(pupil), DiskMapping::Concentric) = (&camera.sampler, camera.mapping) {
            let zero = [0.0; BLOCK];
            let (mut film, mut disk, mut slopes) = ([zero; 2], [zero; 2], [zero; 2]);
            for i in 0..n {
                let Sample { image_x, image_y, lens_u, lens_v, .. } = samples.get(i);
                [film[0][i], film[1][i]] = camera.film.point(image_x.into(), image_y.into());
                [disk[0][i], disk[1][i]] = concentric(lens_u.into(), lens_v.into());
            }
            pupil.draw_block(&film, &disk, n, &mut slopes, area);
            for axis in 0..2 {
                bundle.point[axis] = film[axis].map(<S as Real>::from_f64);
                bundle.slopes[axis] = slopes[axis].map(<S as Real>::from_f64);
            }
            return;
        }
        for (i, area) in area[..n].iter_mut().enumerate() {
            let (point, drawn) = match camera.film_side(&samples.get(i)) {
                FilmSide::Ray(point, drawn) => (point, drawn),
                FilmSide::Dark(_) | FilmSide::Redraw => {
                    ([0.0; 2], Drawn { slopes: [0.0; 2], area: f64::NAN })
                }
            };
            [bundle.point[0][i], bundle.point[1][i]] = point.map(<S as Real>::from_f64);
            [bundle.slopes[0][i], bundle.slopes[1][i]] = drawn.slopes.map(<S as Real>::from_f64);
            *area = drawn.area;
        }
    }
}

/// World rays and weights of a traced block.
struct Finish<'a, S> {
    camera: &'a RealisticCamera,
    samples: &'a SampleBlock,
    n: usize,
    bundle: &'a Bundle<S, BLOCK>,
    area: &'a [f64; BLOCK],
    rays: &'a mut RayBlock,
}

impl<S: Real + Precision> Compiled for Finish<'_, S> {
    #[inline(always)]
    fn run(self) {
        let Self { camera, samples, n, bundle, area, rays } = self;
        for ((weight, cos4), area) in rays.weight[..n].iter_mut().zip(&bundle.weight).zip(area) {
            let passes = cos4.to_f64() > 0.0 && !area.is_nan();
            *weight = if passes { camera.weigh(*area, cos4.to_f64()) } else { 0.0 };
        }
        camera.placement.world_rays(
            &bundle.origin,
            &bundle.direction,
            camera.units_per_mm,
            &samples.time,
            n,
            rays,
        );
    }
}

//! Rays of whole blocks: drawn, traced, weighed and put into the world, each in a loop of its own.

use super::{
    DiskMapping, Drawn, RealisticCamera,
    block::{BLOCK, RayBlock, SampleBlock},
    disk::concentric,
    realistic::{FilmSide, Sampler},
    scratch::{Blocks, Scratch},
    tracer::Tracer,
};
use crate::trace::{
    Real,
    kernel::{Compiled, Kernel},
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

    fn traced<S: Blocks>(&self, kernel: &Kernel<S>, samples: &SampleBlock, n: usize, rays: &mut RayBlock) {
        assert!(n <= BLOCK, "a block has {BLOCK} samples");
        let simd = kernel.simd();
        S::with_scratch(|scratch| {
            simd.run(Draw { camera: self, samples, n, scratch });
            scratch.bundle.trace(kernel, self.film_z, n);
            simd.run(Finish { camera: self, samples, n, scratch, rays });
        });
    }
}

/// Film points and slopes of a block.
struct Draw<'a, S> {
    camera: &'a RealisticCamera,
    samples: &'a SampleBlock,
    n: usize,
    scratch: &'a mut Scratch<S>,
}

impl<S: Blocks> Compiled for Draw<'_, S> {
    #[inline(always)]
    fn run(self) {
        let Self { camera, samples, n, scratch } = self;
        let Scratch { film, disk, places, slopes, area, bundle } = scratch;
        let [film_x, film_y] = &mut *film;
        for (i, (x, y)) in film_x[..n].iter_mut().zip(film_y).enumerate() {
            [*x, *y] = camera.film.point(samples.image_x[i].into(), samples.image_y[i].into());
        }
        if let (Sampler::Warped(pupil), DiskMapping::Concentric) = (&camera.sampler, camera.mapping) {
            let [disk_x, disk_y] = &mut *disk;
            for (i, (x, y)) in disk_x[..n].iter_mut().zip(disk_y).enumerate() {
                [*x, *y] = concentric(samples.lens_u[i].into(), samples.lens_v[i].into());
            }
            pupil.draw_block(film, disk, n, places, slopes, area);
        } else {
            for (i, area) in area[..n].iter_mut().enumerate() {
                let drawn = match camera.film_side(&samples.get(i)) {
                    FilmSide::Ray(_, drawn) => drawn,
                    FilmSide::Dark(_) | FilmSide::Redraw => Drawn { slopes: [0.0; 2], area: f64::NAN },
                };
                [slopes[0][i], slopes[1][i]] = drawn.slopes;
                *area = drawn.area;
            }
        }
        for (from, to) in film.iter().zip(&mut bundle.point).chain(slopes.iter().zip(&mut bundle.slopes)) {
            for (from, to) in from[..n].iter().zip(to) {
                *to = <S as Real>::from_f64(*from);
            }
        }
    }
}

/// World rays and weights of a traced block.
struct Finish<'a, S> {
    camera: &'a RealisticCamera,
    samples: &'a SampleBlock,
    n: usize,
    scratch: &'a Scratch<S>,
    rays: &'a mut RayBlock,
}

impl<S: Blocks> Compiled for Finish<'_, S> {
    #[inline(always)]
    fn run(self) {
        let Self { camera, samples, n, scratch: Scratch { area, bundle, .. }, rays } = self;
        for ((weight, cos4), area) in rays.weight[..n].iter_mut().zip(&bundle.weight).zip(area) {
            let passes = cos4.to_f64() > 0.0 && !area.is_nan();
            let weighed = camera.weigh(*area, cos4.to_f64());
            *weight = if passes { weighed } else { 0.0 };
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

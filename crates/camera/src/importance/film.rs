//! The film's part of importance: computes raster coordinates, weight and density from film points and
//! slopes.

use super::block::{load, store};
use crate::vectors::in_vectors;
use crate::{pipeline::body::CameraBody, plan::FilmSide, sampling::film_rays::FilmRays};
use realistic_simd::{Available, Cpu, Lanes};
use realistic_trace::kernel::{Grouping, InVectors, LensRays, RayBuffer};

/// A film and its sampler, for rays that arrive from the scene.
#[derive(Clone, Debug)]
pub struct ImportanceFilm {
    side: FilmSide,
    weight: Option<f64>,
    /// The film's area, mm², times the radiance factor (n'/n)² of the media at both ends of the lens, by which
    /// cosθ dA dω at the scene exceeds that at the film.
    area: f64,
    /// x and y of the film's centre in the sampler's coordinates, mm.
    center: [f64; 2],
    simd: Available,
}

impl ImportanceFilm {
    /// Returns the film of a camera body behind a lens with this factor (n'/n)².
    pub fn new(body: &CameraBody, radiance_factor: f64) -> Self {
        let film = &body.film_side.film;
        let (size, center) = (film.half_size().map(|half| 2.0 * half), film.sampled_center());
        let (side, weight, simd) = (body.film_side.clone(), body.weight, Available::best());
        Self { side, weight, area: size[0] * size[1] * radiance_factor, center, simd }
    }

    /// Returns z of the film, mm.
    pub fn z(&self) -> f64 {
        self.side.z
    }

    /// Computes in place the importance of rays behind the lens, in the layout of
    /// [`super::block::ArrivingRays`], from the density per area and slopes² at the film. The weight is 0 for
    /// blocked rays, for rays that miss the film and for rays outside the sampled pupil. On entry a ray's
    /// weight is the share of its light that the lens transmits.
    pub fn we(&self, rays: &mut RayBuffer<f64>) {
        in_vectors(self.simd, Grouping::Wide, &mut Arrivals { film: self, rays: rays.rays() });
    }
}

/// Rays behind the lens, which are overwritten by their importance.
struct Arrivals<'a> {
    film: &'a ImportanceFilm,
    rays: LensRays<'a, f64>,
}

impl InVectors<f64> for Arrivals<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.rays.weight.len()
    }

    #[cfg_attr(not(debug_assertions), inline(always))]
    fn group<L: Lanes<Scalar = f64>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize, count: usize) {
        if count == U {
            return self.vectors::<L, U>(cpu, first);
        }
        for u in 0..count {
            self.vectors::<L, 1>(cpu, first + u * L::WIDTH);
        }
    }
}

impl Arrivals<'_> {
    /// Processes whole groups of vectors, so that the table look-ups of different vectors overlap.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vectors<L: Lanes<Scalar = f64>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize) {
        let mut arrived = [self.arrived(cpu, first); U];
        for (u, arrived) in arrived.iter_mut().enumerate().skip(1) {
            *arrived = self.arrived(cpu, first + u * L::WIDTH);
        }
        let flat_per_area = self.film.side.sampler.areas(cpu, &mut arrived);
        for (u, arrived) in arrived.iter().enumerate() {
            self.store_importance(cpu, first + u * L::WIDTH, arrived, flat_per_area[u]);
        }
    }

    /// Returns the points where rays meet the film, and their slopes there.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn arrived<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, at: usize) -> FilmRays<L> {
        let LensRays { origin, direction, .. } = &self.rays;
        let ([x, y, z], [dx, dy, dz]) = (load(cpu, origin, at), load(cpu, direction, at));
        let slopes = [dx / dz, dy / dz];
        let along = L::splat(cpu, self.film.side.z) - z;
        let point = [along.mul_add(slopes[0], x), along.mul_add(slopes[1], y)];
        FilmRays { point, slopes, disk: slopes, area_per_pi: L::splat(cpu, 0.0) }
    }

    /// Replaces rays by their raster coordinates, weights and densities.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn store_importance<L: Lanes<Scalar = f64>>(
        &mut self,
        cpu: Cpu<L>,
        at: usize,
        arrived: &FilmRays<L>,
        flat_per_area: L,
    ) {
        let (ImportanceFilm { side, weight, area, center, .. }, rays) = (self.film, &mut self.rays);
        let number = |number: f64| L::splat(cpu, number);
        let (zero, one) = (number(0.0), number(1.0));
        let FilmRays { point, slopes, area_per_pi, .. } = *arrived;
        let per_cos2 = slopes[1].mul_add(slopes[1], slopes[0].mul_add(slopes[0], one));
        let patch = number(std::f64::consts::PI) * area_per_pi / (per_cos2 * per_cos2);
        let centred = [point[0] - number(center[0]), point[1] - number(center[1])];
        let (raster, is_on_film) = side.film.raster_of(cpu, centred);
        let left = L::load(cpu, &rays.weight[at..]);
        let passes = L::both(is_on_film, zero.less(left));
        let weight =
            weight.map_or(L::select(zero.less(patch), one, zero), |weight| (number(weight) * patch) * left);
        let density = flat_per_area / (number(*area) * patch);
        let counts = L::both(passes, density.abs().less(number(f64::INFINITY)));
        store([raster[0], raster[1], weight.or_zero(counts)], &mut rays.origin, at);
        density.store(&mut rays.direction[0][at..]);
    }
}

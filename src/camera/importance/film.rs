//! The film's side of importance: film points and slopes in; raster coordinates, weight and density out.

use super::FilmWe;
use crate::{
    camera::pipeline::body::CameraBody,
    light::LaneTransmission,
    plan::FilmSide,
    sampling::film_rays::FilmRays,
    trace::kernel::{Available, Cpu, Grouping, InVectors, Lanes, LensRays, RayBuffer, in_vectors},
};

/// A film and what is sampled there, for rays that arrive.
#[derive(Clone, Debug)]
pub(crate) struct ImportanceFilm {
    side: FilmSide,
    weight: Option<f64>,
    transmission: Option<LaneTransmission<f64>>,
    /// Width and height, mm.
    size: [f64; 2],
    simd: Available,
}

impl ImportanceFilm {
    /// Of a camera with a film.
    pub fn new(body: &CameraBody) -> Self {
        let film = &body.film_side.film;
        let size = film.middle().map(|middle| 2.0 * middle * film.pixel());
        let (side, weight, simd) = (body.film_side.clone(), body.weight, Available::best());
        let transmission = body.transmission.as_ref().map(|own| own.lane_transmission());
        Self { side, weight, transmission, size, simd }
    }

    /// z of the film, mm.
    pub fn z(&self) -> f64 {
        self.side.z
    }

    /// Half the film's width and height, mm.
    pub fn half(&self) -> [f64; 2] {
        self.size.map(|size| size / 2.0)
    }

    /// The importance of rays behind the lens, in their order, by the density per area and slopes² at the film; `None` for
    /// blocked rays, off the film and outside what the sampler samples.
    pub fn we(&self, rays: &mut RayBuffer<f64>, found: &mut Vec<Option<FilmWe>>) {
        let mut arrivals = Arrivals { film: self, rays: rays.rays() };
        in_vectors(self.simd, Grouping::Wide, &mut arrivals);
        let Arrivals { rays: LensRays { origin: [x, y, weight], direction: [density, ..], .. }, .. } =
            arrivals;
        found.extend((0..weight.len()).map(|i| {
            let we = FilmWe { raster: [x[i], y[i]], weight: weight[i], density: density[i] };
            (we.weight > 0.0 && we.density.is_finite()).then_some(we)
        }));
    }
}

/// Rays behind the lens, in whose place come what they carry: raster coordinates and weight for the origin, density for the
/// direction's x.
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
    fn vectors<L: Lanes<Scalar = f64>, const U: usize>(&mut self, cpu: Cpu<L>, first: usize) {
        for u in 0..U {
            self.vector::<L>(cpu, first + u * L::WIDTH);
        }
    }
}

impl Arrivals<'_> {
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector<L: Lanes<Scalar = f64>>(&mut self, cpu: Cpu<L>, at: usize) {
        let (ImportanceFilm { side, weight, transmission, size, .. }, rays) = (self.film, &mut self.rays);
        let number = |number: f64| L::splat(cpu, number);
        let (zero, one) = (number(0.0), number(1.0));
        let [x, y, z] = [0, 1, 2].map(|axis| L::load(cpu, &rays.origin[axis][at..]));
        let [dx, dy, dz] = [0, 1, 2].map(|axis| L::load(cpu, &rays.direction[axis][at..]));
        let slopes = [dx / dz, dy / dz];
        let along = number(side.z) - z;
        let point = [along.mul_add(slopes[0], x), along.mul_add(slopes[1], y)];
        let mut film_ray = FilmRays { point, slopes, disk: slopes, area_per_pi: zero };
        side.sampler.areas(cpu, &mut film_ray);
        let area = number(std::f64::consts::PI) * film_ray.area_per_pi;
        let per_cos2 = slopes[1].mul_add(slopes[1], slopes[0].mul_add(slopes[0], one));
        let patch = area / (per_cos2 * per_cos2);
        let (raster, is_on_film) = side.film.raster_of(cpu, point);
        let passes = L::both(is_on_film, zero.less(L::load(cpu, &rays.weight[at..])));
        let mut weight =
            weight.map_or(L::select(zero.less(patch), one, zero), |weight| number(weight) * patch);
        if let (Some(transmission), true) = (transmission, self.film.weight.is_some()) {
            let [left] = transmission.lanes(cpu, &[point], &[slopes], &[zero]);
            weight = weight * left;
        }
        raster[0].store(&mut rays.origin[0][at..]);
        raster[1].store(&mut rays.origin[1][at..]);
        weight.or_zero(passes).store(&mut rays.origin[2][at..]);
        (one / (number(size[0] * size[1]) * patch)).store(&mut rays.direction[0][at..]);
    }
}

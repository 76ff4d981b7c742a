//! What a ray at the film counts: a film point and slopes in; raster coordinates, weight and density out.

use crate::{camera::pipeline::body::CameraBody, lens::cos4, plan::FilmSide};

/// What a ray counts in camera space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Counted {
    /// Raster coordinates, pixels.
    pub raster: [f64; 2],
    /// The weight that the camera gives the same ray from the film.
    pub weight: f64,
    /// The density of its rays from the film, per cosθ dA dω; the square of camera space's unit is dA's.
    pub density: f64,
}

/// A film and what is sampled there, for rays that arrive.
#[derive(Clone, Debug)]
pub(crate) struct FilmCount {
    side: FilmSide,
    weight: Option<f64>,
    /// Width and height, mm.
    size: [f64; 2],
}

impl FilmCount {
    /// Of a camera with a film.
    pub fn new(body: &CameraBody) -> Self {
        let film = &body.film_side.film;
        let size = film.middle().map(|middle| 2.0 * middle * film.pixel());
        Self { side: body.film_side.clone(), weight: body.weight, size }
    }

    /// z of the film, mm.
    pub fn z(&self) -> f64 {
        self.side.z
    }

    /// Half the film's width and height, mm.
    pub fn half(&self) -> [f64; 2] {
        self.size.map(|size| size / 2.0)
    }

    /// What a ray counts at the film, by the density per area and slopes² there; `None` off the film and outside what the
    /// sampler samples.
    pub fn count(&self, point: [f64; 2], slopes: [f64; 2]) -> Option<Counted> {
        let raster = self.side.film.raster_of(point)?;
        let area = self.side.sampler.area_at(point, slopes)?;
        let cos4 = cos4(slopes);
        let weight = self.weight.map_or(1.0, |weight| weight * area * cos4);
        let density = 1.0 / (self.size[0] * self.size[1] * area * cos4);
        (weight > 0.0 && density.is_finite()).then_some(Counted { raster, weight, density })
    }
}

//! Importance of cameras whose rays are linear in film point and lens point: the thick and the thin lens, and the
//! stock cameras with a lens.
//!
//! Of a ray that crosses the plane z = 0 at x with the slopes s, film coordinates and lens coordinates are both sums h x +
//! k s, the same on both axes. A camera samples film and lens evenly, and so its rays' density per area and slopes² at z =
//! 0 is the square of the determinant over both areas.

use std::f64::consts::PI;

use super::{FilmWe, LensDirection};
use crate::{
    lens::{Ray, cos4},
    sampling::DiskMapping,
};

/// A rectangle: its middle, and half its width and height.
struct PlaneWindow {
    center: [f64; 2],
    half: [f64; 2],
}

/// A coordinate of rays: from the height at z = 0, and from the slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlaneMap {
    pub from_height: f64,
    pub from_slope: f64,
}

impl PlaneMap {
    fn of(self, height: f64, slope: f64) -> f64 {
        self.from_height * height + self.from_slope * slope
    }

    /// Its part from the slope of rays through a point at the depth `z`.
    fn about(self, z: f64) -> f64 {
        self.from_slope - self.from_height * z
    }
}

/// A camera with linear rays.
#[derive(Clone, Debug)]
pub(crate) struct Linear {
    pub film: PlaneMap,
    pub lens: PlaneMap,
    /// The lens's radius, in its coordinate.
    pub lens_radius: f64,
    /// The slope at the film of a ray, and what its cos⁴ is multiplied by to be the weight; `None` for the weight 1.
    pub weight: Option<(PlaneMap, f64)>,
    /// Raster coordinates from film coordinates: factor and constant of each.
    pub raster: [[f64; 2]; 2],
    /// Pixels across and down.
    pub size: [f64; 2],
    /// Depths at which a point is seen.
    pub depths: [f64; 2],
}

/// Single precision puts rays of the lens's edge that far outside it, relative.
const ROUNDING: f64 = 2e-6;

impl Linear {
    /// The lens's area in its coordinates.
    fn lens_area(&self) -> f64 {
        PI * self.lens_radius * self.lens_radius
    }

    /// The part of the film that makes the picture, in film coordinates.
    fn window(&self) -> PlaneWindow {
        let film = |axis: usize, raster: f64| (raster - self.raster[axis][1]) / self.raster[axis][0];
        let ends = [0, 1].map(|axis| [film(axis, 0.0), film(axis, self.size[axis])]);
        PlaneWindow {
            center: ends.map(|[from, to]| f64::midpoint(from, to)),
            half: ends.map(|[from, to]| ((to - from) / 2.0).abs()),
        }
    }

    /// What a ray counts, of any length of direction, that begins at z = 0 or before it.
    pub fn arrive(&self, Ray { origin: [x, y, z], direction: [dx, dy, dz] }: &Ray) -> Option<FilmWe> {
        if !(*dz < 0.0 && *z >= 0.0) {
            return None;
        }
        let slopes = [dx / dz, dy / dz];
        let heights = [x - z * slopes[0], y - z * slopes[1]];
        let at = |map: PlaneMap| [0, 1].map(|axis| map.of(heights[axis], slopes[axis]));
        let [u, v] = at(self.lens);
        if !(u * u + v * v <= (self.lens_radius * (1.0 + ROUNDING)).powi(2)) {
            return None;
        }
        let film = at(self.film);
        let raster = [0, 1].map(|axis| self.raster[axis][0] * film[axis] + self.raster[axis][1]);
        if !(0..2).all(|axis| (0.0..self.size[axis]).contains(&raster[axis])) {
            return None;
        }
        let [width, height] = self.window().half.map(|half| 2.0 * half);
        let determinant =
            self.film.from_height * self.lens.from_slope - self.film.from_slope * self.lens.from_height;
        let density = determinant * determinant / (width * height * self.lens_area() * cos4(slopes));
        let weight = self.weight.map_or(1.0, |(slope, factor)| factor * cos4(at(slope)));
        (density.is_finite() && weight > 0.0).then_some(FilmWe { raster, weight, density })
    }

    /// A direction toward the lens from a point, for two numbers in [0, 1].
    pub fn aim(&self, [x, y, z]: [f64; 3], numbers: [f64; 2]) -> Option<LensDirection> {
        let [from, to] = self.depths;
        if !(z > 0.0 && z >= from && z <= to) {
            return None;
        }
        // In the plane of slopes the lens is a disk, and the film a rectangle.
        let (lens, film, point) = (self.lens.about(z), self.film.about(z), [x, y]);
        let radius = self.lens_radius / lens.abs();
        let center = point.map(|at| -self.lens.from_height * at / lens);
        let window = self.window();
        let ends = [0, 1].map(|axis| {
            let middle = (window.center[axis] - self.film.from_height * point[axis]) / film;
            let half = (window.half[axis] / film).abs();
            // In focus the film is everywhere or nowhere.
            let is_known = middle.is_finite() && half.is_finite();
            let [low, high] = if is_known { [middle - half, middle + half] } else { [f64::MIN, f64::MAX] };
            [low.max(center[axis] - radius), high.min(center[axis] + radius)]
        });
        let sides = ends.map(|[low, high]| high - low);
        if !sides.iter().all(|side| *side > 0.0) {
            return None;
        }
        // The smaller of the disk and what the rectangle has of the square about it: what else there is of it is blocked.
        let (disk, rectangle) = (PI * radius * radius, sides[0] * sides[1]);
        let slopes = if disk <= rectangle {
            let [u, v] = DiskMapping::Concentric.map(numbers[0], numbers[1])?;
            [center[0] + radius * u, center[1] + radius * v]
        } else {
            [0, 1].map(|axis| ends[axis][0] + numbers[axis] * sides[axis])
        };
        let density = disk.min(rectangle).recip();
        let [a, b] = slopes;
        let length = (1.0 + a * a + b * b).sqrt();
        let origin = [x - z * slopes[0], y - z * slopes[1], 0.0];
        let direction = [-slopes[0] / length, -slopes[1] / length, -1.0 / length];
        let ray = Ray { origin, direction };
        Some(LensDirection { ray, density: density * length.powi(3), we: self.arrive(&ray) })
    }
}

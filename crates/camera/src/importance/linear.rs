//! Importance of the cameras whose rays depend linearly on film point and lens point: the thick lens, the
//! thin lens, and the stock cameras with a lens.
//!
//! For a ray that crosses the plane z = 0 at height x with slope s, its film coordinate and its lens
//! coordinate both have the form h x + k s, with the same coefficients on both axes. A camera samples film
//! and lens uniformly, so the density of its rays per area and slopes² at z = 0 is the squared determinant of
//! this map divided by the product of the two areas.

use std::f64::consts::PI;

use super::FilmWe;
use crate::sampling::DiskMapping;
use realistic_optics::lens::{Ray, cos4};

/// A coordinate of rays as a linear function of the height at z = 0 and the slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneMap {
    pub from_height: f64,
    pub from_slope: f64,
}

impl PlaneMap {
    fn of(self, height: f64, slope: f64) -> f64 {
        self.from_height * height + self.from_slope * slope
    }

    /// Returns the coefficient of the slope in the coordinate, for rays through a fixed point at depth `z`.
    fn about(self, z: f64) -> f64 {
        self.from_slope - self.from_height * z
    }
}

/// A camera with linear rays.
#[derive(Clone, Debug)]
pub struct Linear {
    pub film: PlaneMap,
    pub lens: PlaneMap,
    /// Radius of the lens, in the lens coordinate.
    pub lens_radius: f64,
    /// The slope of a ray at the film, and the factor from the cos⁴ of that slope's angle to the weight;
    /// `None` for weight 1.
    pub weight: Option<(PlaneMap, f64)>,
    /// Factor and constant from film coordinates to raster coordinates, per axis.
    pub raster: [[f64; 2]; 2],
    /// Width and height of the image, pixels.
    pub size: [f64; 2],
    /// Smallest and largest depth at which a point is seen.
    pub depths: [f64; 2],
}

/// Relative distance by which rounding to single precision may move rays beyond the edge of the lens.
const ROUNDING: f64 = 2e-6;

impl Linear {
    /// Returns the area of the lens in lens coordinates.
    fn lens_area(&self) -> f64 {
        PI * self.lens_radius * self.lens_radius
    }

    /// Returns the centre and half the extent, along each axis, of the part of the film that forms the
    /// picture, in film coordinates.
    fn window(&self) -> [[f64; 2]; 2] {
        let film = |axis: usize, raster: f64| (raster - self.raster[axis][1]) / self.raster[axis][0];
        [0, 1].map(|axis| {
            let [from, to] = [film(axis, 0.0), film(axis, self.size[axis])];
            [f64::midpoint(from, to), ((to - from) / 2.0).abs()]
        })
    }

    /// Returns the importance of a ray that begins at z = 0 or in front of it; the ray's direction may have
    /// any length.
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
        let [width, height] = self.window().map(|[_, half]| 2.0 * half);
        let determinant =
            self.film.from_height * self.lens.from_slope - self.film.from_slope * self.lens.from_height;
        let density = determinant * determinant / (width * height * self.lens_area() * cos4(slopes));
        let weight = self.weight.map_or(1.0, |(slope, factor)| factor * cos4(at(slope)));
        (density.is_finite() && weight > 0.0).then_some(FilmWe { raster, weight, density })
    }

    /// Samples a direction toward the lens from a point, by two numbers in [0, 1]. Returns a ray that begins
    /// at the front of the lens and has a unit direction, and the density of this direction per solid angle
    /// at the point.
    pub fn aim(&self, [x, y, z]: [f64; 3], numbers: [f64; 2]) -> Option<(Ray, f64)> {
        let [from, to] = self.depths;
        if !(z > 0.0 && z >= from && z <= to) {
            return None;
        }
        // In slopes from the point, the lens is a disk and the film a rectangle.
        let (lens, film, point) = (self.lens.about(z), self.film.about(z), [x, y]);
        let radius = self.lens_radius / lens.abs();
        let center = point.map(|at| -self.lens.from_height * at / lens);
        let window = self.window();
        let ends = [0, 1].map(|axis| {
            let [middle, half] = window[axis];
            let middle = (middle - self.film.from_height * point[axis]) / film;
            let half = (half / film).abs();
            // At the depth in focus all slopes lead to the same film point, so the film does not limit the
            // slopes.
            let is_known = middle.is_finite() && half.is_finite();
            let [low, high] = if is_known { [middle - half, middle + half] } else { [f64::MIN, f64::MAX] };
            [low.max(center[axis] - radius), high.min(center[axis] + radius)]
        });
        let sides = ends.map(|[low, high]| high - low);
        if !sides.iter().all(|side| *side > 0.0) {
            return None;
        }
        // Samples the smaller of two areas: the disk, and the part of the rectangle within the disk's
        // bounding square. If the rectangle is sampled, slopes outside the disk are blocked.
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
        Some((Ray { origin, direction }, density * length.powi(3)))
    }
}

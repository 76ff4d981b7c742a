//! The film: a raster of pixels on a rectangle behind the lens.

use realistic_simd::{Cpu, Lanes};

/// Pixels of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Raster {
    /// Pixels across, 1 or more.
    pub xres: u32,
    /// Pixels down, 1 or more.
    pub yres: u32,
}

/// A film of square pixels centred on the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    raster: Raster,
    diagonal: f64,
    pixel: f64,
}

/// Distance outside the raster, in pixels, up to which a host's reconstruction filter requests rays (pbrt-v1 goes to -2
/// and resolution + 3).
const FILTER_MARGIN: f64 = 3.0;

impl Film {
    /// Returns a film with this diagonal in mm, positive.
    pub fn new(raster: Raster, diagonal: f64) -> Self {
        let (x, y) = (f64::from(raster.xres), f64::from(raster.yres));
        Self { raster, diagonal, pixel: diagonal / (x * x + y * y).sqrt() }
    }

    /// Returns width and height of a pixel, mm.
    pub fn pixel(&self) -> f64 {
        self.pixel
    }

    /// Returns the diagonal, mm.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Returns the film point, mm in lens space, of raster coordinates ((0, 0) is the image's top left corner). The
    /// image on film is upside down and mirrored; this function turns it, so that raster x grows toward the scene's
    /// right.
    #[inline(always)]
    pub fn point(&self, image_x: f64, image_y: f64) -> [f64; 2] {
        let [x, y] = self.middle();
        [(x - image_x) * self.pixel, (image_y - y) * self.pixel]
    }

    /// Returns the raster coordinates of film points, mm, the inverse of [`Film::point`], and the mask of points on the
    /// film.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn raster_of<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, [x, y]: [L; 2]) -> ([L; 2], L::Mask) {
        let (zero, pixel) = (L::splat(cpu, 0.0), L::splat(cpu, self.pixel));
        let [middle_x, middle_y] = self.middle().map(|middle| L::splat(cpu, middle));
        let (image_x, image_y) = (middle_x - x / pixel, middle_y + y / pixel);
        let is_across = L::both(zero.less_equal(image_x), image_x.less(middle_x + middle_x));
        let is_down = L::both(zero.less_equal(image_y), image_y.less(middle_y + middle_y));
        ([image_x, image_y], L::both(is_across, is_down))
    }

    /// Returns the raster coordinates of the axis.
    pub fn middle(&self) -> [f64; 2] {
        [self.raster.xres, self.raster.yres].map(|resolution| f64::from(resolution) / 2.0)
    }

    /// Returns the largest distance from the axis, mm, at which a host requests rays.
    pub fn reach(&self) -> f64 {
        self.diagonal / 2.0 + FILTER_MARGIN * std::f64::consts::SQRT_2 * self.pixel
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_are_half_a_diagonal_away_and_turned() {
        let film = Film::new(Raster { xres: 300, yres: 400 }, 50.0);
        assert_eq!(film.pixel(), 0.1);
        assert_eq!(film.point(0.0, 0.0), [15.0, -20.0]);
        assert_eq!(film.point(300.0, 400.0), [-15.0, 20.0]);
        assert_eq!(film.point(150.0, 200.0), [0.0, 0.0]);
        let [x, y] = film.point(303.0, -3.0);
        assert!(x.hypot(y) <= film.reach());
    }
}

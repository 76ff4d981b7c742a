//! The film: a raster of pixels on a rectangle behind the lens.

use super::film_surface::FilmSurface;
use realistic_optics::lens::Lens;
use realistic_simd::{Cpu, Lanes};

/// Numbers of pixels of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Raster {
    /// Number of pixel columns, 1 or more.
    pub xres: u32,
    /// Number of pixel rows, 1 or more.
    pub yres: u32,
}

/// A film of square pixels, centred on the axis unless its surface is shifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    raster: Raster,
    diagonal: f64,
    pixel: f64,
    surface: FilmSurface,
    /// Whether the lens in front of the film has surfaces that are not symmetric about one axis.
    has_other_lens: bool,
}

/// Distance outside the raster, in pixels, within which a host's reconstruction filter requests rays (in
/// pbrt-v1, from -2 to resolution + 3).
const FILTER_MARGIN: f64 = 3.0;

impl Film {
    /// Returns a flat film perpendicular to the axis with the given diagonal in mm, which is positive.
    pub fn new(raster: Raster, diagonal: f64) -> Self {
        let (x, y) = (f64::from(raster.xres), f64::from(raster.yres));
        let pixel = diagonal / (x * x + y * y).sqrt();
        Self { raster, diagonal, pixel, surface: FilmSurface::FLAT, has_other_lens: false }
    }

    /// Returns this film behind a lens.
    #[must_use]
    pub fn behind(self, lens: &Lens) -> Self {
        Self { has_other_lens: !lens.is_centred(), ..self }
    }

    /// Returns whether pupils depend on the distance from the axis alone: the film is flat and perpendicular to the axis,
    /// and the lens is symmetric, whatever its apertures. Otherwise pupils are tabulated by x and y of the flat film.
    pub fn is_round(&self) -> bool {
        self.surface.is_across() && !self.has_other_lens
    }

    /// Returns this film on another surface.
    #[must_use]
    pub fn on(self, surface: FilmSurface) -> Self {
        Self { surface, ..self }
    }

    /// Returns the film's surface.
    pub fn surface(&self) -> &FilmSurface {
        &self.surface
    }

    /// Returns the width of a pixel, which equals its height, mm.
    pub fn pixel(&self) -> f64 {
        self.pixel
    }

    /// Returns the diagonal, mm.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Returns the film point, mm in lens space, that corresponds to raster coordinates, for a film
    /// perpendicular to the axis. Raster (0, 0) is the image's top left corner. The image on film is upside
    /// down and mirrored; this function inverts both, so that raster x grows toward the right of the scene.
    #[inline(always)]
    pub fn point(&self, image_x: f64, image_y: f64) -> [f64; 2] {
        let ([x, y], [right, up]) = (self.middle(), self.surface.shift());
        [(x - image_x) * self.pixel + right, (image_y - y) * self.pixel + up]
    }

    /// Returns x and y, mm, of the film's centre in the coordinates in which a sampler takes film points:
    /// coordinates in space where pupils depend on the distance from the axis, else coordinates on the flat film, whose
    /// centre is 0.
    pub fn sampled_center(&self) -> [f64; 2] {
        if self.is_round() { self.surface.shift() } else { [0.0; 2] }
    }

    /// Returns half the width and half the height of the picture, mm.
    pub fn half_size(&self) -> [f64; 2] {
        self.middle().map(|middle| middle * self.pixel)
    }

    /// Returns the raster coordinates of film points, given in mm from the film's centre, and the mask of the
    /// points that lie on the film.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn raster_of<L: Lanes<Scalar = f64>>(&self, cpu: Cpu<L>, [x, y]: [L; 2]) -> ([L; 2], L::Mask) {
        let (zero, pixel) = (L::splat(cpu, 0.0), L::splat(cpu, self.pixel));
        let [middle_x, middle_y] = self.middle().map(|middle| L::splat(cpu, middle));
        let (image_x, image_y) = (middle_x - x / pixel, middle_y + y / pixel);
        let is_across = L::both(zero.less_equal(image_x), image_x.less(middle_x + middle_x));
        let is_down = L::both(zero.less_equal(image_y), image_y.less(middle_y + middle_y));
        ([image_x, image_y], L::both(is_across, is_down))
    }

    /// Returns the raster coordinates of the film's centre.
    pub fn middle(&self) -> [f64; 2] {
        [self.raster.xres, self.raster.yres].map(|resolution| f64::from(resolution) / 2.0)
    }

    /// Returns the largest distance from the axis, mm, at which a host requests rays; for film that is
    /// shifted or tilted, this is an upper bound.
    pub fn reach(&self) -> f64 {
        let [right, up] = self.surface.shift();
        self.diagonal / 2.0 + FILTER_MARGIN * std::f64::consts::SQRT_2 * self.pixel + right.hypot(up)
    }

    /// Returns the distance of the picture's farthest corner from the axis, mm; for film that is shifted or
    /// tilted, this is an upper bound.
    pub fn corner(&self) -> f64 {
        let [right, up] = self.surface.shift();
        self.diagonal / 2.0 + right.hypot(up)
    }

    /// Returns the diagonal, mm, with which the picture's farthest corner would lie `radius` mm from the axis.
    /// It is not positive if the film's centre lies that far from the axis or farther.
    pub fn diagonal_within(&self, radius: f64) -> f64 {
        let [right, up] = self.surface.shift();
        2.0 * (radius - right.hypot(up))
    }

    /// Returns the rectangle of the flat film within which a host requests rays: a corner, mm from the film's
    /// centre, and the rectangle's size.
    pub fn rectangle(&self) -> [[f64; 2]; 2] {
        let half = self.half_size().map(|half| half + FILTER_MARGIN * self.pixel);
        [half.map(|half| -half), half.map(|half| 2.0 * half)]
    }

    /// Returns the smallest and the largest distance by which points of the film lie in front of the plane
    /// through the film's centre perpendicular to the axis, mm. Both are 0 for flat film perpendicular to the
    /// axis, and NaN if the film reaches beyond the sphere along which it is curved.
    pub fn depth(&self) -> [f64; 2] {
        const STEPS: u32 = 16;
        let mut depth = [0.0_f64; 2];
        let [corner, size] = self.rectangle();
        for (i, j) in (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| (i, j))) {
            let at = |axis: usize, k: u32| corner[axis] + size[axis] * f64::from(k) / f64::from(STEPS);
            let (_, ahead) = self.surface.point([at(0, i), at(1, j)]);
            if ahead.is_nan() {
                return [f64::NAN; 2];
            }
            depth = [depth[0].min(ahead), depth[1].max(ahead)];
        }
        depth
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

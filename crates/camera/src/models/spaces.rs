//! The spaces through which a point is transformed to a pixel.
//!
//! ```text
//!  object ──> world ──> camera ──> screen ──> NDC ──> raster
//!         host   affine     projection   affine   affine
//!                (CameraToWorld⁻¹)
//!
//!  world, camera                 screen                        NDC                raster
//!  (world units)                 z: 0 near, 1 far
//!
//!        y  z (forward)          (x0,y1) ┌───────┐ (x1,y1)    (0,0) ┌───> x      (0,0) ┌───> x
//!        │ ╱                             │   │   │                  │  (1,0)           │  (xres,0)
//!        │╱                              │ ──┼── │                  │                  │
//!        o──── x (right)                 │   │   │                  v y (0,1)          v y (0,yres)
//!      eye                       (x0,y0) └───────┘ (x1,y0)
//!
//!  side view of the viewing volume in camera space and in screen space
//!
//!            near  ╱│                        ┌──────┐
//!               ╱│╱ │                        │      │
//!        eye  o  │  │ far       ───>         │      │
//!               ╲│╲ │                        │      │
//!                  ╲│                        └──────┘
//!             z: n   f                    z': 0      1
//! ```
//!
//! * **Object** space is each object's own space, **world** space that of the scene; the host transforms one
//!   to the other. **Camera** space has the eye (for a lens: its front vertex) at the origin.
//! * **Screen** space is camera space projected onto the picture plane; the **screen window** is the part of it that
//!   becomes the image. By default its shorter side reaches from -1 to 1, and the longer one is larger by the **frame
//!   aspect ratio** (width over height).
//! * **NDC** (normalised device coordinates) are fractions of the image, **raster** coordinates are pixels; both
//!   begin at the top left corner and grow to the right and down.
//!
//! Rays are transformed from right to left in this diagram, so a camera needs the inverse transforms.
//! Matrices act on column vectors. They are in single precision and are multiplied in pbrt-v1's order, so
//! that the rays are bit-identical to those of pbrt-v1 (M. Pharr and G. Humphreys, *Physically Based
//! Rendering*, 1st ed. 2004, §6.1-6.2).

use crate::film::Raster;
use realistic_simd::{Cpu, Lanes};

/// A transform from one of the spaces to one on its left that transforms x and y separately: an affine
/// transform, or the inverse of a perspective projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Factor and constant from x to x'.
    x: [f32; 2],
    /// Factor and constant from y to y'.
    y: [f32; 2],
    /// Factors and constants from z to z' and w'.
    zw: [[f32; 2]; 2],
}

impl Projection {
    fn scale([x, y, z]: [f32; 3]) -> Self {
        Self { x: [x, 0.0], y: [y, 0.0], zw: [[z, 0.0], [0.0, 1.0]] }
    }

    fn translate([x, y, z]: [f32; 3]) -> Self {
        Self { x: [1.0, x], y: [1.0, y], zw: [[1.0, z], [0.0, 1.0]] }
    }

    /// Returns the transform from screen space to camera space without perspective, which is the inverse of
    /// z' = (z - n)/(f - n) and leaves x and y unchanged. `near` must be less than `far`.
    pub fn of_orthographic_screen(near: f32, far: f32) -> Self {
        let depth = (1.0 / (far - near)).recip();
        Self::scale([1.0, 1.0, depth]).then(&Self::translate([0.0, 0.0, near]))
    }

    /// Returns the transform from screen space to camera space with perspective. It is the inverse of z' = f
    /// (z - n)/(z (f - n)) and of the division of x and y by z and by the tangent of half the angle `fov`
    /// (degrees, between 0 and 180) that spans [-1, 1] on the screen. 0 < `near` < `far`.
    pub fn of_perspective_screen(fov: f32, near: f32, far: f32) -> Self {
        let per_depth = 1.0 / (far - near);
        let zw = inverse_of_depth(far * per_depth, -far * near * per_depth);
        let half_angle = (std::f32::consts::PI / 180.0) * fov / 2.0;
        let tangent = (1.0 / half_angle.tan()).recip();
        Self::scale([tangent, tangent, 1.0]).then(&Self { x: [1.0, 0.0], y: [1.0, 0.0], zw })
    }

    /// Returns the transform from raster to screen space, through NDC.
    pub fn of_raster(window: ScreenWindow, raster: Raster) -> Self {
        let ScreenWindow([x0, x1, y0, y1]) = window;
        let [width, height] = [1.0 / (x1 - x0), 1.0 / (y0 - y1)].map(f32::recip);
        let of_ndc = Self::scale([width, height, 1.0]).then(&Self::translate([x0, y1, 0.0]));
        Self::scale([(raster.xres as f32).recip(), (raster.yres as f32).recip(), 1.0]).then(&of_ndc)
    }

    /// Returns this transform followed by `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        let line = |[a, b]: [f32; 2], [c, d]: [f32; 2]| [a * c, a * d + b];
        let ([a, b], [c, d]) = (next.zw, self.zw);
        let row = |[p, q]: [f32; 2]| [p * c[0] + q * d[0], p * c[1] + q * d[1]];
        Self { x: line(next.x, self.x), y: line(next.y, self.y), zw: [row(a), row(b)] }
    }

    /// Transforms a point; tests compare [`NearPlane`] with it.
    #[cfg(test)]
    fn point(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let on = |[a, b]: [f32; 2], x: f32| a * x + b;
        let inverse = 1.0 / on(self.zw[1], z);
        [on(self.x, x), on(self.y, y), on(self.zw[0], z)].map(|part| part * inverse)
    }

    /// Returns the near plane of a transform from raster to camera space.
    pub fn near_plane(&self) -> NearPlane {
        let [[_, z], [_, w]] = self.zw;
        let inverse = 1.0 / w;
        NearPlane { x: self.x, y: self.y, inverse, z: z * inverse }
    }
}

/// A [`Projection`] specialized for raster points, whose z is 0: maps them to points of the near plane.
#[derive(Clone, Copy, Debug)]
pub struct NearPlane {
    x: [f32; 2],
    y: [f32; 2],
    /// 1/w.
    inverse: f32,
    z: f32,
}

impl NearPlane {
    /// Returns the camera-space points of raster points, in lanes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = f32>>(&self, cpu: Cpu<L>, [x, y]: [L; 2]) -> [L; 3] {
        let inverse = L::splat(cpu, self.inverse);
        let [[a, b], [c, d]] = [self.x, self.y];
        [
            (L::splat(cpu, a) * x + L::splat(cpu, b)) * inverse,
            (L::splat(cpu, c) * y + L::splat(cpu, d)) * inverse,
            L::splat(cpu, self.z),
        ]
    }
}

/// Returns the inverse of the depth part ((a, b), (1, 0)) of the perspective matrix. In exact arithmetic it
/// is ((0, 1), (1/b, -a/b)). Like pbrt's general inverse, the elimination begins with the largest entry; if
/// that is a, this adds rounding errors, and the near plane moves accordingly.
fn inverse_of_depth(a: f32, b: f32) -> [[f32; 2]; 2] {
    if a > 1.0 && a > b.abs() {
        let p = 1.0 / a;
        let bp = b * p;
        let q = 1.0 / -bp;
        let first = -p * q;
        [[p - first * bp, 0.0 - q * bp], [first, q]]
    } else {
        let q = 1.0 / b;
        [[0.0, 1.0], [q, -a * q]]
    }
}

/// The part of screen space that becomes the image: x at its left and right edges, then y at its bottom and
/// top edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenWindow(pub [f32; 4]);

impl ScreenWindow {
    /// Returns the window of an image whose width is `aspect` times its height: the shorter side reaches from -1 to 1.
    pub fn of_aspect(aspect: f32) -> Self {
        if aspect > 1.0 {
            Self([-aspect, aspect, -1.0, 1.0])
        } else {
            Self([-1.0, 1.0, -1.0 / aspect, 1.0 / aspect])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RASTER: Raster = Raster { xres: 400, yres: 300 };

    #[track_caller]
    fn near(got: [f32; 3], expected: [f32; 3]) {
        for (a, b) in got.iter().zip(expected) {
            assert!((a - b).abs() <= 1e-5 * (1.0 + b.abs()), "{got:?} is not {expected:?}");
        }
    }

    #[test]
    fn depth_goes_from_0_at_the_near_plane_to_1_at_the_far_one() {
        let (n, f) = (2.0, 10.0);
        let orthographic = Projection::of_orthographic_screen(n, f);
        let perspective = Projection::of_perspective_screen(90.0, n, f);
        for z in [2.0, 3.0, 5.0, 10.0] {
            near(orthographic.point([3.0, -4.0, (z - n) / (f - n)]), [3.0, -4.0, z]);
            near(perspective.point([3.0 / z, -4.0 / z, f * (z - n) / (z * (f - n))]), [3.0, -4.0, z]);
        }
    }

    #[test]
    fn the_field_of_view_spans_the_screen_from_minus_1_to_1() {
        for fov in [10.0_f32, 60.0, 90.0, 120.0] {
            let edge = (fov / 2.0).to_radians().tan() * 7.0;
            let (n, f) = (0.5, 20.0);
            let depth = f * (7.0 - n) / (7.0 * (f - n));
            near(Projection::of_perspective_screen(fov, n, f).point([1.0, -1.0, depth]), [edge, -edge, 7.0]);
        }
    }

    #[test]
    fn the_corners_of_the_window_are_the_corners_of_the_raster() {
        let window = ScreenWindow::of_aspect(400.0 / 300.0);
        let ScreenWindow([x0, x1, y0, y1]) = window;
        assert_eq!([y0, y1], [-1.0, 1.0]);
        let raster = Projection::of_raster(window, RASTER);
        near(raster.point([0.0, 0.0, 0.0]), [x0, y1, 0.0]);
        near(raster.point([400.0, 300.0, 1.0]), [x1, y0, 1.0]);
        near(raster.point([200.0, 150.0, 0.0]), [0.0, 0.0, 0.0]);
        assert_eq!(ScreenWindow::of_aspect(0.5), ScreenWindow([-1.0, 1.0, -2.0, 2.0]));
    }

    #[test]
    fn raster_to_camera_puts_the_image_on_the_near_plane() {
        let square = Projection::of_raster(ScreenWindow::of_aspect(1.0), Raster { xres: 100, yres: 100 });
        for (near_plane, far) in [(1e-3, 1e30), (0.5, 3.0), (2.0, 3.0), (5.0, 5.5)] {
            let back = square.then(&Projection::of_perspective_screen(90.0, near_plane, far));
            near(back.point([0.0, 0.0, 0.0]), [-near_plane, near_plane, near_plane]);
            near(back.point([100.0, 50.0, 0.0]), [near_plane, 0.0, near_plane]);
            let back = square.then(&Projection::of_orthographic_screen(near_plane, far));
            near(back.point([100.0, 0.0, 0.0]), [1.0, 1.0, near_plane]);
        }
    }
}

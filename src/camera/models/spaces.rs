//! The spaces that a point passes through on its way to a pixel.
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
//! * **Object** space is each object's own, **world** space the scene's: how one leads to the other is the
//!   host's. **Camera** space has the eye (for a lens: its front vertex) at the origin.
//! * **Screen** space is camera space projected onto the picture plane; the **screen window** is the part of
//!   it that becomes the image. Unless one is given, its shorter side reaches from -1 to 1 and the longer one as
//!   much farther as the **frame aspect ratio** (width over height) says.
//! * **NDC** (normalised device coordinates) are fractions of the image, **raster** coordinates are pixels; both
//!   begin at the top left corner and grow to the right and down.
//!
//! Matrices act on column vectors. They are in single precision and multiplied in pbrt-v1's order, so
//! that the rays made with them have its bits (M. Pharr and G. Humphreys, *Physically Based Rendering*,
//! 1st ed. 2004, §6.1-6.2). A transform knows whether it is affine; the affine ones divide nothing.

use crate::camera::film::Raster;

/// A transform between two of the spaces, and its inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    matrix: Rows,
    inverse: Rows,
    /// Whether parallels stay parallel, so that no point needs a division.
    affine: bool,
}

type Rows = [[f32; 4]; 4];

const LAST_AFFINE: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

impl Projection {
    fn new(matrix: Rows, inverse: Rows) -> Self {
        Self { matrix, inverse, affine: matrix[3] == LAST_AFFINE }
    }

    fn scale([x, y, z]: [f32; 3]) -> Self {
        let rows = |x, y, z| [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0], LAST_AFFINE];
        Self::new(rows(x, y, z), rows(x.recip(), y.recip(), z.recip()))
    }

    fn translate(by: [f32; 3]) -> Self {
        let rows =
            |[x, y, z]: [f32; 3]| [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], LAST_AFFINE];
        Self::new(rows(by), rows(by.map(|part| -part)))
    }

    /// Camera space to screen space without perspective: z' = (z - n)/(f - n), x and y as they are.
    /// Affine. `near` < `far`.
    pub fn orthographic(near: f32, far: f32) -> Self {
        Self::translate([0.0, 0.0, -near]).then(&Self::scale([1.0, 1.0, 1.0 / (far - near)]))
    }

    /// Camera space to screen space with perspective: z' = f (z - n)/(z (f - n)), and x and y divided by z
    /// and by the tangent of half the angle `fov` (degrees, between 0 and 180) that spans [-1, 1] on the screen.
    /// 0 < `near` < `far`.
    pub fn perspective(fov: f32, near: f32, far: f32) -> Self {
        let per_depth = 1.0 / (far - near);
        let (a, b) = (far * per_depth, -far * near * per_depth);
        let [[zz, zw], [wz, ww]] = inverse_of_depth(a, b);
        let divide = Self::new(
            [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, a, b], [0.0, 0.0, 1.0, 0.0]],
            [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, zz, zw], [0.0, 0.0, wz, ww]],
        );
        let half_angle = (std::f32::consts::PI / 180.0) * fov / 2.0;
        let magnification = 1.0 / half_angle.tan();
        divide.then(&Self::scale([magnification, magnification, 1.0]))
    }

    /// Screen space to NDC. Affine.
    pub fn screen_to_ndc(window: ScreenWindow) -> Self {
        let ScreenWindow([x0, x1, y0, y1]) = window;
        Self::translate([-x0, -y1, 0.0]).then(&Self::scale([1.0 / (x1 - x0), 1.0 / (y0 - y1), 1.0]))
    }

    /// NDC to raster. Affine.
    pub fn ndc_to_raster(raster: Raster) -> Self {
        Self::scale([raster.xres as f32, raster.yres as f32, 1.0])
    }

    /// Screen space to raster. Affine.
    pub fn screen_to_raster(window: ScreenWindow, raster: Raster) -> Self {
        Self::screen_to_ndc(window).then(&Self::ndc_to_raster(raster))
    }

    /// Raster to camera space for a projection of [`Projection::orthographic`] or
    /// [`Projection::perspective`]: raster points with z = 0 lie on the near plane.
    pub fn raster_to_camera(camera_to_screen: &Self, window: ScreenWindow, raster: Raster) -> Self {
        Self::screen_to_raster(window, raster).inverse().then(&camera_to_screen.inverse())
    }

    /// This transform, then `next`.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self::new(product(&next.matrix, &self.matrix), product(&self.inverse, &next.inverse))
    }

    /// The way back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self::new(self.inverse, self.matrix)
    }

    /// Transforms a point.
    pub fn point(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let row = |m: &[f32; 4]| m[0] * x + m[1] * y + m[2] * z + m[3];
        let [mx, my, mz, mw] = &self.matrix;
        let point = [row(mx), row(my), row(mz)];
        if self.affine {
            return point;
        }
        let inverse = 1.0 / row(mw);
        point.map(|part| part * inverse)
    }
}

fn product(a: &Rows, b: &Rows) -> Rows {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j] + a[i][3] * b[3][j])
    })
}

/// The inverse of the depth part ((a, b), (1, 0)) of the perspective matrix. In exact arithmetic it
/// is ((0, 1), (1/b, -a/b)); elimination that begins with the largest entry, as pbrt's general inverse
/// does, leaves rounding there when that is a, and the near plane lies where that puts it.
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

/// The part of the screen that becomes the image: x from, x to, y from, y to, in screen space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenWindow(pub [f32; 4]);

impl ScreenWindow {
    /// The window of an image whose width is `aspect` times its height: the shorter side reaches from
    /// -1 to 1.
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
        let orthographic = Projection::orthographic(n, f);
        let perspective = Projection::perspective(90.0, n, f);
        assert!(orthographic.affine && !perspective.affine);
        for z in [2.0, 3.0, 5.0, 10.0] {
            near(orthographic.point([3.0, -4.0, z]), [3.0, -4.0, (z - n) / (f - n)]);
            near(perspective.point([3.0, -4.0, z]), [3.0 / z, -4.0 / z, f * (z - n) / (z * (f - n))]);
        }
    }

    #[test]
    fn the_field_of_view_spans_the_screen_from_minus_1_to_1() {
        for fov in [10.0_f32, 60.0, 90.0, 120.0] {
            let edge = (fov / 2.0).to_radians().tan() * 7.0;
            let [x, y, _] = Projection::perspective(fov, 1e-3, 1e30).point([edge, -edge, 7.0]);
            near([x, y, 0.0], [1.0, -1.0, 0.0]);
        }
    }

    #[test]
    fn the_corners_of_the_window_are_the_corners_of_the_raster() {
        let window = ScreenWindow::of_aspect(400.0 / 300.0);
        let ScreenWindow([x0, x1, y0, y1]) = window;
        assert_eq!([y0, y1], [-1.0, 1.0]);
        let ndc = Projection::screen_to_ndc(window);
        let raster = Projection::screen_to_raster(window, RASTER);
        assert!(ndc.affine && raster.affine);
        near(ndc.point([x0, y1, 0.5]), [0.0, 0.0, 0.5]);
        near(ndc.point([x1, y0, 0.5]), [1.0, 1.0, 0.5]);
        near(raster.point([x0, y1, 0.0]), [0.0, 0.0, 0.0]);
        near(raster.point([x1, y0, 1.0]), [400.0, 300.0, 1.0]);
        near(raster.inverse().point([200.0, 150.0, 0.0]), [0.0, 0.0, 0.0]);
        assert_eq!(ScreenWindow::of_aspect(0.5), ScreenWindow([-1.0, 1.0, -2.0, 2.0]));
    }

    #[test]
    fn raster_to_camera_puts_the_image_on_the_near_plane() {
        let window = ScreenWindow::of_aspect(1.0);
        let square = Raster { xres: 100, yres: 100 };
        for (near_plane, far) in [(1e-3, 1e30), (0.5, 3.0), (2.0, 3.0), (5.0, 5.5)] {
            let to_screen = Projection::perspective(90.0, near_plane, far);
            let back = Projection::raster_to_camera(&to_screen, window, square);
            near(back.point([0.0, 0.0, 0.0]), [-near_plane, near_plane, near_plane]);
            near(back.point([100.0, 50.0, 0.0]), [near_plane, 0.0, near_plane]);
            let to_screen = Projection::orthographic(near_plane, far);
            let back = Projection::raster_to_camera(&to_screen, window, square);
            assert!(back.affine);
            near(back.point([100.0, 0.0, 0.0]), [1.0, 1.0, near_plane]);
        }
    }

    #[test]
    fn a_transform_and_its_inverse_undo_each_other() {
        let window = ScreenWindow([-0.5, 1.5, -1.0, 0.25]);
        let to_screen = Projection::perspective(50.0, 1.0, 4.0);
        let there = to_screen.then(&Projection::screen_to_raster(window, RASTER));
        for point in [[0.1, 0.2, 1.5], [-1.0, 0.7, 2.0], [0.3, -0.6, 3.9]] {
            near(there.inverse().point(there.point(point)), point);
        }
    }
}

//! The surface of a film that is shifted, tilted or curved.
//!
//! The point (u, v) of the flat film, mm from the film's centre, lies in space at
//!
//! ```text
//! C + R (u, v, w),   w = -c r² / (1 + √(1 - c² r²)),   r² = u² + v²,
//! ```
//!
//! where C is the film's centre, R the rotation and c the curvature: the raster is projected along the film's
//! own axis onto a sphere. The unit normal toward the lens is R (c u, c v, 1 + c w).
//!
//! The camera traces all rays from the plane through C perpendicular to the optical axis; flat film without a
//! tilt lies in this plane. A ray that leaves a point of any other surface is extended to this plane;
//! [`FilmPoint::ahead`] is the distance by which the point lies in front of it.

use realistic_base::numeric::{cross, dot, unit};
use realistic_simd::{Cpu, Lanes, OneLane, Portable, Scalar};

/// A film's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSurface {
    /// x and y of the centre, mm.
    shift: [f64; 2],
    /// The rows of the rotation R.
    rotation: [[f64; 3]; 3],
    /// The curvature c, 1/mm: positive if the sphere's centre lies behind the film.
    curvature: f64,
}

/// Points of a film.
#[derive(Clone, Copy, Debug)]
pub struct FilmPoint<L> {
    /// x and y, mm.
    pub point: [L; 2],
    /// Distance in front of the plane through the film's centre perpendicular to the axis, mm.
    pub ahead: L,
    /// The unit normal, toward the lens.
    pub normal: [L; 3],
}

/// Points where rays meet a film.
#[derive(Clone, Copy, Debug)]
pub struct FilmMeeting<L> {
    /// Coordinates (u, v) on the flat film, mm.
    pub flat: [L; 2],
    /// The same point in space.
    pub at: FilmPoint<L>,
    /// Ratio of the flat area du dv to the area on the film's surface: the cosine between the normal and the
    /// film's own axis.
    pub flat_per_area: L,
}

impl FilmSurface {
    /// Flat film perpendicular to the axis and centred on it.
    pub const FLAT: Self = Self {
        shift: [0.0; 2],
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        curvature: 0.0,
    };

    /// Returns a film whose centre is shifted by `shift` mm, which is then tilted by `tilt` degrees, first
    /// about its own x axis and then about its own y axis, and which is curved with the signed radius
    /// `radius` in mm, infinite for a flat film.
    ///
    /// A positive tilt about x turns the normal from the axis toward -y; a positive tilt about y turns it
    /// toward +x. With a positive radius, the centre of curvature lies behind the film.
    pub fn new(shift: [f64; 2], tilt: [f64; 2], radius: f64) -> Self {
        let [[sin_x, cos_x], [sin_y, cos_y]] = tilt.map(|degrees| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            [sin, cos]
        });
        let rotation = [
            [cos_y, 0.0, sin_y],
            [sin_x * sin_y, cos_x, -sin_x * cos_y],
            [-cos_x * sin_y, sin_x, cos_x * cos_y],
        ];
        Self { shift, rotation, curvature: radius.recip() }
    }

    /// Returns x and y of the film's centre, mm.
    pub fn shift(&self) -> [f64; 2] {
        self.shift
    }

    /// Whether all points lie in one plane perpendicular to the axis.
    pub fn is_across(&self) -> bool {
        self.rotation[2][2] == 1.0 && self.curvature == 0.0
    }

    /// Returns whether the surface is symmetric in x, and in y.
    pub fn symmetries(&self) -> [bool; 2] {
        [0, 1].map(|axis| self.shift[axis] == 0.0 && self.rotation[axis][2] == 0.0)
    }

    /// Returns x and y in space, mm, of a point of the flat film, and the distance by which the point lies in
    /// front of the plane through the film's centre perpendicular to the axis.
    pub fn point(&self, flat: [f64; 2]) -> ([f64; 2], f64) {
        let FilmPoint { point, ahead, .. } = self.lifted(flat);
        (point, ahead)
    }

    /// Returns the point of [`FilmSurface::point`] and two perpendicular unit vectors that span the tangent plane there. On
    /// flat film they point along u and v; on curved film u is constant along the second. All are NaN for points beyond the
    /// edge of the sphere.
    pub fn tangent(&self, flat: [f64; 2]) -> ([f64; 2], f64, [[f64; 3]; 2]) {
        let FilmPoint { point, ahead, normal } = self.lifted(flat);
        let u = self.rotation.map(|row| row[0]);
        let cosine = dot(u, normal);
        let along_u = unit(std::array::from_fn(|i| u[i] - cosine * normal[i]));
        (point, ahead, [along_u, cross(normal, along_u)])
    }

    fn lifted(&self, flat: [f64; 2]) -> FilmPoint<f64> {
        let number = |Portable([number])| number;
        let FilmPoint { point, ahead, normal } =
            self.constants().lift(OneLane::cpu(), flat.map(|number| Portable([number])));
        FilmPoint { point: point.map(number), ahead: number(ahead), normal: normal.map(number) }
    }

    /// Returns the surface's constants in the precision of lanes.
    pub fn constants<S: Scalar>(&self) -> SurfaceConstants<S> {
        SurfaceConstants {
            shift: self.shift.map(S::from_f64),
            rotation: self.rotation.map(|row| row.map(S::from_f64)),
            curvature: S::from_f64(self.curvature),
        }
    }
}

/// A [`FilmSurface`] in the precision of lanes.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceConstants<S> {
    shift: [S; 2],
    rotation: [[S; 3]; 3],
    curvature: S,
}

impl<S: Scalar> SurfaceConstants<S> {
    /// Returns the points in space of points of the flat film. They are NaN for flat points beyond the edge
    /// of the sphere.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lift<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, [u, v]: [L; 2]) -> FilmPoint<L> {
        let (one, c) = (L::splat(cpu, S::ONE), L::splat(cpu, self.curvature));
        let square = v.mul_add(v, u * u);
        let cosine = (c * c * square).neg_mul_add(one, one).sqrt();
        let w = (c * square) / (L::splat(cpu, S::ZERO) - one - cosine);
        self.placed(cpu, [u, v, w], [c * u, c * v, cosine])
    }

    /// Returns the points where rays meet the film. A ray is given by its slopes and its point (x, y) in the
    /// plane through the film's centre perpendicular to the axis. The points are NaN for rays that miss the
    /// sphere.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn meet<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        [x, y]: [L; 2],
        [sx, sy]: [L; 2],
    ) -> FilmMeeting<L> {
        let number = |number| L::splat(cpu, number);
        let (zero, one, c) = (number(S::ZERO), number(S::ONE), number(self.curvature));
        // Transforms to the film's own frame by the inverse of R, which is its transpose.
        let own = |[a, b, z]: [L; 3]| -> [L; 3] {
            std::array::from_fn(|k| {
                let [r0, r1, r2] = [0, 1, 2].map(|row| number(self.rotation[row][k]));
                a.mul_add(r0, b.mul_add(r1, z * r2))
            })
        };
        let [ox, oy, oz] = own([x - number(self.shift[0]), y - number(self.shift[1]), zero]);
        let [dx, dy, dz] = own([sx, sy, one]);
        let dot = |a: [L; 3], b: [L; 3]| a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]));
        // The sphere is c (u² + v² + w²) + 2 w = 0. Of the two roots, this computes the one near the film's
        // plane, in the form without cancellation.
        let a = c * dot([dx, dy, dz], [dx, dy, dz]);
        let b = dz + c * dot([ox, oy, oz], [dx, dy, dz]);
        let e = oz + oz + c * dot([ox, oy, oz], [ox, oy, oz]);
        let root = b.mul_add(b, zero - a * e).sqrt();
        let along = (zero - e) / (b + L::select(b.less(zero), zero - root, root));
        let [u, v, w] = [along.mul_add(dx, ox), along.mul_add(dy, oy), along.mul_add(dz, oz)];
        let cosine = c.mul_add(w, one);
        let at = self.placed(cpu, [u, v, w], [c * u, c * v, cosine]);
        FilmMeeting { flat: [u, v], at, flat_per_area: cosine }
    }

    /// Transforms a point and a normal from the film's own frame to space.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn placed<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, point: [L; 3], normal: [L; 3]) -> FilmPoint<L> {
        let number = |number| L::splat(cpu, number);
        let turned = |[a, b, z]: [L; 3]| -> [L; 3] {
            self.rotation.map(|[r0, r1, r2]| a.mul_add(number(r0), b.mul_add(number(r1), z * number(r2))))
        };
        let [x, y, ahead] = turned(point);
        let point = [x + number(self.shift[0]), y + number(self.shift[1])];
        FilmPoint { point, ahead, normal: turned(normal) }
    }
}

impl<L: Lanes> FilmPoint<L> {
    /// Returns cos θ_f/cos θ_a for rays with slopes, where θ_f is the angle to the film's normal and θ_a the
    /// angle to the axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn facing(&self, [sx, sy]: [L; 2]) -> L {
        let [nx, ny, nz] = self.normal;
        sx.mul_add(nx, sy.mul_add(ny, nz))
    }

    /// Returns the points where rays with slopes cross the plane through the film's centre perpendicular to
    /// the axis.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn on_plane(&self, [sx, sy]: [L; 2]) -> [L; 2] {
        let [x, y] = self.point;
        [self.ahead.neg_mul_add(sx, x), self.ahead.neg_mul_add(sy, y)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    type One = Portable<f64, 1>;

    fn lanes<const N: usize>(numbers: [f64; N]) -> [One; N] {
        numbers.map(|number| Portable([number]))
    }

    fn numbers<const N: usize>(lanes: [One; N]) -> [f64; N] {
        lanes.map(|Portable([number])| number)
    }

    fn lift(surface: &FilmSurface, flat: [f64; 2]) -> ([f64; 2], f64, [f64; 3]) {
        let FilmPoint { point, ahead, normal } = surface.lifted(flat);
        (point, ahead, normal)
    }

    #[test]
    fn a_tilt_turns_the_normal_as_documented_and_the_second_axis_with_the_first() {
        let [sin, cos] = [30.0_f64.to_radians().sin(), 30.0_f64.to_radians().cos()];
        for (tilt, expected) in [([30.0, 0.0], [0.0, -sin, cos]), ([0.0, 30.0], [sin, 0.0, cos])] {
            let (_, _, normal) = lift(&FilmSurface::new([0.0; 2], tilt, f64::INFINITY), [0.0; 2]);
            for axis in 0..3 {
                assert!((normal[axis] - expected[axis]).abs() < 1e-15, "{tilt:?} {normal:?}");
            }
        }
        // After a rotation by 90° about x, the film's own y axis points to +z.
        let ([x, y], ahead, normal) =
            lift(&FilmSurface::new([1.0, 2.0], [90.0, 30.0], f64::INFINITY), [0.0, 3.0]);
        assert!((x - 1.0).abs() < 1e-15 && (y - 2.0).abs() < 1e-15 && (ahead - 3.0).abs() < 1e-15);
        assert!((normal[0] - sin).abs() < 1e-15 && (normal[1] + cos).abs() < 1e-15, "{normal:?}");
    }

    #[test]
    fn a_curved_film_lies_on_its_sphere_with_the_normal_along_the_radius() {
        for radius in [-12.0, 30.0] {
            let surface = FilmSurface::new([0.5, -0.25], [0.0; 2], radius);
            let ([x, y], ahead, normal) = lift(&surface, [3.0, 4.0]);
            let from_centre = [x - 0.5, y + 0.25, ahead + radius];
            let distance = from_centre.iter().map(|part| part * part).sum::<f64>().sqrt();
            assert!((distance - radius.abs()).abs() < 1e-13 && (ahead < 0.0) == (radius > 0.0), "{ahead}");
            for axis in 0..3 {
                assert!((normal[axis] - from_centre[axis] / radius).abs() < 1e-15, "{normal:?}");
            }
        }
    }

    #[test]
    fn the_tangent_plane_is_perpendicular_to_the_normal_and_follows_the_film() {
        for radius in [-12.0, 30.0, f64::INFINITY] {
            let surface = FilmSurface::new([0.5, -0.25], [20.0, -7.0], radius);
            let flat = [3.0, 4.0];
            let (point, ahead, [along_u, along_v]) = surface.tangent(flat);
            assert_eq!((point, ahead), surface.point(flat));
            let (_, _, normal) = lift(&surface, flat);
            for (a, b, expected) in [
                (along_u, normal, 0.0),
                (along_v, normal, 0.0),
                (along_u, along_v, 0.0),
                (along_u, along_u, 1.0),
                (along_v, along_v, 1.0),
            ] {
                assert!((dot(a, b) - expected).abs() < 1e-14, "{radius}: {a:?} {b:?}");
            }
            // The film's point moves along the second axis if v grows.
            let step = 1e-4;
            let [([ax, ay], a), ([bx, by], b)] =
                [-step, step].map(|step| surface.point([flat[0], flat[1] + step]));
            let moved = [bx - ax, by - ay, b - a];
            let length = dot(moved, moved).sqrt();
            assert!((dot(moved, along_v) / length - 1.0).abs() < 1e-7, "{radius}: {moved:?}");
            assert!((dot(moved, along_u) / length).abs() < 1e-7, "{radius}: {moved:?}");
        }
        assert!(FilmSurface::new([0.0; 2], [0.0; 2], 4.0).tangent([3.0, 4.0]).1.is_nan());
    }

    #[test]
    fn rays_that_leave_a_point_meet_the_film_there() {
        for (k, radius) in [f64::INFINITY, -14.0, 25.0].into_iter().cycle().take(60).enumerate() {
            let at = |step: f64| 2.0 * (0.5 + k as f64 * step).fract() - 1.0;
            let surface =
                FilmSurface::new([at(0.37), 2.0 * at(0.61)], [25.0 * at(0.23), 30.0 * at(0.71)], radius);
            let (flat, slopes) = ([5.0 * at(0.11), 6.0 * at(0.53)], [0.5 * at(0.19), 0.5 * at(0.83)]);
            let (constants, cpu) = (surface.constants(), OneLane::cpu());
            let left = constants.lift::<One>(cpu, lanes(flat));
            let met = constants.meet(cpu, left.on_plane(lanes(slopes)), lanes(slopes));
            let (found, ahead) = (numbers(met.flat), numbers([left.ahead, met.at.ahead]));
            for axis in 0..2 {
                assert!((found[axis] - flat[axis]).abs() < 1e-12, "{surface:?} {flat:?} {found:?}");
            }
            assert!((ahead[0] - ahead[1]).abs() < 1e-12, "{ahead:?}");
            let [own, facing] = numbers([left.facing(lanes(slopes)), met.at.facing(lanes(slopes))]);
            assert!((own - facing).abs() < 1e-12, "{own} {facing}");
        }
    }
}

//! Intersection of a ray with a surface that is not symmetric about its axis, in numbers of any type.
//!
//! Coordinates are in the frame of the vertex, with the axis along the direction of travel. The surface is z = h(x, y),
//! and φ = z - h is negative before it. N = (-∂h/∂x, -∂h/∂y, 1), normalised, points ahead.
//!
//! **Cylinders** without terms are quadratic. With u the coordinate across the cylinder, V_u its part of V, A = c (V_u² +
//! (1 + k) Vz²) and g = Vz - c u V_u on the vertex plane, e = √(g² - A c u²) and t = c u²/(g + e) = (g - e)/A is the root
//! at which the ray crosses toward the side ahead; the other one is t + 2 e/A.
//!
//! **Other surfaces** are reached by steps that cannot skip a crossing. Along a ray φ'' <= H, where H is the least
//! second derivative of h, negated, times Vx² + Vy² ([`RegionBounds`]). From a point before the surface, φ stays
//! negative up to the point where the parabola with φ, φ' and H reaches 0; the next step begins there. The steps
//! converge as Newton's do, because near the crossing the parabola is a tangent, and their limit is the first crossing
//! after the start.

use super::{Blocked, State};
use crate::{
    lens::{RegionBounds, UnsymmetricFigure},
    prescription::{Cylinder, Meridian, UnsymmetricConstants},
};
use realistic_base::numeric::{Gradient, Real, dot};

/// A surface of a path that is not symmetric about its axis, with z along the direction of travel.
#[derive(Clone, Debug)]
pub struct UnsymmetricSheet<R> {
    /// The surface.
    pub constants: UnsymmetricConstants<R>,
    /// The cylinder that the surface is, if it is one without terms.
    pub cylinder: Option<CylinderSheet<R>>,
    /// Bounds from the axis to the edge of the clear aperture.
    pub inside: SheetBounds,
    /// Bounds from the axis to the reach.
    pub beyond: SheetBounds,
    /// The square of the clear semi-diameter, mm².
    pub rim: R,
    /// The squared distance from the axis up to which the bounds hold, mm².
    pub reach: f64,
    /// Rounding error of φ, mm. Values of |φ| up to this error count as 0.
    pub tolerance: f64,
}

/// A cylinder whose section is a conic.
#[derive(Clone, Copy, Debug)]
pub struct CylinderSheet<R> {
    /// Whether the cylinder is curved in x; otherwise it is curved in y.
    pub is_in_x: bool,
    /// The vertex curvature, positive if the centre lies ahead.
    pub curvature: R,
    /// 1 + k.
    pub kappa: R,
}

/// Bounds of a surface, with z along the direction of travel.
#[derive(Clone, Copy, Debug)]
pub struct SheetBounds {
    /// The least and the greatest z, mm, with a small margin.
    pub extent: [f64; 2],
    /// Factor of Vx² + Vy² in the bound of φ'', 1/mm, at least 0.
    pub bend: f64,
}

/// Maximum number of steps along a ray.
const STEPS: u32 = 256;

impl SheetBounds {
    fn new(bounds: &RegionBounds, is_forward: bool, margin: f64) -> Self {
        let signed = |[low, high]: [f64; 2]| if is_forward { [low, high] } else { [-high, -low] };
        let [low, high] = signed(bounds.sagitta);
        Self { extent: [low - margin, high + margin], bend: (-signed(bounds.curvature)[0]).max(0.0) }
    }
}

impl<R: Real> UnsymmetricSheet<R> {
    /// Builds the surface as light meets it that travels toward +z of the file's frames if `is_forward`.
    pub fn new(figure: &UnsymmetricFigure, is_forward: bool) -> Self {
        let sign = if is_forward { 1.0 } else { -1.0 };
        let [low, high] = figure.inside.sagitta;
        let size = figure.rim + (high - low).min(figure.rim);
        let margin = 1024.0 * R::EPSILON * size;
        let cylinder = figure.cylinder().map(|Cylinder { meridian, radius, conic }| CylinderSheet {
            is_in_x: meridian == Meridian::X,
            curvature: R::from_f64(sign) / R::from_f64(radius),
            kappa: R::ONE + R::from_f64(conic),
        });
        Self {
            constants: figure.surface.constants(sign).map(R::from_f64),
            cylinder,
            inside: SheetBounds::new(&figure.inside, is_forward, margin),
            beyond: SheetBounds::new(&figure.beyond, is_forward, margin),
            rim: R::from_f64(figure.rim) * R::from_f64(figure.rim),
            reach: figure.reach * figure.reach,
            tolerance: 16.0 * R::EPSILON * size,
        }
    }

    /// Moves the ray to the surface. The hit may lie up to `slack` (in units of V) before the last point of the ray.
    pub(super) fn meet(&self, state: &mut State<R>, slack: R) -> Result<(), Blocked> {
        let v = state.v;
        let (start, last) = state.at_vertex_plane(slack)?;
        let t = match &self.cylinder {
            // In front of its aperture the other half of a cylinder is not part of the surface.
            Some(cylinder) => {
                let lowest = R::from_f64(self.inside.extent[0]) / v[2];
                cylinder.crossing(start, v, if last > lowest { last } else { lowest })?
            }
            None => self.first_crossing(start, v, last)?,
        };
        *state = State { p: std::array::from_fn(|i| start[i] + t * v[i]), lead: R::ZERO, ..*state };
        Ok(())
    }

    /// Returns the first crossing of the ray and the surface after `from`, as a distance from `start`, a point of the
    /// vertex plane, in units of V.
    ///
    /// # Errors
    /// The reason why the ray does not reach the surface.
    pub fn first_crossing(&self, start: [R; 3], v: [R; 3], from: R) -> Result<R, Blocked> {
        let number = R::from_f64;
        let across = v[0] * v[0] + v[1] * v[1];
        let bends = [&self.inside, &self.beyond].map(|bounds| number(bounds.bend) * across);
        let lowest = number(self.beyond.extent[0]) / v[2];
        let end = number(self.beyond.extent[1]) / v[2];
        let height_squared = |t: R| {
            let [x, y] = [0, 1].map(|i| start[i] + t * v[i]);
            x * x + y * y
        };
        let mut t = self.within_reach(start, v, if from > lowest { from } else { lowest })?;
        let beside = |t: R| if height_squared(t) <= self.rim { Blocked::Missed } else { Blocked::Clipped };
        let two = number(2.0);
        for _ in 0..STEPS {
            if !(t <= end && height_squared(t) <= number(self.reach * BESIDE)) {
                return Err(beside(t));
            }
            let [before, facing] = self.measure(start, v, t);
            let distance = before.to_f64();
            if distance.abs() <= self.tolerance {
                let t = t + before / facing;
                return if facing > R::ZERO { Ok(t) } else { Err(beside(t)) };
            }
            if !(distance > 0.0) {
                // The ray starts behind the surface.
                return Err(if height_squared(t) <= self.rim {
                    Blocked::TurnedBack
                } else {
                    Blocked::Clipped
                });
            }
            let step = |bend: R| two * before / (facing + (facing * facing + two * bend * before).sqrt());
            let by_inside = step(bends[0]);
            let stays_inside = height_squared(t) <= self.rim && height_squared(t + by_inside) <= self.rim;
            let step = if stays_inside && by_inside > R::ZERO { by_inside } else { step(bends[1]) };
            if !(step > R::ZERO) {
                return Err(beside(t));
            }
            t = t + step;
        }
        Err(Blocked::Missed)
    }

    /// Returns -φ and φ' at t.
    fn measure(&self, start: [R; 3], v: [R; 3], t: R) -> [R; 2] {
        let [x, y, z] = std::array::from_fn(|i| start[i] + t * v[i]);
        let Gradient { value, x, y } = self.with_gradient([x, y]);
        [value - z, v[2] - x * v[0] - y * v[1]]
    }

    /// Returns h with its derivatives.
    fn with_gradient(&self, [x, y]: [R; 2]) -> Gradient<R> {
        let x = Gradient { value: x, x: R::ONE, y: R::ZERO };
        let y = Gradient { value: y, x: R::ZERO, y: R::ONE };
        self.constants.sagitta([x, y])
    }

    /// Returns the first t, from `from` on, at which the ray lies within the reach of the bounds.
    fn within_reach(&self, start: [R; 3], v: [R; 3], from: R) -> Result<R, Blocked> {
        let reach = R::from_f64(self.reach);
        let [x, y] = [0, 1].map(|i| start[i] + from * v[i]);
        if x * x + y * y <= reach {
            return Ok(from);
        }
        let (across, along) = (v[0] * v[0] + v[1] * v[1], x * v[0] + y * v[1]);
        let to_reach = -(along + (along * along - across * (x * x + y * y - reach)).sqrt()) / across;
        // The condition is negated so that a ray that never comes within reach is also blocked.
        if !(to_reach > R::ZERO) { Err(Blocked::Clipped) } else { Ok(from + to_reach) }
    }

    /// Returns the unit normal at a point of the surface, pointing to the side ahead.
    pub fn normal(&self, point: [R; 3]) -> [R; 3] {
        let normal = match &self.cylinder {
            Some(cylinder) => cylinder.normal(point),
            None => {
                let Gradient { x, y, .. } = self.with_gradient([point[0], point[1]]);
                [-x, -y, R::ONE]
            }
        };
        let length = dot(normal, normal).sqrt();
        normal.map(|component| component / length)
    }
}

/// Factor by which rounding may move a squared distance beyond the bound on it.
const BESIDE: f64 = 1.0 + 1e-6;

impl<R: Real> CylinderSheet<R> {
    /// Returns the crossing toward the side ahead, if it is the first after `from`, as a distance from `start`, a point
    /// of the vertex plane.
    fn crossing(&self, start: [R; 3], v: [R; 3], from: R) -> Result<R, Blocked> {
        let (c, i) = (self.curvature, usize::from(!self.is_in_x));
        let (u, vu) = (start[i], v[i]);
        let a = c * (vu * vu + self.kappa * v[2] * v[2]);
        let g = v[2] - c * u * vu;
        let square = g * g - a * c * u * u;
        // The condition is negated so that NaN also blocks the ray.
        if !(square > R::ZERO) {
            return Err(Blocked::Missed);
        }
        let e = square.sqrt();
        let t = if g > R::ZERO { c * u * u / (g + e) } else { (g - e) / a };
        let z = t * v[2];
        if !(R::ONE - self.kappa * c * z > R::ZERO) {
            return Err(Blocked::Missed);
        }
        let is_first = t >= from && -(a * (t - from)) < e + e;
        if is_first { Ok(t) } else { Err(Blocked::TurnedBack) }
    }

    /// Returns the normal at a point, not normalised.
    fn normal(&self, point: [R; 3]) -> [R; 3] {
        let mut normal = [R::ZERO, R::ZERO, R::ONE - self.kappa * self.curvature * point[2]];
        let i = usize::from(!self.is_in_x);
        normal[i] = -(self.curvature * point[i]);
        normal
    }
}

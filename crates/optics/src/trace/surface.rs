//! One surface of a path. Intersects a ray, in the frame of the surface's vertex, and refracts it, or returns the
//! reason why the ray is blocked.
//!
//! In that frame, with the axis along the direction of travel and the curvature c, the sphere is (c/2)(x² + y² + z²) -
//! z = 0, and its unit normal is N = (-c x, -c y, 1 - c z). Both formulas also hold for a plane, c = 0, and stay
//! accurate for any radius. With V = n D, the hit lies at P + t V, where t = 2 f/(g + e). Here f is the left side of
//! the sphere's equation at P, g is N·V at P, and e = sqrt(g² - 2 c n² f) is n cos I at the hit. Of the two roots, this
//! is the one at which the ray crosses toward the side ahead. The near side of the sphere is therefore met whether the
//! centre lies ahead or behind. The module `aspheric` intersects aspheres.

use std::sync::Arc;

use super::{
    Blocked, State, aperture::ApertureTest, aspheric::Aspheric, frame_change::FrameChange,
    unsymmetric::UnsymmetricSheet,
};
use crate::lens::{
    Surface,
    refraction::{self, Refraction},
};
use realistic_base::numeric::{Real, dot};

/// Ratio of the distance from the vertex to the radius of curvature beyond which the ray is first moved to the vertex
/// plane. At the ray's start the equation of the sphere loses precision by that ratio.
const FAR: f64 = 2.0;

/// One surface of a path, in a frame whose axis points along the direction of travel and whose origin is the surface's
/// vertex.
#[derive(Clone, Debug)]
pub struct PathSurface<R> {
    /// Index of the lens surface, counted along the path's direction.
    pub along: usize,
    /// Whether rays meet the surface against the path's direction, between two mirrors.
    pub is_backward: bool,
    /// Whether the surface reflects rays. For a mirror, `n_after` equals `n`.
    pub is_mirror: bool,
    /// Refractive index of the medium on the side ahead.
    pub n_behind: f64,
    /// Distance from the previous surface's vertex, mm; 0 for the first surface.
    pub distance: R,
    /// The change to the frame of this surface, in place of the distance, if the surfaces do not share an axis.
    pub change: Option<Arc<FrameChange<R>>>,
    /// 1/radius; positive if the centre lies ahead.
    pub curvature: R,
    /// The asphere, if the surface is neither a sphere nor a plane.
    pub aspheric: Option<Arc<Aspheric<R>>>,
    /// The surface, if it is not symmetric about its axis.
    pub unsymmetric: Option<Arc<UnsymmetricSheet<R>>>,
    /// Refractive index of the medium before the surface.
    pub n: R,
    /// Refractive index of the medium in which the ray continues.
    pub n_after: R,
    /// `n_after`² - `n`².
    pub index_step: R,
    /// Square of the clear semi-diameter.
    pub aperture: R,
    /// The tests of the apertures and obstructions inside the clear aperture.
    pub apertures: Arc<[ApertureTest<R>]>,
    /// Distance, in units of V, by which a hit may lie behind the ray's last surface through rounding alone. The
    /// distance is unbounded where the two surfaces touch, because they may then overlap slightly. It is unused for a
    /// plane that only limits rays. If such a plane lies inside its neighbour's bulge, the straight line of the ray
    /// meets the plane before or behind the neighbour.
    pub slack: R,
}

impl<R: Real> PathSurface<R> {
    /// Prepares a surface of a lens for rays that come from the scene's side (`from_scene`) or from the film's.
    /// `distance` is the distance from the vertex of the previous surface.
    pub fn new(surface: &Surface, from_scene: bool, distance: f64) -> Self {
        let Surface { n_scene, n_film, radius, curvature, semi_diameter, .. } = *surface;
        let (n, n_after) = if from_scene { (n_scene, n_film) } else { (n_film, n_scene) };
        // Both sides of a mirror lie on the same side of the surface.
        let forward = surface.is_reversed != (from_scene || surface.is_mirror);
        // A type wider than double computes the reciprocal and the difference of squares itself. For the other types,
        // both are computed in double and rounded once.
        let (curvature, index_step) = if R::EPSILON < f64::EPSILON {
            let [n, n_after] = [n, n_after].map(R::from_f64);
            let curvature = if curvature == 0.0 { R::ZERO } else { R::ONE / R::from_f64(radius) };
            (curvature, (n_after - n) * (n_after + n))
        } else {
            (R::from_f64(curvature), R::from_f64((n_after - n) * (n_after + n)))
        };
        // Rounding errors reached 60 EPSILON at an incidence of 65 degrees.
        let slack = 512.0 * R::EPSILON * (semi_diameter + distance.abs());
        Self {
            along: 0,
            is_backward: false,
            is_mirror: surface.is_mirror,
            n_behind: n_after,
            distance: R::from_f64(distance),
            change: None,
            curvature: if forward { curvature } else { -curvature },
            aspheric: surface.figure.map(|figure| Arc::new(Aspheric::new(&figure, forward, n))),
            unsymmetric: surface
                .unsymmetric
                .as_ref()
                .map(|figure| Arc::new(UnsymmetricSheet::new(figure, forward))),
            n: R::from_f64(n),
            n_after: R::from_f64(n_after),
            index_step,
            aperture: R::from_f64(semi_diameter) * R::from_f64(semi_diameter),
            apertures: Arc::default(),
            slack: R::from_f64(slack),
        }
    }

    /// Returns the same surface as a mirror.
    #[must_use]
    pub fn mirror(self) -> Self {
        Self { is_mirror: true, n_after: self.n, index_step: R::ZERO, ..self }
    }

    /// Returns the same surface between media of other indices, which are in the order of travel. The bounds of an
    /// asphere remain those for the largest index with which the surface was built. Allocates no memory.
    #[must_use]
    pub fn between(&self, [n, n_behind]: [f64; 2]) -> Self {
        let n_after = if self.is_mirror { n } else { n_behind };
        Self {
            n: R::from_f64(n),
            n_behind,
            n_after: R::from_f64(n_after),
            index_step: R::from_f64((n_after - n) * (n_after + n)),
            ..self.clone()
        }
    }

    /// Returns whether this is a plane within one medium: a stop or a flare stop.
    pub fn only_limits(&self) -> bool {
        let is_plane = self.curvature == R::ZERO && self.aspheric.is_none() && self.unsymmetric.is_none();
        is_plane && self.index_step == R::ZERO && !self.is_mirror
    }

    /// Takes a ray from the frame of the previous surface's vertex to that of this one.
    #[inline(always)]
    pub(super) fn enter_frame(&self, state: &mut State<R>) {
        match &self.change {
            None => state.p[2] = state.p[2] - self.distance,
            Some(change) => change.apply(state),
        }
    }

    /// Moves the ray, given in the frame of this surface's vertex, to the surface.
    // Inlined, like the functions below. A call would pass the state through memory, and at every surface a wide load
    // would then wait for the narrow stores before it.
    #[inline(always)]
    pub fn meet(&self, state: &mut State<R>) -> Result<(), Blocked> {
        if let Some(aspheric) = &self.aspheric {
            return aspheric.meet(state, self.slack);
        }
        if let Some(unsymmetric) = &self.unsymmetric {
            return unsymmetric.meet(state, self.slack);
        }
        let State { p, v, lead, .. } = state;
        let c = self.curvature;
        let advance = |p: &mut [R; 3], t: R| (0..3).for_each(|i| p[i] = p[i] + t * v[i]);
        if v[2] > R::ZERO && -p[2] * if c < R::ZERO { -c } else { c } > R::from_f64(FAR) {
            let to_plane = -p[2] / v[2];
            *lead = *lead + to_plane;
            advance(p, to_plane);
            p[2] = R::ZERO;
        }
        let two = R::from_f64(2.0);
        let n_squared = self.n * self.n;
        let f = c / two * dot(*p, *p) - p[2];
        let g = v[2] - c * dot(*p, *v);
        let discriminant = g * g - two * c * n_squared * f;
        // The condition is negated so that NaN also blocks the ray.
        if !(discriminant > R::ZERO) {
            return Err(Blocked::Missed);
        }
        let e = discriminant.sqrt();
        let t = if g > R::ZERO { two * f / (g + e) } else { (g - e) / (c * n_squared) };
        let only_limits = self.only_limits();
        if !only_limits && *lead + t < -self.slack {
            return Err(Blocked::TurnedBack);
        }
        *lead = if only_limits { *lead + t } else { R::ZERO };
        advance(p, t);
        // Beyond the equator, the sphere is not part of the surface.
        if R::ONE - c * p[2] < R::ZERO {
            return Err(Blocked::Missed);
        }
        Ok(())
    }

    /// Tests the ray against the aperture, and refracts or reflects it.
    #[inline(always)]
    pub fn pass(&self, state: &mut State<R>, method: Refraction) -> Result<(), Blocked> {
        let [x, y, _] = state.p;
        if !(x * x + y * y <= self.aperture && self.apertures.iter().all(|test| test.passes([x, y]))) {
            return Err(Blocked::Clipped);
        }
        self.refract(state, method)
    }

    /// Returns z of the surface at (x, y); NaN where it ends.
    pub fn height(&self, [x, y]: [R; 2]) -> R {
        let u = x * x + y * y;
        match (&self.aspheric, &self.unsymmetric) {
            (Some(aspheric), _) => aspheric.height(u),
            (None, Some(unsymmetric)) => unsymmetric.constants.sagitta([x, y]),
            (None, None) => {
                let c = self.curvature;
                c * u / (R::ONE + (R::ONE - c * c * u).sqrt())
            }
        }
    }

    /// Returns the unit normal at a point of this surface, pointing to the side ahead.
    #[inline(always)]
    pub fn normal(&self, point: [R; 3]) -> [R; 3] {
        if let Some(aspheric) = &self.aspheric {
            return aspheric.normal(point);
        }
        if let Some(unsymmetric) = &self.unsymmetric {
            return unsymmetric.normal(point);
        }
        let ([x, y, z], c) = (point, self.curvature);
        [-c * x, -c * y, R::ONE - c * z]
    }

    /// Refracts the ray by Snell's law, or reflects it, at its current point on this surface.
    #[inline(always)]
    pub fn refract(&self, state: &mut State<R>, method: Refraction) -> Result<(), Blocked> {
        let normal = self.normal(state.p);
        let State { p, v, .. } = state;
        let e = dot(normal, *v);
        if self.is_mirror {
            // The reflected vector is V - 2 e N. From here on, z points along the reversed travel.
            let twice = R::from_f64(2.0) * e;
            *v = [v[0] - twice * normal[0], v[1] - twice * normal[1], twice * normal[2] - v[2]];
            p[2] = -p[2];
            return Ok(());
        }
        if !(e * e + self.index_step > R::ZERO) {
            return Err(Blocked::Reflected);
        }
        let unit_method = match method {
            Refraction::Fused => {
                *v = refraction::fused(*v, normal, e, self.index_step);
                return Ok(());
            }
            Refraction::Heckbert => refraction::heckbert,
            Refraction::Whitted => refraction::whitted,
            Refraction::Other => refraction::other,
        };
        let incident = v.map(|component| component / self.n);
        let after = unit_method(incident, normal, self.n, self.n_after);
        // Because of its own rounding, a method may find total reflection where the test above does not.
        if !(dot(after, after) < R::from_f64(2.0)) {
            return Err(Blocked::Reflected);
        }
        *v = after.map(|d| d * self.n_after);
        Ok(())
    }
}

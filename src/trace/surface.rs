//! One surface of a path: a ray in the frame of its vertex goes in; the ray on it, or refracted behind it, or why it
//! stops there comes out.
//!
//! In the frame of a surface's vertex, axis along the travel, with c its curvature, the sphere is
//! (c/2)(x² + y² + z²) - z = 0 and its unit normal there N = (-c x, -c y, 1 - c z): both hold for
//! the plane, c = 0, and stay accurate for any radius. With V = n D the hit lies at P + t V,
//! t = 2 f/(g + e), where f is the left side at P, g = N·V there, and e = sqrt(g² - 2 c n² f) is
//! n cos I at the hit.
//! Of the two roots this is the one at which the ray crosses toward the side ahead, so the
//! near side of the sphere is met whether its centre lies ahead or behind. Aspheres are met in `aspheric`.

use std::sync::Arc;

use super::{Blocked, State, aspheric::Aspheric};
use crate::{
    lens::{Surface, refraction, refraction::Refraction},
    numeric::{Real, dot},
    prescription::{BladeConstants, Blades},
};

/// Distance to the vertex over radius of curvature beyond which the ray is first moved to the
/// vertex plane: the sphere's equation loses that factor in digits at the ray's start.
const FAR: f64 = 2.0;

/// What one surface asks of a ray, in a frame whose axis points along the travel and whose
/// origin is the surface's vertex.
#[derive(Clone, Debug)]
pub struct PathSurface<R> {
    /// Which surface of the lens, counted along the path's direction.
    pub along: usize,
    /// Whether rays meet it against the path's direction, between two mirrors.
    pub is_backward: bool,
    /// Whether it reflects rays; then `n_after` is `n`.
    pub is_mirror: bool,
    /// Refractive index on the side ahead.
    pub n_behind: f64,
    /// From the previous surface's vertex to this one's; 0 for the first.
    pub distance: R,
    /// 1/radius; positive when the centre lies ahead.
    pub curvature: R,
    /// The whole of a surface that is neither a sphere nor a plane.
    pub aspheric: Option<Arc<Aspheric<R>>>,
    /// Refractive index before.
    pub n: R,
    /// Refractive index after.
    pub n_after: R,
    /// n'^2 - n^2.
    pub index_step: R,
    /// Square of the clear semi-diameter.
    pub aperture: R,
    /// The figure that a stop's blades leave open, inside the clear aperture.
    pub blades: Option<Arc<StopFigure<R>>>,
    /// How far behind the ray's last surface a hit may lie by rounding alone, in units of V; without bound where the two
    /// surfaces touch, which may overlap a little. Of no meaning for a plane that
    /// only limits rays: one inside its neighbour's bulge is met by the ray's straight line before, or behind, the neighbour.
    pub slack: R,
}

impl<R: Real> PathSurface<R> {
    pub fn new(surface: &Surface, forward: bool, distance: f64) -> Self {
        let Surface { n_scene, n_film, radius, curvature, semi_diameter, .. } = *surface;
        let (n, n_after) = if forward { (n_scene, n_film) } else { (n_film, n_scene) };
        // A type wider than double takes the reciprocal and the difference of squares itself; for
        // the others they are rounded once, from double.
        let (curvature, index_step) = if R::EPSILON < f64::EPSILON {
            let [n, n_after] = [n, n_after].map(R::from_f64);
            let curvature = if curvature == 0.0 { R::ZERO } else { R::ONE / R::from_f64(radius) };
            (curvature, (n_after - n) * (n_after + n))
        } else {
            (R::from_f64(curvature), R::from_f64((n_after - n) * (n_after + n)))
        };
        // At an incidence of 65 degrees rounding was seen to reach 60 EPSILON.
        let slack = 512.0 * R::EPSILON * (semi_diameter + distance.abs());
        Self {
            along: 0,
            is_backward: false,
            is_mirror: false,
            n_behind: n_after,
            distance: R::from_f64(distance),
            curvature: if forward { curvature } else { -curvature },
            aspheric: surface.figure.map(|figure| Arc::new(Aspheric::new(&figure, forward, n))),
            n: R::from_f64(n),
            n_after: R::from_f64(n_after),
            index_step,
            aperture: R::from_f64(semi_diameter) * R::from_f64(semi_diameter),
            blades: None,
            slack: R::from_f64(slack),
        }
    }

    /// The same surface as a mirror.
    #[must_use]
    pub fn mirror(self) -> Self {
        Self { is_mirror: true, n_after: self.n, index_step: R::ZERO, ..self }
    }

    /// Returns the same surface between media of other indices, in the order of the travel. The bounds of an asphere stay those
    /// of the largest index that the surface was made with. Allocates nothing.
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

    /// Whether this is a plane in one medium: a stop or a flare stop.
    pub fn only_limits(&self) -> bool {
        self.curvature == R::ZERO && self.index_step == R::ZERO && self.aspheric.is_none() && !self.is_mirror
    }

    /// Moves the ray to this surface, in the frame of whose vertex it is given.
    // Inlined, here and below: between functions the state goes through memory, where a wide load has to wait for
    // the narrow stores before it, at every surface.
    #[inline(always)]
    pub fn meet(&self, state: &mut State<R>) -> Result<(), Blocked> {
        if let Some(aspheric) = &self.aspheric {
            return aspheric.meet(state, self.slack);
        }
        let State { p, v, lead } = state;
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
        // Negated so that NaN blocks the ray, too.
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
        // Beyond the equator the sphere is no part of the surface.
        if R::ONE - c * p[2] < R::ZERO {
            return Err(Blocked::Missed);
        }
        Ok(())
    }

    /// Takes the ray through the aperture and refracts it.
    #[inline(always)]
    pub fn pass(&self, state: &mut State<R>, method: Refraction) -> Result<(), Blocked> {
        let [x, y, _] = state.p;
        if !(x * x + y * y <= self.aperture)
            || self.blades.as_ref().is_some_and(|figure| !figure.passes([x, y]))
        {
            return Err(Blocked::Clipped);
        }
        self.refract(state, method)
    }

    /// The unit normal at a point of this surface, toward the side ahead.
    #[inline(always)]
    pub fn normal(&self, point: [R; 3]) -> [R; 3] {
        if let Some(aspheric) = &self.aspheric {
            return aspheric.normal(point);
        }
        let ([x, y, z], c) = (point, self.curvature);
        [-c * x, -c * y, R::ONE - c * z]
    }

    /// Refracts the ray, by Snell's law, or reflects it, at the point of this surface where it is.
    #[inline(always)]
    pub fn refract(&self, state: &mut State<R>, method: Refraction) -> Result<(), Blocked> {
        let normal = self.normal(state.p);
        let State { p, v, .. } = state;
        let e = dot(normal, *v);
        if self.is_mirror {
            // V - 2 e N, and from there on z is counted the other way, along the travel.
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
        // By its own rounding a method may see total reflection where the test above does not.
        if !(dot(after, after) < R::from_f64(2.0)) {
            return Err(Blocked::Reflected);
        }
        *v = after.map(|d| d * self.n_after);
        Ok(())
    }
}

/// The figure in a stop of one size, in numbers of type `R`.
///
/// With m the largest product of the point p with a normal, p is inside where `bulge` p² + `slant` m w <= `limit` w²; w is 1,
/// or what p was multiplied with to spare a division.
#[derive(Clone, Debug)]
pub struct StopFigure<R> {
    pub blades: Blades,
    pub normals: Box<[[R; 2]]>,
    pub bulge: R,
    /// mm.
    pub slant: R,
    /// mm².
    pub limit: R,
}

impl<R: Real> StopFigure<R> {
    /// In a stop of the given clear semi-diameter, mm.
    pub fn new(blades: Blades, semi_diameter: f64) -> Self {
        let BladeConstants { bulge, slant, limit } = blades.constants();
        Self {
            blades,
            normals: blades.normals().map(|normal| normal.map(R::from_f64)).collect(),
            bulge: R::from_f64(bulge),
            slant: R::from_f64(slant * semi_diameter),
            limit: R::from_f64(limit * semi_diameter * semi_diameter),
        }
    }

    /// Whether a ray gets through at a point; not where that is no number.
    pub fn passes(&self, [x, y]: [R; 2]) -> bool {
        let products = self.normals.iter().map(|[nx, ny]| *nx * x + *ny * y);
        let most = products.reduce(|most, product| if product > most { product } else { most });
        self.bulge * (x * x + y * y) + self.slant * most.unwrap_or(R::ZERO) <= self.limit
    }
}

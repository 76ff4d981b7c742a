//! One ray through a lens, surface by surface, with the reason where it stops.
//!
//! In the frame of a surface's vertex, axis along the travel, with c its curvature, the sphere is
//! (c/2)(x² + y² + z²) - z = 0 and its unit normal there N = (-c x, -c y, 1 - c z): both hold for
//! the plane, c = 0, and stay accurate for any radius. With V = n D the hit lies at P + t V,
//! t = 2 f/(g + e), where f is the left side at P, g = N·V there, and e = sqrt(g² - 2 c n² f) is
//! n cos I at the hit.
//! Of the two roots this is the one at which the ray crosses toward the side ahead, so the
//! near side of the sphere is met whether its centre lies ahead or behind.

use thiserror::Error;

use crate::lens::Ray;

use super::{Direction, Path, Real, path::Step};
use crate::lens::refraction::{self, Refraction};

/// Why a ray does not get through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Error)]
pub enum Blocked {
    /// It passes beside a surface's sphere.
    #[error("missed")]
    Missed,
    /// It meets a surface outside the clear aperture.
    #[error("clipped")]
    Clipped,
    /// It is totally reflected.
    #[error("reflected")]
    Reflected,
    /// The next surface lies behind it, or it travels backward.
    #[error("turned_back")]
    TurnedBack,
}

/// How far a ray got.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk {
    /// The point on the last surface met and the unit direction after it; the input ray, its
    /// direction made a unit vector, where none was met.
    pub ray: Ray,
    /// Surfaces met.
    pub surfaces_met: usize,
    /// Why the ray stopped there, if it did.
    pub blocked: Option<Blocked>,
}

/// Distance to the vertex over radius of curvature beyond which the ray is first moved to the
/// vertex plane: the sphere's equation loses that factor in digits at the ray's start.
const FAR: f64 = 2.0;

/// Squared cosine of the angle to the axis below which a ray meets the first vertex plane too far out for
/// that to be the place to start from.
pub(super) const STEEP: f64 = 0.01;

/// Position and V = n D in the frame of the current vertex.
#[derive(Clone, Copy)]
pub(super) struct State<R> {
    pub p: [R; 3],
    pub v: [R; 3],
    /// How far the ray was moved on from where it last was on a surface, or began, in units of V.
    pub lead: R,
}

impl<R: Real> Path<R> {
    /// Takes a ray through the lens. Its origin may lie anywhere before the first surface; NaN or
    /// infinite components, or a direction of length 0, count as [`Blocked::Missed`].
    pub fn walk(&self, ray: Ray) -> Walk {
        let sense = self.sense();
        let start = Ray { origin: ray.origin, direction: unit(ray.direction) };
        let finite = start.origin.iter().chain(&start.direction).all(|x| x.is_finite());
        if !finite {
            return Walk { ray: start, surfaces_met: 0, blocked: Some(Blocked::Missed) };
        }
        let mut state = self.enter(ray, start.direction);
        let (surfaces_met, blocked) = self.march(&mut state);
        let Some(last) = surfaces_met.checked_sub(1) else {
            return Walk { ray: start, surfaces_met, blocked };
        };
        let vertex = if surfaces_met == self.steps.len() {
            self.exit
        } else {
            let passed: f64 = self.steps[..=last].iter().map(|step| step.distance.to_f64()).sum();
            self.entry + sense * passed
        };
        let [x, y, z] = state.p.map(R::to_f64);
        let [vx, vy, vz] = state.v.map(R::to_f64);
        let ray = Ray { origin: [x, y, vertex + sense * z], direction: unit([vx, vy, sense * vz]) };
        Walk { ray, surfaces_met, blocked }
    }

    /// A ray through the lens in `R` from start to end, for types wider than double: the point in the
    /// frame of the last vertex met (z along +z of lens space) and the unit direction.
    ///
    /// # Errors
    /// The reason why it is blocked.
    pub fn trace_in_full(&self, origin: [R; 3], direction: [R; 3]) -> Result<([R; 3], [R; 3]), Blocked> {
        let sense = R::from_f64(self.sense());
        let [dx, dy, dz] = direction;
        let length = refraction::dot(direction, direction).sqrt();
        let [x, y, z] = origin;
        let mut state = State {
            p: [x, y, sense * (z - R::from_f64(self.entry))],
            v: [dx, dy, sense * dz].map(|d| self.steps[0].n * d / length),
            lead: R::ZERO,
        };
        if let (_, Some(reason)) = self.march(&mut state) {
            return Err(reason);
        }
        let [x, y, z] = state.p;
        let [vx, vy, vz] = state.v;
        let length = refraction::dot(state.v, state.v).sqrt();
        Ok(([x, y, sense * z], [vx / length, vy / length, sense * vz / length]))
    }

    /// Takes the state, in the frame of the first vertex, through the surfaces; says how many were met and
    /// why the ray stopped there. Each surface takes the state whole or not at all, so that a
    /// blocked ray is left where it was last on a surface, in the frame of that vertex.
    fn march(&self, state: &mut State<R>) -> (usize, Option<Blocked>) {
        for (number, step) in self.steps.iter().enumerate() {
            let mut ahead = *state;
            ahead.p[2] = ahead.p[2] - step.distance;
            let hit = if self.is_forward(&ahead, number) {
                step.meet(&mut ahead)
            } else {
                Err(Blocked::TurnedBack)
            };
            if let Err(reason) = hit {
                return (number, Some(reason));
            }
            *state = ahead;
            if let Err(reason) = step.pass(state, self.refraction) {
                return (number + 1, Some(reason));
            }
        }
        (self.steps.len(), None)
    }

    /// Which way along z the light travels.
    pub(super) fn sense(&self) -> f64 {
        match self.direction {
            Direction::FilmToScene => 1.0,
            Direction::SceneToFilm => -1.0,
        }
    }

    /// Whether a ray may go on to surface `number`. A fisheye sees behind itself: from the scene the
    /// first surface may be met going backward.
    pub(super) fn is_forward(&self, state: &State<R>, number: usize) -> bool {
        state.v[2] > R::ZERO || self.may_start_backward(number)
    }

    /// Whether a ray may go on to surface `number` also where it travels backward.
    pub(super) fn may_start_backward(&self, number: usize) -> bool {
        number == 0 && self.direction == Direction::SceneToFilm
    }

    /// The state with which a ray sets out, in the frame of the first vertex; `direction` is the ray's as a
    /// unit vector.
    pub(super) fn enter(&self, ray: Ray, direction: [f64; 3]) -> State<R> {
        let sense = self.sense();
        let (entry, lead) = self.to_entry(ray, sense);
        let [dx, dy, dz] = direction;
        State {
            p: entry.map(R::from_f64),
            v: [dx, dy, sense * dz].map(|d| self.steps[0].n * R::from_f64(d)),
            lead: R::from_f64(lead),
        }
    }

    /// The ray's start in the frame of the first vertex, moved on to where it is near the lens if that lies
    /// ahead: to the vertex plane, or, for a ray along it or back from it, to the point nearest the
    /// vertex. And the distance moved.
    ///
    /// Differences of products, not P + t D: from a distant object that would keep the digits of the
    /// distance, and this keeps those of the lens.
    pub(super) fn to_entry(&self, ray: Ray, sense: f64) -> ([f64; 3], f64) {
        let [x, y, z] = ray.origin;
        // The difference and what rounding took from it (D. E. Knuth, *The Art of Computer Programming* 2,
        // section 4.2.2): a small lens far from its front vertex would feel it.
        let (far, near) = (sense * z, sense * self.entry);
        let z = far - near;
        let taken = z - far;
        let lost = (far - (z - taken)) - (near + taken);
        let start = [x, y, z];
        let [dx, dy, dz] = in_range(ray.direction);
        let d = [dx, dy, sense * dz];
        let squared = refraction::dot(d, d);
        let entry = if z < 0.0 && d[2] > 0.0 && d[2] * d[2] > STEEP * squared {
            let at = |p: f64, along: f64| (difference_of_products(p, d[2], z, along) - lost * along) / d[2];
            [at(x, d[0]), at(y, d[1]), 0.0]
        } else if refraction::dot(start, d) < 0.0 {
            let moment = cross(start, d);
            let moment = [moment[0] - lost * d[1], moment[1] + lost * d[0], moment[2]];
            cross(d, moment).map(|product| product / squared)
        } else {
            return (start, 0.0);
        };
        let moved: [f64; 3] = std::array::from_fn(|i| entry[i] - start[i]);
        (entry, refraction::dot(moved, moved).sqrt())
    }

    /// The ray as it leaves the lens.
    ///
    /// # Errors
    /// The reason why it does not.
    pub fn trace(&self, ray: Ray) -> Result<Ray, Blocked> {
        let walk = self.walk(ray);
        walk.blocked.map_or(Ok(walk.ray), Err)
    }
}

impl<R: Real> Step<R> {
    /// Moves the ray to this surface, in the frame of whose vertex it is given.
    // Inlined, here and below: between functions the state goes through memory, where a wide load has to wait for
    // the narrow stores before it, at every surface.
    #[inline(always)]
    pub(super) fn meet(&self, state: &mut State<R>) -> Result<(), Blocked> {
        let State { p, v, lead } = state;
        let c = self.curvature;
        let advance = |p: &mut [R; 3], t: R| (0..3).for_each(|i| p[i] = p[i] + t * v[i]);
        if v[2] > R::ZERO && -p[2] * if c < R::ZERO { -c } else { c } > R::from_f64(FAR) {
            *lead = -p[2] / v[2];
            advance(p, *lead);
            p[2] = R::ZERO;
        }
        let two = R::from_f64(2.0);
        let n_squared = self.n * self.n;
        let f = c / two * refraction::dot(*p, *p) - p[2];
        let g = v[2] - c * refraction::dot(*p, *v);
        let discriminant = g * g - two * c * n_squared * f;
        // Negated so that NaN blocks the ray, too.
        if !(discriminant > R::ZERO) {
            return Err(Blocked::Missed);
        }
        let e = discriminant.sqrt();
        let t = if g > R::ZERO { two * f / (g + e) } else { (g - e) / (c * n_squared) };
        if *lead + t < -self.slack {
            return Err(Blocked::TurnedBack);
        }
        *lead = R::ZERO;
        advance(p, t);
        // Beyond the equator the sphere is no part of the surface.
        if R::ONE - c * p[2] < R::ZERO {
            return Err(Blocked::Missed);
        }
        Ok(())
    }

    /// Takes the ray through the aperture and refracts it.
    #[inline(always)]
    fn pass(&self, state: &mut State<R>, method: Refraction) -> Result<(), Blocked> {
        let [x, y, _] = state.p;
        if !(x * x + y * y <= self.aperture) {
            return Err(Blocked::Clipped);
        }
        self.refract(state, method)
    }

    /// Refracts the ray at the point of this surface where it is.
    #[inline(always)]
    pub(super) fn refract(&self, state: &mut State<R>, method: Refraction) -> Result<(), Blocked> {
        let State { p: [x, y, z], v, .. } = state;
        let c = self.curvature;
        let normal = [-c * *x, -c * *y, R::ONE - c * *z];
        let e = refraction::dot(normal, *v);
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
        if !(refraction::dot(after, after) < R::from_f64(2.0)) {
            return Err(Blocked::Reflected);
        }
        *v = after.map(|d| d * self.n_after);
        Ok(())
    }
}

/// a b - c d within 1.5 ulp, by Kahan's algorithm (C.-P. Jeannerod, N. Louvet and J.-M. Muller, "Further
/// analysis of Kahan's algorithm for the accurate computation of 2 x 2 determinants", 2013).
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let product = c * d;
    let error = c.mul_add(-d, product);
    a.mul_add(b, -product) + error
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        difference_of_products(a[j], b[k], a[k], b[j])
    })
}

/// A vector times a power of two that keeps its products with lengths from over- and underflow.
pub fn in_range(v: [f64; 3]) -> [f64; 3] {
    const FAR_OUT: f64 = f64::from_bits((1023 + 400) << 52);
    const BACK: f64 = f64::from_bits((1023 + 600) << 52);
    let largest = v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    if largest > FAR_OUT {
        v.map(|x| x / BACK)
    } else if largest < FAR_OUT.recip() {
        v.map(|x| x * BACK)
    } else {
        v
    }
}

pub(super) fn unit(v: [f64; 3]) -> [f64; 3] {
    let largest = v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Scaled first, so that the squares of very small or large components stay in range.
    let scaled = v.map(|x| x / largest);
    let norm = refraction::dot(scaled, scaled).sqrt();
    scaled.map(|x| x / norm)
}

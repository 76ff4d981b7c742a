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

use super::{Direction, Path, Real, path::Step};
use crate::optics::refraction::{self, Refraction};

/// A ray in lens space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// A point on it, mm.
    pub origin: [f64; 3],
    /// Its direction; any length but 0 where it enters a walk, 1 where it leaves one.
    pub direction: [f64; 3],
}

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

/// Position and V = n D in the frame of the current vertex.
#[derive(Clone, Copy)]
struct State<R> {
    p: [R; 3],
    v: [R; 3],
    /// How far the ray was moved on from where it last was on a surface, or began, in units of V.
    lead: R,
}

impl<R: Real> Path<R> {
    /// Takes a ray through the lens. Its origin may lie anywhere before the first surface; NaN or
    /// infinite components, or a direction of length 0, count as [`Blocked::Missed`].
    pub fn walk(&self, ray: Ray) -> Walk {
        let sense = match self.direction {
            Direction::FilmToScene => 1.0,
            Direction::SceneToFilm => -1.0,
        };
        let direction = unit(ray.direction);
        let start = Ray { origin: ray.origin, direction };
        let finite = start.origin.iter().chain(&direction).all(|x| x.is_finite());
        if !finite {
            return Walk { ray: start, surfaces_met: 0, blocked: Some(Blocked::Missed) };
        }
        // Each surface takes the state whole or not at all, so that a blocked ray is reported
        // where it was last on a surface.
        let (entry, lead) = self.to_entry_plane(ray, sense, direction[2]);
        let [dx, dy, dz] = direction;
        let mut state = State {
            p: entry.map(R::from_f64),
            v: [dx, dy, sense * dz].map(R::from_f64),
            lead: R::from_f64(lead),
        };
        let mut vertex = self.entry;
        let mut index = 1.0;
        let mut surfaces_met = 0;
        let mut blocked = None;
        // A fisheye sees behind itself: from the scene the first surface may be met going backward.
        let may_start_backward = self.direction == Direction::SceneToFilm;
        for (number, step) in self.steps.iter().enumerate() {
            let mut ahead = state;
            ahead.p[2] = ahead.p[2] - step.distance;
            let forward = ahead.v[2] > R::ZERO || (number == 0 && may_start_backward);
            let hit = if forward { step.meet(&mut ahead) } else { Err(Blocked::TurnedBack) };
            if let Err(reason) = hit {
                blocked = Some(reason);
                break;
            }
            state = ahead;
            vertex += sense * step.distance.to_f64();
            surfaces_met += 1;
            if let Err(reason) = step.pass(&mut state, self.refraction) {
                index = step.n.to_f64();
                blocked = Some(reason);
                break;
            }
            index = step.n_after.to_f64();
        }
        if surfaces_met == 0 {
            return Walk { ray: start, surfaces_met, blocked };
        }
        if surfaces_met == self.steps.len() {
            vertex = self.exit;
        }
        let [x, y, z] = state.p.map(R::to_f64);
        let [vx, vy, vz] = state.v.map(|v| v.to_f64() / index);
        let ray = Ray { origin: [x, y, vertex + sense * z], direction: unit([vx, vy, sense * vz]) };
        Walk { ray, surfaces_met, blocked }
    }

    /// The ray's start in the frame of the first vertex, moved on to the vertex plane where that
    /// lies ahead, and the distance moved; `unit_dz` is the unit direction's component.
    ///
    /// Differences of products, not P + t D: from a distant object that would keep the digits of the
    /// distance, and this keeps those of the lens.
    fn to_entry_plane(&self, ray: Ray, sense: f64, unit_dz: f64) -> ([f64; 3], f64) {
        let [x, y, z] = ray.origin;
        let [dx, dy, dz] = ray.direction;
        let (z, dz) = (sense * (z - self.entry), sense * dz);
        if !(z < 0.0 && dz > 0.0) {
            return ([x, y, z], 0.0);
        }
        let at = |p: f64, d: f64| difference_of_products(p, dz, z, d) / dz;
        let (px, py) = (at(x, dx), at(y, dy));
        ([px, py, 0.0], -z / unit_dz.abs())
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
    fn meet(&self, state: &mut State<R>) -> Result<(), Blocked> {
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
    fn pass(&self, state: &mut State<R>, method: Refraction) -> Result<(), Blocked> {
        let State { p: [x, y, z], v, .. } = state;
        if !(*x * *x + *y * *y <= self.aperture) {
            return Err(Blocked::Clipped);
        }
        let c = self.curvature;
        let normal = [-c * *x, -c * *y, R::ONE - c * *z];
        let e = refraction::dot(normal, *v);
        let after_squared = e * e + self.index_step;
        if !(after_squared > R::ZERO) {
            return Err(Blocked::Reflected);
        }
        let unit_method = match method {
            Refraction::Fused => {
                // n' cos I' - n cos I, written so that a small index step keeps its digits.
                let bend = self.index_step / (e + after_squared.sqrt());
                *v = std::array::from_fn(|i| v[i] + bend * normal[i]);
                return Ok(());
            }
            Refraction::Heckbert => refraction::heckbert,
            Refraction::Whitted => refraction::whitted,
            Refraction::Other => refraction::other,
        };
        let incident = v.map(|component| component / self.n);
        *v = unit_method(incident, normal, self.n, self.n_after).map(|d| d * self.n_after);
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

fn unit(v: [f64; 3]) -> [f64; 3] {
    let largest = v.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Scaled first, so that the squares of very small or large components stay in range.
    let scaled = v.map(|x| x / largest);
    let norm = refraction::dot(scaled, scaled).sqrt();
    scaled.map(|x| x / norm)
}

//! The fate of the light that enters a lens, by brute force. Every surface randomly reflects or transmits photons, in
//! any order of surfaces, until they reach the film, leave the lens, or end at the barrel.
//!
//! This trace shares nothing with the library but the surfaces' data: rays are vectors, each photon carries its
//! electric field as a three-dimensional vector, and a surface's amplitude coefficients follow Airy's sum. It
//! includes all orders of reflection, and so measures the light that the library leaves out by stopping at two
//! reflections. Aspheres are intersected by Newton's method from the vertex plane. Interference occurs between the two
//! faces of a coating but not between surfaces.

mod complex;
mod surface;

pub use self::surface::Film;

use self::{complex::C, surface::amplitudes};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use realistic_optics::{
    lens::Lens,
    prescription::{Asphere, FIRST_POWER},
};

/// The fates of the photons that enter a lens, as shares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Balance {
    /// Photons that reach the film without a reflection.
    pub direct: f64,
    /// Photons that reach the film after two reflections.
    pub two: f64,
    /// Photons that reach the film after four or more reflections.
    pub more: f64,
    /// Photons that reach the film's plane outside the film.
    pub beside: f64,
    /// Photons that end at mounts, stop or barrel.
    pub blocked: f64,
    /// Photons that return to the scene.
    pub back: f64,
    /// Photons that are absorbed in glass.
    pub absorbed: f64,
    /// Number of photons that entered.
    pub photons: u32,
}

impl Balance {
    /// Returns the standard error of a share of the photons.
    pub fn error(&self, share: f64) -> f64 {
        (share * (1.0 - share) / f64::from(self.photons)).sqrt()
    }
}

/// The fate of a photon.
enum End {
    Film { reflections: u32, point: [f64; 2] },
    Blocked,
    Back,
    Absorbed,
}

type V = [f64; 3];

/// Reflections after which a photon is abandoned; at most 1e-40 of the light remains.
const MOST: u32 = 60;

/// Follows photons of a lamp at infinity in the direction `toward` (from the lens; the vector may have any length)
/// until `photons` of them have met the front surface inside its clear aperture. The film is a disk of radius `spot` at
/// z = `plane`; both are in mm.
pub fn balance(
    lens: &Lens,
    film: Film,
    toward: V,
    plane: f64,
    spot: f64,
    photons: u32,
    seed: u64,
) -> Balance {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let toward = unit(toward);
    let front = lens.front();
    let [low, high] = front.sagitta_range();
    let radius = 1.001 * front.semi_diameter.hypot((high - low) / 2.0);
    let (across, up) = frame(toward);
    let mut counts = [0_u32; 7];
    while counts.iter().sum::<u32>() < photons {
        let (x, y) = (2.0 * random.random::<f64>() - 1.0, 2.0 * random.random::<f64>() - 1.0);
        let angle = std::f64::consts::PI * random.random::<f64>();
        if x * x + y * y > 1.0 {
            continue;
        }
        let middle = f64::midpoint(low, high);
        let at: V = std::array::from_fn(|k| {
            let here = radius * (x * across[k] + y * up[k] + 3.0 * toward[k]);
            if k == 2 { here + middle } else { here }
        });
        // The light is unpolarised: the field is uniform over the directions perpendicular to the ray.
        let field: [C; 3] = std::array::from_fn(|k| C(angle.cos() * across[k] + angle.sin() * up[k], 0.0));
        let Some(end) = follow(lens, film, at, toward.map(|x| -x), field, plane, &mut random) else {
            continue;
        };
        let outcome = match end {
            End::Film { point, .. } if point[0].hypot(point[1]) > spot => 3,
            End::Film { reflections: 0, .. } => 0,
            End::Film { reflections: 2, .. } => 1,
            End::Film { .. } => 2,
            End::Blocked => 4,
            End::Back => 5,
            End::Absorbed => 6,
        };
        counts[outcome] += 1;
    }
    let [direct, two, more, beside, blocked, back, absorbed] =
        counts.map(|count| f64::from(count) / f64::from(photons));
    Balance { direct, two, more, beside, blocked, back, absorbed, photons }
}

/// Traces one photon; `None` if it does not meet the front surface.
fn follow(
    lens: &Lens,
    film: Film,
    mut at: V,
    mut d: V,
    mut field: [C; 3],
    plane: f64,
    random: &mut Xoshiro256PlusPlus,
) -> Option<End> {
    let last = lens.surfaces.len();
    // `gap` numbers the photon's medium: the space before surface `gap`.
    let (mut gap, mut reflections) = (0, 0);
    let mut has_entered = false;
    loop {
        let number = if d[2] < 0.0 {
            if gap == last {
                let along = (plane - at[2]) / d[2];
                return Some(End::Film { reflections, point: [at[0] + along * d[0], at[1] + along * d[1]] });
            }
            gap
        } else {
            if gap == 0 {
                return has_entered.then_some(End::Back);
            }
            gap - 1
        };
        let surface = &lens.surfaces[number];
        let meets = match &surface.figure {
            None => hit(at, d, surface.curvature, surface.vertex),
            Some(figure) => hit_asphere(at, d, &figure.asphere, surface.vertex),
        };
        let inside = meets.filter(|point| point[0].hypot(point[1]) <= surface.semi_diameter);
        let Some(point) = inside else {
            return has_entered.then_some(End::Blocked);
        };
        // The medium of a gap is the one behind the previous surface; nothing is absorbed in front of the lens.
        let absorption = if has_entered && gap > 0 { lens.surfaces[gap - 1].absorption } else { 0.0 };
        let step: V = std::array::from_fn(|k| point[k] - at[k]);
        if absorption > 0.0 && random.random::<f64>() > (-absorption * dot(step, step).sqrt()).exp() {
            return Some(End::Absorbed);
        }
        has_entered = true;
        at = point;
        let c = surface.curvature;
        let mut normal: V = match &surface.figure {
            None => [c * at[0], c * at[1], c * (at[2] - surface.vertex) + 1.0],
            Some(figure) => {
                let [_, slope] = sag(&figure.asphere, at[0].hypot(at[1]));
                let r = at[0].hypot(at[1]).max(1e-300);
                unit([slope * at[0] / r, slope * at[1] / r, 1.0])
            }
        };
        let forward = d[2] < 0.0;
        if dot(normal, d) < 0.0 {
            normal = normal.map(|x| -x);
        }
        let (n, n_behind) =
            if forward { (surface.n_scene, surface.n_film) } else { (surface.n_film, surface.n_scene) };
        if n != n_behind {
            let coat = film.filter(|_| n == 1.0 || n_behind == 1.0);
            let cos = dot(normal, d).min(1.0);
            let [s_amplitudes, p_amplitudes] =
                [false, true].map(|is_p| amplitudes(n, coat, n_behind, cos, lens.wavelength, is_p));
            let across = cross(normal, d);
            let s = if dot(across, across) > 1e-20 { unit(across) } else { frame(d).0 };
            let p = cross(s, d);
            let part = |v: V| (0..3).fold(C(0.0, 0.0), |sum, k| sum + field[k] * C(v[k], 0.0));
            let (e_s, e_p) = (part(s), part(p));
            let whole = e_s.square() + e_p.square();
            let reflected = (s_amplitudes[0] * e_s).square() + (p_amplitudes[0] * e_p).square();
            let is_reflected = random.random::<f64>() * whole < reflected;
            let next: V = if is_reflected {
                std::array::from_fn(|k| d[k] - 2.0 * cos * normal[k])
            } else {
                let cos_behind = (1.0 - (n / n_behind).powi(2) * (1.0 - cos * cos)).max(0.0).sqrt();
                std::array::from_fn(|k| n / n_behind * d[k] + (cos_behind - n / n_behind * cos) * normal[k])
            };
            let outgoing = usize::from(!is_reflected);
            let (a_s, a_p) = (s_amplitudes[outgoing] * e_s, p_amplitudes[outgoing] * e_p);
            let length = (a_s.square() + a_p.square()).sqrt();
            let p_next = cross(s, next);
            field = std::array::from_fn(|k| {
                (a_s * C(s[k], 0.0) + a_p * C(p_next[k], 0.0)) * C(length.recip(), 0.0)
            });
            d = unit(next);
            if is_reflected {
                reflections += 1;
                // The photon has turned by more than 90 degrees: it meets the same surface again, near its edge, or the
                // barrel.
                if (d[2] < 0.0) == forward || reflections > MOST {
                    return Some(End::Blocked);
                }
                continue;
            }
        }
        if (d[2] < 0.0) != forward {
            return Some(End::Blocked);
        }
        gap = if forward { number + 1 } else { number };
    }
}

/// Returns the intersection ahead of the ray with a plane, or with the sheet of a sphere at its vertex.
fn hit(at: V, d: V, c: f64, vertex: f64) -> Option<V> {
    let q = [at[0], at[1], at[2] - vertex];
    let (b, f) = (c * dot(q, d) + d[2], c * dot(q, q) + 2.0 * q[2]);
    let root = (b * b - c * f).sqrt();
    let t = -f / (b + root * d[2].signum());
    // A reflected photon may start on its next surface, where the edges of two surfaces touch.
    (root.is_finite() && t > -1e-9).then(|| std::array::from_fn(|k| at[k] + t * d[k]))
}

/// Returns the sagitta of an asphere at a distance from the axis, positive toward the film, and the slope there. The
/// sagitta is the conic's c r²/(1 + √(1 - (1 + k) c² r²)) plus the terms of r^i.
fn sag(asphere: &Asphere, r: f64) -> [f64; 2] {
    let c = if asphere.radius.is_finite() { asphere.radius.recip() } else { 0.0 };
    let root = (1.0 - (1.0 + asphere.conic) * c * c * r * r).sqrt();
    let [mut sag, mut slope] = [c * r * r / (1.0 + root), c * r / root];
    for (i, term) in (FIRST_POWER as i32..).zip(asphere.terms) {
        sag += term * r.powi(i);
        slope += term * f64::from(i) * r.powi(i - 1);
    }
    [sag, slope]
}

/// Returns the intersection with an asphere, found by Newton's method; conditions are those of [`hit`].
fn hit_asphere(at: V, d: V, asphere: &Asphere, vertex: f64) -> Option<V> {
    let mut t = (vertex - at[2]) / d[2];
    for _ in 0..40 {
        let p: V = std::array::from_fn(|k| at[k] + t * d[k]);
        let r = p[0].hypot(p[1]);
        let [sag, slope] = sag(asphere, r);
        let off = p[2] - vertex + sag;
        let along = d[2] + slope * (p[0] * d[0] + p[1] * d[1]) / r.max(1e-300);
        let step = off / along;
        if !step.is_finite() {
            return None;
        }
        t -= step;
        if step.abs() < 1e-12 * (1.0 + t.abs()) {
            return (t > -1e-9).then(|| std::array::from_fn(|k| at[k] + t * d[k]));
        }
    }
    None
}

fn dot(a: V, b: V) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: V, b: V) -> V {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn unit(v: V) -> V {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

/// Returns two perpendicular unit vectors that are perpendicular to `d`.
fn frame(d: V) -> (V, V) {
    let helper = if d[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let across = unit(cross(d, helper));
    (across, cross(d, across))
}

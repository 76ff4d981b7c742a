//! An independent trace of light through a lens: rays are traced by vectors and signed distances, the electric field
//! consists of complex vectors in three dimensions, and the amplitudes of a single film follow Airy's sum. It shares
//! only the surfaces' numbers with the library.

use realistic_optics::lens::Lens;
use std::ops::{Add, Mul};

/// A complex number.
#[derive(Clone, Copy, Debug)]
pub struct C(pub f64, pub f64);

impl Add for C {
    type Output = C;
    fn add(self, b: C) -> C {
        C(self.0 + b.0, self.1 + b.1)
    }
}

impl Mul for C {
    type Output = C;
    fn mul(self, b: C) -> C {
        C(self.0 * b.0 - self.1 * b.1, self.0 * b.1 + self.1 * b.0)
    }
}

impl C {
    fn over(self, b: C) -> C {
        let square = b.0 * b.0 + b.1 * b.1;
        self * C(b.0 / square, -b.1 / square)
    }
    pub fn square(self) -> f64 {
        self.0 * self.0 + self.1 * self.1
    }
}

type V = [f64; 3];

fn dot(a: V, b: V) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: V, b: V) -> V {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

/// Returns Fresnel's amplitudes r and t between two media, s or p, as ratios of fields; the p field is positive if it
/// stays on the same side of the ray.
fn fresnel(n: f64, cos: f64, n_behind: f64, cos_behind: f64, is_p: bool) -> [f64; 2] {
    if is_p {
        let sum = n_behind * cos + n * cos_behind;
        [(n_behind * cos - n * cos_behind) / sum, 2.0 * n * cos / sum]
    } else {
        let sum = n * cos + n_behind * cos_behind;
        [(n * cos - n_behind * cos_behind) / sum, 2.0 * n * cos / sum]
    }
}

/// Returns r and t of a surface with one film, or none, by Airy's sum (M. Born and E. Wolf, section 1.6.4).
pub fn amplitudes(
    n: f64,
    film: Option<(f64, f64)>,
    n_behind: f64,
    cos: f64,
    wavelength: f64,
    is_p: bool,
) -> [C; 2] {
    let cos_in = |index: f64| (1.0 - (n / index).powi(2) * (1.0 - cos * cos)).sqrt();
    let Some((index, thickness)) = film else {
        let [r, t] = fresnel(n, cos, n_behind, cos_in(n_behind), is_p);
        return [C(r, 0.0), C(t, 0.0)];
    };
    let (inside, behind) = (cos_in(index), cos_in(n_behind));
    let [r1, t1] = fresnel(n, cos, index, inside, is_p);
    let [r2, t2] = fresnel(index, inside, n_behind, behind, is_p);
    let phase = std::f64::consts::TAU * index * thickness * inside / wavelength;
    let (once, twice) = (C(phase.cos(), phase.sin()), C((2.0 * phase).cos(), (2.0 * phase).sin()));
    let below = C(1.0, 0.0) + C(r1 * r2, 0.0) * twice;
    [(C(r1, 0.0) + C(r2, 0.0) * twice).over(below), (C(t1 * t2, 0.0) * once).over(below)]
}

/// Returns the share of an unpolarised ray's power that is left behind a lens of spheres, from the scene to the film,
/// with the ray's end point and direction. With `turns`, the ray is reflected at the second surface of `turns`, and on
/// its way back at the first, and then goes on. `film` is the index and the thickness, nm, of the film between air and
/// glass.
pub fn trace(
    lens: &Lens,
    film: Option<(f64, f64)>,
    turns: Option<[usize; 2]>,
    mut at: V,
    mut d: V,
) -> Option<(f64, V, V)> {
    let last = lens.surfaces.len();
    let mut order: Vec<(usize, bool)> = Vec::new();
    match turns {
        None => order.extend((0..last).map(|i| (i, false))),
        Some([near, far]) => {
            order.extend((0..far).map(|i| (i, false)));
            order.push((far, true));
            order.extend((near + 1..far).rev().map(|i| (i, false)));
            order.push((near, true));
            order.extend((near + 1..last).map(|i| (i, false)));
        }
    }
    // Two fields perpendicular to the ray and to each other.
    let helper = if d[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let unit = |v: V| v.map(|x| x / dot(v, v).sqrt());
    let first = unit(cross(d, helper));
    let mut fields = [first, cross(d, first)].map(|e| e.map(|x| C(x, 0.0)));
    let mut power = 1.0;
    for (i, is_mirror) in order {
        let surface = &lens.surfaces[i];
        let c = surface.curvature;
        let q = [at[0], at[1], at[2] - surface.vertex];
        // The film lies toward -z: the centre of a positive radius lies on that side.
        let (b, f) = (c * dot(q, d) + d[2], c * dot(q, q) + 2.0 * q[2]);
        let root = (b * b - c * f).sqrt();
        let t = -f / (b + root * d[2].signum());
        if !(root.is_finite() && t > -1e-9) {
            return None;
        }
        at = std::array::from_fn(|k| at[k] + t * d[k]);
        if at[0].hypot(at[1]) > surface.semi_diameter {
            return None;
        }
        let mut normal = [c * at[0], c * at[1], c * (at[2] - surface.vertex) + 1.0];
        if dot(normal, d) < 0.0 {
            normal = normal.map(|x| -x);
        }
        let (n, n_behind) =
            if d[2] < 0.0 { (surface.n_scene, surface.n_film) } else { (surface.n_film, surface.n_scene) };
        let cos = dot(normal, d);
        let square = 1.0 - (n / n_behind).powi(2) * (1.0 - cos * cos);
        if square <= 0.0 {
            return None;
        }
        let cos_behind = square.sqrt();
        let next: V = if is_mirror {
            std::array::from_fn(|k| d[k] - 2.0 * cos * normal[k])
        } else {
            std::array::from_fn(|k| n / n_behind * d[k] + (cos_behind - n / n_behind * cos) * normal[k])
        };
        if is_mirror == (next[2].signum() == d[2].signum()) {
            return None;
        }
        if n != n_behind {
            let coated = film.filter(|_| n == 1.0 || n_behind == 1.0);
            let across = cross(normal, d);
            let s = if dot(across, across) > 1e-24 { unit(across) } else { unit(cross(d, helper)) };
            let (p, p_next) = (cross(s, d), cross(s, next));
            let outgoing = usize::from(!is_mirror);
            let [a_s, a_p] =
                [false, true].map(|p| amplitudes(n, coated, n_behind, cos, lens.wavelength, p)[outgoing]);
            for field in &mut fields {
                let along = |v: V| (0..3).fold(C(0.0, 0.0), |sum, k| sum + field[k] * C(v[k], 0.0));
                let (e_s, e_p) = (a_s * along(s), a_p * along(p));
                *field = std::array::from_fn(|k| e_s * C(s[k], 0.0) + e_p * C(p_next[k], 0.0));
            }
            if !is_mirror {
                power *= n_behind * cos_behind / (n * cos);
            }
        }
        d = next;
    }
    let squares: f64 = fields.iter().flatten().map(|e| e.square()).sum();
    (d[2] < 0.0).then_some((power * squares / 2.0, at, d))
}

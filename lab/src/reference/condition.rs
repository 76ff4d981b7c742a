//! The condition number of the ray map: the amplification of rounding errors by a lens.
//!
//! Any tracer that rounds disturbs the ray slightly at every interface. The best property that it can have is *backward
//! stability*: its result is the exact result of a ray disturbed by about ε at the entry and at every interface.
//! Therefore the disturbances are propagated through the exact Jacobian of each interface (dual numbers: W. K.
//! Clifford, "Preliminary sketch of biquaternions", 1871; A. Griewank and A. Walther, *Evaluating Derivatives*, 2008,
//! §3.1) and summed as independent disturbances (N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2002,
//! §1.5 and §3.8).
//!
//! **The norms.** A disturbance of size 1 is one radian in direction. In position it is, in each component, the point's
//! own distance from the vertex, which is the size of rounding errors in the point's coordinates ([`Trail::own`], for
//! the walks). A tracer that computes its points from other quantities of the surface's size (the compiled kernels,
//! from plane to plane and from sphere to sphere) has rounding errors of the surface's size even on the axis: its
//! disturbance of position is at least the clear semi-diameter ([`Trail::surface`]). An interface's radius, index and
//! position are rounded, too; this moves the point and turns the ray by similar amounts and needs no terms of its own.
//! An asphere's terms may be much larger than their sum. Their rounding shifts the surface by Σ |`A_i`| r^i and tilts
//! it by Σ i |`A_i`| r^(i - 1); these two disturbances are included. The condition number in direction is then the root
//! of the sum of squares of the resulting direction errors, in rad per unit; the condition number in position is that
//! of the position errors, in mm per unit. Multiplied by ε, the condition numbers are the expected errors of a perfect
//! tracer of that precision.

use realistic_base::numeric::in_range;
use realistic_optics::{
    lens::{Lens, Surface, refraction::Refraction},
    trace::{Blocked, Direction, Path, Ray, Real},
};

use super::{
    aspheric::{Aspheric, Crossing, Met},
    double_double::{DoubleDouble, Vector, dot, vector},
    dual::{Dual, N},
    exact::ExactRay,
};

type Matrix = [[f64; N]; N];

/// The exact ray, and the conditioning of the trace.
#[derive(Clone, Copy, Debug)]
pub struct Trail {
    /// The ray at the last surface, in the frame of its vertex, or the reason why it is blocked.
    pub exact: Result<ExactRay, Blocked>,
    /// Condition for disturbances of a point that are relative to its own distance from the vertex.
    pub own: Condition,
    /// Condition for disturbances of a point that are relative to the surface's size.
    pub surface: Condition,
}

/// Growth of disturbances along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Condition {
    /// Condition number in direction, rad per unit; for a blocked ray, that of the path up to the point where the ray
    /// is blocked.
    pub direction: f64,
    /// Condition number in position, mm per unit.
    pub position: f64,
    /// Least margin of the ray's decisions to the opposite outcome, in units of the disturbance at each decision. If
    /// the margin is below a few ε, a tracer cannot decide correctly.
    pub margin: f64,
}

/// The unit in which disturbances of a point's position are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Norm {
    /// The point's own distance from the vertex.
    Own,
    /// The clear semi-diameter, or the point's own distance from the vertex if that is larger.
    Surface,
}

impl Norm {
    const BOTH: [Self; 2] = [Self::Own, Self::Surface];

    fn size(self, distance: f64, semi_diameter: f64) -> f64 {
        match self {
            Self::Own => distance,
            Self::Surface => distance.max(semi_diameter),
        }
    }
}

impl Trail {
    /// Returns the condition in a norm.
    pub fn condition(&self, norm: Norm) -> &Condition {
        match norm {
            Norm::Own => &self.own,
            Norm::Surface => &self.surface,
        }
    }
}

/// A lens prepared for exact rays with their condition numbers.
#[derive(Clone, Debug)]
pub struct Conditioned {
    interfaces: Vec<Interface>,
    sign: f64,
    entry: f64,
}

/// A single interface, in the frame of its vertex.
#[derive(Clone, Debug)]
struct Interface {
    /// Distance from the previous vertex; 0 for the first.
    distance: f64,
    curvature: f64,
    aspheric: Option<Aspheric>,
    semi_diameter: f64,
    /// Distance along the axis from the interface's lowest to its highest point.
    depth: f64,
    /// (n'/n)² - 1.
    index_step: f64,
    /// Whether this interface touches the last refracting interface before it; rays may then meet this interface
    /// slightly behind that one.
    touches: bool,
    exact: Path<DoubleDouble>,
    dual: Path<Dual>,
}

/// Factor by which the clear aperture of an isolated interface is widened.
const OPEN: f64 = 1e6;

impl Conditioned {
    /// Prepares a lens for rays in one direction.
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        let forward = direction == Direction::SceneToFilm;
        let count = lens.surfaces.len();
        let at = |number: usize| if forward { number } else { count - 1 - number };
        let interface = |number: usize| {
            let surface = &lens.surfaces[at(number)];
            let distance = match number {
                0 => 0.0,
                _ => lens.surfaces[at(number).min(at(number - 1))].thickness,
            };
            let (n, n_after) = match forward {
                true => (surface.n_scene, surface.n_film),
                false => (surface.n_film, surface.n_scene),
            };
            let [low, high] = surface.sagitta_range();
            // `follow` tests the clear aperture itself, so that the point of a clipped ray is still available.
            let semi_diameter = OPEN * surface.semi_diameter;
            let last_bent = (0..number).rev().find(|&before| !lens.surfaces[at(before)].only_limits());
            let touches = |before: usize| lens.surfaces[at(number).max(at(before))].is_contact;
            let alone = Surface { vertex: 0.0, thickness: 0.0, semi_diameter, ..surface.clone() };
            let alone = Lens { surfaces: vec![alone], ..lens.clone() };
            Interface {
                distance,
                curvature: if forward { surface.curvature } else { -surface.curvature },
                aspheric: surface.figure.map(|figure| Aspheric::new(&figure, surface, direction)),
                semi_diameter: surface.semi_diameter,
                depth: high - low,
                index_step: (n_after - n) * (n_after + n) / (n * n),
                touches: !surface.only_limits() && last_bent.is_some_and(touches),
                exact: Path::new(&alone, direction, Refraction::Fused),
                dual: Path::new(&alone, direction, Refraction::Fused),
            }
        };
        let sign = if forward { -1.0 } else { 1.0 };
        Self { interfaces: (0..count).map(interface).collect(), sign, entry: lens.surfaces[at(0)].vertex }
    }

    /// Traces a ray, whose components are taken as exact, through the lens.
    pub fn follow(&self, ray: Ray) -> Trail {
        let [x, y, z] = vector(ray.origin);
        let direction = unit(vector(in_range(ray.direction)));
        let origin = [x, y, z - DoubleDouble::from_f64(self.entry)];
        // The disturbance of a distant ray is that of its point nearest the vertex, if that point lies ahead. The ray
        // then starts a little before that point, in front of the whole first surface, which may be deeper than wide.
        let ahead = -dot(origin, direction);
        let nearest = moved(origin, direction, ahead);
        let Interface { semi_diameter, depth, .. } = self.interfaces[0];
        let lead = ahead.to_f64().clamp(0.0, 2.0 * (norm(nearest) + semi_diameter + depth));
        let size = if lead > 0.0 { norm(nearest) } else { norm(origin) };
        let point = if lead < ahead.to_f64() {
            moved(nearest, direction, DoubleDouble::from_f64(-lead))
        } else {
            origin
        };
        let mut now = ExactRay { point, direction };
        let mut doubts = Norm::BOTH.map(|norm| {
            let mut covariance = Covariance::default();
            covariance.disturb(norm.size(size, semi_diameter), 1.0);
            Doubt { norm, covariance: covariance.through(&transfer(-lead)), margin: f64::INFINITY }
        });
        let mut exact = None;
        // Distance from the ray's start or its last refraction: planes that only limit rays do not begin a new
        // distance.
        let mut travelled = DoubleDouble::ZERO;
        for (number, interface) in self.interfaces.iter().enumerate() {
            now.point[2] = now.point[2] - DoubleDouble::from_f64(self.sign * interface.distance);
            if !interface.only_limits() && travelled.to_f64() != 0.0 {
                now.point = moved(now.point, now.direction, DoubleDouble::ZERO - travelled);
                let back = transfer(-travelled.to_f64());
                doubts.iter_mut().for_each(|doubt| doubt.covariance = doubt.covariance.through(&back));
                travelled = DoubleDouble::ZERO;
            }
            if interface.touches {
                let back = -(interface.semi_diameter + interface.depth);
                now.point = moved(now.point, now.direction, DoubleDouble::from_f64(back));
                doubts
                    .iter_mut()
                    .for_each(|doubt| doubt.covariance = doubt.covariance.through(&transfer(back)));
            }
            let onward = self.sign * now.direction[2].to_f64();
            // Rays from the scene may meet a fisheye's front surface while travelling backward.
            if number > 0 || self.sign > 0.0 || interface.only_limits() {
                doubts
                    .iter_mut()
                    .for_each(|doubt| doubt.narrow(onward.abs() / (1.0 + doubt.covariance.direction())));
                if onward <= 0.0 {
                    exact = Some(Blocked::TurnedBack);
                    break;
                }
            }
            let crossing = interface.aspheric.as_ref().map(|aspheric| aspheric.crossing(&now));
            doubts.iter_mut().for_each(|doubt| {
                doubt.narrow(interface.margin(&now, crossing, self.sign, &doubt.covariance));
            });
            let after = match interface.through(&interface.exact, now.point, now.direction, crossing) {
                Ok([point, direction]) => ExactRay { point, direction },
                Err(reason) => {
                    exact = Some(reason);
                    break;
                }
            };
            let Some(jacobian) = interface.jacobian(&now, crossing) else {
                // The ray is so close to a decision that double precision, which the derivatives use, decides
                // otherwise.
                doubts.iter_mut().for_each(|doubt| doubt.narrow(0.0));
                exact = Some(Blocked::Missed);
                break;
            };
            if interface.only_limits() {
                travelled =
                    travelled + dot(std::array::from_fn(|i| after.point[i] - now.point[i]), now.direction);
            }
            now = after;
            let height = (now.point[0] * now.point[0] + now.point[1] * now.point[1]).sqrt();
            let semi_diameter = DoubleDouble::from_f64(interface.semi_diameter);
            let inside = ((semi_diameter - height) / semi_diameter).to_f64();
            for doubt in &mut doubts {
                doubt.covariance = doubt.covariance.through(&jacobian);
                doubt.covariance.disturb(doubt.norm.size(norm(after.point), interface.semi_diameter), 1.0);
                if let Some(aspheric) = &interface.aspheric {
                    let [moved, tilted] = aspheric.rounding(height.to_f64());
                    doubt.covariance.disturb(moved, interface.index_step.abs() * tilted);
                }
                doubt.narrow(inside.abs() / (1.0 + doubt.covariance.position() / interface.semi_diameter));
            }
            if inside < 0.0 {
                exact = Some(Blocked::Clipped);
                break;
            }
        }
        let [own, surface] = doubts.map(|doubt| Condition {
            direction: doubt.covariance.direction(),
            position: doubt.covariance.position(),
            margin: doubt.margin,
        });
        Trail { exact: exact.map_or(Ok(now), Err), own, surface }
    }
}

/// The propagated disturbance and the margin in one norm.
struct Doubt {
    norm: Norm,
    covariance: Covariance,
    margin: f64,
}

impl Doubt {
    fn narrow(&mut self, margin: f64) {
        self.margin = self.margin.min(margin);
    }
}

impl Interface {
    /// Whether the interface is a plane between equal media.
    fn only_limits(&self) -> bool {
        self.curvature == 0.0 && self.aspheric.is_none() && self.index_step == 0.0
    }

    /// Returns the ray after the interface, in any number type. A path traces it through a sphere or a plane; an
    /// asphere is crossed at the given crossing.
    fn through<R: Real>(
        &self,
        path: &Path<R>,
        point: [R; 3],
        direction: [R; 3],
        crossing: Option<Crossing>,
    ) -> Result<[[R; 3]; 2], Blocked> {
        match (&self.aspheric, crossing) {
            (Some(aspheric), Some(crossing)) => aspheric.through(point, direction, crossing?),
            _ => path.trace_in_full(point, direction).map(|(point, direction, _)| [point, direction]),
        }
    }

    /// Returns the Jacobian of the ray after the interface with respect to the ray before it; `None` if the ray is
    /// blocked in double precision.
    fn jacobian(&self, before: &ExactRay, crossing: Option<Crossing>) -> Option<Matrix> {
        let seeded = |v: Vector, first: usize| -> [Dual; 3] {
            std::array::from_fn(|i| {
                let slopes = std::array::from_fn(|j| f64::from(u8::from(j == first + i)));
                Dual { value: v[i].to_f64(), slopes }
            })
        };
        let (point, direction) = (seeded(before.point, 0), seeded(before.direction, 3));
        let [point, direction] = self.through(&self.dual, point, direction, crossing).ok()?;
        let rows: Matrix =
            std::array::from_fn(|i| if i < 3 { point[i].slopes } else { direction[i - 3].slopes });
        rows.iter().flatten().all(|slope| slope.is_finite()).then_some(rows)
    }

    /// Returns the least margin of the ray to missing the sphere, to meeting it beyond its equator or behind itself,
    /// and to total reflection, in units of the disturbance.
    fn margin(
        &self,
        before: &ExactRay,
        crossing: Option<Crossing>,
        sign: f64,
        covariance: &Covariance,
    ) -> f64 {
        if let (Some(aspheric), Some(crossing)) = (&self.aspheric, crossing) {
            return self.margin_at(aspheric, before, crossing, covariance);
        }
        let exact = DoubleDouble::from_f64;
        let (p, d, c) = (before.point, before.direction, exact(self.curvature));
        let (z, dz) = (exact(sign) * p[2], exact(sign) * d[2]);
        let f = c * dot(p, p) - z - z;
        let g = dz - c * dot(p, d);
        let cosine_squared = g * g - c * f;
        let distance = norm(p);
        let doubt = covariance.position() + distance * covariance.direction();
        let angle_doubt = 1.0 + covariance.direction() + self.curvature.abs() * doubt;
        let met = cosine_squared.to_f64().abs() / angle_doubt;
        if cosine_squared < DoubleDouble::ZERO {
            return met;
        }
        let e = cosine_squared.sqrt();
        let t = if g > DoubleDouble::ZERO { f / (g + e) } else { (g - e) / c };
        // A walk accepts a hit up to 512 ε of these lengths behind the ray's point, for rays that begin on a surface.
        let allowed = 16.0 * (self.semi_diameter + self.distance);
        let ahead = match self.only_limits() {
            true => f64::INFINITY,
            false => t.to_f64().abs() / (allowed + doubt / e.to_f64()),
        };
        let equator = (exact(1.0) - c * (z + t * dz)).to_f64().abs() / (angle_doubt / e.to_f64());
        let refracted = (cosine_squared + exact(self.index_step)).to_f64().abs() / angle_doubt;
        met.min(ahead).min(equator).min(refracted)
    }

    /// Returns the same margin for an asphere.
    fn margin_at(
        &self,
        aspheric: &Aspheric,
        before: &ExactRay,
        crossing: Crossing,
        covariance: &Covariance,
    ) -> f64 {
        let doubt = covariance.position() + norm(before.point) * covariance.direction();
        // The same tolerance as for a sphere.
        let allowed = 16.0 * (self.semi_diameter + self.distance);
        // A walk starts its search 1024 ε of the surface's size below the surface's lowest point.
        let start = aspheric.start(before) / (16.0 * aspheric.size() + allowed + doubt);
        let hit = match aspheric.met(before, crossing) {
            Met::At { cosine, steepness, distance } => {
                let angle_doubt = 1.0 + covariance.direction() + steepness * doubt;
                let met = cosine * cosine / angle_doubt;
                let ahead = distance / (allowed + doubt / cosine);
                met.min(ahead).min((cosine * cosine + self.index_step).abs() / angle_doubt)
            }
            Met::Nowhere { nearest } => nearest / (allowed + doubt),
        };
        hit.min(start)
    }
}

/// The accumulated disturbances as a covariance matrix.
#[derive(Clone, Copy, Debug, Default)]
struct Covariance(Matrix);

impl Covariance {
    /// Adds independent disturbances of every coordinate of the point and the direction.
    fn disturb(&mut self, position: f64, direction: f64) {
        for i in 0..N {
            let size = if i < 3 { position } else { direction };
            self.0[i][i] += size * size;
        }
    }

    fn through(&self, jacobian: &Matrix) -> Self {
        let product = |a: &Matrix, b: &dyn Fn(usize, usize) -> f64| -> Matrix {
            std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| a[i][k] * b(k, j)).sum()))
        };
        let half = product(jacobian, &|k, j| self.0[k][j]);
        Self(product(&half, &|k, j| jacobian[j][k]))
    }

    fn trace(&self, from: usize) -> f64 {
        (from..from + 3).map(|i| self.0[i][i]).sum::<f64>().sqrt()
    }

    /// Returns the root of the sum of squares of the position's disturbances, mm.
    fn position(&self) -> f64 {
        self.trace(0)
    }

    /// Returns the root of the sum of squares of the direction's disturbances, rad.
    fn direction(&self) -> f64 {
        self.trace(3)
    }
}

/// Returns the Jacobian of the transfer of a ray's point by `distance`.
fn transfer(distance: f64) -> Matrix {
    let entry = |i, j| if i == j { 1.0 } else { distance * f64::from(u8::from(i + 3 == j)) };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn moved(point: Vector, direction: Vector, distance: DoubleDouble) -> Vector {
    std::array::from_fn(|i| point[i] + distance * direction[i])
}

fn norm(v: Vector) -> f64 {
    dot(v, v).to_f64().sqrt()
}

fn unit(v: Vector) -> Vector {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

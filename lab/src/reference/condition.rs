//! How much a lens amplifies rounding: the condition number of the ray map.
//!
//! Any tracer that rounds disturbs the ray a little at every interface. The best that can be asked of
//! one is *backward stability*: that its result is the exact result of a ray disturbed by about ε at
//! the entry and at every interface, and no more. So the disturbances are carried through the exact
//! Jacobian of each interface (dual numbers: W. K. Clifford, "Preliminary sketch of biquaternions",
//! 1871; A. Griewank and A. Walther, *Evaluating Derivatives*, 2008, §3.1) and summed as independent
//! ones (N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, §1.5 and §3.8).
//!
//! **The norms.** A disturbance of size 1 is one radian in direction, and in position the point's own
//! distance from the vertex, in each component: what rounding does to the numbers that the point is kept
//! in ([`Trail::own`], for the walks). A tracer that forms its points from other numbers of the
//! surface's size (the compiled kernels, from plane to plane and from sphere to sphere) rounds by that
//! size also where the point lies on the axis: for it a disturbance of position is at least the clear
//! semi-diameter ([`Trail::surface`]). An interface's radius, index and place are rounded, too; that moves its
//! point and turns its ray by as much and needs no terms of its own. An asphere's terms may be many times what they add up
//! to: their rounding moves the surface by Σ |`A_i`| r^i and tilts it by Σ i |`A_i`| r^(i - 1), and does count. The condition number in direction is then the
//! root of the summed squares of the resulting direction errors, in rad per unit; the one in position the same in
//! mm per unit. Times ε they are the errors that a perfect tracer of that precision must expect.

use realistic::unstable::{
    lens::{Lens, Surface, refraction::Refraction},
    numeric::in_range,
    trace::{Blocked, Direction, Path, Ray, Real},
};

use super::{
    aspheric::{Aspheric, Crossing, Met},
    double_double::{DoubleDouble, Vector, dot, vector},
    dual::{Dual, N},
    exact::ExactRay,
};

type Matrix = [[f64; N]; N];

/// What exact arithmetic says of a ray, and how well posed the question was.
#[derive(Clone, Copy, Debug)]
pub struct Trail {
    /// The ray at the last surface, in the frame of its vertex, or why there is none.
    pub exact: Result<ExactRay, Blocked>,
    /// For disturbances of points relative to themselves.
    pub own: Condition,
    /// For disturbances of points relative to the surfaces.
    pub surface: Condition,
}

/// How much disturbances grow along a ray.
#[derive(Clone, Copy, Debug)]
pub struct Condition {
    /// Condition number in direction, rad per unit; of a blocked ray, up to where it is blocked.
    pub direction: f64,
    /// Condition number in position, mm per unit.
    pub position: f64,
    /// How far the ray was from the other outcome at the nearest of its decisions, in units of the
    /// disturbance there: at less than a few ε a tracer cannot know.
    pub margin: f64,
}

/// What a disturbance of a point is relative to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Norm {
    /// The point's own distance from the vertex.
    Own,
    /// The clear semi-diameter, or that distance where it is larger.
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
    /// The condition in a norm.
    pub fn condition(&self, norm: Norm) -> &Condition {
        match norm {
            Norm::Own => &self.own,
            Norm::Surface => &self.surface,
        }
    }
}

/// A lens made ready for exact rays with their condition numbers.
#[derive(Clone, Debug)]
pub struct Conditioned {
    interfaces: Vec<Interface>,
    sign: f64,
    entry: f64,
}

/// One interface by itself, in the frame of its vertex.
#[derive(Clone, Debug)]
struct Interface {
    /// From the vertex before; 0 for the first.
    distance: f64,
    curvature: f64,
    aspheric: Option<Aspheric>,
    semi_diameter: f64,
    /// From its lowest to its highest point, along the axis.
    depth: f64,
    /// (n'/n)² - 1.
    index_step: f64,
    /// Whether it touches the interface at which rays were last bent: rays may meet it a little behind that one.
    touches: bool,
    exact: Path<DoubleDouble>,
    dual: Path<Dual>,
}

/// How much wider than its clear aperture an interface is made.
const OPEN: f64 = 1e6;

impl Conditioned {
    /// Makes a lens ready for rays in one direction.
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        let forward = direction == Direction::SceneToFilm;
        let count = lens.surfaces.len();
        let at = |number: usize| if forward { number } else { count - 1 - number };
        let interface = |number: usize| {
            let surface = lens.surfaces[at(number)];
            let distance = match number {
                0 => 0.0,
                _ => lens.surfaces[at(number).min(at(number - 1))].thickness,
            };
            let (n, n_after) = match forward {
                true => (surface.n_scene, surface.n_film),
                false => (surface.n_film, surface.n_scene),
            };
            let [low, high] = surface.sagitta_range();
            // The clear aperture is tested here, so that a clipped ray's point is known all the same.
            let semi_diameter = OPEN * surface.semi_diameter;
            let last_bent = (0..number).rev().find(|&before| !lens.surfaces[at(before)].only_limits());
            let touches = |before: usize| lens.surfaces[at(number).max(at(before))].is_contact;
            let alone = Surface { vertex: 0.0, thickness: 0.0, semi_diameter, ..surface };
            let alone = Lens { surfaces: vec![alone], ..lens.clone() };
            Interface {
                distance,
                curvature: if forward { surface.curvature } else { -surface.curvature },
                aspheric: surface.figure.map(|figure| Aspheric::new(&figure, &surface, direction)),
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

    /// Takes a ray, its numbers taken as exact, through the lens.
    pub fn follow(&self, ray: Ray) -> Trail {
        let [x, y, z] = vector(ray.origin);
        let direction = unit(vector(in_range(ray.direction)));
        let origin = [x, y, z - DoubleDouble::from_f64(self.entry)];
        // From afar only what reaches the lens counts: the disturbance is that of the ray's point nearest
        // the vertex, where that lies ahead, and the ray begins a little before it: before all of the first surface,
        // which may be deeper than wide.
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
            let mut spread = Spread::default();
            spread.disturb(norm.size(size, semi_diameter), 1.0);
            Doubt { norm, spread: spread.through(&transfer(-lead)), margin: f64::INFINITY }
        });
        let mut exact = None;
        // From where the ray began or was last bent: planes that only limit do not say what lies behind it.
        let mut way = DoubleDouble::ZERO;
        for (number, interface) in self.interfaces.iter().enumerate() {
            now.point[2] = now.point[2] - DoubleDouble::from_f64(self.sign * interface.distance);
            if !interface.only_limits() && way.to_f64() != 0.0 {
                now.point = moved(now.point, now.direction, DoubleDouble::ZERO - way);
                let back = transfer(-way.to_f64());
                doubts.iter_mut().for_each(|doubt| doubt.spread = doubt.spread.through(&back));
                way = DoubleDouble::ZERO;
            }
            if interface.touches {
                let back = -(interface.semi_diameter + interface.depth);
                now.point = moved(now.point, now.direction, DoubleDouble::from_f64(back));
                doubts.iter_mut().for_each(|doubt| doubt.spread = doubt.spread.through(&transfer(back)));
            }
            let onward = self.sign * now.direction[2].to_f64();
            // A fisheye's front is met from the scene going backward, too.
            if number > 0 || self.sign > 0.0 || interface.only_limits() {
                doubts
                    .iter_mut()
                    .for_each(|doubt| doubt.narrow(onward.abs() / (1.0 + doubt.spread.direction())));
                if onward <= 0.0 {
                    exact = Some(Blocked::TurnedBack);
                    break;
                }
            }
            let crossing = interface.aspheric.as_ref().map(|aspheric| aspheric.crossing(&now));
            doubts.iter_mut().for_each(|doubt| {
                doubt.narrow(interface.margin(&now, crossing, self.sign, &doubt.spread));
            });
            let after = match interface.through(&interface.exact, now.point, now.direction, crossing) {
                Ok([point, direction]) => ExactRay { point, direction },
                Err(reason) => {
                    exact = Some(reason);
                    break;
                }
            };
            let Some(jacobian) = interface.jacobian(&now, crossing) else {
                // So near a decision that double precision, which the derivatives have, takes the other.
                doubts.iter_mut().for_each(|doubt| doubt.narrow(0.0));
                exact = Some(Blocked::Missed);
                break;
            };
            if interface.only_limits() {
                way = way + dot(std::array::from_fn(|i| after.point[i] - now.point[i]), now.direction);
            }
            now = after;
            let height = (now.point[0] * now.point[0] + now.point[1] * now.point[1]).sqrt();
            let semi_diameter = DoubleDouble::from_f64(interface.semi_diameter);
            let inside = ((semi_diameter - height) / semi_diameter).to_f64();
            for doubt in &mut doubts {
                doubt.spread = doubt.spread.through(&jacobian);
                doubt.spread.disturb(doubt.norm.size(norm(after.point), interface.semi_diameter), 1.0);
                if let Some(aspheric) = &interface.aspheric {
                    let [moved, tilted] = aspheric.rounding(height.to_f64());
                    doubt.spread.disturb(moved, interface.index_step.abs() * tilted);
                }
                doubt.narrow(inside.abs() / (1.0 + doubt.spread.position() / interface.semi_diameter));
            }
            if inside < 0.0 {
                exact = Some(Blocked::Clipped);
                break;
            }
        }
        let [own, surface] = doubts.map(|doubt| Condition {
            direction: doubt.spread.direction(),
            position: doubt.spread.position(),
            margin: doubt.margin,
        });
        Trail { exact: exact.map_or(Ok(now), Err), own, surface }
    }
}

/// What is known of the disturbances in one norm.
struct Doubt {
    norm: Norm,
    spread: Spread,
    margin: f64,
}

impl Doubt {
    fn narrow(&mut self, margin: f64) {
        self.margin = self.margin.min(margin);
    }
}

impl Interface {
    /// Whether it is a plane in one medium.
    fn only_limits(&self) -> bool {
        self.curvature == 0.0 && self.aspheric.is_none() && self.index_step == 0.0
    }

    /// The ray after the interface, in numbers of any type: through a sphere or a plane by a path, through an asphere where
    /// it was found to cross it.
    fn through<R: Real>(
        &self,
        path: &Path<R>,
        point: [R; 3],
        direction: [R; 3],
        crossing: Option<Crossing>,
    ) -> Result<[[R; 3]; 2], Blocked> {
        match (&self.aspheric, crossing) {
            (Some(aspheric), Some(crossing)) => aspheric.through(point, direction, crossing?),
            _ => path.trace_in_full(point, direction).map(|(point, direction)| [point, direction]),
        }
    }

    /// The Jacobian of the ray after the interface by the ray before it; `None` where double precision
    /// takes the ray for blocked.
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

    /// How far the ray is from missing the sphere, from meeting it beyond its equator or behind
    /// itself, and from total reflection, in units of the disturbance.
    fn margin(&self, before: &ExactRay, crossing: Option<Crossing>, sign: f64, spread: &Spread) -> f64 {
        if let (Some(aspheric), Some(crossing)) = (&self.aspheric, crossing) {
            return self.margin_at(aspheric, before, crossing, spread);
        }
        let exact = DoubleDouble::from_f64;
        let (p, d, c) = (before.point, before.direction, exact(self.curvature));
        let (z, dz) = (exact(sign) * p[2], exact(sign) * d[2]);
        let f = c * dot(p, p) - z - z;
        let g = dz - c * dot(p, d);
        let cosine_squared = g * g - c * f;
        let distance = norm(p);
        let doubt = spread.position() + distance * spread.direction();
        let angle_doubt = 1.0 + spread.direction() + self.curvature.abs() * doubt;
        let met = cosine_squared.to_f64().abs() / angle_doubt;
        if cosine_squared < DoubleDouble::ZERO {
            return met;
        }
        let e = cosine_squared.sqrt();
        let t = if g > DoubleDouble::ZERO { f / (g + e) } else { (g - e) / c };
        // A walk lets a hit lie 512 ε of these lengths behind the ray's point, for rays that begin on a surface.
        let allowed = 16.0 * (self.semi_diameter + self.distance);
        let ahead = match self.only_limits() {
            true => f64::INFINITY,
            false => t.to_f64().abs() / (allowed + doubt / e.to_f64()),
        };
        let equator = (exact(1.0) - c * (z + t * dz)).to_f64().abs() / (angle_doubt / e.to_f64());
        let refracted = (cosine_squared + exact(self.index_step)).to_f64().abs() / angle_doubt;
        met.min(ahead).min(equator).min(refracted)
    }

    /// The same for an asphere.
    fn margin_at(&self, aspheric: &Aspheric, before: &ExactRay, crossing: Crossing, spread: &Spread) -> f64 {
        let doubt = spread.position() + norm(before.point) * spread.direction();
        // As for a sphere.
        let allowed = 16.0 * (self.semi_diameter + self.distance);
        // A walk looks from 1024 ε of the surface's size below its lowest point on.
        let start = aspheric.start(before) / (16.0 * aspheric.size() + allowed + doubt);
        let hit = match aspheric.met(before, crossing) {
            Met::At { cosine, steepness, way } => {
                let angle_doubt = 1.0 + spread.direction() + steepness * doubt;
                let met = cosine * cosine / angle_doubt;
                let ahead = way / (allowed + doubt / cosine);
                met.min(ahead).min((cosine * cosine + self.index_step).abs() / angle_doubt)
            }
            Met::Nowhere { nearest } => nearest / (allowed + doubt),
        };
        hit.min(start)
    }
}

/// The disturbances so far as a covariance matrix.
#[derive(Clone, Copy, Debug, Default)]
struct Spread(Matrix);

impl Spread {
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

    /// Root of the summed squares of the position's disturbances, mm.
    fn position(&self) -> f64 {
        self.trace(0)
    }

    /// The same of the direction's, rad.
    fn direction(&self) -> f64 {
        self.trace(3)
    }
}

/// The Jacobian of moving a ray's point on by `distance`.
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

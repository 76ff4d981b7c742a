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
    lens::Lens,
    prescription::CoordinateBreak,
    trace::{Blocked, Direction, Ray, Real},
};

use super::{
    double_double::DoubleDouble,
    dual::{Dual, N},
    exact::{ExactRay, dot, norm, vector},
    sheet::{Met, Sheet},
};

type Matrix = [[f64; N]; N];

/// The exact ray, and the conditioning of the trace.
#[derive(Clone, Copy, Debug)]
pub struct Trail<R = DoubleDouble> {
    /// The ray at the last surface, or the reason why it is blocked.
    pub exact: Result<ExactRay<R>, Blocked>,
    /// The optical path from the ray's origin to the last surface met, mm: the sum of lengths times indices.
    pub optical_path: R,
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

impl<R> Trail<R> {
    /// Returns the condition in a norm.
    pub fn condition(&self, norm: Norm) -> &Condition {
        match norm {
            Norm::Own => &self.own,
            Norm::Surface => &self.surface,
        }
    }
}

/// A lens prepared for exact rays with their condition numbers. It shares no formula with the walk: frames, crossings and
/// refractions follow from the numbers of the lens. Only the region in which a surface is searched for is the library's.
#[derive(Clone, Debug)]
pub struct Conditioned {
    interfaces: Vec<Interface>,
    direction: Direction,
    entry: f64,
    /// Whether z of the space in front of the first interface points the other way than in the frame of the interface.
    enters_reversed: bool,
    /// The same behind the last interface.
    leaves_reversed: bool,
    /// The change of frame behind the last interface.
    leaving: Option<Change>,
}

/// A single interface, in the frame of its vertex, with z toward the scene along the axis from its vertex.
#[derive(Clone, Debug)]
struct Interface {
    /// Distance from the previous vertex; 0 for the first.
    distance: f64,
    /// The change of frame in front of the interface, in the order of travel.
    change: Change,
    /// 1 for light that arrives toward +z, -1 for light that arrives toward -z.
    sign: f64,
    /// The curvature of a sphere, positive if the centre lies ahead.
    curvature: f64,
    /// Whether the interface is neither a sphere nor a plane.
    is_figured: bool,
    sheet: Sheet,
    semi_diameter: f64,
    /// Distance along the axis from the interface's lowest to its highest point.
    depth: f64,
    /// (n'² - n²)/n².
    index_step: f64,
    /// The index before the interface.
    n: f64,
    /// Whether this is a plane in one medium.
    only_limits: bool,
    /// Whether this interface touches the last refracting interface before it; rays may then meet this interface
    /// slightly behind that one.
    touches: bool,
}

/// A change of frame: a shift along the axis and then a coordinate break, or the way back.
#[derive(Clone, Copy, Debug)]
struct Change {
    /// The shift along z toward the film, mm.
    gap: f64,
    own: Option<CoordinateBreak>,
    is_back: bool,
}

impl Change {
    /// Takes a point to the new frame.
    fn point<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        // z of the frames here points toward the scene, and that of breaks toward the film.
        let along = R::from_f64(self.gap);
        let shift = self.own.map_or([R::ZERO; 3], |own| own.shift.map(R::from_f64));
        if self.is_back {
            let [x, y, z] = self.turned([x, y, z]);
            [x + shift[0], y + shift[1], z - along - shift[2]]
        } else {
            self.turned([x - shift[0], y - shift[1], z + along + shift[2]])
        }
    }

    /// Returns a direction in the new frame.
    fn turned<R: Real>(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        let Some(own) = self.own else { return [x, y, z] };
        let before = [x, y, -z];
        let entry = |i: usize, j: usize| {
            R::from_f64(if self.is_back { own.rotation[i][j] } else { own.rotation[j][i] })
        };
        let turned = |i: usize| entry(i, 0) * before[0] + entry(i, 1) * before[1] + entry(i, 2) * before[2];
        [turned(0), turned(1), -turned(2)]
    }

    /// Returns the Jacobian of the change.
    fn jacobian(&self) -> Matrix {
        let unit = |j: usize| std::array::from_fn(|i| f64::from(u8::from(i == j)));
        let columns: [[f64; 3]; 3] = std::array::from_fn(|j| self.turned(unit(j)));
        std::array::from_fn(|i| {
            std::array::from_fn(|j| if i / 3 == j / 3 { columns[j % 3][i % 3] } else { 0.0 })
        })
    }
}

impl Conditioned {
    /// Prepares a lens for rays in one direction.
    pub fn new(lens: &Lens, direction: Direction) -> Self {
        let forward = direction == Direction::SceneToFilm;
        let count = lens.surfaces.len();
        let at = |number: usize| if forward { number } else { count - 1 - number };
        let interface = |number: usize| {
            let surface = &lens.surfaces[at(number)];
            // The gap and the break between two surfaces stand with the surface before and with the one behind.
            let change = match (number, forward) {
                (0, true) => Change { gap: 0.0, own: surface.coordinate_break, is_back: false },
                (0, false) => Change { gap: 0.0, own: lens.film_break, is_back: true },
                (_, true) => {
                    let gap = lens.surfaces[at(number - 1)].thickness;
                    Change { gap, own: surface.coordinate_break, is_back: false }
                }
                (_, false) => {
                    let own = lens.surfaces[at(number - 1)].coordinate_break;
                    Change { gap: surface.thickness, own, is_back: true }
                }
            };
            let n = match forward {
                true => [surface.n_scene, surface.n_film],
                false => [surface.n_film, surface.n_scene],
            };
            let toward_scene = if forward { surface.is_reversed } else { !surface.is_reversed_behind() };
            let sign = if toward_scene { 1.0 } else { -1.0 };
            let [low, high] = surface.sagitta_range();
            let only_limits = surface.only_limits();
            let last_bent = (0..number).rev().find(|&before| !lens.surfaces[at(before)].only_limits());
            let touches = |before: usize| lens.surfaces[at(number).max(at(before))].is_contact;
            Interface {
                distance: change.gap.abs(),
                change,
                sign,
                curvature: -sign * surface.curvature,
                is_figured: surface.figure.is_some() || surface.unsymmetric.is_some(),
                sheet: Sheet::new(surface, sign, n),
                semi_diameter: surface.semi_diameter,
                depth: high - low,
                index_step: if surface.is_mirror {
                    0.0
                } else {
                    (n[1] - n[0]) * (n[1] + n[0]) / (n[0] * n[0])
                },
                n: n[0],
                only_limits,
                touches: !only_limits && last_bent.is_some_and(touches),
            }
        };
        let behind = lens.rear().is_reversed_behind();
        let leaving = match forward {
            true => lens.film_break.map(|own| Change { gap: 0.0, own: Some(own), is_back: false }),
            false => {
                lens.front().coordinate_break.map(|own| Change { gap: 0.0, own: Some(own), is_back: true })
            }
        };
        Self {
            interfaces: (0..count).map(interface).collect(),
            direction,
            entry: lens.surfaces[at(0)].vertex,
            enters_reversed: !forward && behind,
            leaves_reversed: forward && behind,
            leaving,
        }
    }

    /// Traces a ray, whose components are taken as exact, through the lens.
    pub fn follow<R: Real>(&self, ray: Ray) -> Trail<R> {
        let enter = |[x, y, z]: [R; 3]| [x, y, if self.enters_reversed { -z } else { z }];
        let [x, y, z] = vector(ray.origin);
        let first = &self.interfaces[0].change;
        let origin = first.point(enter([x, y, z - R::from_f64(self.entry)]));
        let direction = unit(first.turned(enter(vector(in_range(ray.direction)))));
        // The disturbance of a distant ray is that of its point nearest the vertex, if that point lies ahead. The ray
        // then starts a little before that point, in front of the whole first surface, which may be deeper than wide.
        let ahead = -dot(origin, direction);
        let nearest = moved(origin, direction, ahead);
        let Interface { semi_diameter, depth, .. } = self.interfaces[0];
        let lead = ahead.to_f64().clamp(0.0, 2.0 * (norm(nearest) + semi_diameter + depth));
        let size = if lead > 0.0 { norm(nearest) } else { norm(origin) };
        let point =
            if lead < ahead.to_f64() { moved(nearest, direction, R::from_f64(-lead)) } else { origin };
        // Distance along the ray from its point here to the point up to which the optical path is known.
        let mut known = dot(std::array::from_fn(|i| origin[i] - point[i]), direction);
        let mut optical_path = R::ZERO;
        let mut now = ExactRay { point, direction };
        let mut doubts = Norm::BOTH.map(|norm| {
            let mut covariance = Covariance::default();
            covariance.disturb(norm.size(size, semi_diameter), 1.0);
            Doubt { norm, covariance: covariance.through(&transfer(-lead)), margin: f64::INFINITY }
        });
        let mut exact = None;
        // Distance from the ray's start or its last refraction: planes that only limit rays do not begin a new
        // distance.
        let mut travelled = R::ZERO;
        for (number, interface) in self.interfaces.iter().enumerate() {
            if number > 0 {
                let change = &interface.change;
                now = ExactRay {
                    point: change.point(now.point),
                    direction: unit(change.turned(now.direction)),
                };
                if change.own.is_some() {
                    // The change of frame rounds the ray once more.
                    let (jacobian, size) = (change.jacobian(), norm(now.point));
                    for doubt in &mut doubts {
                        doubt.covariance = doubt.covariance.through(&jacobian);
                        doubt.covariance.disturb(doubt.norm.size(size, interface.semi_diameter), 1.0);
                    }
                }
            }
            if !interface.only_limits && travelled.to_f64() != 0.0 {
                now.point = moved(now.point, now.direction, -travelled);
                known = known + travelled;
                let back = transfer(-travelled.to_f64());
                doubts.iter_mut().for_each(|doubt| doubt.covariance = doubt.covariance.through(&back));
                travelled = R::ZERO;
            }
            if interface.touches {
                let back = -(interface.semi_diameter + interface.depth);
                now.point = moved(now.point, now.direction, R::from_f64(back));
                known = known - R::from_f64(back);
                doubts
                    .iter_mut()
                    .for_each(|doubt| doubt.covariance = doubt.covariance.through(&transfer(back)));
            }
            let onward = interface.sign * now.direction[2].to_f64();
            // Rays from the scene may meet a fisheye's front surface while travelling backward.
            if number > 0 || self.direction == Direction::FilmToScene || interface.only_limits {
                doubts
                    .iter_mut()
                    .for_each(|doubt| doubt.narrow(onward.abs() / (1.0 + doubt.covariance.direction())));
                if onward <= 0.0 {
                    exact = Some(Blocked::TurnedBack);
                    break;
                }
            }
            let crossing = interface.sheet.crossing(now.point, now.direction);
            doubts.iter_mut().for_each(|doubt| {
                doubt.narrow(interface.margin(&now, crossing, &doubt.covariance));
            });
            let through = |t| Ok((t, interface.sheet.through(now.point, now.direction, t)?));
            let (t, after) = match crossing.and_then(through) {
                Ok((t, [point, direction])) => (t, ExactRay { point, direction }),
                Err(reason) => {
                    exact = Some(reason);
                    break;
                }
            };
            let Some(jacobian) = interface.jacobian(&now, t) else {
                // The ray is so close to a decision that double precision, which the derivatives use, decides
                // otherwise.
                doubts.iter_mut().for_each(|doubt| doubt.narrow(0.0));
                exact = Some(Blocked::Missed);
                break;
            };
            let passed = dot(std::array::from_fn(|i| after.point[i] - now.point[i]), now.direction);
            optical_path = optical_path + R::from_f64(interface.n) * (passed - known);
            known = R::ZERO;
            if interface.only_limits {
                travelled = travelled + passed;
            }
            now = after;
            let height = (now.point[0] * now.point[0] + now.point[1] * now.point[1]).sqrt();
            let semi_diameter = R::from_f64(interface.semi_diameter);
            let inside = ((semi_diameter - height) / semi_diameter).to_f64();
            for doubt in &mut doubts {
                doubt.covariance = doubt.covariance.through(&jacobian);
                doubt.covariance.disturb(doubt.norm.size(norm(after.point), interface.semi_diameter), 1.0);
                if interface.is_figured {
                    let [moved, tilted] = interface.sheet.rounding(height.to_f64());
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
        if let Some(leaving) = &self.leaving {
            now =
                ExactRay { point: leaving.point(now.point), direction: unit(leaving.turned(now.direction)) };
        }
        if self.leaves_reversed {
            (now.point[2], now.direction[2]) = (-now.point[2], -now.direction[2]);
        }
        Trail { exact: exact.map_or(Ok(now), Err), optical_path, own, surface }
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
    /// Returns the Jacobian of the ray after the interface with respect to the ray before it; `None` if the ray is
    /// blocked in double precision.
    fn jacobian<R: Real>(&self, before: &ExactRay<R>, t: R) -> Option<Matrix> {
        let seeded = |v: [R; 3], first: usize| -> [Dual; 3] {
            std::array::from_fn(|i| {
                let slopes = std::array::from_fn(|j| f64::from(u8::from(j == first + i)));
                Dual { value: v[i].to_f64(), slopes }
            })
        };
        let (point, direction) = (seeded(before.point, 0), seeded(before.direction, 3));
        let [point, direction] = self.sheet.through(point, direction, Dual::from_f64(t.to_f64())).ok()?;
        let rows: Matrix =
            std::array::from_fn(|i| if i < 3 { point[i].slopes } else { direction[i - 3].slopes });
        rows.iter().flatten().all(|slope| slope.is_finite()).then_some(rows)
    }

    /// Returns the least margin of the ray to missing the interface, to meeting it beyond its equator or behind itself,
    /// and to total reflection, in units of the disturbance.
    fn margin<R: Real>(
        &self,
        before: &ExactRay<R>,
        crossing: Result<R, Blocked>,
        covariance: &Covariance,
    ) -> f64 {
        if self.is_figured {
            return self.margin_at(before, crossing, covariance);
        }
        let (exact, sign) = (R::from_f64, self.sign);
        let (p, d, c) = (before.point, before.direction, exact(self.curvature));
        let (z, dz) = (exact(sign) * p[2], exact(sign) * d[2]);
        let f = c * dot(p, p) - z - z;
        let g = dz - c * dot(p, d);
        let cosine_squared = g * g - c * f;
        let distance = norm(p);
        let doubt = covariance.position() + distance * covariance.direction();
        let angle_doubt = 1.0 + covariance.direction() + self.curvature.abs() * doubt;
        let met = cosine_squared.to_f64().abs() / angle_doubt;
        if cosine_squared < R::ZERO {
            return met;
        }
        let e = cosine_squared.sqrt();
        let t = if g > R::ZERO { f / (g + e) } else { (g - e) / c };
        // A walk accepts a hit up to 512 ε of these lengths behind the ray's point, for rays that begin on a surface.
        let allowed = 16.0 * (self.semi_diameter + self.distance);
        let ahead = match self.only_limits {
            true => f64::INFINITY,
            false => t.to_f64().abs() / (allowed + doubt / e.to_f64()),
        };
        let equator = (exact(1.0) - c * (z + t * dz)).to_f64().abs() / (angle_doubt / e.to_f64());
        let refracted = (cosine_squared + exact(self.index_step)).to_f64().abs() / angle_doubt;
        met.min(ahead).min(equator).min(refracted)
    }

    /// Returns the same margin for an interface that is neither a sphere nor a plane.
    fn margin_at<R: Real>(
        &self,
        before: &ExactRay<R>,
        crossing: Result<R, Blocked>,
        covariance: &Covariance,
    ) -> f64 {
        let ExactRay { point, direction } = *before;
        let doubt = covariance.position() + norm(before.point) * covariance.direction();
        // The same tolerance as for a sphere.
        let allowed = 16.0 * (self.semi_diameter + self.distance);
        // A walk starts its search 1024 ε of the surface's size below the surface's lowest point.
        let start = self.sheet.start(point, direction) / (16.0 * self.sheet.size + allowed + doubt);
        let hit = match self.sheet.met(point, direction, crossing) {
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

fn moved<R: Real>(point: [R; 3], direction: [R; 3], distance: R) -> [R; 3] {
    std::array::from_fn(|i| point[i] + distance * direction[i])
}

fn unit<R: Real>(v: [R; 3]) -> [R; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

//! Many solid shapes: boxes, rods, balls and turned parts, in a bounding volume hierarchy for ray intersection.

use super::objects::Material;
use super::shapes::{Hit, Ray, Shape, Sphere};
use glam::{Vec2, Vec3, Vec3A};

/// Largest number of shapes in a leaf of the hierarchy.
const LEAF: usize = 3;
/// Largest depth of the hierarchy, and so the largest number of boxes on the stack while a ray descends it.
const DEPTH: usize = 64;

/// Material of a solid as a function of the point and the normal of its surface.
#[derive(Clone, Copy)]
pub enum Appearance {
    /// The same material everywhere.
    Plain(Material),
    /// A material by a formula.
    Painted(fn(Vec3, Vec3) -> Material),
}

/// A box with a horizontal base, rotated about the vertical.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Centre.
    pub centre: Vec3,
    /// Half of the width, the height and the depth.
    pub half: Vec3,
    /// Cosine and sine of the rotation.
    pub turn: Vec2,
}

/// A part of a surface of revolution about a vertical axis: the frustum of a cone, or a flat ring if the height is 0.
#[derive(Clone, Copy, Debug)]
pub struct Turned {
    /// Point of the axis at the lower end.
    pub foot: Vec3,
    /// Height.
    pub height: f32,
    /// Radii at the lower and the upper end.
    pub radii: [f32; 2],
    /// Outward and upward components of the normal, at the lower and the upper end.
    pub normals: [Vec2; 2],
}

/// A cylinder with round ends.
#[derive(Clone, Copy, Debug)]
pub struct Rod {
    /// Centres of the ends.
    pub ends: [Vec3; 2],
    /// Radius.
    pub radius: f32,
}

/// A shape of the hierarchy.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// A ball at rest.
    Ball(Sphere),
    /// A box.
    Block(Block),
    /// A cylinder with round ends.
    Rod(Rod),
    /// A turned part.
    Turned(Turned),
}

impl Block {
    /// Rotates a vector from the scene's axes to the box's own axes.
    fn local(&self, v: Vec3) -> Vec3 {
        let Vec2 { x: cosine, y: sine } = self.turn;
        Vec3::new(cosine * v.x - sine * v.z, v.y, sine * v.x + cosine * v.z)
    }

    /// Rotates a vector from the box's own axes to the scene's axes.
    fn global(&self, v: Vec3) -> Vec3 {
        let Vec2 { x: cosine, y: sine } = self.turn;
        Vec3::new(cosine * v.x + sine * v.z, v.y, cosine * v.z - sine * v.x)
    }
}

impl Shape for Block {
    fn intersect(&self, ray: &Ray, from: f32, to: f32) -> Option<Hit> {
        let (origin, direction) = (self.local(ray.origin - self.centre), self.local(ray.direction));
        let (first, second) = ((-self.half - origin) / direction, (self.half - origin) / direction);
        let (enters, leaves) = (first.min(second), first.max(second));
        let (near, far) = (enters.max_element(), leaves.min_element());
        if near > far {
            return None;
        }
        let is_outside = (from..to).contains(&near);
        let distance = if is_outside { near } else { far };
        if !(from..to).contains(&distance) {
            return None;
        }
        let axis = if is_outside { enters.max_position() } else { leaves.min_position() };
        let mut normal = Vec3::ZERO;
        normal[axis] = if is_outside { -direction[axis].signum() } else { direction[axis].signum() };
        Some(Hit { distance, normal: self.global(normal) })
    }
}

impl Shape for Rod {
    fn intersect(&self, ray: &Ray, from: f32, to: f32) -> Option<Hit> {
        let [start, end] = self.ends;
        let axis = end - start;
        let length = axis.length();
        let axis = axis / length;
        // The origin is moved near the rod, so that rounding does not lose a thin rod far away.
        let shift = (0.5 * (start + end) - ray.origin).dot(ray.direction);
        let origin = ray.at(shift) - start;
        let (along, climb) = (origin.dot(axis), ray.direction.dot(axis));
        let (aside, drift) = (origin - along * axis, ray.direction - climb * axis);
        let (a, b) = (drift.length_squared(), aside.dot(drift));
        let square = b * b - a * (aside.length_squared() - self.radius * self.radius);
        if square < 0.0 {
            return None;
        }
        let t = (-b - square.sqrt()) / a;
        if (0.0..length).contains(&(along + t * climb)) {
            let distance = t + shift;
            return (from..to)
                .contains(&distance)
                .then(|| Hit { distance, normal: (aside + t * drift) / self.radius });
        }
        let caps = self.ends.map(|centre| Sphere::resting(centre, self.radius).intersect(ray, from, to));
        caps.into_iter().flatten().min_by(|a, b| a.distance.total_cmp(&b.distance))
    }
}

impl Shape for Turned {
    fn intersect(&self, ray: &Ray, from: f32, to: f32) -> Option<Hit> {
        let shift = (self.foot - ray.origin).dot(ray.direction);
        let (o, d) = (ray.at(shift) - self.foot, ray.direction);
        let [low, high] = self.radii;
        let hit = |t: f32, part: f32| {
            let distance = t + shift;
            if !(from..to).contains(&distance) {
                return None;
            }
            let outward = Vec3::new(o.x + t * d.x, 0.0, o.z + t * d.z).normalize_or_zero();
            let normal = self.normals[0].lerp(self.normals[1], part).normalize();
            Some(Hit { distance, normal: normal.x * outward + normal.y * Vec3::Y })
        };
        if self.height == 0.0 {
            let t = -o.y / d.y;
            let square = (o.x + t * d.x).powi(2) + (o.z + t * d.z).powi(2);
            let [inner, outer] = [low.min(high), low.max(high)];
            let part = (square.sqrt() - low) / (high - low);
            return (square > inner * inner && square < outer * outer).then(|| hit(t, part)).flatten();
        }
        let slope = (high - low) / self.height;
        let radius = low + slope * o.y;
        let a = d.x * d.x + d.z * d.z - slope * slope * d.y * d.y;
        let b = o.x * d.x + o.z * d.z - radius * slope * d.y;
        let c = o.x * o.x + o.z * o.z - radius * radius;
        let square = b * b - a * c;
        if square <= 0.0 {
            return None;
        }
        let q = -b - square.sqrt().copysign(b);
        let [one, other] = [q / a, c / q];
        let meets = |t: f32| {
            let y = o.y + t * d.y;
            ((0.0..=self.height).contains(&y) && low + slope * y >= 0.0)
                .then(|| hit(t, y / self.height))
                .flatten()
        };
        meets(one.min(other)).or_else(|| meets(one.max(other)))
    }
}

impl Form {
    fn intersect(&self, ray: &Ray, from: f32, to: f32) -> Option<Hit> {
        match self {
            Self::Ball(ball) => ball.intersect(ray, from, to),
            Self::Block(block) => block.intersect(ray, from, to),
            Self::Rod(rod) => rod.intersect(ray, from, to),
            Self::Turned(turned) => turned.intersect(ray, from, to),
        }
    }

    /// Returns the lowest and the highest corner of a box that contains the shape.
    fn bounds(&self) -> [Vec3; 2] {
        match self {
            Self::Ball(ball) => [ball.centre - ball.radius, ball.centre + ball.radius],
            Self::Block(block) => {
                let Vec3 { x, y, z } = block.half;
                let [cosine, sine] = [block.turn.x.abs(), block.turn.y.abs()];
                let half = Vec3::new(cosine * x + sine * z, y, sine * x + cosine * z);
                [block.centre - half, block.centre + half]
            }
            Self::Rod(rod) => {
                let [a, b] = rod.ends;
                [a.min(b) - rod.radius, a.max(b) + rod.radius]
            }
            Self::Turned(turned) => {
                let radius = turned.radii[0].max(turned.radii[1]);
                let aside = Vec3::new(radius, 0.0, radius);
                // A ring has no height; without a margin, rounding could lose it.
                let [below, above] = [Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, turned.height + 0.01, 0.0)];
                [turned.foot - aside + below, turned.foot + aside + above]
            }
        }
    }
}

/// A box of the hierarchy: its corners, its shapes, and the index of the box of the second half of the shapes; 0 for
/// a leaf. The box of the first half follows its parent.
struct BvhNode {
    low: Vec3A,
    high: Vec3A,
    shapes: [u32; 2],
    second: u32,
}

/// Solids with their hierarchy.
#[derive(Default)]
pub struct Solids {
    forms: Vec<Form>,
    appearances: Vec<Appearance>,
    nodes: Vec<BvhNode>,
}

impl FromIterator<(Form, Appearance)> for Solids {
    fn from_iter<I: IntoIterator<Item = (Form, Appearance)>>(solids: I) -> Self {
        let mut solids: Vec<(Form, Appearance)> = solids.into_iter().collect();
        let mut nodes = Vec::new();
        if !solids.is_empty() {
            build(&mut solids, 0, &mut nodes);
        }
        let (forms, appearances) = solids.into_iter().unzip();
        Self { forms, appearances, nodes }
    }
}

/// Returns the box that contains all these boxes.
fn around(boxes: impl Iterator<Item = [Vec3; 2]>) -> [Vec3; 2] {
    boxes.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], [a, b]| [low.min(a), high.max(b)])
}

/// Adds the boxes of these solids, the first of which has index `first`. The solids are sorted by their centres along
/// the best axis and split by the surface area heuristic, which minimises the sum over both parts of a box's area
/// times its number of solids (J. D. MacDonald and K. S. Booth, "Heuristics for Ray Tracing Using Space Subdivision",
/// *The Visual Computer* 6(3), 1990).
fn build(solids: &mut [(Form, Appearance)], first: u32, nodes: &mut Vec<BvhNode>) {
    let [low, high] = around(solids.iter().map(|solid| solid.0.bounds()));
    let own = nodes.len();
    let shapes = [first, first + solids.len() as u32];
    nodes.push(BvhNode { low: low.into(), high: high.into(), shapes, second: 0 });
    if solids.len() <= LEAF {
        return;
    }
    let area = |[low, high]: [Vec3; 2]| {
        let side = high - low;
        side.x * side.y + side.y * side.z + side.z * side.x
    };
    let sort = |solids: &mut [(Form, Appearance)], axis: usize| {
        let centre = |solid: &(Form, Appearance)| solid.0.bounds().into_iter().sum::<Vec3>()[axis];
        solids.sort_by(|a, b| centre(a).total_cmp(&centre(b)));
    };
    let mut best = (f32::INFINITY, 0, 0);
    for axis in 0..3 {
        sort(solids, axis);
        let grow = |sum: &mut [Vec3; 2], solid: &(Form, Appearance)| {
            *sum = around([*sum, solid.0.bounds()].into_iter());
            Some(area(*sum))
        };
        let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let lower: Vec<f32> = solids.iter().scan(empty, grow).collect();
        let upper: Vec<f32> = solids.iter().rev().scan(empty, grow).collect();
        for count in 1..solids.len() {
            let rest = solids.len() - count;
            let cost = lower[count - 1] * count as f32 + upper[rest - 1] * rest as f32;
            if cost < best.0 {
                best = (cost, axis, count);
            }
        }
    }
    let (_, axis, count) = best;
    sort(solids, axis);
    let (one, other) = solids.split_at_mut(count.max(1));
    build(one, first, nodes);
    nodes[own].second = nodes.len() as u32;
    build(other, first + one.len() as u32, nodes);
}

/// A ray prepared for box tests.
struct BoxTestRay {
    origin: Vec3A,
    inverse: Vec3A,
    from: f32,
}

impl BoxTestRay {
    /// Returns the distance at which the ray enters a box, if it does so before `to`; otherwise infinity.
    #[inline(always)]
    fn enters(&self, node: &BvhNode, to: f32) -> f32 {
        let first = (node.low - self.origin) * self.inverse;
        let second = (node.high - self.origin) * self.inverse;
        let near = first.min(second).max_element().max(self.from);
        let far = first.max(second).min_element().min(to);
        if near <= far { near } else { f32::INFINITY }
    }
}

impl Solids {
    /// Returns the intersection with the nearest solid that a ray meets beyond `from` and before `to`, and the
    /// material there.
    pub fn nearest(&self, ray: &Ray, from: f32, to: f32) -> Option<(Hit, Material)> {
        let mut best: Option<(Hit, usize)> = None;
        self.descend(ray, from, to, |hit, index| {
            best = Some((hit, index));
            hit.distance
        });
        best.map(|(hit, index)| {
            let material = match self.appearances[index] {
                Appearance::Plain(material) => material,
                Appearance::Painted(paint) => paint(ray.at(hit.distance), hit.normal),
            };
            (hit, material)
        })
    }

    /// Whether any solid blocks a ray between two distances.
    pub fn hides(&self, ray: &Ray, from: f32, to: f32) -> bool {
        let mut is_hidden = false;
        self.descend(ray, from, to, |_, _| {
            is_hidden = true;
            f32::NEG_INFINITY
        });
        is_hidden
    }

    /// Visits the boxes along a ray; `found` receives each intersection and returns the distance up to which the
    /// search continues.
    #[inline(always)]
    fn descend(&self, ray: &Ray, from: f32, mut to: f32, mut found: impl FnMut(Hit, usize) -> f32) {
        let line =
            BoxTestRay { origin: ray.origin.into(), inverse: Vec3A::from(ray.direction).recip(), from };
        let mut waiting = [(0_u32, 0.0_f32); DEPTH];
        let mut count = 0;
        let mut next = match self.nodes.first() {
            Some(root) if line.enters(root, to) < f32::INFINITY => 0,
            _ => return,
        };
        loop {
            let node = &self.nodes[next as usize];
            if node.second != 0 {
                let (one, other) = (next + 1, node.second);
                let near_one = line.enters(&self.nodes[one as usize], to);
                let near_other = line.enters(&self.nodes[other as usize], to);
                // The nearer box is visited first.
                let (nearer, farther, near, far) = if near_one <= near_other {
                    (one, other, near_one, near_other)
                } else {
                    (other, one, near_other, near_one)
                };
                if far < f32::INFINITY {
                    waiting[count] = (farther, far);
                    count += 1;
                }
                if near < f32::INFINITY {
                    next = nearer;
                    continue;
                }
            } else {
                for shape in node.shapes[0]..node.shapes[1] {
                    if let Some(hit) = self.forms[shape as usize].intersect(ray, from, to) {
                        to = found(hit, shape as usize);
                    }
                }
            }
            loop {
                if count == 0 {
                    return;
                }
                count -= 1;
                if waiting[count].1 <= to {
                    next = waiting[count].0;
                    break;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::scene::Finish;

    fn ray(origin: Vec3, target: Vec3) -> Ray {
        Ray { origin, direction: (target - origin).normalize(), time: 0.5 }
    }

    /// Returns a number in [0, 1); successive indices show no visible pattern.
    fn at(index: u16, step: f32) -> f32 {
        (f32::from(index) * step).fract()
    }

    fn anywhere(index: u16) -> Vec3 {
        Vec3::new(at(index, 0.819_173), at(index, 0.671_044), at(index, 0.549_7)) * 200.0 - 100.0
    }

    fn forms() -> Vec<Form> {
        let form = |index: u16| {
            let [centre, other] = [anywhere(3 * index), anywhere(3 * index + 1)];
            let size = 2.0 + 9.0 * at(index, 0.37);
            match index % 4 {
                0 => Form::Ball(Sphere::resting(centre, size)),
                1 => Form::Block(Block {
                    centre,
                    half: Vec3::new(size, 0.5 * size, 2.0 * size),
                    turn: Vec2::from_angle(f32::from(index)),
                }),
                2 => Form::Rod(Rod { ends: [centre, centre + 0.2 * other], radius: 0.3 * size }),
                _ => Form::Turned(Turned {
                    foot: centre,
                    height: 2.0 * size,
                    radii: [size, 0.4 * size],
                    normals: [Vec2::new(2.0, 0.6).normalize(); 2],
                }),
            }
        };
        (0..120).map(form).collect()
    }

    #[test]
    fn the_hierarchy_finds_what_trying_every_shape_finds() {
        let forms = forms();
        let appearance = Appearance::Plain(Material::new(Vec3::ONE, Finish::Matte));
        let solids: Solids = forms.iter().map(|form| (*form, appearance)).collect();
        let mut met = 0;
        for index in 0..4000 {
            let ray = ray(1.5 * anywhere(2 * index), anywhere(2 * index + 1));
            let hits = forms.iter().filter_map(|form| form.intersect(&ray, 0.0, f32::INFINITY));
            let expected = hits.map(|hit| hit.distance).min_by(f32::total_cmp);
            let found = solids.nearest(&ray, 0.0, f32::INFINITY).map(|(hit, _)| hit.distance);
            assert_eq!(found, expected);
            assert_eq!(solids.hides(&ray, 0.0, f32::INFINITY), expected.is_some());
            if let Some(distance) = expected {
                assert!(!solids.hides(&ray, 0.0, distance));
                met += 1;
            }
        }
        assert!(met > 1000 && met < 4000, "{met}");
    }

    #[test]
    fn normals_are_those_of_the_surface() {
        // To first order, points of a surface next to an intersection lie in the plane perpendicular to the reported
        // normal.
        const STEP: f32 = 0.02;
        for form in forms() {
            let [low, high] = form.bounds();
            let (centre, size) = (0.5 * (low + high), (high - low).length());
            let mut met = 0;
            for index in 0..40 {
                let from = centre + anywhere(index).normalize() * size;
                let view_ray = ray(from, centre + 0.05 * size * anywhere(index + 7).normalize());
                let (side, up) = view_ray.direction.any_orthonormal_pair();
                let meet = |aside: Vec3| {
                    let ray = Ray { origin: view_ray.origin + aside, ..view_ray };
                    form.intersect(&ray, 0.0, f32::INFINITY).map(|hit| (ray.at(hit.distance), hit.normal))
                };
                let (Some((point, normal)), Some((beside, other)), Some((above, third))) =
                    (meet(Vec3::ZERO), meet(STEP * side), meet(STEP * up))
                else {
                    continue;
                };
                assert!((normal.length() - 1.0).abs() < 1e-4, "{form:?}");
                // A turned part has no end faces, so its inside is visible through the ends.
                if matches!(form, Form::Turned(_)) && normal.dot(view_ray.direction) > 0.0 {
                    continue;
                }
                assert!(normal.dot(view_ray.direction) < 0.0, "{form:?}");
                let tangent = (beside - point).cross(above - point).normalize();
                // An edge lies between the points, or the view is grazing.
                if normal.dot(other).min(normal.dot(third)) < 0.99 || normal.dot(view_ray.direction) > -0.3 {
                    continue;
                }
                assert!(tangent.dot(normal).abs() > 0.995, "{form:?}: {tangent} {normal}");
                met += 1;
            }
            assert!(met > 5, "{form:?}: {met}");
        }
    }
}

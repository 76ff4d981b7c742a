//! The scene's shapes, and their intersections with rays.

use glam::{Vec2, Vec3};

/// A ray with a unit direction.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Start of the ray.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
    /// Time of the ray; the camera defines when its shutter opens and closes.
    pub time: f32,
}

/// Time at which a moving shape is at its described position: the middle of the default exposure.
pub const MID_SHUTTER: f32 = 0.5;

impl Ray {
    /// Returns the point at a distance.
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + distance * self.direction
    }
}

/// An intersection of a ray with a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray.
    pub distance: f32,
    /// Unit normal of the surface, outward.
    pub normal: Vec3,
}

/// A shape that can be intersected with a ray.
pub trait Shape {
    /// Returns the nearest intersection farther than `from` and nearer than `to`.
    fn intersect(&self, ray: &Ray, from: f32, to: f32) -> Option<Hit>;
}

/// A ball, which may move.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Centre at [`MID_SHUTTER`].
    pub centre: Vec3,
    /// Radius.
    pub radius: f32,
    /// Displacement per unit of time.
    pub velocity: Vec3,
}

impl Sphere {
    /// Makes a sphere at rest.
    pub fn resting(centre: Vec3, radius: f32) -> Self {
        Self { centre, radius, velocity: Vec3::ZERO }
    }

    /// Returns the centre at a time.
    pub fn centre_at(&self, time: f32) -> Vec3 {
        self.centre + (time - MID_SHUTTER) * self.velocity
    }
}

impl Shape for Sphere {
    fn intersect(&self, ray: &Ray, from: f32, to: f32) -> Option<Hit> {
        let centre = self.centre_at(ray.time);
        let towards = centre - ray.origin;
        let along = towards.dot(ray.direction);
        // The offset is measured from the foot of the perpendicular, because b^2 - c of the textbook formula would
        // lose a small lamp tens of metres away to rounding.
        let aside = towards - along * ray.direction;
        let half = self.radius * self.radius - aside.length_squared();
        if half <= 0.0 {
            return None;
        }
        let half = half.sqrt();
        let inside = |distance: &f32| (from..to).contains(distance);
        let distance = if inside(&(along - half)) { along - half } else { along + half };
        if !inside(&distance) {
            return None;
        }
        let normal = (ray.at(distance) - centre) / self.radius;
        Some(Hit { distance, normal })
    }
}

/// The horizontal plane at a height, visible from above only.
#[derive(Clone, Copy, Debug)]
pub struct Floor {
    /// y of the plane.
    pub height: f32,
}

impl Shape for Floor {
    fn intersect(&self, ray: &Ray, from: f32, to: f32) -> Option<Hit> {
        let distance = (self.height - ray.origin.y) / ray.direction.y;
        ((from..to).contains(&distance) && ray.direction.y < 0.0).then_some(Hit { distance, normal: Vec3::Y })
    }
}

/// An upright rectangle that faces the camera.
#[derive(Clone, Copy, Debug)]
pub struct Panel {
    /// The top left corner, as the camera sees it.
    pub corner: Vec3,
    /// Width and height.
    pub size: Vec2,
}

impl Shape for Panel {
    fn intersect(&self, ray: &Ray, from: f32, to: f32) -> Option<Hit> {
        let distance = (self.corner.z - ray.origin.z) / ray.direction.z;
        if !(from..to).contains(&distance) {
            return None;
        }
        let coordinates = self.coordinates(ray.at(distance));
        let inside = coordinates.cmpge(Vec2::ZERO).all() && coordinates.cmplt(self.size).all();
        inside.then_some(Hit { distance, normal: -Vec3::Z })
    }
}

impl Panel {
    /// Returns the coordinates of a point on the panel: to the right and down from the corner.
    pub fn coordinates(&self, point: Vec3) -> Vec2 {
        let offset = point - self.corner;
        Vec2::new(offset.x, -offset.y)
    }
}

/// An axis-aligned box around many small objects.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    /// Returns the box around balls at rest.
    pub fn around<'a>(spheres: impl Iterator<Item = &'a Sphere>) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for sphere in spheres {
            low = low.min(sphere.centre - sphere.radius);
            high = high.max(sphere.centre + sphere.radius);
        }
        Self { low, high }
    }

    /// Whether a ray passes through the box.
    pub fn intersects(&self, ray: &Ray) -> bool {
        let first = (self.low - ray.origin) / ray.direction;
        let second = (self.high - ray.origin) / ray.direction;
        let enters = first.min(second).max_element();
        let leaves = first.max(second).min_element();
        enters <= leaves && leaves > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moving_ball_is_intersected_where_it_is_at_the_rays_time() {
        let velocity = Vec3::new(40.0, 0.0, 0.0);
        let ball = Sphere { centre: Vec3::new(0.0, 0.0, 100.0), radius: 5.0, velocity };
        let hit = |x: f32, time: f32| {
            let ray = Ray { origin: Vec3::new(x, 0.0, 0.0), direction: Vec3::Z, time };
            ball.intersect(&ray, 0.0, f32::INFINITY).map(|hit| hit.distance)
        };
        assert_eq!([hit(-20.0, 0.0), hit(0.0, MID_SHUTTER), hit(20.0, 1.0)], [Some(95.0); 3]);
        assert_eq!([hit(0.0, 0.0), hit(20.0, MID_SHUTTER), hit(-20.0, 1.0)], [None; 3]);
    }

    #[test]
    fn a_distant_small_ball_is_intersected_where_it_is() {
        let ball = Sphere::resting(Vec3::new(3.0, -4.0, 40_000.0), 20.0);
        let ray = Ray { origin: Vec3::ZERO, direction: Vec3::Z, time: MID_SHUTTER };
        let hit = ball.intersect(&ray, 0.0, f32::INFINITY).unwrap();
        assert!((hit.distance - 39_980.635).abs() < 0.02, "{}", hit.distance);
        assert!(Bounds::around([&ball].into_iter()).intersects(&ray));
        let back = Ray { direction: -Vec3::Z, ..ray };
        assert!(!Bounds::around([&ball].into_iter()).intersects(&back));
    }
}

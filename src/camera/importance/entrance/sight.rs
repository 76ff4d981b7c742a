//! Where spots of the scene are seen from: for each field angle the point of the axis that the chief ray of that angle makes
//! for, so that the middle of the pupil lies near it however far a pupil walks; and how far from there the front is.

use super::spot::Spot;
use crate::{
    lens::Ray,
    numeric::{Monotone, on_broken_line, root},
};

/// Points of the axis by the field angle, and the front's distances from them.
#[derive(Clone, Debug)]
pub(in crate::camera::importance) struct Sight {
    /// z over the angle, up to the last one.
    centers: Monotone,
    last: f64,
    /// Angles and distances, mm, of the front surface from the vertex to the rim.
    front: Vec<[f64; 2]>,
}

impl Sight {
    /// From these points, angle and z, of which the first is that of the angle 0; `cap` are places of the front surface,
    /// height and z, from the vertex to the rim.
    pub fn new(centers: &[[f64; 2]], cap: &[[f64; 2]]) -> Self {
        let column = |i: usize| centers.iter().map(|place| place[i]).collect();
        let last = centers.last().map_or(0.0, |[angle, _]| *angle);
        let mut sight = Self { centers: Monotone::new(column(0), column(1)), last, front: Vec::new() };
        sight.front = cap
            .iter()
            .map(|[height, z]| {
                let spot = sight.spot([*height, 0.0, *z]);
                [spot.angle(), spot.vergence.recip()]
            })
            .collect();
        sight
    }

    /// z of the point at a field angle.
    pub fn center(&self, angle: f64) -> f64 {
        self.centers.at(angle.min(self.last))
    }

    /// The spot at a point of lens space, mm.
    pub fn spot(&self, point: [f64; 3]) -> Spot {
        let [x, y, z] = point;
        let height = x.hypot(y);
        // The angle that the point has as it is seen from that angle's point of the axis.
        let off = |angle: f64| height.atan2(z - self.center(angle)) - angle;
        let angle = if self.last > 0.0 && height > 0.0 { root(0.0, std::f64::consts::PI, off) } else { 0.0 };
        Spot::of_point(point, self.center(angle))
    }

    /// The spot in the direction of a unit vector, infinitely far away.
    pub fn toward(&self, direction: [f64; 3]) -> Spot {
        let [x, y, z] = direction;
        Spot::toward(direction, 0.0, self.center(x.hypot(y).atan2(z)))
    }

    /// The spot at a field angle in the plane of x and the axis: the front's distance over its own is `nearness`.
    pub fn on_meridian(&self, angle: f64, nearness: f64) -> Spot {
        Spot::on_meridian(self.center(angle), angle, nearness / self.front(angle))
    }

    /// The spot on a ray out into the scene that begins at the front, whose nearness is about that: 0 is infinitely far away, 1
    /// the front.
    pub fn on_ray(&self, ray: &Ray, nearness: f64) -> Option<Spot> {
        if nearness == 0.0 {
            return Some(self.toward(ray.direction));
        }
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        let start = self.spot(ray.origin);
        let distance = self.front(start.angle()) / nearness;
        let from = [x, y, z - start.reference];
        let along = from[0] * dx + from[1] * dy + from[2] * dz;
        let square = from[0] * from[0] + from[1] * from[1] + from[2] * from[2];
        let root = along * along - square + distance * distance;
        if !(root >= 0.0) {
            return None;
        }
        let length = (root.sqrt() - along).max(0.0);
        Some(self.spot([x + length * dx, y + length * dy, z + length * dz]))
    }

    /// How far the front lies in the direction of a field angle, mm; beyond its rim as far as that.
    pub fn front(&self, angle: f64) -> f64 {
        let [vertex, rim] = [self.front[0][0], self.front[self.front.len() - 1][0]];
        on_broken_line(&self.front, angle.max(vertex).min(rim))
    }
}

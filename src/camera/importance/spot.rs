//! A point of the scene as seen from a point of the axis in the lens: its direction and distance, and the plane across the
//! way between them, by the points of which rays are named.

use crate::lens::Ray;

/// A point of the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    /// z of the point of the axis that it is seen from.
    pub reference: f64,
    /// Unit vector across the axis, toward the spot.
    pub azimuth: [f64; 2],
    /// Of the angle to the axis.
    sin: f64,
    cos: f64,
    /// 1 over the distance, 1/mm; 0 at infinity.
    pub vergence: f64,
}

impl Spot {
    /// The spot at a field angle θ in the plane of x and the axis, by tan(θ/2).
    pub fn on_meridian(reference: f64, half_tangent: f64, vergence: f64) -> Self {
        let square = half_tangent * half_tangent;
        let (sin, cos) = (2.0 * half_tangent / (1.0 + square), (1.0 - square) / (1.0 + square));
        Self { reference, azimuth: [1.0, 0.0], sin, cos, vergence }
    }

    /// A point of lens space, mm, not the reference itself.
    pub fn of_point([x, y, z]: [f64; 3], reference: f64) -> Self {
        let (square, depth) = (x * x + y * y, z - reference);
        let (height, distance) = (square.sqrt(), (square + depth * depth).sqrt());
        let azimuth = if height > 0.0 { [x / height, y / height] } else { [1.0, 0.0] };
        let vergence = distance.recip();
        Self { reference, azimuth, sin: height * vergence, cos: depth * vergence, vergence }
    }

    /// tan(θ/2).
    pub fn half_tangent(&self) -> f64 {
        // By the one of two forms that loses no digits.
        if self.cos < 0.0 { (1.0 - self.cos) / self.sin } else { self.sin / (1.0 + self.cos) }
    }

    /// A vector by its parts along the plane's axes, the first in the plane of the axis and the spot, and toward the spot.
    fn vector(&self, [a, b, w]: [f64; 3]) -> [f64; 3] {
        let ([x, y], out) = (self.azimuth, a * self.cos + w * self.sin);
        [x * out - y * b, y * out + x * b, w * self.cos - a * self.sin]
    }

    /// The parts of a vector, as there.
    fn parts(&self, [dx, dy, dz]: [f64; 3]) -> [f64; 3] {
        let [x, y] = self.azimuth;
        let out = x * dx + y * dy;
        [out * self.cos - dz * self.sin, x * dy - y * dx, out * self.sin + dz * self.cos]
    }

    /// The ray from the spot through a point of the plane, as it begins `lead` before that, or at the spot if that is
    /// nearer; and 1 over the cosine that it makes with the way to the reference.
    pub fn ray(&self, [a, b]: [f64; 2], lead: f64) -> (Ray, f64) {
        let v = self.vergence;
        let stretch = (1.0 + (a * a + b * b) * v * v).sqrt();
        let [x, y, w] = [a * v / stretch, b * v / stretch, -1.0 / stretch];
        let back = lead.min(stretch / v);
        let [ox, oy, oz] = self.vector([a - back * x, b - back * y, -back * w]);
        let ray = Ray { origin: [ox, oy, oz + self.reference], direction: self.vector([x, y, w]) };
        (ray, stretch)
    }

    /// Where on the plane the spot sees a point of lens space; at infinity what is beside or behind it.
    pub fn seen(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        let [a, b, depth] = self.parts([x, y, z - self.reference]);
        let nearness = 1.0 - depth * self.vergence;
        let scale = if nearness > 0.0 { nearness.recip() } else { f64::INFINITY };
        [a, b].map(|part| if part == 0.0 { 0.0 } else { scale * part })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_is_seen_where_it_was_aimed_at_and_comes_from_the_spot() {
        let reference = -20.0;
        for point in [[30.0, -40.0, 500.0], [0.0, 0.0, 90.0], [100.0, 1.0, -15.0], [-3e5, 2e5, 1e6]] {
            let spot = Spot::of_point(point, reference);
            for aim in [[0.0, 0.0], [3.0, -2.0], [-7.0, 5.0]] {
                let (ray, stretch) = spot.ray(aim, 60.0);
                for length in [5.0, 60.0, 100.0] {
                    let seen = spot.seen([0, 1, 2].map(|i| ray.origin[i] + length * ray.direction[i]));
                    assert!((0..2).all(|i| (seen[i] - aim[i]).abs() < 1e-6), "{point:?} {seen:?}");
                }
                let (angle, half) = (2.0 * spot.half_tangent().atan(), spot.half_tangent());
                let same = Spot::on_meridian(reference, half, spot.vergence);
                assert!((angle.cos() - spot.cos).abs() < 1e-12 && (same.sin - spot.sin).abs() < 1e-12);
                let [x, y, z] = [0, 1, 2].map(|i| point[i] - ray.origin[i]);
                let [dx, dy, dz] = ray.direction;
                let aside = [y * dz - z * dy, z * dx - x * dz, x * dy - y * dx];
                let distance = (x * x + y * y + z * z).sqrt();
                assert!(
                    aside.iter().all(|part| part.abs() < 1e-12 * (100.0 + distance) * 100.0),
                    "{point:?}"
                );
                assert!(x * dx + y * dy + z * dz <= 1e-9 && stretch >= 1.0);
            }
        }
    }
}

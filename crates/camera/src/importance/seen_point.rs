//! Points of the scene as seen from a point E on the axis inside the lens, in lanes: the direction and
//! distance of each point, and the plane through E perpendicular to the line from E to the point. Points of
//! this plane identify rays.

use realistic_optics::lens::Ray;
use realistic_simd::{Cpu, Lanes, OneLane, Portable};

/// One point of the scene.
pub(super) type OneSeenPoint = SeenPoint<OneLane<f64>>;

/// Points of the scene, as seen from E.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenPoint<L> {
    /// z of E, mm.
    reference: f64,
    /// Unit vector perpendicular to the axis, toward the point.
    pub azimuth: [L; 2],
    /// Sine and cosine of the angle θ between the axis and the direction from E to the point.
    sin: L,
    cos: L,
    /// Reciprocal of the distance from E, 1/mm; 0 at infinity.
    pub vergence: L,
}

/// A ray toward the lens.
#[derive(Clone, Copy, Debug)]
pub(super) struct AimedRay<L> {
    pub origin: [L; 3],
    /// A unit vector.
    pub direction: [L; 3],
    /// Reciprocal of the cosine of the angle between the ray and the line from the point to E.
    pub stretch: L,
}

impl<L: Lanes<Scalar = f64>> SeenPoint<L> {
    /// Describes points of lens space, mm, other than E itself.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn of_point(cpu: Cpu<L>, [x, y, z]: [L; 3], reference: f64) -> Self {
        let (zero, one) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0));
        let (square, depth) = (x * x + y * y, z - L::splat(cpu, reference));
        let is_aside = L::splat(cpu, f64::MIN_POSITIVE).less(square);
        let height = L::select(is_aside, square.sqrt(), zero);
        let vergence = one / (square + depth * depth).sqrt();
        let per_height = one / L::select(is_aside, height, one);
        let azimuth = [L::select(is_aside, x * per_height, one), L::select(is_aside, y * per_height, zero)];
        Self { reference, azimuth, sin: height * vergence, cos: depth * vergence, vergence }
    }

    /// Returns tan(θ/2).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn half_tangent(&self, cpu: Cpu<L>) -> L {
        let (zero, one) = (L::splat(cpu, 0.0), L::splat(cpu, 1.0));
        // Chooses the form of tan(θ/2) without cancellation.
        let is_behind = self.cos.less(zero);
        let above = L::select(is_behind, one - self.cos, self.sin);
        above / L::select(is_behind, self.sin, one + self.cos)
    }

    /// Rotates a vector perpendicular to the optical axis by the azimuth; returns its components along the
    /// plane's axes.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn turned(&self, [x, y]: [L; 2]) -> [L; 2] {
        let [c, s] = self.azimuth;
        [y.mul_add(s, x * c), x.neg_mul_add(s, y * c)]
    }

    /// Returns a vector from its components along the plane's two axes and along the direction to the point;
    /// the first of the plane's axes lies in the plane that contains the optical axis and the point.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn vector(&self, [a, b, w]: [L; 3]) -> [L; 3] {
        let ([x, y], out) = (self.azimuth, a * self.cos + w * self.sin);
        [x * out - y * b, y * out + x * b, w * self.cos - a * self.sin]
    }

    /// Returns the rays from the scene points through points of their planes. Each ray begins at the distance
    /// `lead` before the plane, or at the scene point if that is nearer.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn ray(&self, cpu: Cpu<L>, [a, b]: [L; 2], lead: f64) -> AimedRay<L> {
        let (v, one) = (self.vergence, L::splat(cpu, 1.0));
        let stretch = (one + (a * a + b * b) * v * v).sqrt();
        let per_stretch = one / stretch;
        let [x, y] = [a * v * per_stretch, b * v * per_stretch];
        let back = (stretch / v).smaller(L::splat(cpu, lead));
        let [ox, oy, oz] = self.vector([a - back * x, b - back * y, back * per_stretch]);
        let origin = [ox, oy, oz + L::splat(cpu, self.reference)];
        AimedRay { origin, direction: self.vector([x, y, L::splat(cpu, 0.0) - per_stretch]), stretch }
    }
}

impl OneSeenPoint {
    /// Returns the scene point at field angle θ in the plane of x and the axis, given tan(θ/2).
    pub fn on_meridian(reference: f64, half_tangent: f64, vergence: f64) -> Self {
        let square = half_tangent * half_tangent;
        let [sin, cos] = [2.0 * half_tangent, 1.0 - square].map(|part| Portable([part / (1.0 + square)]));
        let azimuth = [1.0, 0.0].map(|part| Portable([part]));
        Self { reference, azimuth, sin, cos, vergence: Portable([vergence]) }
    }

    /// Returns one ray.
    pub fn one_ray(&self, at: [f64; 2], lead: f64) -> Ray {
        let ray = self.ray(OneLane::cpu(), at.map(|part| Portable([part])), lead);
        let number = |Portable([number]): OneLane<f64>| number;
        Ray { origin: ray.origin.map(number), direction: ray.direction.map(number) }
    }

    /// Projects a point of lens space from the scene point onto the plane; points beside or behind the scene
    /// point project to infinity.
    pub fn seen(&self, [x, y, z]: [f64; 3]) -> [f64; 2] {
        let Self { azimuth: [Portable([ax]), Portable([ay])], .. } = *self;
        let (Portable([sin]), Portable([cos])) = (self.sin, self.cos);
        let (out, depth) = (ax * x + ay * y, z - self.reference);
        let nearness = 1.0 - (out * sin + depth * cos) * self.vergence.0[0];
        let scale = if nearness > 0.0 { nearness.recip() } else { f64::INFINITY };
        [out * cos - depth * sin, ax * y - ay * x].map(|part| if part == 0.0 { 0.0 } else { scale * part })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_passes_the_point_aimed_at_and_comes_from_the_scene_point() {
        let reference = -20.0;
        for point in [[30.0, -40.0, 500.0], [0.0, 0.0, 90.0], [100.0, 1.0, -15.0], [-3e5, 2e5, 1e6]] {
            let seen_point =
                OneSeenPoint::of_point(OneLane::cpu(), point.map(|part| Portable([part])), reference);
            for aim in [[0.0, 0.0], [3.0, -2.0], [-7.0, 5.0]] {
                let ray = seen_point.one_ray(aim, 60.0);
                let Portable([stretch]) =
                    seen_point.ray(OneLane::cpu(), aim.map(|part| Portable([part])), 60.0).stretch;
                for length in [5.0, 60.0, 100.0] {
                    let seen = seen_point.seen([0, 1, 2].map(|i| ray.origin[i] + length * ray.direction[i]));
                    assert!((0..2).all(|i| (seen[i] - aim[i]).abs() < 1e-6), "{point:?} {seen:?}");
                }
                let Portable([half]) = seen_point.half_tangent(OneLane::cpu());
                let same = OneSeenPoint::on_meridian(reference, half, seen_point.vergence.0[0]);
                assert!(((2.0 * half.atan()).cos() - seen_point.cos.0[0]).abs() < 1e-12);
                assert!((same.sin.0[0] - seen_point.sin.0[0]).abs() < 1e-12);
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

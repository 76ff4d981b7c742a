//! Rays from the scene to the film: from a spot through points of its plane to film points.

use super::{
    detail::{Detail, Work},
    spot::Spot,
};
use crate::trace::kernel::{Kernel, RayBuffer};

/// Rays that reach the film's plane farther from the axis than this, over the film's reach, are not looked for: some lenses
/// let rays through that leave them nearly along the film.
const STRAY: f64 = 2.0;

/// A lens and a film to look at from the scene.
pub(in crate::camera::importance) struct Probe<'a> {
    pub kernel: &'a Kernel<f64>,
    /// The lens up to its stop, where it matters what points of that rays cross.
    pub to_stop: Option<&'a Kernel<f64>>,
    /// z of the film.
    pub film: f64,
    /// The farthest film point from the axis, mm.
    pub reach: f64,
    /// Whether the film has rays of these slopes at a point, mm.
    pub is_sampled: &'a dyn Fn([f64; 2], [f64; 2]) -> bool,
    /// z of the entrance pupil, if that lies in the lens.
    pub pupil: f64,
    /// z of the point of the axis that all spots are seen from where pupils stay about there: behind the front's rim.
    pub still: f64,
    /// z that no spot's point of the axis lies before.
    pub foremost: f64,
    /// Places of the front surface, height and z, mm.
    pub cap: Vec<[f64; 2]>,
    /// From anywhere on the planes to before the lens, mm.
    pub lead: f64,
    /// What is traced.
    pub work: &'a Work,
}

/// What a ray through a point of the plane becomes: its film point.
type Landed = Option<[f64; 2]>;

/// A point of a spot's plane, and where its ray reaches the film or crosses the stop.
pub(super) type Place = ([f64; 2], [f64; 2]);

impl Probe<'_> {
    /// How finely the lens is looked at.
    pub(super) fn detail(&self) -> Detail {
        self.work.detail()
    }

    /// Rays from a spot through points, traced.
    fn traced(
        &self,
        kernel: &Kernel<f64>,
        spot: &Spot,
        points: impl ExactSizeIterator<Item = [f64; 2]>,
    ) -> RayBuffer<f64> {
        self.work.count(points.len());
        let mut buffer = RayBuffer::new(points.len());
        for (i, point) in points.enumerate() {
            let (ray, _) = spot.ray(point, self.lead);
            buffer.put(i, ray.origin, ray.direction);
        }
        // What is not traced is blocked.
        if !self.work.is_overspent() {
            kernel.trace_in_place(&mut buffer.rays());
        }
        buffer
    }

    /// Where rays from a spot through points reach the film.
    pub(super) fn land(&self, spot: &Spot, points: &[[f64; 2]]) -> Vec<Landed> {
        let buffer = self.traced(self.kernel, spot, points.iter().copied());
        (0..points.len()).map(|i| self.film_point(&buffer, i)).collect()
    }

    /// Where rays through points cross the stop; none where that does not matter.
    pub(super) fn crossings(&self, spot: &Spot, points: &[Place]) -> Vec<Place> {
        let Some(to_stop) = self.to_stop else { return Vec::new() };
        let buffer = self.traced(to_stop, spot, points.iter().map(|(point, _)| *point));
        let crossing = |i: usize| {
            let [x, y, _] = buffer.get(i)?.ray().origin;
            Some((points[i].0, [x, y]))
        };
        (0..points.len()).filter_map(crossing).collect()
    }

    fn film_point(&self, buffer: &RayBuffer<f64>, i: usize) -> Landed {
        let ray = buffer.get(i)?.ray();
        let ([x, y, z], [dx, dy, dz]) = (ray.origin, ray.direction);
        let slopes = [dx / dz, dy / dz];
        let point = [x + (self.film - z) * slopes[0], y + (self.film - z) * slopes[1]];
        let is_near = point[0] * point[0] + point[1] * point[1] <= (STRAY * self.reach).powi(2);
        (is_near && (self.is_sampled)(point, slopes)).then_some(point)
    }

    /// The part of the plane that the front surface covers, seen from a spot: along the first axis from, to, and along the
    /// second up to.
    pub(super) fn front(&self, spot: &Spot) -> [f64; 3] {
        const AROUND: u32 = 24;
        let mut part = [f64::MAX, f64::MIN, 0.0];
        let ((sin, cos), most) = (spot.angle().sin_cos(), 4.0 * self.lead);
        for turn in 0..=AROUND {
            let (aside, along) = (std::f64::consts::PI * f64::from(turn) / f64::from(AROUND)).sin_cos();
            for [height, z] in &self.cap {
                let (x, y, z) = (height * along, height * aside, z - spot.reference);
                let (a, depth) = (x * cos - z * sin, x * sin + z * cos);
                // Points beside or behind the spot are seen at no end.
                let nearness = 1.0 - depth * spot.vergence;
                let scale = if nearness > 0.0 { nearness.recip() } else { f64::INFINITY };
                let (a, b) = ((a * scale).clamp(-most, most), (y * scale).clamp(-most, most));
                part = [part[0].min(a), part[1].max(a), part[2].max(b)];
            }
        }
        let margin = 0.02 * (part[1] - part[0]).max(part[2]);
        [part[0] - margin, part[1] + margin, part[2] + margin]
    }
}

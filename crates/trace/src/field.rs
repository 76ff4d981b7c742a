//! Field of view: the angle in the scene that the film's diagonal covers, and the lit radius of the film.
//!
//! For a lens and its film position, this module computes the beam that a film point receives, as a range of slopes,
//! and the chief ray of the point, both in the plane through the axis (R. Kingslake, *Optics in Photography*, ch. 1).

use crate::kernel::{Kernel, PlaneRays, RayBuffer};
use realistic_base::numeric::{edge, root};
use realistic_optics::imaging::axial_beam::stop_or_limiting;
use realistic_optics::{
    lens::{Lens, film_ray},
    trace::{Path, Ray},
};

/// Returns the field angle, radians, of a thick lens for a film with this diagonal in the focal plane: 2 atan(d/2f)
/// (Kingslake, *Optics in Photography*, ch. 1).
pub fn paraxial(focal_length: f64, diagonal: f64) -> f64 {
    2.0 * (diagonal / (2.0 * focal_length.abs())).atan()
}

/// The rays that reach film points at any distance from the axis, in the plane through the axis.
#[derive(Clone, Debug)]
pub struct Field {
    path: Path,
    /// The compiled path, for many rays at once.
    kernel: Kernel<f64>,
    to_stop: Path,
    /// Index of the stop, counted along the direction of travel.
    stop: usize,
    film: f64,
    rear: f64,
    rear_radius: f64,
}

/// Number of rays, spread across the rear element, in a scan for rays that get through.
const SCAN: u32 = 1024;
/// Number of rays traced per batch.
const PART: u32 = 64;
/// Stride of the coarse scan for the chief ray.
const COARSE: u32 = SCAN / PART;

impl Field {
    /// Prepares a lens with the film at `film` (z in lens space, mm, behind the whole lens).
    pub fn new(lens: &Lens, film: f64) -> Self {
        let stop = stop_or_limiting(lens);
        // A ray that an aperture behind the stop blocks is not a chief ray, and is not traced further.
        let behind = Lens { surfaces: lens.surfaces[stop..].to_vec(), ..lens.clone() };
        let rear = lens.rear();
        let [edge_sagitta, _] = rear.sagitta_range();
        // Radius of the rear surface as seen from the film: by perspective, an edge closer to the film appears larger.
        let rear_radius =
            rear.semi_diameter * 1.0_f64.max((rear.vertex - film) / (rear.vertex + edge_sagitta - film));
        let path = Path::film_to_scene(lens);
        Self {
            kernel: Kernel::along(&path),
            path,
            to_stop: Path::film_to_scene(&behind),
            stop: lens.surfaces.len() - 1 - stop,
            film,
            rear: rear.vertex,
            rear_radius,
        }
    }

    fn ray(&self, height: f64, slope: f64) -> Ray {
        film_ray([0.0, height], self.film, [0.0, slope])
    }

    fn passes(&self, height: f64, slope: f64) -> bool {
        self.path.trace(self.ray(height, slope)).is_ok()
    }

    /// Returns the lowest and the highest slope dy/dz, in the plane through the axis, at which rays of the film point
    /// at `height` mm from the axis get through, or `None` if the point is dark. Several separate intervals count as
    /// one.
    pub fn beam(&self, height: f64) -> Option<[f64; 2]> {
        Some(self.to_edges(height, self.scanned(height)?))
    }

    /// Extends the beam that a scan found to the exact edges.
    fn to_edges(&self, height: f64, [low, high]: [f64; 2]) -> [f64; 2] {
        [self.to_edge(height, low, -1.0), self.to_edge(height, high, 1.0)]
    }

    /// Extends one end of the beam that a scan found, in the direction `outward`, to the exact edge.
    fn to_edge(&self, height: f64, end: f64, outward: f64) -> f64 {
        let step = self.scan(height, 1) - self.scan(height, 0);
        edge(end, end + outward * step, 0.0, |slope| self.passes(height, slope))
    }

    /// Returns the slope of the scan with index `i`.
    fn scan(&self, height: f64, i: u32) -> f64 {
        let at_rear = self.scan_reach(height) * (2.0 * (f64::from(i) + 0.5) / f64::from(SCAN) - 1.0);
        (at_rear - height) / (self.rear - self.film)
    }

    /// Returns the distance from the axis up to which the scan covers the plane of the rear vertex.
    fn scan_reach(&self, height: f64) -> f64 {
        // Off the axis, parallax shifts an edge that is in front of the vertex or behind it. To allow for this, half of
        // the height is added.
        self.rear_radius + 0.5 * height.abs()
    }

    /// Returns the first index of the part of the scan whose middle is near this slope.
    fn part_about(&self, height: f64, slope: f64) -> u32 {
        let at_rear = height + slope * (self.rear - self.film);
        let index = 0.5 * (at_rear / self.scan_reach(height) + 1.0) * f64::from(SCAN);
        (index as u32).saturating_sub(PART / 2).min(SCAN - PART)
    }

    /// Returns the lowest and the highest slope of a scan whose rays get through. If the stop is so narrow that it lies
    /// between two slopes, both are the slope through the centre of the stop.
    fn scanned(&self, height: f64) -> Option<[f64; 2]> {
        let at = |i: u32| self.scan(height, i);
        // The kernel preselects rays; for rays within rounding of an edge, the path decides.
        let passes = |i: &u32| self.passes(height, at(*i));
        let parts = || (0..SCAN / PART).map(|part| self.may_pass(height, part * PART, 1));
        Some(match parts().find_map(|slopes| slopes.into_iter().find(passes)) {
            Some(first) => {
                [at(first), at(parts().rev().find_map(|slopes| slopes.into_iter().rev().find(passes))?)]
            }
            None => [self.through_pinhole(height, at)?; 2],
        })
    }

    /// Returns the indices of slopes of the scan whose rays the kernel lets through, among [`PART`] slopes: every
    /// `each`-th from `first` on.
    fn may_pass(&self, height: f64, first: u32, each: u32) -> Vec<u32> {
        const COUNT: usize = PART as usize;
        let number = |i: u32| first + each * i;
        let slopes: [f64; COUNT] = std::array::from_fn(|i| self.scan(height, number(i as u32)));
        let mut out = RayBuffer::new(COUNT);
        let (x, y) = (&[0.0; COUNT], &[height; COUNT]);
        let from = PlaneRays { plane: self.film, x, y, slope_x: x, slope_y: &slopes };
        self.kernel.trace_batch(&from, &mut out.rays());
        (0..PART).filter(|&i| out.get(i as usize).is_some()).map(number).collect()
    }

    /// Returns the slope through the centre of a stop so narrow that it lies between two slopes of a scan.
    fn through_pinhole(&self, height: f64, at: impl Fn(u32) -> f64) -> Option<f64> {
        let in_stop = |slope: f64| {
            let mut found = f64::NAN;
            self.path.intersections(self.film, [0.0, height], [0.0, slope], |met| {
                if met.surface == self.stop {
                    found = met.point[1];
                }
                met.surface < self.stop
            });
            found
        };
        let mut below = in_stop(at(0));
        let above_centre = (1..SCAN).find(|&i| {
            let before = std::mem::replace(&mut below, in_stop(at(i)));
            before * below <= 0.0
        })?;
        let [low, high] = [at(above_centre - 1), at(above_centre)];
        Some(root(low, high, in_stop)).filter(|&slope| self.passes(height, slope))
    }

    /// Returns the chief ray, in the scene, of the film point at `height`: the ray through the centre of the stop or,
    /// if vignetting blocks that ray, the ray nearest to the centre among those that get through. `None` if the film
    /// point is dark.
    pub fn chief_ray(&self, height: f64) -> Option<Ray> {
        self.path.trace(self.ray(height, self.chief_slope(height, None)?)).ok()
    }

    /// Returns the heights and the chief rays ([`Field::chief_ray`]) of evenly spaced film points, from the axis up to,
    /// but without, the first dark point.
    pub fn chief_rays(&self, spacing: f64, count: u32) -> Vec<(f64, Ray)> {
        let mut rays = Vec::with_capacity(count as usize);
        // The slope of the last chief ray, and that of the chief ray before it.
        let mut slopes = [0.0; 2];
        for i in 0..count {
            let height = f64::from(i) * spacing;
            let [last, before] = slopes;
            let Some(slope) = self.chief_slope(height, Some(2.0 * last - before)) else { break };
            let Ok(ray) = self.path.trace(self.ray(height, slope)) else { break };
            rays.push((height, ray));
            slopes = [slope, last];
        }
        rays
    }

    /// Returns the slope of the chief ray; `expected` is its approximate value, if known.
    fn chief_slope(&self, height: f64, expected: Option<f64>) -> Option<f64> {
        let in_stop =
            |slope: f64| self.to_stop.trace(self.ray(height, slope)).map_or(f64::NAN, |ray| ray.origin[1]);
        // For most beams, the centre of the stop lies between two rays of a scan near the expected slope, or of a
        // coarse scan. For most other beams, the scan near the expected slope contains the whole beam.
        let close = expected.map(|slope| (self.part_about(height, slope), 1));
        let mut whole = None;
        for (first, each) in close.into_iter().chain([(COARSE / 2, COARSE)]) {
            let [from, .., to] = self.may_pass(height, first, each)[..] else { continue };
            let beam @ [low, high] = [from, to].map(|i| self.scan(height, i));
            if in_stop(low) * in_stop(high) < 0.0 {
                return Some(root(low, high, in_stop));
            }
            let has_margins = each == 1 && from > first && to + 1 < first + PART;
            if has_margins && self.passes(height, low) && self.passes(height, high) {
                whole = Some(beam);
                break;
            }
        }
        let scanned @ [low, high] = match whole {
            Some(beam) => beam,
            None => self.scanned(height)?,
        };
        let (below, above) = (in_stop(low), in_stop(high));
        if below * above < 0.0 {
            return Some(root(low, high, in_stop));
        }
        // The centre of the stop lies within a step of one end of the beam, or beyond that end.
        let (end, outward, other) =
            if below.abs() < above.abs() { (low, -1.0, above) } else { (high, 1.0, below) };
        let edge = self.to_edge(height, end, outward);
        Some(if low < high && in_stop(edge) * other >= 0.0 {
            edge
        } else {
            Self::nearest_to_centre(self.to_edges(height, scanned), in_stop)
        })
    }

    /// Returns the slope, within a beam, of the ray that comes nearest to the stop's centre.
    fn nearest_to_centre([low, high]: [f64; 2], in_stop: impl Fn(f64) -> f64) -> f64 {
        let (below, above) = (in_stop(low), in_stop(high));
        if below * above < 0.0 {
            root(low, high, in_stop)
        } else if below.abs() < above.abs() {
            low
        } else {
            high
        }
    }

    /// Returns the full field angle, radians, of a film with this diagonal, from the real chief ray of the film's
    /// corner; `None` if the corner is dark.
    pub fn real(&self, diagonal: f64) -> Option<f64> {
        let [_, dy, dz] = self.chief_ray(diagonal / 2.0)?.direction;
        Some(2.0 * dy.abs().atan2(dz))
    }

    /// Returns the lit radius of the film, searched up to `radius` mm: `None` if the axis is dark, `radius` if the film
    /// is still lit there.
    pub fn lit_radius(&self, radius: f64) -> Option<f64> {
        if !self.is_lit(0.0) {
            return None;
        }
        if self.is_lit(radius) {
            return Some(radius);
        }
        // A micrometre is finer than the scan resolves.
        let width = 1e-3 * radius.min(1.0);
        Some(edge(0.0, radius, width, |height| self.is_lit(height)))
    }

    /// Whether a point of the film has a beam.
    fn is_lit(&self, height: f64) -> bool {
        let passes = |i: &u32| self.passes(height, self.scan(height, *i));
        let mut parts = (0..SCAN / PART).map(|part| self.may_pass(height, part * PART, 1));
        parts.any(|slopes| slopes.iter().any(passes))
            || self.through_pinhole(height, |i| self.scan(height, i)).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::{lens::first_order::FirstOrder, prescription::catalogue};

    fn field(name: &str) -> (Lens, Field, f64) {
        let lens = Lens::at_d_line(&catalogue::find(name).expect("listed"));
        let first_order = FirstOrder::of(&lens).expect("focal");
        let field = Field::new(&lens, first_order.rear_focal_point);
        (lens, field, first_order.focal_length)
    }

    #[test]
    fn the_real_field_of_a_small_film_is_the_paraxial_one() {
        for name in catalogue::round() {
            let (_, field, f) = field(name);
            let real = field.real(1e-3 * f).expect("lit");
            let thick = paraxial(f, 1e-3 * f);
            assert!((real / thick - 1.0).abs() < 1e-4, "{name}: {real} is not {thick}");
        }
    }

    #[test]
    fn the_real_fields_are_those_of_the_designs() {
        // Smith's captions: half field 22 degrees for the double Gauss, 38 for the wide angle, which is tested at 36.
        let degrees = |name: &str, half: f64| {
            let (_, field, f) = field(name);
            let height = f * half.to_radians().tan();
            field.real(2.0 * height).expect("lit").to_degrees() / 2.0
        };
        assert!((degrees("dgauss.50mm", 22.0) - 22.0).abs() < 1.0);
        assert!((degrees("wide.22mm", 36.0) - 36.0).abs() < 2.0);
    }

    #[test]
    fn a_beam_ends_with_its_rays_and_the_chief_ray_is_central() {
        let (lens, field, _) = field("dgauss.50mm");
        let [low, high] = field.beam(8.0).expect("lit");
        assert!(field.passes(8.0, low) && field.passes(8.0, high));
        let width = high - low;
        assert!(!field.passes(8.0, low - 1e-9 * width) && !field.passes(8.0, high + 1e-9 * width));
        // The chief ray is traced back from the scene, through the front half of the lens, to the stop.
        let chief = field.chief_ray(8.0).expect("lit");
        let stop = lens.stop_index().expect("a stop");
        let front = Lens { surfaces: lens.surfaces[..=stop].to_vec(), ..lens.clone() };
        let back = Ray { origin: chief.origin, direction: chief.direction.map(|x| -x) };
        let at_stop = Path::<f64>::scene_to_film(&front).trace(back).expect("passes");
        assert!(at_stop.origin[1].abs() < 1e-9, "{at_stop:?}");
    }

    #[test]
    fn a_stop_narrower_than_a_scans_step_has_a_beam() {
        let (lens, _, f) = field("dgauss.50mm");
        let film = FirstOrder::of(&lens).expect("focal").rear_focal_point;
        let mut pinhole = lens.clone();
        pinhole.surfaces[lens.stop_index().expect("a stop")].semi_diameter = 1e-5;
        let (field, narrow) = (Field::new(&lens, film), Field::new(&pinhole, film));
        for height in [0.0, 1.0, 8.0] {
            let [low, high] = narrow.beam(height).expect("lit");
            assert!(low < high && high - low < 1e-5 && narrow.passes(height, f64::midpoint(low, high)));
            let directions = [&field, &narrow].map(|field| field.chief_ray(height).expect("lit").direction);
            assert!((directions[0][1] - directions[1][1]).abs() < 1e-8, "{directions:?}");
        }
        assert!(narrow.beam(2.0 * f).is_none());
    }

    #[test]
    fn a_fisheye_lights_a_circle_and_leaves_the_corner_dark() {
        let (_, field, _) = field("fisheye.10mm");
        assert!(field.real(60.0).is_none());
        let radius = field.lit_radius(30.0).expect("lit on the axis");
        assert!(field.beam(radius).is_some() && field.beam(radius + 0.01).is_none());
        assert_eq!(field.lit_radius(1.0), Some(1.0));
    }
}

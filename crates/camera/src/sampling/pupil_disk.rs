//! Disks to which lens samples (u, v) are mapped, described by ray slopes at the film.
//!
//! Seen from a film point, a disk of radius R in a plane at axial distance Z from the film is a disk of
//! radius R/Z in slopes, centred on the slope to the disk's centre; dA/Z² = d(slope)². In slopes, a disk at
//! infinity or behind the film needs no special case.

use std::f64::consts::PI;

use realistic_optics::{
    imaging::axial_beam::axial_cone,
    lens::{
        Lens,
        pupil::{ExitPupil, SlopeDisk},
    },
};
use realistic_simd::{Cpu, Lanes, Scalar};

/// Ratio of the front vertex's distance from the film to the pupil's, below which the pupil counts as being
/// at infinity.
const TELECENTRIC: f64 = 1e-12;

/// A slope sampled within a pupil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PupilSample {
    /// dx/dz and dy/dz of the ray at the film.
    pub slopes: [f64; 2],
    /// Slope area per sample. Its mean over all lens samples, counting those whose rays are blocked as 0, is
    /// the area of the pupil.
    pub area: f64,
}

/// A disk centred on the axis, to which the lens samples of every film point are mapped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PupilDisk {
    /// 1/Z, 1/mm; 0 for a disk at infinity, negative for a disk behind the film.
    vergence: f64,
    /// R/Z.
    slope_radius: f64,
}

impl PupilDisk {
    /// Returns the rear element's disk, in the rear vertex plane, for film at z = `film` (lens space) and
    /// rays from film points up to `reach` mm from the axis.
    ///
    /// If the edge of the rear surface lies in front of or behind its vertex, the disk is larger than the
    /// clear aperture, so that it contains every ray from such film through the surface. `None` if the film
    /// is not behind the whole surface.
    pub fn rear(lens: &Lens, film: f64, reach: f64) -> Option<Self> {
        Self::rear_of_depth(lens, film, reach, [0.0; 2])
    }

    /// Returns the disk of [`PupilDisk::rear`] for film whose points lie between `depth[0]` and `depth[1]` mm
    /// in front of the film's plane.
    pub fn rear_of_depth(lens: &Lens, film: f64, reach: f64, depth: [f64; 2]) -> Option<Self> {
        let rear = lens.rear();
        let distance = rear.vertex - film;
        let nearest = distance - depth[1];
        if lens.film_break.is_some() {
            return Self::around_turned_rear(lens, film, reach, depth);
        }
        // For a sphere only the edge matters; for an asphere any height matters, and is treated as if it were
        // at the edge.
        let ends = match (&rear.figure, &rear.unsymmetric) {
            (None, None) => [lens.rear_sagitta(rear.sagitta(rear.semi_diameter)); 2],
            _ => {
                let [a, b] = rear.sagitta_range().map(|sagitta| lens.rear_sagitta(sagitta));
                [a.min(b), a.max(b)]
            }
        };
        if !(nearest > 0.0 && nearest + ends[0] > 0.0) {
            return None;
        }
        // From film height h, a point of the surface at height r and sagitta s projects to (r Z + h
        // s)/(Z + s). Over the surface and the film, the magnitude of this is largest at the edge of both. If
        // s > 0, h is on the same side of the axis as that edge of the surface; if s < 0, on the other side.
        // Otherwise it is largest at s = 0.
        let projected = |height: f64, sagitta: f64| {
            let from = |distance: f64| {
                (rear.semi_diameter * distance + height * sagitta.abs()) / (distance + sagitta)
            };
            from(nearest).max(from(distance - depth[0]))
        };
        let [low, high] = ends.map(|end| projected(0.0, end).max(projected(reach, end)));
        let radius = rear.semi_diameter.max(low).max(high);
        Some(Self { vergence: distance.recip(), slope_radius: radius / distance })
    }

    /// Returns the disk of [`PupilDisk::rear_of_depth`] for film that does not lie across the axis of the rear surface.
    /// The rear surface is replaced by the cylinder around it.
    fn around_turned_rear(lens: &Lens, film: f64, reach: f64, depth: [f64; 2]) -> Option<Self> {
        /// Number of points of a circle. A circle is larger than the polygon of these points by the factor.
        const POINTS: u32 = 64;
        const LARGER: f64 = 1.01;
        let rear = lens.rear();
        let distance = rear.vertex - film;
        let around = |radius: f64| {
            (0..POINTS).map(move |i| {
                let (sin, cos) = (f64::from(i) * 2.0 * PI / f64::from(POINTS)).sin_cos();
                [radius * cos, radius * sin]
            })
        };
        let mut radius = 0.0_f64;
        for sagitta in rear.sagitta_range() {
            for edge in around(rear.semi_diameter) {
                let [x, y, z] = lens.rear_point(edge, sagitta);
                for (ahead, [from_x, from_y]) in
                    depth.into_iter().flat_map(|ahead| around(reach).map(move |from| (ahead, from)))
                {
                    let to_point = z - film - ahead;
                    if !(to_point > 0.0) {
                        return None;
                    }
                    let along = (distance - ahead) / to_point;
                    radius = radius.max((from_x + (x - from_x) * along).hypot(from_y + (y - from_y) * along));
                }
            }
        }
        Some(Self { vergence: distance.recip(), slope_radius: LARGER * radius / distance })
    }

    /// Returns the exit pupil for film at `film`. The pupil lies in the plane in which the thick lens images
    /// the aperture that limits the cone of exact rays at the film's centre, and it has the width of that
    /// cone. If the film's centre is dark, the pupil is the thick lens's exit pupil.
    pub fn exit(lens: &Lens, film: f64) -> Self {
        let (pupil, slope_radius) = match axial_cone(lens, film) {
            Some((limiting, slope)) => (ExitPupil::of_surface(lens, limiting), slope),
            None => {
                let pupil = ExitPupil::paraxial(lens, film);
                (pupil, pupil.slopes(0.0, 0.0, film).radius)
            }
        };
        let vergence = pupil.vergence(film);
        // For a telecentric lens, rounding gives a small number instead of 0.
        let vergence = if (vergence * film).abs() < TELECENTRIC { 0.0 } else { vergence };
        Self { vergence, slope_radius }
    }

    /// Returns a disk centred on the axis at `distance` mm (not 0) in front of the film, with the given
    /// radius in slopes.
    pub(crate) fn about_axis(distance: f64, slope_radius: f64) -> Self {
        Self { vergence: distance.recip(), slope_radius }
    }

    /// Returns the disk's radius in slopes: the tangent of the half angle that the disk subtends at the
    /// film's centre.
    pub fn slope_radius(&self) -> f64 {
        self.slope_radius
    }

    /// Returns the disk as seen from the film point (`x`, `y`).
    pub fn seen_from(&self, [x, y]: [f64; 2]) -> SlopeDisk {
        SlopeDisk { center: [-x * self.vergence, -y * self.vergence], radius: self.slope_radius }
    }

    /// Returns the disk as seen from a point `ahead` mm in front of the film. The radius is not positive if
    /// the point lies in the disk's plane or in front of it.
    pub fn seen_from_ahead(&self, point: [f64; 2], ahead: f64) -> SlopeDisk {
        let SlopeDisk { center, radius } = self.seen_from(point);
        let nearer = 1.0 - ahead * self.vergence;
        let nearer = if nearer > 0.0 { nearer.recip() } else { 0.0 };
        SlopeDisk { center: center.map(|slope| slope * nearer), radius: radius * nearer }
    }

    /// Returns the slope sample that corresponds to the point (u, v) of the unit disk, for a film point in
    /// mm.
    pub fn sample(&self, film: [f64; 2], [u, v]: [f64; 2]) -> PupilSample {
        let SlopeDisk { center: [x, y], radius } = self.seen_from(film);
        PupilSample { slopes: [x + radius * u, y + radius * v], area: self.slope_area() }
    }

    /// Returns the disk in the precision of lanes.
    pub(crate) fn lane_disk<S: Scalar>(&self) -> LaneDisk<S> {
        LaneDisk {
            shift: S::from_f64(-self.vergence),
            slope_radius: S::from_f64(self.slope_radius),
            area_per_pi: S::from_f64(self.slope_radius * self.slope_radius),
        }
    }

    /// Returns the area of the disk in slopes.
    pub fn slope_area(&self) -> f64 {
        PI * self.slope_radius * self.slope_radius
    }

    /// Returns the disk's area in mm²; `None` if the disk is at infinity.
    pub fn area(&self) -> Option<f64> {
        let area = self.slope_area() / (self.vergence * self.vergence);
        area.is_finite().then_some(area)
    }
}

/// A [`PupilDisk`] in the precision of lanes.
#[derive(Clone, Copy, Debug)]
pub struct LaneDisk<S> {
    /// Ratio of the slope to the disk's centre to the film point's coordinate, 1/mm.
    shift: S,
    slope_radius: S,
    area_per_pi: S,
}

impl<S: Scalar> LaneDisk<S> {
    /// Returns the slopes that correspond to points of the unit disk, for film points in mm, and the slope
    /// area per sample divided by π.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, [x, y]: [L; 2], [u, v]: [L; 2]) -> ([L; 2], L) {
        let (shift, radius) = (L::splat(cpu, self.shift), L::splat(cpu, self.slope_radius));
        ([radius.mul_add(u, shift * x), radius.mul_add(v, shift * y)], L::splat(cpu, self.area_per_pi))
    }

    /// Computes [`LaneDisk::lanes`] for points `ahead` mm in front of the film. The area is NaN for points in
    /// the disk's plane or in front of it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn lanes_ahead<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        point: [L; 2],
        ahead: L,
        disk: [L; 2],
    ) -> ([L; 2], L) {
        let nearer = self.nearer(cpu, ahead);
        let (slopes, area) = self.lanes(cpu, point, disk);
        (slopes.map(|slope| slope * nearer), area * (nearer * nearer))
    }

    /// Computes [`LaneDisk::areas`] for points `ahead` mm in front of the film.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn areas_ahead<L: Lanes<Scalar = S>>(
        &self,
        cpu: Cpu<L>,
        point: [L; 2],
        ahead: L,
        slopes: [L; 2],
    ) -> L {
        let nearer = self.nearer(cpu, ahead);
        self.areas(cpu, point, slopes.map(|slope| slope / nearer)) * (nearer * nearer)
    }

    /// Returns the ratio of the disk's distance from the film to its distance from points in front of the
    /// film; NaN for points in the disk's plane or in front of it.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn nearer<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, ahead: L) -> L {
        let (zero, one) = (L::splat(cpu, S::ZERO), L::splat(cpu, S::ONE));
        let left = ahead.mul_add(L::splat(cpu, self.shift), one);
        L::select(zero.less(left), one / left, L::splat(cpu, S::from_f64(f64::NAN)))
    }

    /// Returns the slope area per sample, divided by π, for rays with these slopes from film points; NaN
    /// outside the disk.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub fn areas<L: Lanes<Scalar = S>>(&self, cpu: Cpu<L>, [x, y]: [L; 2], [sx, sy]: [L; 2]) -> L {
        let shift = L::splat(cpu, self.shift);
        let (u, v) = (shift.neg_mul_add(x, sx), shift.neg_mul_add(y, sy));
        let area = L::splat(cpu, self.area_per_pi);
        L::select(v.mul_add(v, u * u).less_equal(area), area, L::splat(cpu, S::from_f64(f64::NAN)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::read;

    #[test]
    fn the_rear_disk_holds_every_ray_through_the_rear_surface() {
        // Lenses whose rear edge lies in front of the vertex (radius < 0), behind it (> 0), and in its plane.
        for row in ["-12 0 1 16", "12 0 1 16", "0 0 1 16"] {
            let lens =
                Lens::at_d_line(&read("lens", format!("30 4 1.6 16\n{row}").as_bytes()).expect("a lens"));
            let rear = lens.rear();
            let (film, reach) = (rear.vertex - 30.0, 20.0);
            let disk = PupilDisk::rear(&lens, film, reach).expect("film behind the lens");
            for point in [[0.0, 0.0], [reach, 0.0], [-6.0, 8.0]] {
                let seen = disk.seen_from(point);
                for ring in [0.3, 0.8, 1.0] {
                    for angle in (0..36).map(|i| f64::from(i) * PI / 18.0) {
                        let height = ring * rear.semi_diameter;
                        let axial = rear.vertex + rear.sagitta(height) - film;
                        let sx = (height * angle.cos() - point[0]) / axial - seen.center[0];
                        let sy = (height * angle.sin() - point[1]) / axial - seen.center[1];
                        assert!(sx.hypot(sy) <= seen.radius * (1.0 + 1e-12), "{row}, {point:?}, {angle}");
                    }
                }
            }
        }
    }
}

//! The disk that lens samples are drawn from, as ray slopes at the film.
//!
//! A disk of radius R in a plane at axial distance Z from the film is, seen from a film point, a disk
//! of slopes of radius R/Z about the slope to its centre; dA/Z² = d(slope)². In slopes a disk at
//! infinity or behind the film is like any other.

use std::f64::consts::PI;

use crate::optics::{
    Lens,
    pupil::{ExitPupil, SlopeDisk},
};

/// A slope drawn from a pupil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// dx/dz and dy/dz of the ray at the film.
    pub slopes: [f64; 2],
    /// The area that the sample stands for, slope²: the mean over lens samples of this where the ray gets
    /// through is the pupil's area.
    pub area: f64,
}

/// A disk about the axis, in which every film point's lens samples are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PupilDisk {
    /// 1/Z, 1/mm; 0 for a disk at infinity, negative behind the film.
    vergence: f64,
    /// R/Z.
    slope_radius: f64,
}

impl PupilDisk {
    /// The rear element's disk in the rear vertex plane, for film at `film` (z in lens space) asked
    /// for rays up to `reach` mm from the axis.
    ///
    /// Where the rear surface's rim lies in front of or behind its vertex the disk is as much larger
    /// than the clear aperture as it takes to hold every ray from such film through the surface.
    /// `None` when the film is not behind the whole surface.
    pub fn rear(lens: &Lens, film: f64, reach: f64) -> Option<Self> {
        let rear = lens.rear();
        let distance = rear.vertex - film;
        let rim = rear.sagitta(rear.semi_diameter);
        if !(distance > 0.0 && distance + rim > 0.0) {
            return None;
        }
        // A point of the surface at height r and sagitta s projects from film height h to
        // (r Z + h s)/(Z + s), which over the surface is largest at the rim or the vertex plane.
        let projected = |height: f64| (rear.semi_diameter * distance + height * rim) / (distance + rim);
        let radius = rear.semi_diameter.max(projected(0.0)).max(projected(reach));
        Some(Self { vergence: distance.recip(), slope_radius: radius / distance })
    }

    /// The thick-lens exit pupil for film at `film`.
    pub fn exit(lens: &Lens, film: f64) -> Self {
        let pupil = ExitPupil::of_lens(lens, film);
        Self { vergence: pupil.vergence(film), slope_radius: pupil.slopes(0.0, 0.0, film).radius }
    }

    /// The disk as the film point (`x`, `y`) sees it.
    pub fn seen_from(&self, [x, y]: [f64; 2]) -> SlopeDisk {
        SlopeDisk { center: [-x * self.vergence, -y * self.vergence], radius: self.slope_radius }
    }

    /// The slope that the point `disk` of the unit disk stands for at a film point, mm.
    pub fn draw(&self, film: [f64; 2], [u, v]: [f64; 2]) -> Drawn {
        let SlopeDisk { center: [x, y], radius } = self.seen_from(film);
        Drawn { slopes: [x + radius * u, y + radius * v], area: self.slope_area() }
    }

    /// Area of the disk in slopes.
    pub fn slope_area(&self) -> f64 {
        PI * self.slope_radius * self.slope_radius
    }

    /// Area of the disk in mm²; `None` at infinity.
    pub fn area(&self) -> Option<f64> {
        let area = self.slope_area() / (self.vergence * self.vergence);
        area.is_finite().then_some(area)
    }
}

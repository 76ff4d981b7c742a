//! Pupils by first-order optics: the image of one aperture by the glass behind it (exit pupil) or in front of it
//! (entrance pupil). The module `imaging` determines with exact rays which aperture limits the beam, and how wide the
//! beam is.
//!
//! The image is stored as two coefficients, for height and slope. They give the height of a ray in the aperture from
//! the ray's height and slope at the outer vertex. The coefficients can also represent a pupil at infinity, which has
//! no position or diameter.

use super::{Lens, first_order::Abcd};

/// The paraxial image of one aperture, formed on the film's side of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExitPupil {
    /// Index of the surface whose aperture is imaged, counted from the scene.
    pub surface: usize,
    semi_diameter: f64,
    rear_vertex: f64,
    /// Height in the aperture = `from_height` y + `from_slope` dy/dz at the rear vertex plane.
    from_height: f64,
    from_slope: f64,
}

/// A disk of ray slopes (dx/dz, dy/dz) at a film point: the pupil as seen from that point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeDisk {
    /// Slopes of the ray to the pupil's centre.
    pub center: [f64; 2],
    /// Radius of the disk, as a slope; positive.
    pub radius: f64,
}

impl ExitPupil {
    /// Images the aperture of one surface through the glass behind it.
    pub fn of_surface(lens: &Lens, surface: usize) -> Self {
        let matrix = Abcd::behind(lens, surface);
        Self {
            surface,
            semi_diameter: lens.surfaces[surface].semi_diameter,
            rear_vertex: lens.rear().vertex,
            from_height: matrix.d,
            // The matrix counts slopes in the direction of the light, toward -z, and maps from the aperture to the
            // vertex. The coefficients here are those of the inverse matrix, with the sign of the slope reversed. The
            // matrix acts on optical slopes: the index of the film's medium times the slope.
            from_slope: matrix.b * lens.rear().n_film,
        }
    }

    /// Returns this exit pupil with the width that corresponds to the diameter of an entrance pupil of the same
    /// aperture.
    #[must_use]
    pub fn conjugate_to(self, entrance: &EntrancePupil) -> Self {
        Self { semi_diameter: entrance.semi_diameter_for(entrance.diameter), ..self }
    }

    /// Returns the exit pupil of first-order optics for film at `film` (z in lens space, behind the lens). Among the
    /// images of all apertures, each formed by the glass behind it, this is the image that subtends the smallest solid
    /// angle from the film's centre.
    pub fn paraxial(lens: &Lens, film: f64) -> Self {
        (0..lens.surfaces.len())
            .map(|surface| Self::of_surface(lens, surface))
            .min_by(|a, b| a.slope_radius(film).total_cmp(&b.slope_radius(film)))
            .expect("a lens has at least one surface")
    }

    /// Returns the z coordinate of the pupil plane in lens space, mm; `None` if the pupil is at infinity.
    pub fn position(&self) -> Option<f64> {
        let z = self.rear_vertex + self.from_slope / self.from_height;
        z.is_finite().then_some(z)
    }

    /// Returns the diameter of the pupil, mm; infinite if the pupil is at infinity.
    pub fn diameter(&self) -> f64 {
        2.0 * self.semi_diameter / self.from_height.abs()
    }

    /// Returns 1/Z, 1/mm, where Z is the axial distance from film at `film` to the pupil. The result is 0 for a pupil
    /// at infinity, and negative for a pupil behind the film.
    pub fn vergence(&self, film: f64) -> f64 {
        self.from_height / self.height_from_slope(film)
    }

    /// Returns the tangent of the pupil's angular radius as seen from the film's centre.
    fn slope_radius(&self, film: f64) -> f64 {
        self.semi_diameter / self.height_from_slope(film).abs()
    }

    /// Returns the pupil as seen from the film point (`x`, `y`, `film`).
    pub fn slopes(&self, x: f64, y: f64, film: f64) -> SlopeDisk {
        let vergence = self.vergence(film);
        SlopeDisk { center: [-x * vergence, -y * vergence], radius: self.slope_radius(film) }
    }

    fn height_from_slope(&self, film: f64) -> f64 {
        self.from_slope + self.from_height * (self.rear_vertex - film)
    }
}

/// The paraxial image of one aperture, formed on the scene's side of the lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EntrancePupil {
    diameter: f64,
    /// Height in the aperture = `from_height` y + `from_slope` dy/ds at the front vertex plane.
    from_height: f64,
    from_slope: f64,
}

impl EntrancePupil {
    /// Images the aperture of one surface through the glass in front of it.
    pub fn of_surface(lens: &Lens, surface: usize) -> Self {
        let Abcd { a: from_height, b: from_slope, .. } = Abcd::in_front_of(lens, surface);
        let diameter = 2.0 * lens.surfaces[surface].semi_diameter / from_height.abs();
        Self { diameter, from_height, from_slope: from_slope * lens.front().n_scene }
    }

    /// Returns the semi-diameter of the aperture, mm, at which the pupil has this diameter, mm.
    pub fn semi_diameter_for(&self, diameter: f64) -> f64 {
        diameter / 2.0 * self.from_height.abs()
    }

    /// Returns the pupil at the same position with another diameter, mm: the diameter of a beam of exact rays.
    #[must_use]
    pub fn with_diameter(self, diameter: f64) -> Self {
        Self { diameter, ..self }
    }

    /// Returns the z coordinate of the pupil plane in lens space, mm; `None` if the pupil is at infinity.
    pub fn position(&self) -> Option<f64> {
        let z = -self.from_slope / self.from_height;
        z.is_finite().then_some(z)
    }

    /// Returns the diameter of the pupil, mm; infinite for an aperture that is imaged to infinity.
    pub fn diameter(&self) -> f64 {
        self.diameter
    }

    /// Returns the ray from the axial point 1/`vergence` mm in front of the front vertex to `fraction` of the pupil's
    /// radius; for a vergence of 0 the ray is parallel to the axis. The result is the ray's height in the front vertex
    /// plane, mm, and its slope dy/ds, where s points toward the film.
    pub fn marginal_ray(&self, vergence: f64, fraction: f64) -> (f64, f64) {
        let spread = self.position().map_or(1.0, |z| 1.0 - vergence * z);
        let height = fraction * (self.diameter / 2.0) / spread;
        (height, height * vergence)
    }
}

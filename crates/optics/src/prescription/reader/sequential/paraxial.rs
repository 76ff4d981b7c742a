//! The semi-diameters of the stop and of surfaces that state none, computed from the file's aperture and field by two
//! paraxial rays (W. J. Smith, *Modern Optical Engineering*, on raytracing).

use super::SequentialSurface;
use crate::prescription::{glass::refractive_index, interfaces::Medium, unsymmetric::Meridian};

/// The aperture that limits the beam, as the file states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Aperture {
    /// The semi-diameter of the stop's surface.
    ByStop,
    /// Diameter of the entrance pupil.
    EntrancePupil(f64),
    /// Focal length divided by the diameter of the entrance pupil.
    FNumber(f64),
    /// Working f-number 1/(2 n' u'), where n' is the index on the image side and u' the slope of the paraxial marginal
    /// ray there, for the actual object distance.
    WorkingFNumber(f64),
    /// Numerical aperture on the object side: the sine of the half angle times the index of the object's medium.
    ObjectNa(f64),
    /// Half angle of the cone of light from the object, degrees.
    ObjectCone(f64),
}

impl Aperture {
    /// Returns the aperture of a numerical aperture on the image side, in air: the sine of the half angle.
    pub(in super::super) fn image_na(na: f64) -> Self {
        Self::WorkingFNumber(1.0 / (2.0 * na.asin().tan()))
    }

    /// Returns the same kind of aperture with another value.
    pub(in super::super) fn with(self, value: f64) -> Self {
        match self {
            Self::ByStop => Self::ByStop,
            Self::EntrancePupil(_) => Self::EntrancePupil(value),
            Self::FNumber(_) => Self::FNumber(value),
            Self::WorkingFNumber(_) => Self::WorkingFNumber(value),
            Self::ObjectNa(_) => Self::ObjectNa(value),
            Self::ObjectCone(_) => Self::ObjectCone(value),
        }
    }
}

/// The farthest field point, as the file states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Field {
    /// Angle from the axis, degrees.
    Angle(f64),
    /// Height of an object point.
    ObjectHeight(f64),
    /// Height of an image point.
    ImageHeight(f64),
}

/// A kind of field, as a function of its size.
pub(in super::super) type FieldKind = fn(f64) -> Field;

/// The heights of two paraxial rays at each surface. One ray enters parallel to the axis at height 1; the other starts
/// at the first vertex with slope 1. Every paraxial ray is a linear combination of these two rays.
///
/// Changes of frame are left out: the axis is unfolded. A mirror is a refraction to the negative of the index in front of
/// it, and the indices behind an odd number of mirrors are negative, as the thicknesses there are.
#[derive(Debug)]
pub(in super::super) struct Paraxial {
    parallel: Vec<f64>,
    from_vertex: Vec<f64>,
    /// The slopes of the two rays behind the last surface, times the index there.
    slopes: [f64; 2],
    /// The refractive indices in front of the lens and behind it; the latter is negative behind an odd number of mirrors.
    indices: [f64; 2],
}

impl Paraxial {
    /// Traces the two rays from the medium `object` through surfaces, with the thicknesses behind them, in a meridian, at
    /// a wavelength in nm.
    pub(in super::super) fn of(
        object: Medium,
        surfaces: &[SequentialSurface],
        thicknesses: &[f64],
        meridian: Meridian,
        wavelength: f64,
    ) -> Self {
        let first_index = refractive_index(object, wavelength);
        let trace = |mut height: f64, mut slope: f64| {
            // The index in front of the surface. `slope` holds the ray's slope times this index.
            let mut index = first_index;
            let mut sign = 1.0;
            let mut heights = Vec::with_capacity(surfaces.len());
            for (surface, thickness) in surfaces.iter().zip(thicknesses) {
                heights.push(height);
                sign = if surface.general.is_mirror { -sign } else { sign };
                let behind = sign * refractive_index(surface.behind.medium, wavelength);
                let curvature = vertex_curvature(surface, meridian);
                slope -= (behind - index) * curvature * height;
                index = behind;
                height += thickness * slope / index;
            }
            (heights, slope, index)
        };
        let (parallel, slope, last_index) = trace(1.0, 0.0);
        let (from_vertex, other_slope, _) = trace(0.0, first_index);
        let indices = [first_index, last_index];
        Self { parallel, from_vertex, slopes: [slope, other_slope], indices }
    }

    /// Returns the magnitude of the power 1/f.
    pub(in super::super) fn power(&self) -> f64 {
        self.slopes[0].abs()
    }

    /// Returns the distance of the entrance pupil behind the first vertex.
    fn pupil(&self, stop: usize) -> f64 {
        self.from_vertex[stop] / self.parallel[stop]
    }

    /// Returns the height at a surface, and the slope behind the last one times the index there, of the ray from the
    /// axial object point that meets the first vertex plane at height 1. `object` is the distance of that point.
    fn axial(&self, surface: usize, object: f64) -> [f64; 2] {
        [
            self.parallel[surface] + self.from_vertex[surface] / object,
            self.slopes[0] + self.slopes[1] / object,
        ]
    }

    /// Returns the distance of the image behind the last surface, in units of the focal length's magnitude from the
    /// distance `stated`. `object` is the distance from the object to the first vertex.
    pub(in super::super) fn defocus(&self, object: f64, stated: f64) -> f64 {
        let [height, slope] = self.axial(self.parallel.len() - 1, object);
        (-height * self.indices[1] / slope - stated).abs() * self.power()
    }

    /// Returns the semi-diameter of the surface `stop` that an aperture determines; `None` if the aperture does not
    /// determine it. `object` is the distance from the object to the first vertex.
    pub(in super::super) fn stop(&self, aperture: Aperture, stop: usize, object: f64) -> Option<f64> {
        let by_pupil = |diameter: f64| diameter / 2.0 * self.parallel[stop];
        let by_cone = |slope: f64| slope * (object + self.pupil(stop)) * self.parallel[stop];
        let size = match aperture {
            Aperture::ByStop => return None,
            Aperture::EntrancePupil(diameter) => by_pupil(diameter),
            Aperture::FNumber(number) => by_pupil(1.0 / (self.power() * number)),
            Aperture::WorkingFNumber(number) => {
                let [height, slope] = self.axial(stop, object);
                height / (2.0 * number * slope)
            }
            Aperture::ObjectNa(na) => {
                let sine = na / self.indices[0];
                by_cone(sine / (1.0 - sine * sine).sqrt())
            }
            Aperture::ObjectCone(degrees) => by_cone(degrees.to_radians().tan()),
        };
        Some(size.abs()).filter(|size| *size > 0.0 && size.is_finite())
    }

    /// Returns the semi-diameter, at the surface `stop`, of the widest axial beam from a distant object that passes all
    /// other surfaces. `others` has these surfaces with their semi-diameters. Returns `None` if there are no other
    /// surfaces.
    pub(in super::super) fn let_through(
        &self,
        stop: usize,
        others: impl Iterator<Item = (usize, f64)>,
    ) -> Option<f64> {
        let widest =
            others.map(|(surface, size)| (size / self.parallel[surface]).abs()).min_by(f64::total_cmp)?;
        Some((widest * self.parallel[stop]).abs()).filter(|size| *size > 0.0 && size.is_finite())
    }

    /// Returns the height, at a surface, of the beam that passes the stop at a given field. `field` is the tangent of
    /// the field's angle from the axis.
    pub(in super::super) fn reach(
        &self,
        surface: usize,
        stop: usize,
        stop_semi_diameter: f64,
        field: f64,
    ) -> Option<f64> {
        let marginal = self.parallel[surface] * stop_semi_diameter / self.parallel[stop];
        let chief = field * (self.from_vertex[surface] - self.pupil(stop) * self.parallel[surface]);
        Some(marginal.abs() + chief.abs()).filter(|reach| *reach > 0.0 && reach.is_finite())
    }

    /// Returns the tangent of the field angle.
    pub(in super::super) fn field(&self, field: Field, stop: usize, object: f64) -> f64 {
        match field {
            Field::Angle(degrees) => degrees.min(89.0).to_radians().tan(),
            Field::ObjectHeight(height) if object.is_finite() => height / (object + self.pupil(stop)),
            Field::ObjectHeight(_) => 0.0,
            Field::ImageHeight(height) => height * self.power() / self.indices[0],
        }
    }
}

/// Returns the curvature of a surface at its vertex, in a meridian.
fn vertex_curvature(surface: &SequentialSurface, meridian: Meridian) -> f64 {
    let unsymmetric = surface.general.unsymmetric.map_or(0.0, |figure| {
        let [x, y] = figure.radii();
        if meridian == Meridian::X { x.recip() } else { y.recip() }
    });
    surface.curvature + 2.0 * surface.asphere.map_or(0.0, |asphere| asphere.term(2)) + unsymmetric
}

//! The semi-diameters of the stop and of surfaces that state none, computed from the file's aperture and field by two
//! paraxial rays (W. J. Smith, *Modern Optical Engineering*, on raytracing).

use super::SequentialSurface;
use crate::prescription::{glass::refractive_index, interfaces::Medium};

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

/// The heights of two paraxial rays at each surface. One ray enters parallel to the axis at height 1; the other starts
/// at the first vertex with slope 1. Every paraxial ray is a linear combination of these two rays.
#[derive(Debug)]
pub(in super::super) struct Paraxial {
    parallel: Vec<f64>,
    from_vertex: Vec<f64>,
    /// The slopes of the two rays behind the last surface, times the index there.
    slopes: [f64; 2],
    /// The refractive index in front of the lens.
    index: f64,
}

impl Paraxial {
    /// Traces the two rays from the medium `object` through surfaces, with the thicknesses behind them, at a wavelength
    /// in nm.
    pub(in super::super) fn of(
        object: Medium,
        surfaces: &[SequentialSurface],
        thicknesses: &[f64],
        wavelength: f64,
    ) -> Self {
        let first_index = refractive_index(object, wavelength);
        let trace = |mut height: f64, mut slope: f64| {
            // The index in front of the surface. `slope` holds the ray's slope times this index.
            let mut index = first_index;
            let mut heights = Vec::with_capacity(surfaces.len());
            for (surface, thickness) in surfaces.iter().zip(thicknesses) {
                heights.push(height);
                let behind = refractive_index(surface.behind.medium, wavelength);
                let curvature =
                    surface.curvature + 2.0 * surface.asphere.map_or(0.0, |asphere| asphere.terms[0]);
                slope -= (behind - index) * curvature * height;
                index = behind;
                height += thickness * slope / index;
            }
            (heights, slope)
        };
        let (parallel, slope) = trace(1.0, 0.0);
        let (from_vertex, other_slope) = trace(0.0, first_index);
        Self { parallel, from_vertex, slopes: [slope, other_slope], index: first_index }
    }

    /// Returns the magnitude of the power 1/f.
    fn power(&self) -> f64 {
        self.slopes[0].abs()
    }

    /// Returns the distance of the entrance pupil behind the first vertex.
    fn pupil(&self, stop: usize) -> f64 {
        self.from_vertex[stop] / self.parallel[stop]
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
                // The ray starts at the axial object point and meets the first vertex plane at height 1.
                let [height, slope] = [
                    self.parallel[stop] + self.from_vertex[stop] / object,
                    self.slopes[0] + self.slopes[1] / object,
                ];
                height / (2.0 * number * slope)
            }
            Aperture::ObjectNa(na) => {
                let sine = na / self.index;
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
            Field::ImageHeight(height) => height * self.power() / self.index,
        }
    }
}

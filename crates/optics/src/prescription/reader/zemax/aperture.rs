//! The semi-diameters of the stop and of surfaces that state none, computed from the file's aperture and field by two
//! paraxial rays (W. J. Smith, *Modern Optical Engineering*, on raytracing).

use super::{blocks::Blocks, surface::ZemaxSurface};
use crate::prescription::{
    Fate, LensFileError,
    glass::refractive_index,
    interfaces::Medium,
    reader::{ledger::Ledger, text::Text},
};

/// The aperture that limits the beam, as the file states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aperture {
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

/// Keywords that state an aperture.
const KEYS: [&str; 3] = ["ENPD", "FNUM", "OBNA"];

impl Aperture {
    /// Reads the lines `ENPD`, `FNUM` and `OBNA`. A second value of 1 makes `FNUM` a working f-number and `OBNA` the
    /// angle of a cone. With `FLOA`, or without any of these lines, the stop's own size is used.
    pub(super) fn of(
        text: &Text<'_>,
        blocks: &Blocks<'_>,
        ledger: &mut Ledger<'_>,
    ) -> Result<Self, LensFileError> {
        let mut found = Self::ByStop;
        for record in blocks.general.iter().filter(|record| KEYS.contains(&record.key.text)) {
            let (location, key) = (record.key.location, record.key.text);
            // A line without a value, or with the value 0, leaves the aperture to another line.
            let value = if record.values().is_empty() { 0.0 } else { record.number(text, 0)? };
            let is_second = record.number_if_any(1) == Some(1.0);
            let (made, end): (fn(f64) -> Self, f64) = match (key, is_second) {
                ("ENPD", _) => (Self::EntrancePupil, f64::INFINITY),
                ("FNUM", false) => (Self::FNumber, f64::INFINITY),
                ("FNUM", true) => (Self::WorkingFNumber, f64::INFINITY),
                (_, false) => (Self::ObjectNa, 1.0),
                (_, true) => (Self::ObjectCone, 90.0),
            };
            if value < 0.0 || value >= end {
                return Err(text.error(location, format!("{key} {value} is not an aperture")));
            }
            if value > 0.0 && found == Self::ByStop {
                found = made(value);
            } else if value > 0.0 {
                ledger.warn(Fate::LeftOut, location, key, None, "a second aperture; the first counts");
            }
        }
        if let Some(record) = blocks.find("FLOA") {
            let fate = if found == Self::ByStop { Fate::Used } else { Fate::LeftOut };
            let reason = if found == Self::ByStop { "" } else { "another line states the aperture" };
            ledger.note(fate, record.key.location, "FLOA", None, reason);
        }
        Ok(found)
    }

    /// Returns the same kind of aperture with another value.
    pub(super) fn with(self, value: f64) -> Self {
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

/// The heights of two paraxial rays at each surface. One ray enters parallel to the axis at height 1; the other starts
/// at the first vertex with slope 1. Every paraxial ray is a linear combination of these two rays.
#[derive(Debug)]
pub(super) struct Paraxial {
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
    pub(super) fn of(
        object: Medium,
        surfaces: &[ZemaxSurface],
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
    pub(super) fn stop(&self, aperture: Aperture, stop: usize, object: f64) -> Option<f64> {
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
    pub(super) fn let_through(&self, stop: usize, others: impl Iterator<Item = (usize, f64)>) -> Option<f64> {
        let widest =
            others.map(|(surface, size)| (size / self.parallel[surface]).abs()).min_by(f64::total_cmp)?;
        Some((widest * self.parallel[stop]).abs()).filter(|size| *size > 0.0 && size.is_finite())
    }

    /// Returns the height, at a surface, of the beam that passes the stop at a given field. `field` is the tangent of
    /// the field's angle from the axis.
    pub(super) fn reach(
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

    /// Returns the tangent of the field angle, from `FTYP` and the farthest field. `FTYP` states whether fields are
    /// angles, object heights or image heights.
    pub(super) fn field(&self, blocks: &Blocks<'_>, stop: usize, object: f64) -> f64 {
        let kind = blocks.find("FTYP").and_then(|record| record.number_if_any(0)).unwrap_or(0.0);
        let size = farthest(blocks);
        match kind as i64 {
            0 => size.min(89.0).to_radians().tan(),
            1 if object.is_finite() => size / (object + self.pupil(stop)),
            1 => 0.0,
            _ => size * self.power() / self.index,
        }
    }
}

/// Returns the size of the farthest field in `XFLN` and `YFLN`: degrees or a length, depending on `FTYP`.
pub(super) fn farthest(blocks: &Blocks<'_>) -> f64 {
    let count = blocks.find("FTYP").and_then(|record| record.number_if_any(2)).unwrap_or(f64::INFINITY);
    let value =
        |key: &str, i: usize| blocks.find(key).and_then(|record| record.number_if_any(i)).unwrap_or(0.0);
    let fields = (0..count.clamp(1.0, 24.0) as usize).map(|i| value("XFLN", i).hypot(value("YFLN", i)));
    fields.fold(0.0, f64::max)
}

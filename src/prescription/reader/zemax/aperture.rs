//! How large the stop is, and the surfaces of which the file does not say it: from the aperture and the field that it
//! states, by two paraxial rays (W. J. Smith, *Modern Optical Engineering*, on raytracing).

use super::{blocks::Blocks, surface::Surface};
use crate::prescription::{LensFileError, glass::refractive_index, reader::text::Text};

/// What limits the beam, as the file states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aperture {
    /// The semi-diameter of the stop's surface.
    ByStop,
    /// Diameter of the entrance pupil.
    EntrancePupil(f64),
    /// Focal length over the entrance pupil's diameter.
    FNumber(f64),
    /// Numerical aperture on the object's side.
    ObjectNa(f64),
}

impl Aperture {
    /// Of the file's lines `FLOA`, `ENPD`, `FNUM`, `OBNA`.
    pub(super) fn of(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<Self, LensFileError> {
        for (key, made) in [
            ("ENPD", Self::EntrancePupil as fn(f64) -> Self),
            ("FNUM", Self::FNumber),
            ("OBNA", Self::ObjectNa),
        ] {
            if let Some(record) = blocks.find(key) {
                let value = record.number(text, 0)?;
                let is_na = key == "OBNA";
                if value < 0.0 || is_na && value >= 1.0 {
                    return Err(text.error(record.key.place, format!("{key} {value} is not an aperture")));
                }
                // 0 is written where another kind counts.
                if value > 0.0 {
                    return Ok(made(value));
                }
            }
        }
        Ok(Self::ByStop)
    }

    /// The same aperture with another value.
    pub(super) fn with(self, value: f64) -> Self {
        match self {
            Self::ByStop => Self::ByStop,
            Self::EntrancePupil(_) => Self::EntrancePupil(value),
            Self::FNumber(_) => Self::FNumber(value),
            Self::ObjectNa(_) => Self::ObjectNa(value),
        }
    }
}

/// The heights of two paraxial rays at each surface: one parallel to the axis at height 1, one from the first vertex at
/// slope 1. Every paraxial ray is a sum of the two.
#[derive(Debug)]
pub(super) struct Paraxial {
    parallel: Vec<f64>,
    from_vertex: Vec<f64>,
    /// 1/f.
    power: f64,
}

impl Paraxial {
    /// Of surfaces and the thicknesses behind them, at a wavelength, nm.
    pub(super) fn of(surfaces: &[Surface], thicknesses: &[f64], wavelength: f64) -> Self {
        let trace = |mut height: f64, mut slope: f64| {
            // The slope times the index.
            let mut index = 1.0;
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
        let (from_vertex, _) = trace(0.0, 1.0);
        Self { parallel, from_vertex, power: -slope }
    }

    /// Distance of the entrance pupil behind the first vertex.
    fn pupil(&self, stop: usize) -> f64 {
        self.from_vertex[stop] / self.parallel[stop]
    }

    /// Semi-diameter of the stop, a surface, for an aperture; `object` is the distance from the object to the first vertex.
    /// `None`: the aperture does not say it.
    pub(super) fn stop(&self, aperture: Aperture, stop: usize, object: f64) -> Option<f64> {
        let diameter = match aperture {
            Aperture::ByStop => return None,
            Aperture::EntrancePupil(diameter) => diameter,
            Aperture::FNumber(number) => 1.0 / (self.power.abs() * number),
            Aperture::ObjectNa(na) => 2.0 * na / (1.0 - na * na).sqrt() * (object + self.pupil(stop)),
        };
        let size = (diameter / 2.0 * self.parallel[stop]).abs();
        Some(size).filter(|size| *size > 0.0 && size.is_finite())
    }

    /// How far from the axis the beam of a stop and a field (tangent of the angle from the axis) reaches at a surface.
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

    /// The tangent of the field's angle from `FTYP` and the farthest of the fields: an angle, an object's height or an
    /// image's.
    pub(super) fn field(&self, blocks: &Blocks<'_>, stop: usize, object: f64) -> f64 {
        let kind = blocks.find("FTYP").and_then(|record| record.number_if_any(0)).unwrap_or(0.0);
        let size = farthest(blocks);
        match kind as i64 {
            0 => size.min(89.0).to_radians().tan(),
            1 if object.is_finite() => size / (object + self.pupil(stop)),
            1 => 0.0,
            _ => size * self.power.abs(),
        }
    }
}

/// The largest field of `XFLN` and `YFLN`: degrees or a length, as `FTYP` says.
pub(super) fn farthest(blocks: &Blocks<'_>) -> f64 {
    let count = blocks.find("FTYP").and_then(|record| record.number_if_any(2)).unwrap_or(f64::INFINITY);
    let value =
        |key: &str, i: usize| blocks.find(key).and_then(|record| record.number_if_any(i)).unwrap_or(0.0);
    let fields = (0..count.clamp(1.0, 24.0) as usize).map(|i| value("XFLN", i).hypot(value("YFLN", i)));
    fields.fold(0.0, f64::max)
}

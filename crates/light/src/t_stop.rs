//! Transmission of a lens on its axis, and the resulting T-number. The beam of a distant point on the axis is traced,
//! and the remaining light is averaged.

use super::coated::{LitPath, Surfaces};
use realistic_optics::{
    imaging::axial_beam::AxialBeam,
    lens::{Lens, Ray},
    trace::Path,
};

/// Number of annuli into which the beam is divided, all of the same area.
const RINGS: u32 = 512;

/// Transmission of the beam of a distant point on the axis, at the lens's wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TStop {
    /// Ratio of the light behind the lens to that behind a lossless lens.
    pub transmission: f64,
    /// T-number: the f-number divided by the square root of the transmission (ISO 517); infinite for an afocal lens.
    pub number: f64,
}

impl TStop {
    /// Returns the T-number of a lens with these surfaces, this axial beam and this focal length, mm. `None` if no ray
    /// gets through.
    pub fn of(lens: &Lens, surfaces: &Surfaces, beam: &AxialBeam, focal_length: f64) -> Option<Self> {
        let transmission = axial_transmission(lens, surfaces, beam)?;
        Some(Self { transmission, number: beam.fnumber(focal_length) / transmission.sqrt() })
    }
}

fn axial_transmission(lens: &Lens, surfaces: &Surfaces, beam: &AxialBeam) -> Option<f64> {
    let lit = LitPath::new(Path::scene_to_film(lens), surfaces);
    let front = lens.front();
    let radius = beam.diameter() / 2.0;
    let start = front.sagitta_range()[1] + front.semi_diameter;
    let at = |ring: u32| {
        let height = radius * ((f64::from(ring) + 0.5) / f64::from(RINGS)).sqrt();
        let ray = Ray { origin: [height, 0.0, start], direction: [0.0, 0.0, -1.0] };
        lit.trace(ray).ok().map(|(_, left)| left)
    };
    let left: Vec<f64> = (0..RINGS).filter_map(at).collect();
    (!left.is_empty()).then(|| left.iter().sum::<f64>() / left.len() as f64)
}

//! The transmission of a lens on its axis and the T-number that it makes: the beam of a distant point on the axis in; the
//! share of it that the surfaces leave out.

use super::coated::{LitPath, Surfaces};
use crate::{
    lens::{Lens, Ray, pupil::EntrancePupil},
    trace::Path,
};

/// Rings of the beam, of one area each.
const RINGS: u32 = 512;
/// How far the beam may be wider than the paraxial entrance pupil.
const WIDER: f64 = 1.2;

/// What the surfaces of a lens make of the beam of a distant point on the axis, at the lens's wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TStop {
    /// The share of the light of a lossless lens that is left.
    pub transmission: f64,
    /// The T-number: the f-number over the square root of that share (ISO 517). Infinite for an afocal lens.
    pub number: f64,
}

impl TStop {
    /// That of a lens with these surfaces and an f-number, its focal length over its paraxial entrance pupil's diameter. `None`
    /// where no ray gets through.
    pub fn of(lens: &Lens, surfaces: &Surfaces, f_number: f64) -> Option<Self> {
        let transmission = axial_transmission(lens, surfaces)?;
        Some(Self { transmission, number: f_number / transmission.sqrt() })
    }
}

fn axial_transmission(lens: &Lens, surfaces: &Surfaces) -> Option<f64> {
    let lit = LitPath::new(Path::scene_to_film(lens), surfaces);
    let front = lens.front();
    let widest = WIDER * EntrancePupil::of_lens(lens).diameter() / 2.0;
    let radius = if widest.is_finite() { widest.min(front.semi_diameter) } else { front.semi_diameter };
    let start = front.sagitta_range()[1] + front.semi_diameter;
    let at = |ring: u32| {
        let height = radius * ((f64::from(ring) + 0.5) / f64::from(RINGS)).sqrt();
        let ray = Ray { origin: [height, 0.0, start], direction: [0.0, 0.0, -1.0] };
        lit.trace(ray).ok().map(|(_, left)| left)
    };
    let left: Vec<f64> = (0..RINGS).filter_map(at).collect();
    (!left.is_empty()).then(|| left.iter().sum::<f64>() / left.len() as f64)
}

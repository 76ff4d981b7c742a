//! The transmission of a lens on its axis, of which its T-number is made: the beam of a distant point on the axis in; the share
//! of it that the surfaces leave out.

use super::{
    coated::{LitPath, Surfaces},
    coating::Coating,
};
use crate::{
    lens::{Lens, Ray, pupil::EntrancePupil},
    trace::Path,
};

/// Rings of the beam, of one area each.
const RINGS: u32 = 512;
/// How far the beam may be wider than the paraxial entrance pupil.
const WIDER: f64 = 1.2;

/// The share of the light of a lossless lens that a lens with a coating lets through of the beam of a distant point on the axis,
/// at the lens's wavelength. `None` where no ray gets through. The T-number is the f-number over the square root of it (ISO
/// 517).
pub fn axial_transmission(lens: &Lens, coating: Coating) -> Option<f64> {
    let lit = LitPath::new(Path::scene_to_film(lens), &Surfaces::new(lens, coating));
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

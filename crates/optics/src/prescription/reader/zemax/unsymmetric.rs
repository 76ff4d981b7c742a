//! Surfaces that are not symmetric about their axis: `TOROIDAL` and `BICONICX`.

use super::{blocks::Block, frames::parameters};
use crate::prescription::{
    LensFileError, PROFILE_TERMS,
    reader::text::Text,
    unsymmetric::{Biconic, Meridian, Toroid, Unsymmetric},
};

/// Returns the figure of a block of the type `kind`; `None` for another type. `curvature` and `conic` are those of `CURV`
/// and `CONI`, in the meridian y.
///
/// # Errors
/// A number is malformed, or the surface has Zernike terms, which are not traced.
pub(super) fn read(
    text: &Text<'_>,
    block: &Block<'_>,
    kind: &str,
    (curvature, conic): (f64, f64),
) -> Result<Option<Unsymmetric>, LensFileError> {
    let radius = |radius: f64| if radius == 0.0 { f64::INFINITY } else { radius };
    let in_y = if curvature == 0.0 { f64::INFINITY } else { curvature.recip() };
    match kind {
        "TOROIDAL" => {
            let data = block.numbered(text, "XDAT")?;
            if let Some(&(.., location)) =
                data.iter().find(|(number, value, _)| *number == 1 && *value != 0.0)
            {
                let message = format!(
                    "surface {} is a toroid with Zernike terms (XDAT 1), which are not traced: write 0 to trace it without \
                     them",
                    block.number
                );
                return Err(text.error(location, message));
            }
            let p = parameters::<{ PROFILE_TERMS + 1 }>(text, block)?;
            Ok(Some(Unsymmetric::Toroid(Toroid {
                meridian: Meridian::Y,
                radius: in_y,
                conic,
                terms: std::array::from_fn(|i| p[i + 1]),
                rotation_radius: radius(p[0]),
            })))
        }
        "BICONICX" => {
            let [x, conic_x] = parameters::<2>(text, block)?;
            Ok(Some(Unsymmetric::Biconic(Biconic { radii: [radius(x), in_y], conics: [conic_x, conic] })))
        }
        _ => Ok(None),
    }
}

//! Code V sequences (`.seq`): commands that enter a lens. `SO`, `S` and `SI` enter the object, the surfaces and the
//! image, each with its radius or curvature, its thickness and the glass behind it. Semi-diameters are in `CIR`.
//!
//! `blocks` assigns the statements to the surfaces. `system` reads the statements about the whole lens, `surface` and
//! `shapes` those about a surface, `frames` its changes of frame, and `glasses` the glasses. `radius_mode` finds whether `S` states radii or
//! curvatures. `statements` has the keywords without an effect.

mod blocks;
mod frames;
mod glasses;
mod radius_mode;
mod shapes;
mod statements;
mod surface;
mod system;

use super::{
    commands::{Block, record_fates},
    ledger::Ledger,
    sequential::{CURVED_IMAGE, SequentialLens, SequentialSurface, SurfacePlaces},
    surface_rows::checked,
    text::{Location, Text},
};
use crate::prescription::{Fate, LensFileError, glass::GlassLibrary, interfaces::Prescription};
use blocks::{Blocks, is_image};
use glasses::Glasses;

/// Reads a lens.
///
/// # Errors
/// The text is not a lens, or is a lens that cannot be traced; the error gives the first location with a fault.
pub(super) fn read(
    text: &Text<'_>,
    library: &GlassLibrary,
    ledger: &mut Ledger<'_>,
) -> Result<Prescription, LensFileError> {
    let blocks = Blocks::of(text)?;
    statements::refuse(text, &blocks)?;
    let (object, own, image) = parts(text, &blocks)?;
    let mut glasses = Glasses::of(text, &blocks, library, ledger)?;
    let front = checked(glasses.behind(text, object, ledger)?, |reason| {
        ledger.warn(Fate::Replaced, object.entry.location(), "SO", Some("0"), reason);
    });
    let object_distance = surface::object_distance(text, object)?;
    frames::check_object(text, object)?;
    let mut surfaces: Vec<SequentialSurface> = Vec::with_capacity(own.len());
    let mut thicknesses = Vec::with_capacity(own.len());
    let mut places = Vec::with_capacity(own.len());
    for block in own {
        let in_front = surfaces.last().map_or(front, |before| before.behind);
        surfaces.push(surface::read(text, block, in_front, &mut glasses, ledger)?);
        thicknesses.push(surface::thickness(text, block)?);
        places.push(SurfacePlaces {
            surface: block.entry.location(),
            size: block.find("CIR").map(|statement| statement.location()),
            thickness: block.find("THI").map(|statement| statement.location()),
            number: block.number.clone(),
        });
    }
    if let (Some(last), false) = (thicknesses.last_mut(), image.entry.record.words().is_empty()) {
        // The thickness of the image is the distance of the film from it.
        *last += surface::thickness(text, image)?;
        if image.entry.record.number(text, 0)? != 0.0 {
            ledger.warn(Fate::Replaced, image.entry.location(), "SI", None, CURVED_IMAGE);
        }
    }
    let [image_break, _] = frames::read(text, image, false)?;
    for statement in image.statements.iter().filter(|own| frames::KEYS.contains(&own.key.as_str())) {
        ledger.note(Fate::Used, statement.location(), &statement.key, None, "");
    }
    let is_distant = object_distance.is_infinite();
    let mut lens = SequentialLens {
        object: front,
        object_place: object.entry.location(),
        object_distance,
        surfaces,
        thicknesses,
        image_break,
        places,
        aperture: system::aperture(text, &blocks, is_distant, ledger)?,
        field: system::field(text, &blocks)?,
        wavelength: system::wavelength(text, &blocks, ledger)?,
        keys: ["S", "CIR", "S"],
        unit: system::unit(text, &blocks)?,
    };
    radius_mode::apply(text, &blocks, own, &mut lens, ledger)?;
    lens.take_first_for_stop("STO", ledger);
    let (lens, _) = lens.prescription(text, object.entry.location(), ledger)?;
    let title = system::title(&blocks);
    let (glasses, remarks) = glasses.glasses_and_warnings(text.file);
    let general = blocks.general.iter().chain(&blocks.catalogue);
    record_fates(general, &blocks.surfaces, &blocks.comments, statements::NO_EFFECT, ledger);
    Ok(Prescription { title, glasses, remarks, ..lens })
}

/// Returns the object, the surfaces of the lens and the image.
fn parts<'b, 't>(
    text: &Text<'_>,
    blocks: &'b Blocks<'t>,
) -> Result<(&'b Block<'t>, &'b [Block<'t>], &'b Block<'t>), LensFileError> {
    const EXPECTED: &str = "expected SO, the object, at least one surface S, and SI, the image";
    match blocks.surfaces.as_slice() {
        [object, own @ .., image] if !own.is_empty() && is_image(&image.entry) => Ok((object, own, image)),
        [] => Err(text.error(Location { line: 1, column: 1 }, format!("no surface; {EXPECTED}"))),
        [.., last] if !is_image(&last.entry) => {
            Err(text.error(last.entry.location(), format!("no image behind this surface; {EXPECTED}")))
        }
        [.., image] => {
            Err(text.error(image.entry.location(), format!("no lens before the image; {EXPECTED}")))
        }
    }
}

#[cfg(test)]
mod tests;

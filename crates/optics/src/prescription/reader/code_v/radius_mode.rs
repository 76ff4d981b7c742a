//! Whether the first number of `S` is a radius or a curvature. `RDM` and `RDM Y` state radii, `RDM N` curvatures. Files
//! without `RDM` have either, depending on a setting of the program. Such a file is read if only one of the two is
//! possible: a surface is no wider than its sphere, or only one of them forms its image where the file has it.

use super::blocks::Blocks;
use crate::prescription::{
    Fate, LensFileError,
    glass::D_LINE,
    interfaces::Asphere,
    reader::{
        commands::Block,
        ledger::Ledger,
        sequential::{Aperture, Paraxial, SequentialLens},
        text::Text,
    },
};
use realistic_base::message::short;

/// The meaning of the first number of `S`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Radii,
    Curvatures,
}

/// The largest distance between a file's image and the paraxial one, in focal lengths, at which the image is in focus.
const IN_FOCUS: f64 = 0.1;

/// Sets the curvatures of the surfaces of a lens, which `own` enter.
///
/// # Errors
/// A number is missing, or nothing in the file decides between radii and curvatures.
pub(super) fn apply(
    text: &Text<'_>,
    blocks: &Blocks<'_>,
    own: &[Block<'_>],
    lens: &mut SequentialLens,
    ledger: &mut Ledger<'_>,
) -> Result<(), LensFileError> {
    let numbers = own.iter().map(|block| Numbers::of(text, block)).collect::<Result<Vec<_>, _>>()?;
    let stated = match blocks.find("RDM") {
        Some(statement) => match statement.record.word(0) {
            None => Some(Mode::Radii),
            Some(word) if word.text.starts_with(['Y', 'y']) => Some(Mode::Radii),
            Some(word) if word.text.starts_with(['N', 'n']) => Some(Mode::Curvatures),
            Some(word) => {
                return Err(
                    text.error(word.location, format!("\"{word}\" is not Y (radii) or N (curvatures)"))
                );
            }
        },
        None => None,
    };
    let ambiguous = numbers.iter().position(|own| own.set.is_none() && own.entered != 0.0);
    let mode = match (stated, ambiguous) {
        (Some(mode), _) => mode,
        (None, None) => Mode::Radii,
        (None, Some(first)) => {
            let (mode, reason) = decided(lens, &numbers).ok_or_else(|| {
                let [radii, curvatures] = [Mode::Radii, Mode::Curvatures].map(|mode| {
                    set(lens, &numbers, mode);
                    short(paraxial(lens).power().recip())
                });
                let message = format!(
                    "surface {}: the first number of S is a radius or a curvature, and nothing in the file says which; as radii \
                     the focal length is {radii}, as curvatures {curvatures}: write RDM Y for radii or RDM N for curvatures \
                     before the surfaces",
                    own[first].number
                );
                text.error(own[first].entry.location(), message)
            })?;
            let name = if mode == Mode::Radii { "radii" } else { "curvatures" };
            let reason = format!(
                "the file does not state whether S has radii or curvatures (RDM); {name} are read, {reason}"
            );
            ledger.note(Fate::Replaced, own[first].entry.location(), "S", None, reason);
            mode
        }
    };
    set(lens, &numbers, mode);
    Ok(())
}

/// The statements about the curvature of a surface.
struct Numbers {
    /// The first number of `S`.
    entered: f64,
    /// The curvature of `RDY` or `CUY`.
    set: Option<f64>,
}

impl Numbers {
    fn of(text: &Text<'_>, block: &Block<'_>) -> Result<Self, LensFileError> {
        let entry = &block.entry.record;
        let entered =
            if entry.word(0).is_some_and(|word| word.is_infinite()) { 0.0 } else { entry.number(text, 0)? };
        let set = block.statements.iter().rev().find(|statement| {
            matches!(statement.key.as_str(), "RDY" | "CUY")
                && statement.record.words().first().is_some_and(|word| word.number().is_some())
        });
        let set = set.map(|statement| {
            let value = statement.record.number(text, 0)?;
            Ok(if statement.key == "RDY" { inverse(value) } else { value })
        });
        Ok(Self { entered, set: set.transpose()? })
    }
}

/// Returns the curvature of a radius, of which 0 means a plane.
fn inverse(radius: f64) -> f64 {
    if radius == 0.0 { 0.0 } else { radius.recip() }
}

fn set(lens: &mut SequentialLens, numbers: &[Numbers], mode: Mode) {
    for (surface, own) in lens.surfaces.iter_mut().zip(numbers) {
        let entered = if mode == Mode::Radii { inverse(own.entered) } else { own.entered };
        surface.curvature = own.set.unwrap_or(entered);
    }
}

/// Returns the meaning that the file decides, and the reason; `None` if it decides nothing.
fn decided(lens: &mut SequentialLens, numbers: &[Numbers]) -> Option<(Mode, &'static str)> {
    let both = [Mode::Radii, Mode::Curvatures];
    let of = |lens: &mut SequentialLens, holds: fn(&SequentialLens) -> bool| {
        let [radii, curvatures] = both.map(|mode| {
            set(lens, numbers, mode);
            holds(lens)
        });
        (radii != curvatures).then_some(if radii { Mode::Radii } else { Mode::Curvatures })
    };
    let by_size =
        of(lens, is_within_spheres).map(|mode| (mode, "as otherwise a surface is wider than its sphere"));
    by_size.or_else(|| of(lens, is_in_focus).map(|mode| (mode, "as otherwise the image is out of focus")))
}

fn paraxial(lens: &SequentialLens) -> Paraxial {
    let wavelength = lens.wavelength.map_or(D_LINE, |(wavelength, _)| wavelength);
    lens.paraxial(wavelength)
}

/// Returns whether no sphere is narrower than its aperture or, in front, than the entering beam.
fn is_within_spheres(lens: &SequentialLens) -> bool {
    let beam = match lens.aperture {
        Aperture::EntrancePupil(diameter) if lens.object_distance.is_infinite() => diameter / 2.0,
        _ => 0.0,
    };
    let mut beams = std::iter::once(beam).chain(std::iter::repeat(0.0));
    let mut curved = lens.surfaces.iter().filter(|surface| surface.curvature != 0.0);
    curved.all(|surface| {
        let size = surface.semi_diameter.unwrap_or(0.0).max(beams.next().unwrap_or(0.0));
        let radius = surface.curvature.recip();
        size <= match surface.asphere {
            Some(asphere) => Asphere { radius, ..asphere }.widest(),
            None => radius.abs(),
        }
    })
}

/// Returns whether the paraxial image is where the file has its image.
fn is_in_focus(lens: &SequentialLens) -> bool {
    let back = lens.thicknesses.last().copied().unwrap_or(0.0);
    back != 0.0 && paraxial(lens).defocus(lens.object_distance, back) < IN_FOCUS
}

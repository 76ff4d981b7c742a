//! The statements about the whole lens: its unit, wavelength, aperture, field and title.

use super::blocks::Blocks;
use crate::prescription::{
    Fate, LensFileError,
    reader::{
        ledger::Ledger,
        sequential::{Aperture, Field, FieldKind, nanometres},
        text::{self, Location, Text},
    },
};

/// Returns the unit of the file's lengths, mm.
pub(super) fn unit(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<f64, LensFileError> {
    let Some(word) = blocks.find("DIM").and_then(|statement| statement.record.word(0)) else {
        return Ok(1.0);
    };
    match word.text.to_ascii_uppercase().as_str() {
        "M" | "MM" => Ok(1.0),
        "C" | "CM" => Ok(10.0),
        "I" | "IN" => Ok(25.4),
        _ => Err(text.error(word.location, format!("\"{word}\" is not a unit: M, C or I"))),
    }
}

/// Returns the reference wavelength, nm, and its place. `WL` states all of them, and `REF` the number of the reference.
pub(super) fn wavelength(
    text: &Text<'_>,
    blocks: &Blocks<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<Option<(f64, Location)>, LensFileError> {
    let reference = blocks.find("REF");
    let number = reference.map(|statement| statement.record.number(text, 0)).transpose()?;
    let Some(all) = blocks.find("WL") else { return Ok(None) };
    let count = all.record.values().len();
    let number = match number {
        Some(number) => number,
        None if count < 2 => 1.0,
        None => {
            let reason =
                "several wavelengths and no reference (REF); lenses are traced at the user's wavelength";
            ledger.warn(Fate::LeftOut, all.location(), "WL", None, reason);
            return Ok(None);
        }
    };
    let is_one = number.fract() == 0.0 && number >= 1.0 && number <= count as f64;
    if let (Some(statement), false) = (reference, is_one) {
        let message = format!("the reference is wavelength {number}, and the file has {count} (WL)");
        return Err(text.error(statement.location(), message));
    }
    let index = number as usize - 1;
    let value = all.record.number(text, index)?;
    let location = all.record.word(index).map_or(all.location(), |cell| cell.location);
    let wavelength = nanometres(value / 1e3).map_err(|why| text.error(location, why))?;
    Ok(Some((wavelength, location)))
}

/// Keywords that state an aperture.
const APERTURES: [&str; 4] = ["EPD", "FNO", "NAO", "NA"];

/// Returns the aperture that limits the beam. `FNO` is the working f-number, and that of the focal length for a distant
/// object.
pub(super) fn aperture(
    text: &Text<'_>,
    blocks: &Blocks<'_>,
    is_distant: bool,
    ledger: &mut Ledger<'_>,
) -> Result<Aperture, LensFileError> {
    let mut found = Aperture::ByStop;
    let mut stated =
        blocks.general.iter().filter(|statement| APERTURES.contains(&statement.key.as_str())).peekable();
    while let Some(statement) = stated.next() {
        let value = statement.record.number(text, 0)?;
        let key = statement.key.as_str();
        let end = if key.starts_with("NA") { 1.0 } else { f64::INFINITY };
        if !(value > 0.0 && value < end) {
            let message = format!("{} is not an aperture; expected a positive number", statement.shown());
            return Err(text.error(statement.location(), message));
        }
        if stated.peek().is_some() {
            ledger.warn(
                Fate::LeftOut,
                statement.location(),
                key,
                None,
                "a later statement replaces this aperture",
            );
        }
        found = match key {
            "EPD" => Aperture::EntrancePupil(value),
            "FNO" if is_distant => Aperture::FNumber(value),
            "FNO" => Aperture::WorkingFNumber(value),
            "NAO" => Aperture::ObjectNa(value),
            _ => Aperture::image_na(value),
        };
    }
    Ok(found)
}

/// Returns the farthest field: degrees (`XAN`, `YAN`), or a height of the object (`XOB`, `YOB`) or of the image (`XIM`,
/// `YIM`, `XRI`, `YRI`).
pub(super) fn field(text: &Text<'_>, blocks: &Blocks<'_>) -> Result<Option<Field>, LensFileError> {
    const KINDS: [(&str, FieldKind); 4] = [
        ("AN", Field::Angle),
        ("OB", Field::ObjectHeight),
        ("IM", Field::ImageHeight),
        ("RI", Field::ImageHeight),
    ];
    for (kind, field) in KINDS {
        let values = |axis: &str| -> Result<Option<Vec<f64>>, LensFileError> {
            let Some(statement) = blocks.find(&format!("{axis}{kind}")) else { return Ok(None) };
            statement.record.numbers(text, 0).map(Some)
        };
        let [x, y] = [values("X")?, values("Y")?];
        if x.is_none() && y.is_none() {
            continue;
        }
        let [x, y] = [x, y].map(Option::unwrap_or_default);
        let value = |all: &[f64], i: usize| all.get(i).copied().unwrap_or(0.0);
        let sizes = (0..x.len().max(y.len())).map(|i| value(&x, i).hypot(value(&y, i)));
        return Ok(Some(field(sizes.fold(0.0, f64::max))));
    }
    Ok(None)
}

/// Returns the title.
pub(super) fn title(blocks: &Blocks<'_>) -> Option<String> {
    let words = blocks.find("TIT")?.record.values().iter().map(|word| word.text).collect::<Vec<_>>();
    text::title(Some(&words.join(" ")))
}

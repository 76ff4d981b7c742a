//! The aperture and the farthest field, as the file states them.

use super::blocks::Blocks;
use crate::prescription::{
    Fate, LensFileError,
    reader::{
        ledger::Ledger,
        sequential::{Aperture, Field},
        text::Text,
    },
};

/// Keywords that state an aperture.
const KEYS: [&str; 3] = ["ENPD", "FNUM", "OBNA"];

/// Reads the lines `ENPD`, `FNUM` and `OBNA`. A second value of 1 makes `FNUM` a working f-number and `OBNA` the
/// angle of a cone. With `FLOA`, or without any of these lines, the stop's own size is used.
pub(super) fn aperture(
    text: &Text<'_>,
    blocks: &Blocks<'_>,
    ledger: &mut Ledger<'_>,
) -> Result<Aperture, LensFileError> {
    let mut found = Aperture::ByStop;
    for record in blocks.general.iter().filter(|record| KEYS.contains(&record.key.text)) {
        let (location, key) = (record.key.location, record.key.text);
        // A line without a value, or with the value 0, leaves the aperture to another line.
        let value = if record.values().is_empty() { 0.0 } else { record.number(text, 0)? };
        let is_second = record.number_if_any(1) == Some(1.0);
        let (made, end): (fn(f64) -> Aperture, f64) = match (key, is_second) {
            ("ENPD", _) => (Aperture::EntrancePupil, f64::INFINITY),
            ("FNUM", false) => (Aperture::FNumber, f64::INFINITY),
            ("FNUM", true) => (Aperture::WorkingFNumber, f64::INFINITY),
            (_, false) => (Aperture::ObjectNa, 1.0),
            (_, true) => (Aperture::ObjectCone, 90.0),
        };
        if value < 0.0 || value >= end {
            return Err(text.error(location, format!("{key} {value} is not an aperture")));
        }
        if value > 0.0 && found == Aperture::ByStop {
            found = made(value);
        } else if value > 0.0 {
            ledger.warn(Fate::LeftOut, location, key, None, "a second aperture; the first counts");
        }
    }
    if let Some(record) = blocks.find("FLOA") {
        let fate = if found == Aperture::ByStop { Fate::Used } else { Fate::LeftOut };
        let reason = if found == Aperture::ByStop { "" } else { "another line states the aperture" };
        ledger.note(fate, record.key.location, "FLOA", None, reason);
    }
    Ok(found)
}

/// Returns the farthest field. `FTYP` states whether fields are angles, object heights or image heights.
pub(super) fn farthest_field(blocks: &Blocks<'_>) -> Field {
    let size = farthest(blocks);
    match blocks.find("FTYP").and_then(|record| record.number_if_any(0)).unwrap_or(0.0) as i64 {
        0 => Field::Angle(size),
        1 => Field::ObjectHeight(size),
        _ => Field::ImageHeight(size),
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

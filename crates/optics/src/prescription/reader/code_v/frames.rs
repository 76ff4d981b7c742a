//! Changes of frame. `XDE`, `YDE` and `ZDE` move the frame in front of a surface, then `ADE`, `BDE` and `CDE` turn it
//! about x, y and z. The change stays for the surfaces behind; with `DAR` it is undone behind the surface, and with `BEN`
//! it is repeated behind a mirror, so that the axis follows the light.

use crate::prescription::{
    CoordinateBreak, LensFileError,
    reader::{
        commands::Block,
        sequential::{Behind, decentre_and_tilts},
        text::Text,
    },
};

/// Keywords of decentres and tilts that are read.
pub(super) const KEYS: [&str; 6] = ["XDE", "YDE", "ZDE", "ADE", "BDE", "CDE"];

/// Returns the changes of frame in front of a surface and behind it, before its thickness.
///
/// # Errors
/// A number is malformed, or the change behind the surface is not known for certain.
pub(super) fn read(
    text: &Text<'_>,
    block: &Block<'_>,
    is_mirror: bool,
) -> Result<[Option<CoordinateBreak>; 2], LensFileError> {
    let mut values = [0.0; 6];
    for (value, key) in values.iter_mut().zip(KEYS) {
        *value = block.find(key).map_or(Ok(0.0), |statement| statement.record.number(text, 0))?;
    }
    if values == [0.0; 6] {
        return Ok([None; 2]);
    }
    let [reverse, bend, back] =
        ["REV", "BEN", "DAR"].map(|key| block.find(key).inspect(|own| _ = own.record.values()));
    if let Some(statement) = reverse {
        let what = "has a reversed tilt or decentring, whose order is not known for certain; write the tilts themselves";
        return Err(block.refused(text, statement, what));
    }
    let behind = match (bend, back) {
        (Some(_), _) => Behind::Bend,
        (None, Some(_)) => Behind::Return,
        (None, None) => Behind::Stay,
    };
    let [x, y, z, a, b, c] = values;
    let at = bend.unwrap_or(&block.entry);
    decentre_and_tilts([x, y, z], [a, b, c], behind, is_mirror).map_err(|what| block.refused(text, at, what))
}

/// Checks that the object is not tilted.
///
/// # Errors
/// The object is tilted.
pub(super) fn check_object(text: &Text<'_>, object: &Block<'_>) -> Result<(), LensFileError> {
    let statement = KEYS.iter().filter_map(|key| object.find(key)).find(|statement| !statement.is_zero());
    statement.map_or(Ok(()), |statement| {
        let what = "is a tilted or decentred object; place the scene in front of the camera instead";
        Err(object.refused(text, statement, what))
    })
}

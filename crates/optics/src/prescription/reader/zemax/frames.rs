//! Changes of frame: coordinate breaks (`TYPE COORDBRK`), tilts and decentrings of a surface (`SCBD`), and tilted planes
//! (`TYPE TILTSURF`).

use super::blocks::Block;
use crate::prescription::{
    Aperture, CoordinateBreak, LensFileError, Outline,
    reader::{record::Record, text::Text},
};
use realistic_base::message::cut;

/// Returns whether a block is a coordinate break, and no surface.
pub(super) fn is_break(block: &Block<'_>) -> bool {
    is_of_type(block, "COORDBRK")
}

fn is_of_type(block: &Block<'_>, kind: &str) -> bool {
    block.find("TYPE").and_then(|record| record.word(0)).is_some_and(|word| word.text == kind)
}

/// Returns the statement by which a coordinate break returns to the frame of an earlier surface. Its parameters hold the
/// values.
pub(super) fn return_of<'b, 't>(block: &'b Block<'t>) -> Option<&'b Record<'t>> {
    let mut sides = block.records.iter().filter(|record| record.key.text == "SCBD" && is_break(block));
    sides.find(|record| record.number_if_any(0) == Some(3.0) && record.number_if_any(1) != Some(0.0))
}

/// Returns the changes of frame in front of a surface and behind it, before its thickness.
///
/// # Errors
/// A number is malformed, or the side of the surface is not known for certain.
pub(super) fn read(
    text: &Text<'_>,
    block: &Block<'_>,
) -> Result<[Option<CoordinateBreak>; 2], LensFileError> {
    let mut changes = [None; 2];
    for record in block.records.iter().filter(|record| record.key.text == "SCBD") {
        // The side, the order of decentre and tilts, a pickup whose values are written out, and the values.
        let values: Vec<f64> = (3..8).map(|value| record.number_if_any(value).unwrap_or(0.0)).collect();
        let [x, y, a, b, c] = values[..] else { continue };
        let side = record.number_if_any(0).unwrap_or(0.0);
        match side {
            3.0 if is_break(block) => {}
            _ if values.iter().all(|value| *value == 0.0) => {}
            1.0 | 2.0 => {
                let tilts_first = record.number_if_any(1).unwrap_or(0.0) != 0.0;
                let own = CoordinateBreak::zemax([x, y], [a, b, c], tilts_first);
                let change = &mut changes[if side == 1.0 { 0 } else { 1 }];
                *change = Some(change.map_or(own, |before: CoordinateBreak| before.then(&own)));
            }
            _ => return Err(unsure(text, block, record)),
        }
    }
    let [front, behind] = &mut changes;
    if is_break(block) {
        let p = parameters::<6>(text, block)?;
        let own = CoordinateBreak::zemax([p[0], p[1]], [p[2], p[3], p[4]], p[5] != 0.0);
        *front = Some(front.map_or(own, |before| before.then(&own)));
    } else if let Some(own) = tilt(text, block)? {
        *front = Some(front.map_or(own, |before| before.then(&own)));
        *behind = Some(behind.map_or(own.inverse(), |after| own.inverse().then(&after)));
    }
    Ok(changes)
}

/// Checks that the object is not tilted.
///
/// # Errors
/// The object is tilted.
pub(super) fn check_object(text: &Text<'_>, object: &Block<'_>) -> Result<(), LensFileError> {
    match read(text, object)? {
        [None, None] => Ok(()),
        _ => Err(text.error(
            object.location,
            "a tilt or decentring of the object: place the scene in front of the camera instead, and delete the lines SCBD",
        )),
    }
}

fn unsure(text: &Text<'_>, block: &Block<'_>, record: &Record<'_>) -> LensFileError {
    let values = record.values().iter().take(8).map(|value| value.text).collect::<Vec<_>>().join(" ");
    let message = format!(
        "surface {} has a tilt or decentring ({}) on a side that is neither 1, before it, nor 2, behind it: write 1 or 2, or \
         delete the line to trace the surface without it",
        block.number,
        cut(&format!("SCBD {values}"))
    );
    text.error(record.key.location, message)
}

/// Returns the parameters 1 to N of a block, which are 0 where the file states none.
pub(super) fn parameters<const N: usize>(
    text: &Text<'_>,
    block: &Block<'_>,
) -> Result<[f64; N], LensFileError> {
    let mut all = [0.0; N];
    for (number, value, _) in block.numbered(text, "PARM")? {
        if let Some(own) = number.checked_sub(1).and_then(|index| all.get_mut(index)) {
            *own = value;
        }
    }
    Ok(all)
}

/// Returns the tilt of a plane z = x `PARM 1` + y `PARM 2`; `None` if the block is no such plane.
fn tilt(text: &Text<'_>, block: &Block<'_>) -> Result<Option<CoordinateBreak>, LensFileError> {
    if !is_of_type(block, "TILTSURF") {
        return Ok(None);
    }
    let [x, y] = parameters::<2>(text, block)?;
    let about_x = y.atan();
    let about_y = (-x * about_x.cos()).atan();
    Ok(Some(CoordinateBreak::tilted([about_x.to_degrees(), about_y.to_degrees(), 0.0])))
}

/// Returns the outline of a circle of this semi-diameter about the axis on a tilted plane: an ellipse. Returns `None` if
/// the block is no tilted plane.
pub(super) fn tilted_circle(
    text: &Text<'_>,
    block: &Block<'_>,
    radius: f64,
) -> Result<Option<Aperture>, LensFileError> {
    let Some(change) = tilt(text, block)? else { return Ok(None) };
    let [x, y] = parameters::<2>(text, block)?;
    // The steepest direction, in which the circle is the longest.
    let steepest = change.inverse().turned([x, y, x.hypot(y).powi(2)]);
    let longer = radius * (1.0 + x * x + y * y).sqrt();
    let rotation = steepest[1].atan2(steepest[0]).to_degrees();
    Ok(Some(Aperture { rotation, ..Aperture::centered(Outline::Ellipse([longer, radius])) }))
}

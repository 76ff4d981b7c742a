//! The apertures and obstructions of a surface: `CLAP`, `FLAP`, `OBSC`, `SQAP`, `UDAD` and their decentring `OBDC`.

use super::blocks::Block;
use crate::prescription::{
    Aperture, Fate, LensFileError, MAX_VERTICES, Outline,
    reader::{ledger::Ledger, record::Record, text::Text},
};
use realistic_base::message::cut;

/// Keywords of apertures whose values have no order that is known for certain, with descriptions of these apertures.
const UNSURE: [(&str, &str); 6] = [
    ("SQOB", "a rectangular obscuration"),
    ("ELAP", "an elliptical aperture"),
    ("ELOB", "an elliptical obscuration"),
    ("SPID", "the vanes of a spider"),
    ("UDAP", "an aperture of the user's own"),
    ("USOB", "an obscuration of the user's own"),
];

/// Returns the semi-diameter of the circle around the surface's aperture, if the file states an aperture, and the
/// apertures and obstructions that are not a circle about the axis. Lengths are in the file's unit. `listed` is the
/// semi-diameter of `DIAM`, and `floating` that of an aperture as large as `DIAM`.
///
/// # Errors
/// The surface has an aperture of a kind that is not read. Rays traced without it would be wrong.
pub(super) fn read(
    text: &Text<'_>,
    block: &Block<'_>,
    [listed, floating]: [Option<f64>; 2],
    ledger: &mut Ledger<'_>,
) -> Result<(Option<f64>, Vec<Aperture>), LensFileError> {
    let refuse = |record: &Record<'_>, what: &str| {
        let key = record.key.text;
        let values = record.values().iter().take(8).map(|value| value.text).collect::<Vec<_>>().join(" ");
        let message = format!(
            "surface {} has {what} ({}), which is not traced: delete the line to trace the surface without it",
            block.number,
            cut(&format!("{key} {values}"))
        );
        Err(text.error(record.key.location, message))
    };
    let decentring = block.find("OBDC");
    let part = |value: usize| decentring.and_then(|record| record.number_if_any(value)).unwrap_or(0.0);
    let center = [part(0), part(1)];
    let is_centered = center == [0.0; 2];
    let placed = |outline: Outline| Aperture { center, ..Aperture::centered(outline) };
    let obstruction =
        |radius: f64| Aperture { is_obstruction: true, ..placed(Outline::Ellipse([radius; 2])) };
    let mut shaped = Vec::new();
    let mut round = floating;
    for record in &block.records {
        let key = record.key.text;
        let [first, second] = [0, 1].map(|value| record.number_if_any(value).unwrap_or(0.0));
        match key {
            "CLAP" | "FLAP" => {
                if key == "CLAP" {
                    let clip = record.number(text, 1)?;
                    round = Some(clip).filter(|clip| *clip > 0.0).or(round);
                }
                if first > 0.0 {
                    shaped.push(obstruction(first));
                }
            }
            "OBSC" if second > first && first == 0.0 => shaped.push(obstruction(second)),
            "OBSC" if second > first && is_centered && listed.is_some_and(|listed| second >= listed) => {
                round = Some(first);
            }
            "OBSC" if second > first => return refuse(record, "an obscuration that is a ring"),
            "OBSC" => {}
            "SQAP" | "ELAP" if is_centered && listed.is_some_and(|circle| first.min(second) >= circle) => {
                let reason = format!(
                    "an aperture ({key}) around that of the semi-diameter (DIAM); the latter is traced"
                );
                ledger.note(Fate::Replaced, record.key.location, key, Some(block.number), reason);
            }
            "SQAP" if first > 0.0 && second > 0.0 => shaped.push(placed(Outline::Rectangle([first, second]))),
            _ => {
                if let Some((_, what)) = UNSURE.iter().find(|(own, _)| *own == key) {
                    return refuse(record, what);
                }
            }
        }
    }
    if let Some(vertices) = vertices(text, block)? {
        shaped.push(placed(Outline::Polygon(vertices.into())));
    } else if let Some(record) = block.find("USAP") {
        return refuse(record, "an aperture whose outline is in another file");
    }
    if let (Some(radius), false) = (round, is_centered) {
        shaped.push(placed(Outline::Ellipse([radius; 2])));
    }
    if let (Some(record), true, false) = (decentring, shaped.is_empty(), is_centered) {
        return refuse(record, "a decentring without an aperture");
    }
    let around = shaped.iter().filter(|aperture| !aperture.is_obstruction).map(Aperture::reach);
    let clip = around.chain(round.filter(|_| is_centered)).min_by(f64::total_cmp);
    Ok((clip, shaped))
}

/// Whether any value from a number on is not 0.
fn is_any(record: &Record<'_>, from: usize) -> bool {
    record.values().iter().skip(from).any(|value| value.number().is_none_or(|number| number != 0.0))
}

/// Returns the vertices of a polygon: lines `UDAD n x y 0`, and x = y = 0 in the last line. A line with n = 0 names the
/// file from which the vertices come.
///
/// # Errors
/// The lines are not one polygon, or it has more vertices than are traced.
fn vertices(text: &Text<'_>, block: &Block<'_>) -> Result<Option<Vec<[f64; 2]>>, LensFileError> {
    let mut vertices = Vec::new();
    let mut is_closed = false;
    let lines = block.records.iter().filter(|record| record.key.text == "UDAD");
    for record in lines.filter(|record| record.number_if_any(0) != Some(0.0)) {
        let refuse = |why: &str| {
            let message = format!("surface {} has an aperture of the user's own (UDAD) {why}", block.number);
            Err(text.error(record.key.location, message))
        };
        if is_closed {
            return refuse("with more than one outline; one polygon is traced");
        }
        let vertex = [record.number(text, 1)?, record.number(text, 2)?];
        is_closed = vertex == [0.0; 2];
        if is_any(record, 3) {
            return refuse("with an edge that is not straight; polygons are traced");
        }
        if !is_closed {
            vertices.push(vertex);
        }
        if vertices.len() > MAX_VERTICES {
            return refuse(&format!("with too many vertices; at most {MAX_VERTICES} are traced"));
        }
    }
    match vertices.len() {
        0 => Ok(None),
        3.. => Ok(Some(vertices)),
        _ => {
            let message =
                format!("surface {} has an aperture (UDAD) of fewer than three vertices", block.number);
            Err(text.error(block.location, message))
        }
    }
}

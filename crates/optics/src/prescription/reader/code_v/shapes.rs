//! The apertures of a surface. `CIR` is a semi-diameter, `REX` and `REY` are half widths, `ELX` and `ELY` semi-axes,
//! and `ADX` and `ADY` the place of the centre. A qualifier makes the aperture an obstruction (`OBS`), the hole of a mirror
//! (`HOL`), which reflects nothing, or the edge of the glass (`EDG`), and a label tells apertures of one surface apart (`L'A'`).

use crate::prescription::{
    Aperture, Fate, LensFileError, Outline,
    reader::{
        commands::{Block, Command},
        ledger::Ledger,
        text::Text,
    },
};

/// Maximum number of apertures and obstructions of a surface. Every ray is tested against each.
const MOST: usize = 100;

/// The apertures of a surface.
#[derive(Debug)]
pub(super) struct SurfaceAperture {
    /// The semi-diameter of the circle around the clear aperture.
    pub clip: Option<f64>,
    /// The apertures and obstructions that are not a circle about the axis.
    pub others: Vec<Aperture>,
}

/// An aperture of which some statements were read.
#[derive(Debug)]
struct Draft<'b, 't> {
    is_obstruction: bool,
    label: &'b str,
    statement: &'b Command<'t>,
    circle: f64,
    rectangle: [f64; 2],
    ellipse: [f64; 2],
    center: [f64; 2],
}

/// Reads the apertures of a surface.
///
/// # Errors
/// An aperture is malformed or not traced.
pub(super) fn read(
    text: &Text<'_>,
    block: &Block<'_>,
    is_mirror: bool,
    ledger: &mut Ledger<'_>,
) -> Result<SurfaceAperture, LensFileError> {
    let mut drafts: Vec<Draft<'_, '_>> = Vec::new();
    for statement in &block.statements {
        let key = statement.key.as_str();
        if !matches!(key, "CIR" | "REX" | "REY" | "ELX" | "ELY" | "ADX" | "ADY" | "ARO") {
            continue;
        }
        let values = statement.record.values();
        let number = values.iter().position(|value| value.number().is_some()).unwrap_or(values.len());
        let size = statement.record.number(text, number)?;
        let mut is_obstruction = false;
        let mut label = "";
        let mut is_edge = false;
        for word in &values[..number] {
            match word.text.to_ascii_uppercase().as_str() {
                "CLR" => is_obstruction = false,
                "OBS" => is_obstruction = true,
                "EDG" => is_edge = true,
                "HOL" if size == 0.0 => {}
                "HOL" if is_mirror => is_obstruction = true,
                "HOL" => {
                    let what = "has a hole and is no mirror, so that it is unsure what the hole does; delete the statement";
                    return Err(block.refused(text, statement, what));
                }
                own if own.starts_with('L') => label = word.text,
                _ => {
                    let message = format!(
                        "\"{word}\" is not a qualifier of an aperture: CLR, OBS, HOL, EDG or a label L'A'"
                    );
                    return Err(text.error(word.location, message));
                }
            }
        }
        if is_edge {
            let reason = "the edge of the glass, which lies outside the clear aperture";
            ledger.note(Fate::Informative, statement.location(), key, None, reason);
            continue;
        }
        let known = drafts.iter().position(|own| own.is_obstruction == is_obstruction && own.label == label);
        let draft = known.unwrap_or_else(|| {
            drafts.push(Draft {
                is_obstruction,
                label,
                statement,
                circle: 0.0,
                rectangle: [0.0; 2],
                ellipse: [0.0; 2],
                center: [0.0; 2],
            });
            drafts.len() - 1
        });
        if drafts.len() > MOST {
            return Err(block.refused(text, statement, &format!("has more than {MOST} apertures")));
        }
        let own = &mut drafts[draft];
        match key {
            "CIR" => own.circle = size,
            "REX" => own.rectangle[0] = size,
            "REY" => own.rectangle[1] = size,
            "ELX" => own.ellipse[0] = size,
            "ELY" => own.ellipse[1] = size,
            "ADX" => own.center[0] = size,
            "ADY" => own.center[1] = size,
            _ if size == 0.0 => {}
            _ => return Err(block.refused(text, statement, "has a rotated aperture, which is not read")),
        }
    }
    let mut aperture = SurfaceAperture { clip: None, others: Vec::new() };
    for draft in &drafts {
        let Some(outline) = outline(text, block, draft)? else { continue };
        let is_obstruction = draft.is_obstruction;
        let own = Aperture { center: draft.center, is_obstruction, ..Aperture::centered(outline) };
        if !is_obstruction && aperture.clip.is_some() {
            return Err(block.refused(text, draft.statement, "has a second clear aperture; expected one"));
        }
        if !is_obstruction {
            aperture.clip = Some(own.reach());
        }
        if is_obstruction || draft.center != [0.0; 2] || draft.circle == 0.0 {
            aperture.others.push(own);
        }
    }
    Ok(aperture)
}

/// Returns the outline of an aperture; `None` if it has no size.
fn outline(
    text: &Text<'_>,
    block: &Block<'_>,
    draft: &Draft<'_, '_>,
) -> Result<Option<Outline>, LensFileError> {
    let has = |pair: [f64; 2]| pair != [0.0; 2];
    let count = usize::from(draft.circle != 0.0)
        + usize::from(has(draft.rectangle))
        + usize::from(has(draft.ellipse));
    let (outline, sizes) = match count {
        0 if draft.center == [0.0; 2] => return Ok(None),
        1 if draft.circle != 0.0 => (Outline::Ellipse([draft.circle; 2]), [draft.circle; 2]),
        1 if has(draft.rectangle) => (Outline::Rectangle(draft.rectangle), draft.rectangle),
        1 => (Outline::Ellipse(draft.ellipse), draft.ellipse),
        0 => {
            return Err(block.refused(
                text,
                draft.statement,
                "has the place of an aperture, and no aperture",
            ));
        }
        _ => return Err(block.refused(text, draft.statement, "has an aperture of two forms; expected one")),
    };
    if sizes.iter().all(|size| *size > 0.0) {
        return Ok(Some(outline));
    }
    let what = "has an aperture without two positive sizes; expected CIR, REX and REY, or ELX and ELY";
    Err(block.refused(text, draft.statement, what))
}

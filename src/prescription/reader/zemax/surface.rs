//! A surface of the file: its curvature, figure, glass, semi-diameter and coating; and what no surface of a lens here can be.
//!
//! A coating is a name (`COAT NAME`). The recipes stand in a file of the program's own (COATING.DAT), which is not read: names
//! of its sample stand for the coatings here that have their layers, and others are reported.

use super::blocks::{Block, Record};
use crate::{
    message::{cut, quoted},
    prescription::{
        LensFileError,
        coating::{Coating, SurfaceCoating},
        interfaces::{Asphere, FIRST_POWER, Interface, LAST_POWER, Medium, has_coating},
        reader::{named_glass::NamedGlasses, surfaces::Behind, text::Text},
    },
};

/// A surface, lengths in the file's unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surface {
    /// 1/R; the figure's radius is left at infinity.
    pub curvature: f64,
    pub asphere: Option<Asphere>,
    /// Behind the surface.
    pub behind: Behind,
    /// Where it is stated and not 0.
    pub semi_diameter: Option<f64>,
    /// The semi-diameter is the file's, not one that its program computed from rays; or an aperture is stated.
    pub is_fixed: bool,
    pub is_stop: bool,
}

/// Reads one surface between object and image.
///
/// # Errors
/// It is none that rays are traced through here, or a value is missing.
pub(super) fn read(
    text: &Text<'_>,
    block: &Block<'_>,
    glasses: &mut NamedGlasses<'_>,
) -> Result<Surface, LensFileError> {
    let kind =
        block.find("TYPE").and_then(|record| record.values.first()).map_or("STANDARD", |kind| kind.text);
    let refuse = |what: &str| {
        let place = block.find("TYPE").map_or(block.place, |record| record.key.place);
        let message = format!(
            "surface {} is {what}; only surfaces of revolution about one axis are traced",
            block.number
        );
        Err(text.error(place, message))
    };
    let mut terms = [0.0; LAST_POWER - FIRST_POWER + 1];
    // A term of r^power, which only those from 2 to 20 may have.
    let mut add = |power: usize, value: f64, place| -> Result<(), LensFileError> {
        match power.checked_sub(FIRST_POWER).and_then(|index| terms.get_mut(index)) {
            Some(term) => *term = value,
            None if value == 0.0 => {}
            None => {
                let message = format!("a term of r^{power}; terms are A{FIRST_POWER} to A{LAST_POWER}");
                return Err(text.error(place, message));
            }
        }
        Ok(())
    };
    match kind {
        "STANDARD" => {}
        "EVENASPH" => {
            for (i, value, place) in block.numbered(text, "PARM")? {
                add(2 * i, value, place)?;
            }
        }
        "ODDASPHE" => {
            for (i, value, place) in block.numbered(text, "PARM")? {
                add(i, value, place)?;
            }
        }
        "XASPHERE" | "XOSPHERE" => {
            let data = block.numbered(text, "XDAT")?;
            let radius = data.iter().find(|(i, ..)| *i == 2).map_or(1.0, |&(_, radius, _)| radius);
            for (i, value, place) in data.into_iter().filter(|(i, ..)| *i > 2) {
                let power = if kind == "XASPHERE" { 2 * (i - 2) } else { i - 2 };
                let value = if value == 0.0 { 0.0 } else { value / radius.powi(power.min(999) as i32) };
                if !value.is_finite() {
                    return Err(text.error(place, "the normalisation radius leaves this term without end"));
                }
                add(power, value, place)?;
            }
        }
        "COORDBRK" => return refuse("a tilt or decentring (COORDBRK)"),
        "TOROIDAL" | "BICONICX" | "CYLINDER" => return refuse(&format!("a cylinder or toroid ({kind})")),
        "DGRATING" | "EGRATING" => return refuse(&format!("a grating ({kind})")),
        "PARAXIAL" => return refuse("an ideal thin lens (PARAXIAL), which has no glass"),
        other => return refuse(&format!("of type {}", cut(other))),
    }
    let conic = block.find("CONI").map_or(Ok(0.0), |record| record.number(text, 0))?;
    let curvature = block.find("CURV").map_or(Ok(0.0), |record| record.number(text, 0))?;
    let behind = match block.find("GLAS") {
        Some(record) => glass(text, block, record, glasses)?,
        None => Medium::Air.into(),
    };
    let diameter = block.find("DIAM");
    let semi_diameter = diameter.map(|record| record.number(text, 0)).transpose()?;
    let aperture =
        ["CLAP", "FLAP"].iter().find_map(|key| block.find(key)).and_then(|record| record.number_if_any(1));
    Ok(Surface {
        curvature,
        asphere: (conic != 0.0 || terms.iter().any(|term| *term != 0.0)).then_some(Asphere {
            radius: f64::INFINITY,
            conic,
            terms,
        }),
        behind,
        semi_diameter: aperture.or(semi_diameter).filter(|semi_diameter| *semi_diameter != 0.0),
        is_fixed: aperture.is_some() || diameter.and_then(|record| record.number_if_any(1)) == Some(1.0),
        is_stop: block.find("STOP").is_some(),
    })
}

/// `GLAS name code pickup n_d V …`: solve code 1 is a model glass by the two numbers. With another the name counts alone: the
/// numbers may be those of a glass that stood there before, and with code 3 (substitute) mostly are.
fn glass(
    text: &Text<'_>,
    block: &Block<'_>,
    record: &Record<'_>,
    glasses: &mut NamedGlasses<'_>,
) -> Result<Behind, LensFileError> {
    let place = record.key.place;
    let Some(name) = record.values.first() else {
        return Err(text.error(place, "GLAS without a name"));
    };
    if name.text.eq_ignore_ascii_case("MIRROR") {
        let message = format!("surface {} is a mirror; only lenses that refract are traced", block.number);
        return Err(text.error(place, message));
    }
    // What a program writes that keeps no numbers of catalogue glasses.
    const PLACEHOLDER: [Option<f64>; 2] = [Some(1.5), Some(40.0)];
    const NO_NAME: &str = "___BLANK";
    let code = record.number_if_any(1).unwrap_or(0.0);
    let numbers = [record.number_if_any(3), record.number_if_any(4)];
    let [n_d, abbe] = [numbers[0], numbers[1].filter(|abbe| *abbe > 0.0)];
    if name.text == NO_NAME || code == 1.0 {
        // What stands there and is no number is an error.
        record.number(text, 3)?;
        if record.values.len() > 4 {
            record.number(text, 4)?;
        }
        let name = Some(name.text).filter(|name| *name != NO_NAME).unwrap_or("");
        return match n_d {
            Some(1.0) => Ok(Medium::Air.into()),
            Some(n_d) if n_d > 1.0 => Ok(glasses.by_numbers(name, n_d, abbe)),
            _ => Err(text.error(place, "a model glass has an index of 1 or more as its fourth value")),
        };
    }
    if code == 4.0 {
        let message = format!("glass {} with offsets of its index (mode 4) is not read", name.cut());
        return Err(text.error(place, message));
    }
    let is_own = code != 3.0 && numbers != PLACEHOLDER;
    let [n_d, abbe] = if is_own { [n_d.filter(|n_d| *n_d > 1.0), abbe] } else { [None, None] };
    glasses.by_name(name.text, n_d, abbe).map_err(|why| {
        let numbers = match numbers {
            PLACEHOLDER | [None, _] => String::new(),
            [Some(n_d), _] => format!(
                "; that n_d is {n_d} counts only with 1, a model glass, for the solve code {code} behind the name: write 1 \
                 to take the line's numbers"
            ),
        };
        text.error(name.place, why + &numbers)
    })
}

/// Names, capitals or not, beside those of [`Coating::NAMES`]. AR is a layer of MgF2 a quarter wave thick, HEAR1 layers of MgF2,
/// ZrO2 and CeF3, a quarter, half and quarter wave thick; waves are of the file's primary wavelength.
const COATINGS: [(&str, Coating); 5] = [
    ("none", Coating::Bare),
    ("null", Coating::Bare),
    ("ar", Coating::QuarterWave),
    ("mgf2", Coating::QuarterWave),
    ("hear1", Coating::ThreeLayer),
];

/// The coatings of the interfaces, each made of one of `blocks`, for layers in waves of `wavelength`, nm. `None` where the file
/// names none. What is taken in another way than it stands there is added to `remarks`.
pub(super) fn coatings(
    text: &Text<'_>,
    blocks: &[&Block<'_>],
    interfaces: &[Interface],
    wavelength: f64,
    remarks: &mut Vec<String>,
) -> Option<Vec<SurfaceCoating>> {
    let mut names_any = false;
    let coatings = blocks.iter().zip(has_coating(interfaces)).map(|(block, can_have)| {
        let named = |coating| SurfaceCoating::Named { coating, wavelength };
        let bare = named(Coating::Bare);
        let Some(name) = block.find("COAT").and_then(|record| record.values.first()) else { return bare };
        names_any = true;
        let known = Coating::NAMES.iter().chain(&COATINGS);
        let known = known.into_iter().find(|(known, _)| known.eq_ignore_ascii_case(name.text));
        let message = match known {
            Some((_, Coating::Bare)) => return bare,
            Some((_, coating)) if can_have => return named(*coating),
            Some(_) => format!(
                "surface {} is not between air and glass, where coatings are; its coating {} is left out",
                block.number,
                name.cut()
            ),
            None => format!(
                "coating {} is known to the file's program alone; surface {} is bare. {} are known here",
                name.cut(),
                block.number,
                quoted(&Coating::NAMES.iter().chain(&COATINGS).map(|(name, _)| *name).collect::<Vec<_>>())
            ),
        };
        remarks.push(text.error(name.place, message).to_string());
        bare
    });
    let coatings = coatings.collect();
    names_any.then_some(coatings)
}

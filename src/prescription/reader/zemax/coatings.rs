//! The coatings that surfaces name (`COAT NAME`). The recipes stand in a file of the program's own (COATING.DAT), which is not
//! read: names of its sample stand for the coatings here that have their layers, and others are reported.

use super::blocks::Block;
use crate::{
    message::quoted,
    prescription::{
        coating::{Coating, SurfaceCoating},
        interfaces::{Interface, has_coating},
        reader::text::Text,
    },
};

/// Names, capitals or not, beside those of [`Coating::NAMES`]. AR is a layer of MgF2 a quarter wave thick, HEAR1 layers of MgF2,
/// ZrO2 and CeF3, a quarter, half and quarter wave thick; waves are of the file's primary wavelength.
const NAMES: [(&str, Coating); 5] = [
    ("none", Coating::Bare),
    ("null", Coating::Bare),
    ("ar", Coating::QuarterWave),
    ("mgf2", Coating::QuarterWave),
    ("hear1", Coating::ThreeLayer),
];

/// The coatings of the interfaces, each made of one of `blocks`, for layers in waves of `wavelength`, nm. `None` where the file
/// names none. What is taken in another way than it stands there is added to `remarks`.
pub(super) fn of_surfaces(
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
        let known = Coating::NAMES.iter().chain(&NAMES);
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
                quoted(&Coating::NAMES.iter().chain(&NAMES).map(|(name, _)| *name).collect::<Vec<_>>())
            ),
        };
        remarks.push(text.error(name.place, message).to_string());
        bare
    });
    let coatings = coatings.collect();
    names_any.then_some(coatings)
}

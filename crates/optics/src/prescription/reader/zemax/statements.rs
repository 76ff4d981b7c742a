//! The keywords that this reader knows but does not need, each with the reason why it has no effect on rays through the
//! lens. Keywords that are neither listed here nor read are reported by name as left out.

use super::blocks::{Block, Blocks};
use crate::prescription::{
    Fate,
    reader::{ledger::Ledger, record::Record},
};

/// Keywords, grouped by the reason why they have no effect.
const NO_EFFECT: [(&str, &[&str]); 5] = [
    (
        "names and notes",
        &["VERS", "NAME", "NOTE", "COMM", "AUTH", "LANG", "DBDT", "LUID", "MOFF", "BLNK", "FIMP"],
    ),
    (
        "settings of the file's program and of its displays",
        &[
            "PFIL", "RAIM", "PUSH", "SDMA", "OMMA", "ROPD", "HYPR", "PICB", "GLRS", "GSTD", "NSCD", "COFN",
            "IWDP", "GFAC", "HIDE", "MIRR", "SLAB", "POPS", "COLR", "DRAW", "RAID", "POLS",
        ],
    ),
    ("tolerances, solves and pickups, whose values the file holds", &["TOL", "MAZH", "PZUP", "PPAR", "PPIC"]),
    ("outlines of the glass and its mount", &["MEMA", "OEMA"]),
    (
        "fields, wavelengths and their weights, which the user chooses",
        &[
            "FTYP", "XFLN", "YFLN", "XFLD", "YFLD", "FWGN", "FWGT", "VDXN", "VDYN", "VCXN", "VCYN", "VANN",
            "VDSZ", "WAVM", "WAVN", "WAVL", "WWGN", "WWGT", "PWAV",
        ],
    ),
];

/// Operands of configurations that concern fields, wavelengths and their weights.
const OPERANDS_WITHOUT_EFFECT: [&str; 12] =
    ["XFIE", "YFIE", "FLWT", "FVDX", "FVDY", "FVCX", "FVCY", "FVAN", "WAVE", "WLWT", "FLTP", "CWGT"];

/// Returns the reason why an operand of a configuration has no effect on the lens; `None` if it may have an effect.
pub(super) fn no_effect_of_operand(key: &str) -> Option<&'static str> {
    OPERANDS_WITHOUT_EFFECT.contains(&key).then_some(NO_EFFECT[4].0).or_else(|| no_effect(key))
}

/// Returns the reason why a keyword has no effect on the lens; `None` if it may have an effect.
fn no_effect(key: &str) -> Option<&'static str> {
    NO_EFFECT.iter().find(|(_, keys)| keys.contains(&key)).map(|(reason, _)| *reason)
}

/// Records the fates of all lines. A line is used if the reader has read its values, and informative if it has no
/// effect on the lens. The surfaces `own` are those of the lens; the other surfaces are the object and the image.
pub(super) fn record_fates(blocks: &Blocks<'_>, own: &[Block<'_>], ledger: &mut Ledger<'_>) {
    let mut line = |record: &Record<'_>, surface: Option<&str>, otherwise: Option<&str>| {
        let location = record.key.location;
        if !ledger.is_open(location.line) {
            return;
        }
        let key = record.key.text;
        if record.is_used() {
            ledger.note(Fate::Used, location, key, None, "");
        } else if let Some(reason) = no_effect(key).or(otherwise) {
            ledger.note(Fate::Informative, location, key, None, reason);
        } else {
            ledger.unknown(location, key, surface, UNKNOWN);
        }
    };
    blocks.general.iter().for_each(|record| line(record, None, None));
    for block in &blocks.surfaces {
        let is_own = own.iter().any(|own| own.location == block.location);
        let otherwise = (!is_own).then_some("describes the object or the image, which are the user's");
        block.records.iter().for_each(|record| line(record, Some(block.number), otherwise));
    }
    for block in &blocks.surfaces {
        if ledger.is_open(block.location.line) {
            ledger.note(Fate::Used, block.location, "SURF", None, "");
        }
    }
}

/// The reason recorded for an unknown keyword.
const UNKNOWN: &str = "a keyword that this reader does not know";

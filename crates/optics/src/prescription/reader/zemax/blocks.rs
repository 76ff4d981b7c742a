//! The lines of the file. `SURF n` begins the lines that describe a surface. The lines before and behind the surfaces
//! describe the whole lens.
//!
//! The lines of a surface are indented more than its `SURF`. Some programs indent nothing; in their files a line with a
//! keyword of surfaces belongs to the surface before it.

use crate::prescription::{
    LensFileError, MAX_INTERFACES,
    reader::{
        record::Record,
        text::{Location, Text, words},
    },
};
use realistic_base::message::cut;

/// The lines of one surface.
#[derive(Clone, Debug)]
pub(super) struct Block<'t> {
    /// The location of `SURF n`.
    pub location: Location,
    /// The number n in `SURF n`.
    pub number: &'t str,
    pub records: Vec<Record<'t>>,
}

impl<'t> Block<'t> {
    pub(super) fn find(&self, key: &str) -> Option<&Record<'t>> {
        self.records.iter().find(|record| record.key.text == key)
    }

    /// Returns the numbered values in the lines `PARM` or `XDAT`.
    pub(super) fn numbered(
        &self,
        text: &Text<'_>,
        key: &str,
    ) -> Result<Vec<(usize, f64, Location)>, LensFileError> {
        let lines = self.records.iter().filter(|record| record.key.text == key);
        lines
            .map(|record| {
                let number = record.word(0).and_then(|value| value.text.parse().ok());
                let message = || format!("{} without its number", cut(key));
                let number = number.ok_or_else(|| text.error(record.key.location, message()))?;
                Ok((number, record.number(text, 1)?, record.key.location))
            })
            .collect()
    }
}

/// Keywords of the lines that describe a surface.
const OF_SURFACE: [&str; 44] = [
    "TYPE", "CURV", "CONI", "COAT", "GLAS", "DISZ", "DIAM", "PARM", "XDAT", "STOP", "COMM", "FIMP", "HIDE",
    "MIRR", "SLAB", "POPS", "MEMA", "OEMA", "MAZH", "FLAP", "CLAP", "OBSC", "SQAP", "SQOB", "ELAP", "ELOB",
    "SPID", "USAP", "USOB", "UDAP", "UDAD", "OBDC", "SCBD", "PPAR", "PPIC", "PZUP", "TAPR", "BLNK", "COLR",
    "DRAW", "RAID", "GLCZ", "IGNR", "NSCS",
];

/// Returns whether a line begins a surface: `SURF n`, with any spacing.
pub(super) fn is_surface(line: &[u8]) -> bool {
    let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    words.next() == Some(b"SURF") && words.next().is_some_and(|word| word[0].is_ascii_digit())
}

/// All lines of a file.
#[derive(Debug)]
pub(super) struct Blocks<'t> {
    /// The lines that belong to no surface.
    pub general: Vec<Record<'t>>,
    /// The surfaces in order, with the object first and the image last.
    pub surfaces: Vec<Block<'t>>,
}

impl<'t> Blocks<'t> {
    pub(super) fn of(text: &'t Text<'_>) -> Result<Self, LensFileError> {
        let mut all = Self { general: Vec::new(), surfaces: Vec::new() };
        let mut indent_of_surface: Option<usize> = None;
        for (number, line) in text.lines() {
            let mut words = words(number, line).into_iter();
            let Some(key) = words.next() else { continue };
            let record = Record::new(key, words.collect());
            let indent = key.location.column;
            if is_surface(line.as_bytes()) {
                if all.surfaces.len() == MAX_INTERFACES + 2 {
                    let message = format!("more surfaces; a lens has at most {MAX_INTERFACES} interfaces");
                    return Err(text.error(key.location, message));
                }
                let own = record.words().first().map_or("", |value| value.text);
                all.surfaces.push(Block { location: key.location, number: own, records: Vec::new() });
                indent_of_surface = Some(indent);
            } else if let Some(surface) = all.surfaces.last_mut().filter(|_| {
                indent_of_surface.is_some_and(|surface| indent > surface || OF_SURFACE.contains(&key.text))
            }) {
                surface.records.push(record);
            } else {
                indent_of_surface = None;
                all.general.push(record);
            }
        }
        Ok(all)
    }

    /// Returns the first line with this keyword that belongs to no surface.
    pub(super) fn find(&self, key: &str) -> Option<&Record<'t>> {
        self.general.iter().find(|record| record.key.text == key)
    }
}

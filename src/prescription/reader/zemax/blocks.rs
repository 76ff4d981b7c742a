//! The file's lines: `SURF n` with indented lines that say what the surface is, and lines before and behind that say what
//! holds for all.

use crate::{
    message::cut,
    prescription::{
        LensFileError, MAX_INTERFACES,
        reader::text::{Cell, Place, Text, no_number, words},
    },
};

/// A line: its keyword and the values behind.
#[derive(Clone, Debug)]
pub(super) struct Record<'t> {
    pub key: Cell<'t>,
    pub values: Vec<Cell<'t>>,
}

impl<'t> Record<'t> {
    /// A value, counted from 0, that must be a finite number.
    pub(super) fn number(&self, text: &Text<'_>, value: usize) -> Result<f64, LensFileError> {
        let Some(cell) = self.values.get(value) else {
            return Err(
                text.error(self.key.place, format!("{} lacks its value {}", self.key.cut(), value + 1))
            );
        };
        cell.number().ok_or_else(|| {
            let expected = format!("value {} of {}", value + 1, self.key.cut());
            text.error(cell.place, no_number(cell.text, &expected))
        })
    }

    /// A value that may be missing or anything; `None` where it is no finite number.
    pub(super) fn number_if_any(&self, value: usize) -> Option<f64> {
        self.values.get(value).and_then(Cell::number)
    }
}

/// What the lines of one surface say.
#[derive(Clone, Debug)]
pub(super) struct Block<'t> {
    /// Where `SURF n` stands.
    pub place: Place,
    /// The number n.
    pub number: &'t str,
    pub records: Vec<Record<'t>>,
}

impl<'t> Block<'t> {
    pub(super) fn find(&self, key: &str) -> Option<&Record<'t>> {
        self.records.iter().find(|record| record.key.text == key)
    }

    /// The numbered values of `PARM` or `XDAT` lines.
    pub(super) fn numbered(
        &self,
        text: &Text<'_>,
        key: &str,
    ) -> Result<Vec<(usize, f64, Place)>, LensFileError> {
        let lines = self.records.iter().filter(|record| record.key.text == key);
        lines
            .map(|record| {
                let number = record.values.first().and_then(|value| value.text.parse().ok());
                let message = || format!("{} without its number", cut(key));
                let number = number.ok_or_else(|| text.error(record.key.place, message()))?;
                Ok((number, record.number(text, 1)?, record.key.place))
            })
            .collect()
    }
}

/// All of a file.
#[derive(Debug)]
pub(super) struct Blocks<'t> {
    /// The lines that belong to no surface.
    pub general: Vec<Record<'t>>,
    /// The surfaces in their order, the object first and the image last.
    pub surfaces: Vec<Block<'t>>,
}

impl<'t> Blocks<'t> {
    pub(super) fn of(text: &'t Text<'_>) -> Result<Self, LensFileError> {
        let mut all = Self { general: Vec::new(), surfaces: Vec::new() };
        let mut is_within = false;
        for (number, line) in text.lines() {
            let mut words = words(number, line).into_iter();
            let Some(key) = words.next() else { continue };
            let record = Record { key, values: words.collect() };
            let is_indented = line.starts_with([' ', '\t']);
            if key.text == "SURF" && !is_indented {
                if all.surfaces.len() == MAX_INTERFACES + 2 {
                    let message = format!("more surfaces; a lens has at most {MAX_INTERFACES} interfaces");
                    return Err(text.error(key.place, message));
                }
                let own = record.values.first().map_or("", |value| value.text);
                all.surfaces.push(Block { place: key.place, number: own, records: Vec::new() });
                is_within = true;
            } else if is_within && is_indented {
                all.surfaces.last_mut().expect("within one").records.push(record);
            } else {
                is_within = false;
                all.general.push(record);
            }
        }
        Ok(all)
    }

    /// The first line of that keyword that belongs to no surface.
    pub(super) fn find(&self, key: &str) -> Option<&Record<'t>> {
        self.general.iter().find(|record| record.key.text == key)
    }
}

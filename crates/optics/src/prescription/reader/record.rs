//! Statements of a text: a keyword and its values.
//!
//! A record remembers whether its values were read ([`Record::is_used`]), so that a reader can report unused statements
//! at the end.

use std::cell::Cell as Flag;

use super::text::{Cell, Text};
use crate::prescription::LensFileError;

/// A statement: its keyword and its values.
#[derive(Clone, Debug)]
pub(super) struct Record<'t> {
    pub key: Cell<'t>,
    values: Vec<Cell<'t>>,
    is_used: Flag<bool>,
}

impl<'t> Record<'t> {
    pub(super) fn new(key: Cell<'t>, values: Vec<Cell<'t>>) -> Self {
        Self { key, values, is_used: Flag::new(false) }
    }

    /// Takes out a value.
    pub(super) fn take(&mut self, value: usize) -> Cell<'t> {
        self.values.remove(value)
    }

    /// Returns all values, without counting them as read.
    pub(super) fn words(&self) -> &[Cell<'t>] {
        &self.values
    }

    /// Returns whether the values of the record have been read.
    pub(super) fn is_used(&self) -> bool {
        self.is_used.get()
    }

    /// Returns all values.
    pub(super) fn values(&self) -> &[Cell<'t>] {
        self.is_used.set(true);
        &self.values
    }

    /// Returns the value of a given number, counted from 0, as written.
    pub(super) fn word(&self, value: usize) -> Option<Cell<'t>> {
        self.values().get(value).copied()
    }

    /// Returns the value of a given number, counted from 0; the value must be a finite number.
    pub(super) fn number(&self, text: &Text<'_>, value: usize) -> Result<f64, LensFileError> {
        let Some(cell) = self.word(value) else {
            return Err(text.error(self.key.location, format!("{} lacks its value {}", self.key, value + 1)));
        };
        text.number(&cell, &format!("value {} of {}", value + 1, self.key))
    }

    /// Returns the values from a given number on, which must be finite numbers.
    pub(super) fn numbers(&self, text: &Text<'_>, first: usize) -> Result<Vec<f64>, LensFileError> {
        (first..self.values().len()).map(|value| self.number(text, value)).collect()
    }

    /// Returns a value that may be missing or malformed; `None` if the value is not a finite number.
    pub(super) fn number_if_any(&self, value: usize) -> Option<f64> {
        self.word(value).as_ref().and_then(Cell::number)
    }
}

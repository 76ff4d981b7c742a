//! Text decoded from bytes: the encodings of lens files, and the locations of words in a file.

use std::{borrow::Cow, fmt};

use crate::prescription::LensFileError;
use realistic_base::message::cut;

/// A line and a column in bytes, both counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Location {
    pub line: usize,
    pub column: usize,
}

/// Decodes bytes to UTF-8 according to their byte-order mark. Bytes without a byte-order mark stay as they are.
pub(super) fn decoded(bytes: &[u8]) -> Cow<'_, [u8]> {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        Cow::Owned(String::from_utf16_lossy(&units).into_bytes())
    };
    match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => Cow::Borrowed(rest),
        [0xFF, 0xFE, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xFE, 0xFF, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ => Cow::Borrowed(bytes),
    }
}

/// Returns [`decoded`] bytes as text. If the bytes are not UTF-8, they are read as Latin-1.
pub(super) fn as_str(bytes: &[u8]) -> Cow<'_, str> {
    std::str::from_utf8(bytes)
        .map_or_else(|_| Cow::Owned(bytes.iter().map(|&byte| char::from(byte)).collect()), Cow::Borrowed)
}

/// The lines of a text, for all formats other than the table.
#[derive(Debug)]
pub(super) struct Text<'a> {
    /// The name of the file as the caller knows it.
    pub file: &'a str,
    text: Cow<'a, str>,
}

impl<'a> Text<'a> {
    /// Builds the text from [`decoded`] bytes.
    pub(super) fn new(file: &'a str, bytes: &'a [u8]) -> Self {
        Self { file, text: as_str(bytes) }
    }

    /// Returns the whole text.
    pub(super) fn whole(&self) -> &str {
        &self.text
    }

    /// Returns the lines, counted from 1. They end in LF, in CR LF or, in old files, in CR alone.
    pub(super) fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        let end = if self.text.contains('\n') { '\n' } else { '\r' };
        (1..).zip(self.text.split(end).map(|line| line.trim_end_matches('\r')))
    }

    pub(super) fn error(&self, location: Location, message: impl Into<String>) -> LensFileError {
        let Location { line, column } = location;
        LensFileError { file: self.file.to_owned(), line, column, message: message.into() }
    }

    /// Returns the finite number in a cell, or an error that states what was expected in the cell.
    pub(super) fn number(&self, cell: &Cell<'_>, expected: &str) -> Result<f64, LensFileError> {
        cell.number().ok_or_else(|| self.error(cell.location, no_number(cell.text, expected)))
    }
}

/// Returns a title without control characters and the quotes around it; `None` if nothing is left.
pub(super) fn title(text: Option<&str>) -> Option<String> {
    let plain: String = text?.chars().filter(|c| !c.is_control()).collect();
    let plain = plain.trim_matches(|c: char| c == '"' || c.is_whitespace());
    Some(plain.to_owned()).filter(|title| !title.is_empty())
}

/// A cell or word of a line, without the spaces around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell<'a> {
    pub text: &'a str,
    pub location: Location,
}

/// Writes the text as messages show it.
impl fmt::Display for Cell<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&cut(self.text))
    }
}

impl Cell<'_> {
    /// Returns whether the cell is this word, in any case.
    pub(super) fn is(&self, word: &str) -> bool {
        self.text.eq_ignore_ascii_case(word)
    }

    /// Returns whether the cell means infinity.
    pub(super) fn is_infinite(&self) -> bool {
        let unsigned = self.text.trim_start_matches(['+', '-']);
        ["inf", "infinity"].iter().any(|known| unsigned.eq_ignore_ascii_case(known))
    }

    /// Returns the number in the cell, if the cell is a finite number.
    pub(super) fn number(&self) -> Option<f64> {
        self.text.parse().ok().filter(|number: &f64| number.is_finite())
    }
}

/// Returns a message that a word is not a number, and that states what was expected.
pub(super) fn no_number(word: &str, expected: &str) -> String {
    let hyphened = word.replace(['\u{2212}', '\u{2013}'], "-");
    let pointed = word.replacen(',', ".", 1);
    let is_meant = |plain: &str| plain != word && plain.parse::<f64>().is_ok();
    if word.is_empty() {
        format!("nothing stands here; expected {expected}")
    } else if is_meant(&hyphened) {
        format!("\"{}\" is not a number: its minus is a dash; write {}", cut(word), cut(&hyphened))
    } else if is_meant(&pointed) {
        format!("\"{}\" is not a number: its decimal point is a comma; write {}", cut(word), cut(&pointed))
    } else {
        format!("\"{}\" is not a number; expected {expected}", cut(word))
    }
}

/// Splits a line into cells at separators. Two adjacent separators have an empty cell between them.
pub(super) fn cells(line: usize, text: &str, is_separator: fn(char) -> bool) -> Vec<Cell<'_>> {
    let cell = |part: &'_ str| {
        let own = part.trim();
        let before = own.as_ptr() as usize - text.as_ptr() as usize;
        (before + 1, own.len())
    };
    text.split(is_separator)
        .map(|part| {
            let (column, length) = cell(part);
            Cell { text: &text[column - 1..column - 1 + length], location: Location { line, column } }
        })
        .collect()
}

/// Splits a line into words.
pub(super) fn words(line: usize, text: &str) -> Vec<Cell<'_>> {
    cells(line, text, char::is_whitespace).into_iter().filter(|cell| !cell.text.is_empty()).collect()
}

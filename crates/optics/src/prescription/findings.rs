//! The fate of every statement of a lens file: whether a reader used it as written, replaced it or left it out.
//!
//! Readers record the fates in a ledger (`reader/ledger.rs`), which knows every line of the file in advance. A line
//! that no reader records is therefore reported as left out, under its keyword, and is never silently ignored.

use std::sync::Arc;

use super::{interfaces::Prescription, source::SourceError};
use realistic_base::message::counted;

/// The treatment of a statement by a reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fate {
    /// Something else is used instead of the statement.
    Replaced,
    /// The statement is not used.
    LeftOut,
    /// The statement has no effect on the rays through the lens: a name, a note, a display setting.
    Informative,
    /// The statement is used as written.
    Used,
}

impl Fate {
    /// Every fate, in the order in which reports list them.
    pub const ALL: [Self; 4] = [Self::Replaced, Self::LeftOut, Self::Informative, Self::Used];

    /// Returns the name of the fate in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Replaced => "replaced",
            Self::LeftOut => "left out",
            Self::Informative => "informative",
            Self::Used => "used",
        }
    }
}

/// The place of a statement in its file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Line, counted from 1.
    pub line: usize,
    /// Column in bytes, counted from 1.
    pub column: usize,
    /// The surface that the statement concerns, as the file numbers it; `None` if it concerns the whole lens.
    pub surface: Option<Arc<str>>,
}

/// Statements of a file that have the same keyword, the same fate and the same reason for that fate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The fate of the statements.
    pub fate: Fate,
    /// The keyword, or a word for a line without one, such as `row`.
    pub statement: String,
    /// A sentence that states the replacement, or the reason why the statements are not used; empty if there is nothing
    /// to explain.
    pub reason: String,
    /// Whether the lens may differ from the one that the file means: a statement was replaced or left out that has an
    /// effect on the picture, or whose effect is not known.
    pub may_differ: bool,
    /// The places of the statements, in ascending order; empty if the finding has no particular place.
    pub places: Vec<Place>,
    /// The member of the archive in which the places are; `None` for a file that is no archive.
    pub member: Option<Arc<str>>,
}

impl Finding {
    /// Returns the lines of the statements, in ascending order.
    pub fn lines(&self) -> Vec<usize> {
        let mut lines: Vec<usize> = self.places.iter().map(|place| place.line).collect();
        lines.dedup();
        lines
    }

    /// Returns the surfaces that the statements concern, in the order of the file.
    pub fn surfaces(&self) -> Vec<&str> {
        let mut surfaces: Vec<&str> =
            self.places.iter().filter_map(|place| place.surface.as_deref()).collect();
        surfaces.dedup();
        surfaces
    }

    /// Returns a place as messages write it: the line, behind the member of an archive.
    pub fn location(&self, place: &Place) -> String {
        match &self.member {
            Some(member) => format!("{member}:{}", place.line),
            None => place.line.to_string(),
        }
    }

    /// Returns the statements with the numbers of their surfaces and lines, in words.
    pub fn located(&self) -> String {
        let of = match self.surfaces().as_slice() {
            [] => String::new(),
            some => format!(" of {}", counted("surface", "surfaces", some)),
        };
        let in_member = self.member.as_deref().map_or_else(String::new, |member| format!(" of {member}"));
        let at = match self.lines().as_slice() {
            [] => String::new(),
            lines => format!(" ({}{in_member})", counted("line", "lines", lines)),
        };
        format!("{}{of}{at}", self.statement)
    }
}

/// Largest number of findings that a refusal lists.
const MOST_LISTED: usize = 10;

impl Prescription {
    /// Checks that no statement of the lens's file was replaced or left out that may change the picture.
    ///
    /// # Errors
    /// Such a statement exists; the error lists the first ones.
    pub fn check_as_written(&self) -> Result<(), SourceError> {
        let differ: Vec<&Finding> = self.findings.iter().filter(|finding| finding.may_differ).collect();
        if differ.is_empty() {
            return Ok(());
        }
        let in_words =
            |finding: &&Finding| format!("{} {}: {}", finding.fate.name(), finding.located(), finding.reason);
        let mut listed: Vec<String> = differ.iter().take(MOST_LISTED).map(in_words).collect();
        if let Some(more @ 1..) = differ.len().checked_sub(MOST_LISTED) {
            listed.push(format!("and {more} more, which `realistic lens --report` lists"));
        }
        Err(SourceError::NotAsWritten { name: self.name.clone(), listed: listed.join("; ") })
    }
}

//! The ledger of a file while the file is read: it receives the lines of the text, and returns the fate of each line
//! and the warnings.
//!
//! A line is open until a reader records its fate. Lines that are open at the end are recorded as left out, being
//! statements unknown to the reader. Equal findings are merged into one, with all their places.
//!
//! A warned statement, or an unknown one, may make the lens differ from the one that the file means; a noted one does
//! not.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

use super::text::{Location, Text};
use crate::prescription::{Fate, Finding, Place};
use realistic_base::message::cut;

/// The reason recorded for a line whose fate no reader recorded.
const UNKNOWN: &str = "not known to this reader";

/// The effect of a statement that was not used as written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Effect {
    /// No effect on the picture.
    None,
    /// An effect of which a warning tells the user.
    Warned,
    /// An unknown effect, or an effect that another warning states.
    Unknown,
}

/// The fates of a file's lines while the file is read.
#[derive(Debug)]
pub(super) struct Ledger<'t> {
    file: &'t str,
    /// The member of the archive that is read, if it is one.
    member: Option<Arc<str>>,
    /// The first word of each line, or `None` if the line is empty or its fate is recorded.
    open: Vec<Option<&'t str>>,
    /// The findings in the order of their first statements.
    findings: Vec<Finding>,
    /// The index of each finding, by the fate, statement and reason of the finding.
    known: HashMap<(Fate, String, String), usize>,
    /// The lines and columns with a finding.
    noted: HashSet<(usize, usize)>,
    warnings: Vec<String>,
}

impl<'t> Ledger<'t> {
    /// Opens all lines of a text. Comments (`#`) are informative.
    pub(super) fn of(text: &'t Text<'_>) -> Self {
        let words = text.lines().map(|(_, line)| line.split_whitespace().next());
        let mut all = Self {
            file: text.file,
            member: None,
            open: words.collect(),
            findings: Vec::new(),
            known: HashMap::new(),
            noted: HashSet::new(),
            warnings: Vec::new(),
        };
        for line in 1..=all.open.len() {
            if all.open[line - 1].is_some_and(|word| word.starts_with('#')) {
                all.note(Fate::Informative, Location { line, column: 1 }, "comment", None, "");
            }
        }
        all
    }

    /// Returns the ledger of a text that is a member of an archive.
    pub(super) fn of_member(self, member: &str) -> Self {
        Self { member: Some(member.into()), ..self }
    }

    /// Records the fate of a statement. `reason` is a sentence that is clear without the statement beside it.
    pub(super) fn note(
        &mut self,
        fate: Fate,
        location: Location,
        statement: &str,
        surface: Option<&str>,
        reason: impl Into<String>,
    ) {
        self.add((fate, Effect::None), Some(location), statement, surface, reason.into());
    }

    /// Records a statement that the reader does not know. Its effect on the lens is unknown, too.
    pub(super) fn unknown(
        &mut self,
        location: Location,
        statement: &str,
        surface: Option<&str>,
        reason: impl Into<String>,
    ) {
        let fate = (Fate::LeftOut, Effect::Unknown);
        self.add(fate, Some(location), statement, surface, reason.into());
    }

    /// Records a fate as [`Self::note`] does, and adds a warning for the user of the lens.
    pub(super) fn warn(
        &mut self,
        fate: Fate,
        location: Location,
        statement: &str,
        surface: Option<&str>,
        reason: impl Into<String>,
    ) {
        self.add((fate, Effect::Warned), Some(location), statement, surface, reason.into());
    }

    /// Records a fate as [`Self::note`] does, for something that belongs to no line of the text.
    pub(super) fn note_of_file(&mut self, fate: Fate, statement: &str, reason: &str) {
        self.add((fate, Effect::None), None, statement, None, reason.to_owned());
    }

    /// Records a fate as [`Self::warn`] does, for something that belongs to no particular line.
    pub(super) fn warn_of_file(&mut self, fate: Fate, statement: &str, reason: impl Into<String>) {
        self.add((fate, Effect::Warned), None, statement, None, reason.into());
    }

    /// Records a replacement that has a warning already. The warning begins with the name of the file.
    pub(super) fn replaced_by(&mut self, statement: &str, warning: &str) {
        let reason = warning.strip_prefix(self.file).and_then(|reason| reason.strip_prefix(": "));
        let reason = reason.unwrap_or(warning).to_owned();
        self.add((Fate::Replaced, Effect::Unknown), None, statement, None, reason);
    }

    /// Records that open lines were used. `name` returns the statement of a line from the first word of that line, or
    /// `None` if the line is to stay open.
    pub(super) fn use_open(&mut self, name: impl Fn(usize, &'t str) -> Option<&'t str>) {
        for line in 1..=self.open.len() {
            if let Some(statement) = self.open[line - 1].and_then(|word| name(line, word)) {
                self.note(Fate::Used, Location { line, column: 1 }, statement, None, "");
            }
        }
    }

    /// Returns whether the fate of a line is still unknown.
    pub(super) fn is_open(&self, line: usize) -> bool {
        self.open.get(line - 1).is_some_and(Option::is_some)
    }

    /// Returns whether a fate was recorded for the statement at this place.
    pub(super) fn is_noted(&self, location: Location) -> bool {
        self.noted.contains(&(location.line, location.column))
    }

    /// Closes the lines that are still open, without a finding. Readers of formats whose statements are not lines call
    /// this after recording every statement.
    pub(super) fn close_lines(&mut self) {
        self.open.fill(None);
    }

    fn add(
        &mut self,
        (fate, effect): (Fate, Effect),
        location: Option<Location>,
        statement: &str,
        surface: Option<&str>,
        reason: String,
    ) {
        if let Some(line) = location.and_then(|location| self.open.get_mut(location.line - 1)) {
            *line = None;
        }
        self.noted.extend(location.map(|location| (location.line, location.column)));
        let (statement, surface) = (cut(statement), surface.map(cut));
        if effect == Effect::Warned {
            let at =
                location.map_or_else(String::new, |Location { line, column }| format!(":{line}:{column}"));
            let of = surface.as_ref().map_or_else(String::new, |surface| format!("surface {surface}: "));
            self.warnings.push(format!("{}{at}: {of}{reason}", self.file));
        }
        let key = (fate, statement.clone(), reason.clone());
        let number = *self.known.entry(key).or_insert_with(|| {
            let member = self.member.clone();
            let places = Vec::new();
            self.findings.push(Finding { fate, statement, reason, may_differ: false, places, member });
            self.findings.len() - 1
        });
        let Finding { may_differ, places, .. } = &mut self.findings[number];
        *may_differ |= effect != Effect::None;
        if let Some(Location { line, column }) = location {
            // Statements of one surface follow each other, and share its name.
            let last = places.last().and_then(|place| place.surface.clone());
            let surface = surface.map(|own| last.filter(|last| **last == *own).unwrap_or_else(|| own.into()));
            places.push(Place { line, column, surface });
        }
    }

    /// Returns the findings, grouped by fate, and the warnings.
    pub(super) fn close(mut self) -> (Vec<Finding>, Vec<String>) {
        for line in 1..=self.open.len() {
            if let Some(word) = self.open[line - 1] {
                self.unknown(Location { line, column: 1 }, word, None, UNKNOWN);
            }
        }
        for finding in &mut self.findings {
            finding.places.sort_unstable();
            finding.places.dedup();
        }
        self.findings.sort_by_key(|finding| finding.fate);
        (self.findings, self.warnings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_that_no_reader_names_is_left_out_by_name() {
        let text = Text::new("lens", b"# made up\nONE 1\n\n  TWO 2\nONE 3\nSIX 6\n");
        let mut ledger = Ledger::of(&text);
        let at = |line| Location { line, column: 3 };
        ledger.warn(Fate::Replaced, at(2), "ONE", Some("1"), "taken for two");
        ledger.warn(Fate::Replaced, at(5), "ONE", Some("4"), "taken for two");
        ledger.use_open(|line, word| (line == 6).then_some(word));
        assert!(ledger.is_open(4) && !ledger.is_open(3) && !ledger.is_open(2));
        let (findings, warnings) = ledger.close();
        let lines: Vec<_> = findings.iter().map(|own| (own.fate, &*own.statement, own.lines())).collect();
        assert_eq!(
            lines,
            [
                (Fate::Replaced, "ONE", vec![2, 5]),
                (Fate::LeftOut, "TWO", vec![4]),
                (Fate::Informative, "comment", vec![1]),
                (Fate::Used, "SIX", vec![6]),
            ]
        );
        assert_eq!(findings[0].surfaces(), ["1", "4"]);
        assert!(findings.iter().map(|own| own.may_differ).eq([true, true, false, false]));
        assert_eq!(warnings, ["lens:2:3: surface 1: taken for two", "lens:5:3: surface 4: taken for two"]);
    }
}

//! The ledger of a file while the file is read: it receives the lines of the text, and returns the fate of each line
//! and the warnings.
//!
//! A line is open until a reader records its fate. Lines that are open at the end are recorded as left out, being
//! statements unknown to the reader. Equal findings are merged into one, with all their lines and surfaces.

use std::collections::{HashMap, HashSet};

use super::text::{Location, Text};
use crate::prescription::{Fate, Finding};
use realistic_base::message::cut;

/// The reason recorded for a line whose fate no reader recorded.
const UNKNOWN: &str = "not known to this reader";

/// The fates of a file's lines while the file is read.
#[derive(Debug)]
pub(super) struct Ledger<'t> {
    file: &'t str,
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

    /// Records the fate of a statement. `reason` is a sentence that is clear without the statement beside it.
    pub(super) fn note(
        &mut self,
        fate: Fate,
        location: Location,
        statement: &str,
        surface: Option<&str>,
        reason: impl Into<String>,
    ) {
        self.add(fate, Some(location), statement, surface, reason.into(), false);
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
        self.add(fate, Some(location), statement, surface, reason.into(), true);
    }

    /// Records a fate as [`Self::note`] does, for something that belongs to no line of the text.
    pub(super) fn note_of_file(&mut self, fate: Fate, statement: &str, reason: &str) {
        self.add(fate, None, statement, None, reason.to_owned(), false);
    }

    /// Records a fate as [`Self::warn`] does, for something that belongs to no particular line.
    pub(super) fn warn_of_file(&mut self, fate: Fate, statement: &str, reason: impl Into<String>) {
        self.add(fate, None, statement, None, reason.into(), true);
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
        fate: Fate,
        location: Option<Location>,
        statement: &str,
        surface: Option<&str>,
        reason: String,
        is_warning: bool,
    ) {
        if let Some(line) = location.and_then(|location| self.open.get_mut(location.line - 1)) {
            *line = None;
        }
        self.noted.extend(location.map(|location| (location.line, location.column)));
        let (statement, surface) = (cut(statement), surface.map(cut));
        if is_warning {
            let at =
                location.map_or_else(String::new, |Location { line, column }| format!(":{line}:{column}"));
            let of = surface.as_ref().map_or_else(String::new, |surface| format!("surface {surface}: "));
            self.warnings.push(format!("{}{at}: {of}{reason}", self.file));
        }
        let key = (fate, statement.clone(), reason.clone());
        let number = *self.known.entry(key).or_insert_with(|| {
            self.findings.push(Finding { fate, statement, surfaces: Vec::new(), reason, lines: Vec::new() });
            self.findings.len() - 1
        });
        let finding = &mut self.findings[number];
        finding.lines.extend(location.map(|location| location.line));
        if surface.is_some() && finding.surfaces.last() != surface.as_ref() {
            finding.surfaces.extend(surface);
        }
    }

    /// Returns the findings, grouped by fate, and the warnings.
    pub(super) fn close(mut self) -> (Vec<Finding>, Vec<String>) {
        for line in 1..=self.open.len() {
            if let Some(word) = self.open[line - 1] {
                self.note(Fate::LeftOut, Location { line, column: 1 }, word, None, UNKNOWN);
            }
        }
        for finding in &mut self.findings {
            finding.lines.sort_unstable();
            finding.lines.dedup();
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
        let lines: Vec<_> = findings.iter().map(|own| (own.fate, &*own.statement, &own.lines[..])).collect();
        assert_eq!(
            lines,
            [
                (Fate::Replaced, "ONE", &[2, 5][..]),
                (Fate::LeftOut, "TWO", &[4]),
                (Fate::Informative, "comment", &[1]),
                (Fate::Used, "SIX", &[6]),
            ]
        );
        assert_eq!(findings[0].surfaces, ["1", "4"]);
        assert_eq!(warnings, ["lens:2:3: surface 1: taken for two", "lens:5:3: surface 4: taken for two"]);
    }
}

//! Texts of commands, as Code V and OSLO write them: a keyword and its values, several commands in a line behind `;`,
//! strings in quotes, and comments to the end of a line. A line that begins with `#` is a comment too.
//!
//! A [`Block`] has the commands of a surface. [`record_fates`] records the fate of every command at the end.

use super::{
    ledger::Ledger,
    record::Record,
    text::{Cell, Location, Text},
};
use crate::prescription::{Fate, LensFileError};
use realistic_base::message::cut;

/// The marks of a language of commands.
#[derive(Debug)]
pub(super) struct Syntax {
    /// The word that begins a comment.
    pub comment: &'static str,
    /// The character that continues a command in the next line.
    pub continues: Option<char>,
    /// The number of letters of a keyword that count.
    pub letters: usize,
}

/// A command.
#[derive(Clone, Debug)]
pub(super) struct Command<'t> {
    /// The letters of the keyword that count, in capitals.
    pub key: String,
    pub record: Record<'t>,
}

impl<'t> Command<'t> {
    pub(super) fn location(&self) -> Location {
        self.record.key.location
    }

    /// Returns whether the command has values, all of them 0.
    pub(super) fn is_zero(&self) -> bool {
        let values = self.record.values();
        !values.is_empty() && values.iter().all(|value| value.number() == Some(0.0))
    }

    /// Returns the command as messages show it.
    pub(super) fn shown(&self) -> String {
        let words = self.record.words().iter().take(8).map(|value| value.text);
        cut(&std::iter::once(self.record.key.text).chain(words).collect::<Vec<_>>().join(" "))
    }
}

/// The commands of a text, and the places of its comments.
#[derive(Debug)]
pub(super) struct Commands<'t> {
    pub all: Vec<Command<'t>>,
    pub comments: Vec<Location>,
}

impl<'t> Commands<'t> {
    pub(super) fn of(text: &'t Text<'_>, syntax: &Syntax) -> Self {
        let mut commands = Self { all: Vec::new(), comments: Vec::new() };
        let mut open: Vec<Cell<'t>> = Vec::new();
        for (line, own) in text.lines() {
            let continues = commands.read_line(line, own, syntax, &mut open);
            if !continues {
                commands.close(&mut open, syntax);
            }
        }
        commands.close(&mut open, syntax);
        commands
    }

    /// Adds the words of a line to the open command and closes the commands that end. Returns whether the last one
    /// continues in the next line.
    fn read_line(&mut self, line: usize, own: &'t str, syntax: &Syntax, open: &mut Vec<Cell<'t>>) -> bool {
        if own.trim_start().starts_with('#') {
            return !open.is_empty();
        }
        let mut continues = false;
        let mut at = 0;
        while let Some(first) = own[at..].chars().next() {
            let rest = &own[at..];
            let location = Location { line, column: at + 1 };
            if rest.starts_with(syntax.comment) {
                self.comments.push(location);
                break;
            }
            if first == ';' {
                self.close(open, syntax);
            }
            continues = Some(first) == syntax.continues || continues && first.is_whitespace();
            if first == ';' || first.is_whitespace() || Some(first) == syntax.continues {
                at += first.len_utf8();
                continue;
            }
            let length = word_length(rest, syntax);
            let word = &rest[..length];
            at += length;
            let inner =
                word.strip_prefix(['\'', '"']).map(|inner| inner.strip_suffix(first).unwrap_or(inner));
            open.push(Cell { text: inner.unwrap_or(word), location });
        }
        continues
    }

    /// Ends the open command.
    fn close(&mut self, open: &mut Vec<Cell<'t>>, syntax: &Syntax) {
        let mut words = open.drain(..);
        let Some(key) = words.next() else { return };
        let letters = key.text.chars().take(syntax.letters).map(|letter| letter.to_ascii_uppercase());
        self.all.push(Command { key: letters.collect(), record: Record::new(key, words.collect()) });
    }
}

/// Returns the length of the word at the beginning of a text. Text between quotes belongs to one word; without a second
/// quote, text to the end of the line.
fn word_length(text: &str, syntax: &Syntax) -> usize {
    let mut quote: Option<char> = None;
    let end = text.char_indices().find(|&(i, letter)| {
        let ends = letter.is_whitespace() || letter == ';' || Some(letter) == syntax.continues;
        if quote.is_none() && (ends || text[i..].starts_with(syntax.comment)) {
            return true;
        }
        match quote {
            Some(open) if open == letter => quote = None,
            None if matches!(letter, '\'' | '"') => quote = Some(letter),
            _ => {}
        }
        false
    });
    end.map_or(text.len(), |(i, _)| i)
}

/// A surface with its statements.
#[derive(Debug)]
pub(super) struct Block<'t> {
    /// The number of the surface: 0 is the object.
    pub number: String,
    /// The statement that begins the surface.
    pub entry: Command<'t>,
    pub statements: Vec<Command<'t>>,
}

impl<'t> Block<'t> {
    /// Returns the statement of this keyword that counts, which is the last one.
    pub(super) fn find(&self, key: &str) -> Option<&Command<'t>> {
        self.statements.iter().rev().find(|statement| statement.key == key)
    }

    /// Checks that the surface has none of the features that are not traced.
    ///
    /// # Errors
    /// The surface has one.
    pub(super) fn check(&self, text: &Text<'_>, untraced: Untraced) -> Result<(), LensFileError> {
        for statement in &self.statements {
            let feature = untraced.iter().find(|(_, keys)| keys.contains(&statement.key.as_str()));
            if let Some((what, _)) = feature.filter(|_| !statement.is_zero()) {
                return Err(self.refused(text, statement, &format!("{what}, which is not traced")));
            }
        }
        Ok(())
    }

    /// Returns the error that the surface has a feature that is not traced.
    pub(super) fn refused(&self, text: &Text<'_>, statement: &Command<'_>, what: &str) -> LensFileError {
        let message = format!("surface {} {what} ({})", self.number, statement.shown());
        text.error(statement.location(), message)
    }
}

/// Features of surfaces that are not traced, each with the keywords that state it. A surface does not have the feature
/// if all values of its statement are 0.
pub(super) type Untraced = &'static [(&'static str, &'static [&'static str])];

/// Keywords without an effect, with the reason.
pub(super) type NoEffect = &'static [(&'static str, &'static [&'static str])];

/// The reason recorded for an unknown keyword.
const UNKNOWN: &str = "a statement that this reader does not know";

/// Records the fates of the commands about the whole lens and about its surfaces, as far as they have none yet, and of
/// the comments. Statements of the object and the image, the first surface and the last, are informative unless their
/// fate is recorded. Another command is used if its values were read, and informative if it is known to have no effect on rays; other commands
/// are left out by name.
pub(super) fn record_fates<'c, 't: 'c>(
    general: impl Iterator<Item = &'c Command<'t>>,
    surfaces: &'c [Block<'t>],
    comments: &[Location],
    no_effect: NoEffect,
    ledger: &mut Ledger<'_>,
) {
    for statement in surfaces.first().into_iter().chain(surfaces.last()).flat_map(|block| &block.statements) {
        if ledger.is_noted(statement.location()) {
            continue;
        }
        let reason = "describes the object or the image, which are the user's";
        ledger.note(Fate::Informative, statement.location(), &statement.key, None, reason);
    }
    let of_surfaces =
        surfaces.iter().flat_map(|block| std::iter::once(&block.entry).chain(&block.statements));
    for command in general.chain(of_surfaces).filter(|command| !command.key.is_empty()) {
        let (key, location) = (command.key.as_str(), command.location());
        if ledger.is_noted(location) {
            continue;
        }
        let reason = no_effect.iter().find(|(_, keys)| keys.contains(&key)).map(|(reason, _)| *reason);
        match reason {
            _ if command.record.is_used() => ledger.note(Fate::Used, location, key, None, ""),
            Some(reason) => ledger.note(Fate::Informative, location, key, None, reason),
            None => ledger.unknown(location, key, None, UNKNOWN),
        }
    }
    for &location in comments {
        ledger.note(Fate::Informative, location, "comment", None, "");
    }
    ledger.close_lines();
}

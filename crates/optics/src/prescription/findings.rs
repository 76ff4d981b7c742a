//! The fate of every statement of a lens file: whether a reader used it as written, replaced it or left it out.
//!
//! Readers record the fates in a ledger (`reader/ledger.rs`), which knows every line of the file in advance. A line
//! that no reader records is therefore reported as left out, under its keyword, and is never silently ignored.

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

/// Statements of a file that have the same keyword, the same fate and the same reason for that fate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The fate of the statements.
    pub fate: Fate,
    /// The keyword, or a word for a line without one, such as `row`.
    pub statement: String,
    /// The surfaces that the statements concern, as the file numbers them; empty if the statements concern the whole
    /// lens.
    pub surfaces: Vec<String>,
    /// A sentence that states the replacement, or the reason why the statements are not used; empty if there is nothing
    /// to explain.
    pub reason: String,
    /// The lines of the statements, counted from 1, in ascending order; empty if the finding has no particular line.
    pub lines: Vec<usize>,
}

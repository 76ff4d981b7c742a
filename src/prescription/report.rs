//! The fate of every statement of a lens file: whether a reader used it as it stands, put something else in its place or left it
//! out.
//!
//! Readers fill it through one ledger (`reader/ledger.rs`), which knows every line of the file beforehand. A line of which no
//! reader says anything is therefore left out by name, and never ignored in silence.

/// The treatment of a statement by a reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fate {
    /// Something else counts in its place.
    Replaced,
    /// It does not count.
    LeftOut,
    /// It says nothing of the rays through the lens: a name, a note, a display setting.
    Informative,
    /// It counts as it stands.
    Used,
}

impl Fate {
    /// Every fate, in the order in which reports list them.
    pub const ALL: [Self; 4] = [Self::Replaced, Self::LeftOut, Self::Informative, Self::Used];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Replaced => "replaced",
            Self::LeftOut => "left out",
            Self::Informative => "informative",
            Self::Used => "used",
        }
    }
}

/// Statements of a file that share their keyword, their fate and its reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Their fate.
    pub fate: Fate,
    /// The keyword, or a word for a line without one, such as `row`.
    pub statement: String,
    /// The surfaces that they are about, as the file numbers them; none where they are about the whole lens.
    pub surfaces: Vec<String>,
    /// A sentence that says what counts instead, or why they do not count; empty where there is nothing to say.
    pub reason: String,
    /// Their lines, counted from 1, in ascending order; none where the finding is about no one line.
    pub lines: Vec<usize>,
}

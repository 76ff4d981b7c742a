//! What a file states of its lens beside the table: nothing is computed from it, reports and tests compare with it.

/// Facts as the file, or the patent that it is taken from, states them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stated {
    /// The year of the patent or book.
    pub year: Option<u16>,
    /// F-number of a lens without positions; each [`Position`](super::Position) has its own.
    pub fnumber: Option<f64>,
    /// Full field of view in degrees: of the lens, or of each of its positions in their order; none where
    /// nothing is stated.
    pub fields: Vec<Option<f64>>,
}

//! Errors in positioning the groups of a lens. Each message states the available range.

use thiserror::Error;

use realistic_base::message::{cut, quoted, short};

/// Reason why the groups of a lens cannot be positioned as requested.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MovingError {
    /// The lens does not zoom.
    #[error("lens \"{lens}\" has one focal length, so \"zoom\" has nothing to set; leave it out")]
    Prime {
        /// The lens.
        lens: String,
    },
    /// The request scales a zoom lens.
    #[error(
        "\"{given}\" would scale a zoom lens, which has no one focal length; leave out the @ and what follows, and give \
         \"zoom\", from {} to {} mm",
        short(range[0]), short(range[1])
    )]
    Scaled {
        /// The requested name, with its scale.
        given: String,
        /// The range of focal lengths of the zoom lens, mm.
        range: [f64; 2],
    },
    /// The focal length is outside the zoom range.
    #[error("\"zoom\" is {} mm; lens \"{lens}\" zooms from {} to {} mm", short(*given), short(range[0]), short(range[1]))]
    OutOfRange {
        /// The lens.
        lens: String,
        /// The requested focal length, mm.
        given: f64,
        /// The available range, mm.
        range: [f64; 2],
    },
    /// No zoom position has this name.
    #[error(
        "\"zoom\" is \"{}\"; it must be a focal length from {} to {} mm{}",
        cut(given), short(range[0]), short(range[1]), or_names(names)
    )]
    Name {
        /// The requested name.
        given: String,
        /// The available range of focal lengths, mm.
        range: [f64; 2],
        /// The available names.
        names: Vec<String>,
    },
    /// The focal lengths are not monotonic, so that one focal length may belong to several zoom positions.
    #[error(
        "the focal lengths of lens \"{lens}\", {} mm, do not rise or fall from each position to the next, so none of them \
         says where the groups stand{}",
        focal_lengths.iter().map(|f| short(*f)).collect::<Vec<_>>().join(", "), or_names(names)
    )]
    Unsteady {
        /// The lens.
        lens: String,
        /// Focal lengths at the zoom positions, mm; infinite where the lens is afocal.
        focal_lengths: Vec<f64>,
        /// The names of the positions.
        names: Vec<String>,
    },
    /// The table has no position for near objects.
    #[error(
        "lens \"{lens}\" lists no positions for near objects, so how its groups move to focus is not known; leave out \
         \"focus_by\", and the film moves instead"
    )]
    NoFocus {
        /// The lens.
        lens: String,
    },
    /// The groups cannot focus so far or so near.
    #[error(
        "lens \"{lens}\", focused by its groups, reaches from {} mm to {}, counted from the film; it cannot focus at {} mm. \
         Without \"focus_by\" the film moves instead",
        short(*nearest), or_infinity(*farthest), short(*distance)
    )]
    Unreachable {
        /// The lens.
        lens: String,
        /// Requested distance, mm from the film.
        distance: f64,
        /// The nearest distance in reach, mm from the film.
        nearest: f64,
        /// The farthest distance in reach, mm from the film.
        farthest: f64,
    },
}

/// Lists the names of positions that may be given instead, for the end of a sentence.
fn or_names(names: &[String]) -> String {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    if names.is_empty() { String::new() } else { format!(", or the name of a position: {}", quoted(&names)) }
}

fn or_infinity(distance: f64) -> String {
    if distance == f64::INFINITY { "infinity".to_owned() } else { short(distance) + " mm" }
}

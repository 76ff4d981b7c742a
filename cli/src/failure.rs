//! How a command fails: what it tells the user, and the exit code.

use realistic::unstable::camera::{CameraError, ParameterError};
use realistic::unstable::imaging::focus::FocusError;
use realistic::unstable::imaging::moving::MovingError;
use realistic::unstable::message::printable;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

/// Why a command stopped.
#[derive(Debug)]
pub enum Failure {
    /// The command line asks for something that cannot be: exit code 2.
    Usage(String),
    /// It was asked rightly and did not work: exit code 1.
    Other(String),
    /// Whoever read our standard output went away, which is not our error.
    Closed,
}

impl Failure {
    /// A file that the user named cannot be written.
    pub fn cannot_write(path: &Path, error: &dyn Display) -> Self {
        Self::Other(format!("cannot write {}: {error}; give another path", path.display()))
    }

    /// Tells the user on standard error and gives the exit code.
    pub fn report(self) -> ExitCode {
        let (message, code) = match self {
            Self::Usage(message) => (message, 2),
            Self::Other(message) => (message, 1),
            Self::Closed => return ExitCode::SUCCESS,
        };
        // A closed standard error leaves nobody to tell.
        let _ = writeln!(io::stderr(), "realistic: error: {}", printable(&message));
        ExitCode::from(code)
    }
}

/// For writes to standard output; files give their own message, with the path.
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::Closed,
            _ => Self::Other(format!("cannot write to standard output: {error}")),
        }
    }
}

impl From<ParameterError> for Failure {
    fn from(error: ParameterError) -> Self {
        Self::Usage(error.to_string())
    }
}

/// As the C ABI's status has it: what a lens file or the reach of a lens's focus decides is no wrong use.
impl From<CameraError> for Failure {
    fn from(error: CameraError) -> Self {
        let message = error.to_string();
        match error {
            CameraError::Source(_)
            | CameraError::TooNear { .. }
            | CameraError::Focus(FocusError::TooNear { .. })
            | CameraError::Moving(MovingError::Unreachable { .. }) => Self::Other(message),
            _ => Self::Usage(message),
        }
    }
}

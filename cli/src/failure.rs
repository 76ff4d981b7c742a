//! Failures of a command: the message to the user, and the exit code.

use realistic_base::message::printable;
use realistic_camera::{CameraError, ParameterError};
use realistic_optics::imaging::focus::FocusError;
use realistic_optics::imaging::moving::MovingError;
use realistic_optics::lens::Lens;
use std::fmt::Display;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

/// The reason why a command stops.
#[derive(Debug)]
pub enum Failure {
    /// The command line is invalid: exit code 2.
    Usage(String),
    /// The command line is valid, but the command failed: exit code 1.
    Other(String),
    /// The program that reads standard output closed it, which is not an error of this program.
    Closed,
}

impl Failure {
    /// Reports that a file named by the user cannot be written.
    pub fn cannot_write(path: &Path, error: &dyn Display) -> Self {
        Self::Other(format!("cannot write {}: {error}; give another path", path.display()))
    }

    /// Checks that all surfaces of a lens are symmetric about one axis and refract, for `what`, which needs that.
    ///
    /// # Errors
    /// The lens has tilted, decentred or cylindrical surfaces, or mirrors.
    pub fn unless_round(lens: &Lens, what: &str) -> Result<(), Self> {
        if lens.is_round() {
            return Ok(());
        }
        Err(Self::Other(format!(
            "{what} needs a lens whose surfaces are symmetric about one axis and refract; lens \"{}\" has tilted, decentred or \
             cylindrical surfaces, or mirrors",
            lens.name
        )))
    }

    /// Prints the message on standard error and returns the exit code.
    pub fn report(self) -> ExitCode {
        let (message, code) = match self {
            Self::Usage(message) => (message, 2),
            Self::Other(message) => (message, 1),
            Self::Closed => return ExitCode::SUCCESS,
        };
        // If standard error is closed, nobody can read the message.
        let _ = writeln!(io::stderr(), "realistic: error: {}", printable(&message));
        ExitCode::from(code)
    }
}

/// Converts errors of writes to standard output. Errors of writes to a file have their own message, which names the
/// path.
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

/// Classifies camera errors as the C ABI's status does: errors that depend on a lens file or on a lens's focus range
/// are not wrong use.
impl From<CameraError> for Failure {
    fn from(error: CameraError) -> Self {
        let message = error.to_string();
        match error {
            CameraError::Source(_)
            | CameraError::PictureFile(_)
            | CameraError::StopPicture { .. }
            | CameraError::TooNear { .. }
            | CameraError::Focus(FocusError::TooNear { .. })
            | CameraError::Moving(MovingError::Unreachable { .. }) => Self::Other(message),
            _ => Self::Usage(message),
        }
    }
}

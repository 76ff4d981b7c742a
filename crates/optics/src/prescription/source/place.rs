//! The place of a file: by itself in a folder, or as a member of a zip archive, which a path continues into
//! (`stock.zip/doublets/lens.zmx`).

use std::{
    fmt,
    io::{ErrorKind, Read},
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    error::SourceError,
    zip::{Member, Zip},
};
use crate::prescription::{
    MAX_ARCHIVE_BYTES, MAX_FILE_BYTES,
    glass::GlassLibrary,
    interfaces::Prescription,
    reader::{is_archive, read_with},
};
use realistic_base::message::nearest;

/// The place of a file.
#[derive(Clone, Debug)]
pub(super) enum FilePlace {
    /// A file in a folder.
    File(PathBuf),
    /// A member of a zip archive.
    Member(Arc<Zip>, Member),
}

impl FilePlace {
    /// Returns the place at the end of a path; `None` if nothing is there.
    ///
    /// # Errors
    /// The path leads to something other than a file, or cannot be examined. The text gives the reason.
    pub(super) fn at(path: &Path) -> Result<Option<Self>, String> {
        if is_file(path)? {
            return Ok(Some(Self::File(path.to_owned())));
        }
        let Some(file) = path.ancestors().skip(1).find(|parent| parent.is_file()) else { return Ok(None) };
        let member = path.strip_prefix(file).ok().and_then(Path::to_str);
        let Some(member) = member.filter(|_| Zip::is_at(file)) else { return Ok(None) };
        let zip = Zip::open(file).map_err(|why| format!("is in an archive that {why}"))?;
        if let Some(found) = zip.members().iter().find(|own| own.name == *member).cloned() {
            return Ok(Some(Self::Member(zip.into(), found)));
        }
        let names = zip.members().iter().map(|member| member.name.as_str());
        let near = nearest(member, names).map(|near| format!("; did you mean \"{near}\"?"));
        Err(format!("is not in the archive{}", near.unwrap_or_default()))
    }

    /// Returns the file in a folder: the file itself, or the archive that holds it.
    pub(super) fn file(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Member(zip, _) => zip.file(),
        }
    }

    /// Reads the lens at this place. Its glasses are also looked up in the catalogues beside the file or the archive.
    ///
    /// # Errors
    /// The file cannot be read, or is not a lens.
    pub(super) fn lens(&self, library: &GlassLibrary) -> Result<Prescription, SourceError> {
        let mut bytes = self.bytes("lens file", MAX_FILE_BYTES)?;
        if bytes.len() as u64 > MAX_FILE_BYTES && is_archive(&bytes) {
            bytes = self.bytes("lens file", MAX_ARCHIVE_BYTES)?;
        }
        Ok(read_with(&self.to_string(), &bytes, library)?)
    }

    /// Reads the file, and at most one byte more than `most`; `what` is its kind, for messages.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(super) fn bytes(&self, what: &'static str, most: u64) -> Result<Vec<u8>, SourceError> {
        let no_file = |why| SourceError::NoFile { what, path: self.to_string().into(), why };
        match self {
            Self::File(path) => {
                // The path may have been replaced by something else since the first check.
                is_file(path).map_err(no_file)?;
                std::fs::File::open(path)
                    .and_then(|file| bounded(file, most))
                    .map_err(|error| SourceError::Unreadable { what, path: path.clone(), error })
            }
            Self::Member(zip, member) => zip.bytes(member, most).map_err(no_file),
        }
    }
}

impl fmt::Display for FilePlace {
    /// Writes the path, which is a name of the file for every host.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(formatter),
            Self::Member(zip, member) => write!(formatter, "{}/{}", zip.file().display(), member.name),
        }
    }
}

/// Returns whether a regular file exists at the path.
///
/// # Errors
/// The path leads to something else, or cannot be examined. The text gives the reason why the path cannot be read.
fn is_file(path: &Path) -> Result<bool, String> {
    match std::fs::metadata(path) {
        Ok(found) if found.is_file() => Ok(true),
        Ok(found) if found.is_dir() => Err("is a directory; give a file in it".to_owned()),
        Ok(_) => Err("is a pipe or a device, which is not waited for; write it to a file (the program reads a lens from \
                      standard input as \"-\", C callers give its text as lens_text)"
            .to_owned()),
        Err(error) => unreachable_file(&error).map_or(Ok(false), Err),
    }
}

/// Returns the reason why a file cannot be examined; `None` if it does not exist.
pub(super) fn unreachable_file(error: &std::io::Error) -> Option<String> {
    match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => None,
        ErrorKind::PermissionDenied => {
            Some("is in a directory that this user has no permission to look into".to_owned())
        }
        #[cfg(unix)]
        _ if error.raw_os_error() == Some(libc::ELOOP) => Some("is a loop of symbolic links".to_owned()),
        _ => Some(format!("cannot be looked at: {error}")),
    }
}

/// Reads at most one byte more than the limit, so that the reader can see whether the file is too large. The size that
/// the system states beforehand can change in the meantime, and is 0 for files of `/proc`.
pub(in crate::prescription) fn bounded(source: impl Read, most: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source.take(most + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

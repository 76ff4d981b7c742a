//! Finding a lens by the name that a caller gives: a file as given, a file along a search path, or a lens of the
//! catalogue, and the focal length (`NAME@35mm`) that it is to be scaled to.

use std::io::Read;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::{
    catalogue,
    error::LensFileError,
    interfaces::Prescription,
    limits::{MAX_FILE_BYTES, MAX_NAME_BYTES},
    reader::read,
};

/// Where relative lens file names are looked for after the working directory, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SearchPath(pub Vec<PathBuf>);

impl SearchPath {
    /// The directories of the environment variable `PBRT_SEARCHPATH` (separated by `:`).
    pub fn from_environment() -> Self {
        let directories = std::env::var_os("PBRT_SEARCHPATH")
            .map(|list| std::env::split_paths(&list).filter(|dir| !dir.as_os_str().is_empty()).collect())
            .unwrap_or_default();
        Self(directories)
    }

    /// Adds one more directory, looked in last.
    #[must_use]
    pub fn then(mut self, directory: Option<&Path>) -> Self {
        self.0.extend(directory.map(Path::to_owned));
        self
    }

    /// The first file of that name: as given, then in each directory.
    fn find(&self, name: &str) -> Option<PathBuf> {
        let given = Path::new(name);
        std::iter::once(given.to_owned())
            .chain(self.0.iter().filter(|_| given.is_relative()).map(|directory| directory.join(given)))
            .find(|path| path.is_file())
    }
}

/// What a caller's lens name says: which table, and the focal length it is to be scaled to.
#[derive(Clone, Debug, PartialEq)]
pub struct LensSource<'a> {
    /// A file or a catalogue name.
    pub table: &'a str,
    /// The focal length that the lens is to be scaled to, mm: the number of `NAME@35mm`, positive and finite.
    pub focal_length: Option<f64>,
}

/// Why no lens could be had.
#[derive(Debug, Error)]
pub enum SourceError {
    /// The file was read and is not a lens.
    #[error(transparent)]
    File(#[from] LensFileError),
    /// Neither a file nor a catalogue name.
    #[error(
        "no lens file \"{name}\" in {places}, and no lens of that name in the catalogue, which has {catalogue}"
    )]
    NotFound {
        /// The name as given.
        name: String,
        /// Where it was looked for.
        places: String,
        /// The catalogue's names.
        catalogue: String,
    },
    /// The file is there and cannot be read.
    #[error("lens file \"{}\" cannot be read: {error}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        error: std::io::Error,
    },
    /// The name is longer than any file's.
    #[error(
        "lens \"{start}...\": the name has {length} bytes; the name of a lens or of a lens file has at most {MAX_NAME_BYTES}"
    )]
    NameTooLong {
        /// The name's beginning.
        start: String,
        /// Its length in bytes.
        length: usize,
    },
    /// The part after `@` is not a focal length.
    #[error("lens \"{name}\": after @ comes a positive focal length in mm, as in \"dgauss.50mm@35mm\"")]
    FocalLength {
        /// The name as given.
        name: String,
    },
}

impl<'a> LensSource<'a> {
    /// Splits `NAME@35mm`; a name without `@`, or that of a file as given or along `search`, is a table alone.
    ///
    /// # Errors
    /// What follows the `@` is not `<positive number>mm`; the name, without directories, has more than
    /// [`MAX_NAME_BYTES`] bytes.
    pub fn parse(name: &'a str, search: &SearchPath) -> Result<Self, SourceError> {
        let own = name.rsplit('/').next().unwrap_or(name);
        if own.len() > MAX_NAME_BYTES {
            return Err(SourceError::NameTooLong {
                start: own.chars().take(32).collect(),
                length: own.len(),
            });
        }
        let plain = Self { table: name, focal_length: None };
        let Some((table, scale)) = name.rsplit_once('@') else {
            return Ok(plain);
        };
        if search.find(name).is_some() {
            return Ok(plain);
        }
        let number = scale.strip_suffix("mm").and_then(|number| number.trim().parse().ok());
        match number.filter(|&length: &f64| length > 0.0 && length.is_finite()) {
            Some(length) => Ok(Self { table, focal_length: Some(length) }),
            None => Err(SourceError::FocalLength { name: name.to_owned() }),
        }
    }

    /// Finds and reads the table: a file as given, then along `search`, then the catalogue.
    ///
    /// # Errors
    /// No such lens, an unreadable file, or a file that is not a lens.
    pub fn load(&self, search: &SearchPath) -> Result<Prescription, SourceError> {
        if let Some(path) = search.find(self.table) {
            return read_file(&path);
        }
        catalogue::find(self.table).ok_or_else(|| SourceError::NotFound {
            name: self.table.to_owned(),
            places: std::iter::once("the working directory".to_owned())
                .chain(search.0.iter().map(|dir| dir.display().to_string()))
                .collect::<Vec<_>>()
                .join(", "),
            catalogue: catalogue::names().collect::<Vec<_>>().join(", "),
        })
    }
}

fn read_file(path: &Path) -> Result<Prescription, SourceError> {
    let unreadable = |error| SourceError::Unreadable { path: path.to_owned(), error };
    let bytes = std::fs::File::open(path).and_then(bounded).map_err(unreadable)?;
    Ok(read(&path.display().to_string(), &bytes)?)
}

/// All bytes up to one more than a lens file may have, by which [`read`] knows that it is too large. A size asked for
/// beforehand would hold for a file that nobody changes, and for none of `/proc`.
fn bounded(source: impl Read) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_the_limit_whatever_its_size_was_said_to_be() {
        let endless = bounded(std::io::repeat(b'#')).expect("bytes");
        assert_eq!(endless.len() as u64, MAX_FILE_BYTES + 1);
        let message = read("endless", &endless).expect_err("too large").to_string();
        assert!(message.starts_with("endless:1:1048577: "), "{message}");

        let directory = tempfile::tempdir().expect("a temporary directory");
        let path = directory.path().join("lens.dat");
        let mut text = b"20 5 1.5 10\n-20 0 1 10\n#".to_vec();
        text.resize(MAX_FILE_BYTES as usize, b' ');
        std::fs::write(&path, &text).expect("written");
        assert_eq!(read_file(&path).expect("as large as may be").interfaces.len(), 2);
        text.push(b' ');
        std::fs::write(&path, &text).expect("written");
        let message = read_file(&path).expect_err("a byte too large").to_string();
        let at = format!("lens.dat:3:{}: ", MAX_FILE_BYTES - 22);
        assert!(message.contains(&at) && message.contains("1048576 bytes"), "{message}");
        assert!(!message.contains("cannot be read"), "{message}");
    }

    #[test]
    fn a_name_that_no_file_can_have_is_refused_and_not_repeated() {
        let nowhere = SearchPath::default();
        let longest = "n".repeat(MAX_NAME_BYTES);
        assert!(LensSource::parse(&longest, &nowhere).is_ok());
        assert!(
            LensSource::parse(&format!("{longest}/{longest}"), &nowhere).is_ok(),
            "directories do not count"
        );
        for name in [format!("{longest}n"), format!("/{longest}n"), "n".repeat(900_000)] {
            let message = LensSource::parse(&name, &nowhere).expect_err("too long").to_string();
            assert!(message.contains("at most 255") && message.len() < 200, "{message}");
        }
    }

    #[test]
    fn a_name_may_carry_a_focal_length() {
        let nowhere = SearchPath::default();
        let source = LensSource::parse("dgauss.50mm@35mm", &nowhere).expect("valid");
        assert_eq!((source.table, source.focal_length), ("dgauss.50mm", Some(35.0)));
        assert_eq!(LensSource::parse("dgauss.50mm", &nowhere).expect("valid").focal_length, None);
        for wrong in ["dgauss.50mm@", "dgauss.50mm@35", "dgauss.50mm@-3mm", "dgauss.50mm@0mm", "x@infmm"] {
            let message = LensSource::parse(wrong, &nowhere).expect_err(wrong).to_string();
            assert!(message.contains("\"dgauss.50mm@35mm\""), "{message}");
        }
    }

    #[test]
    fn an_unknown_lens_lists_where_it_was_sought_and_the_catalogue() {
        let search = SearchPath(vec!["/nowhere".into()]);
        let error =
            LensSource::parse("zoom", &search).expect("a plain name").load(&search).expect_err("unknown");
        let message = error.to_string();
        for part in ["\"zoom\"", "the working directory", "/nowhere", "telephoto.250mm"] {
            assert!(message.contains(part), "{message} lacks {part}");
        }
    }

    #[test]
    fn a_file_is_found_along_the_search_path_before_the_catalogue() {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let search = SearchPath::default().then(Some(directory.path()));
        for name in ["dgauss.50mm", "dgauss@home"] {
            std::fs::write(directory.path().join(name), "20 5 1.5 10\n-20 0 1 10\n").expect("written");
            let lens = LensSource::parse(name, &search).expect("a plain name").load(&search).expect("found");
            assert_eq!(lens.interfaces.len(), 2);
        }
    }
}

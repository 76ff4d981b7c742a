//! Finds a lens by the name that a caller gives: a file as given, a file along a search path, a lens of the
//! catalogue, or a lens of the user's collections. The name may end with a focal length to which the lens is to be
//! scaled (`NAME@35mm`).
//!
//! [`place`] reads a file, also as a member of a [`zip`] archive. [`collection`] lists the files of a folder tree or
//! an archive, and [`named`] finds a lens among them.

mod collection;
mod error;
mod named;
mod place;
mod zip;

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

use super::{
    MAX_CATALOG_BYTES, MAX_NAME_BYTES, MAX_PATH_BYTES, catalogue, glass::GlassLibrary,
    interfaces::Prescription,
};
pub use collection::{Collection, CollectionFile, Fault, MAX_FILES};
pub use error::SourceError;
use named::{Candidates, by_path};
use place::FilePlace;
pub(super) use place::bounded;
use realistic_base::message::cut;
pub(super) use zip::is_zip;

/// The directories in which relative names of lens files are searched, in order, after the working directory; and the
/// user's collections of lenses and catalogues of glass.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SearchPath {
    /// The directories, each listed once.
    directories: Vec<PathBuf>,
    /// The canonical paths of the directories, by which repeated directories are recognised.
    canonical: BTreeSet<PathBuf>,
    /// A note for messages about a directory that the user may expect in the path, but that is not searched.
    unsearched: &'static str,
    /// Collections of lenses beside the catalogue: folders and archives.
    collections: Vec<PathBuf>,
    /// Glass catalogues, and folders of them, for every lens.
    glasses: Vec<PathBuf>,
}

impl SearchPath {
    /// Returns the search path of the environment: the directories in `PBRT_SEARCHPATH`, the collections of lenses in
    /// `REALISTIC_LENSES`, and the glass catalogues and folders of them in `REALISTIC_GLASS` (each separated by `:`, on
    /// Windows by `;`).
    pub fn from_environment() -> Self {
        let paths = |name: &str| {
            let list = std::env::var_os(name).unwrap_or_default();
            let paths = std::env::split_paths(&list).filter(|path| !path.as_os_str().is_empty());
            paths.collect::<Vec<PathBuf>>()
        };
        let directories = paths("PBRT_SEARCHPATH");
        let path = directories.iter().fold(Self::default(), |path, directory| path.then(Some(directory)));
        path.with_collections(paths("REALISTIC_LENSES")).with_glasses(paths("REALISTIC_GLASS"))
    }

    /// Sets the collections in which lenses are found by their names: folders with all that is below them, and archives.
    #[must_use]
    pub fn with_collections(self, collections: Vec<PathBuf>) -> Self {
        Self { collections, ..self }
    }

    /// Returns the collections in which lenses are found by their names.
    pub fn collections(&self) -> &[PathBuf] {
        &self.collections
    }

    /// Returns the glass catalogues, and the folders of them, that are used for every lens.
    pub fn glasses(&self) -> &[PathBuf] {
        &self.glasses
    }

    /// Sets the glass catalogues, and the folders of them, that are used for every lens after those beside it.
    #[must_use]
    pub fn with_glasses(self, glasses: Vec<PathBuf>) -> Self {
        Self { glasses, ..self }
    }

    /// Adds a directory, which is searched last.
    #[must_use]
    pub fn then(mut self, directory: Option<&Path>) -> Self {
        let new = self.unknown(directory);
        self.directories.extend(new);
        self
    }

    /// Adds a directory, which is searched first.
    #[must_use]
    pub fn first(mut self, directory: Option<&Path>) -> Self {
        let new = self.unknown(directory);
        self.directories.splice(..0, new);
        self
    }

    /// Sets the note that messages add if no lens is found. The note names directories that the user may expect here,
    /// but that are not searched.
    #[must_use]
    pub fn without(self, unsearched: &'static str) -> Self {
        Self { unsearched, ..self }
    }

    /// Returns the directory if it is new and its name is not empty, and remembers the directory.
    fn unknown(&mut self, directory: Option<&Path>) -> Option<PathBuf> {
        let directory = directory.filter(|directory| !directory.as_os_str().is_empty())?;
        let canonical = directory.canonicalize().unwrap_or_else(|_| directory.to_owned());
        self.canonical.insert(canonical).then(|| directory.to_owned())
    }

    /// Lists the searched directories, for use in messages.
    fn in_words(&self) -> String {
        let directories = self.directories.iter().map(|directory| directory.display().to_string());
        let searched: Vec<String> =
            std::iter::once("the working directory".to_owned()).chain(directories).collect();
        searched.join(", ") + self.unsearched
    }

    /// Returns the place of the first file with that name: the file as given, then the file in each directory. `what` is
    /// the kind of file, for the message.
    ///
    /// # Errors
    /// No such file exists. The error has the reason for the first match that is not a regular file, if there is such a
    /// match.
    fn find(&self, what: &'static str, name: &str) -> Result<FilePlace, Option<SourceError>> {
        let given = Path::new(name);
        let directories = self.directories.iter().filter(|_| given.is_relative());
        let mut no_file = None;
        for path in
            std::iter::once(given.to_owned()).chain(directories.map(|directory| directory.join(given)))
        {
            match FilePlace::at(&path) {
                Ok(Some(place)) => return Ok(place),
                Ok(None) => {}
                Err(why) => no_file = no_file.or(Some(SourceError::NoFile { what, path, why })),
            }
        }
        Err(no_file)
    }

    /// Returns the place of a lens: as [`find`](Self::find) does, or else the only file with this path in a collection.
    ///
    /// # Errors
    /// As for [`find`](Self::find).
    fn find_lens(&self, name: &str) -> Result<FilePlace, Option<SourceError>> {
        let mut no_file = match self.find("lens", name) {
            Ok(place) => return Ok(place),
            Err(no_file) => no_file,
        };
        let mut found = Vec::new();
        for root in &self.collections {
            match by_path(root, name) {
                Ok(place) => found.extend(place),
                Err(error) => no_file = no_file.or(Some(error)),
            }
        }
        // Several files are reported when the collections are listed.
        found.pop().filter(|_| found.is_empty()).ok_or(no_file)
    }
}

/// Splits `NAME@35mm` into the name of a table and a focal length. The table is a file or a lens of the catalogue; its
/// lens is to be scaled to the focal length, mm, which is positive and finite. A name is not split if it has no `@`, or
/// if it names a file as given, along `search` or in a collection.
///
/// # Errors
/// The part after the `@` is not `<positive number>mm`, or the name is too long: it has more than [`MAX_NAME_BYTES`]
/// bytes without its directories, or more than [`MAX_PATH_BYTES`] with them.
pub fn split_scale<'a>(name: &'a str, search: &SearchPath) -> Result<(&'a str, Option<f64>), SourceError> {
    check_length("lens", name)?;
    let Some((table, scale)) = name.rsplit_once('@').filter(|_| search.find_lens(name).is_err()) else {
        return Ok((name, None));
    };
    let number = scale.strip_suffix("mm").and_then(|number| number.trim().parse().ok());
    match number.filter(|&length: &f64| length > 0.0 && length.is_finite()) {
        Some(length) => Ok((table, Some(length))),
        None => Err(SourceError::FocalLength { name: name.to_owned() }),
    }
}

/// Finds and reads a table: a file as given, a file along `search`, a file with this path in a collection, a lens of the
/// catalogue, and a lens of the collections whose path ends with the name. Named glasses are looked up in `library` and
/// in the catalogues beside the file.
///
/// # Errors
/// No such lens exists, several lenses of the collections have the name, the path leads to something other than a file,
/// the file is unreadable, or the file is not a lens.
pub fn load(table: &str, search: &SearchPath, library: GlassLibrary) -> Result<Prescription, SourceError> {
    let read = |place: &FilePlace| place.lens(&library.beside(place.file()));
    let no_file = match search.find_lens(table) {
        Ok(place) => {
            let mut lens = read(&place)?;
            if catalogue::names().any(|name| name == table) {
                lens.remarks.push(format!(
                    "lens \"{table}\" is the file {place}, not the built-in lens of that name; rename the file to have that"
                ));
            }
            return Ok(lens);
        }
        Err(no_file) => no_file,
    };
    if let Some(lens) = catalogue::find(table) {
        return Ok(lens);
    }
    let candidates = Candidates::of(&search.collections);
    if let Some(place) = candidates.named(table)? {
        return read(&place);
    }
    Err(no_file.unwrap_or_else(|| SourceError::NotFound {
        name: table.to_owned(),
        searched: search.in_words(),
        collections: candidates.searched().to_owned(),
        known: candidates.near(table),
    }))
}

/// Returns the glasses for `load`: those of a glass catalogue, which is a file as given or along `search`, those of the
/// search path's own catalogues, and the built-in ones.
///
/// # Errors
/// No such file exists, the file is unreadable or is not a catalogue, or the name is too long.
pub fn glass_library(name: Option<&str>, search: &SearchPath) -> Result<GlassLibrary, SourceError> {
    let mut library = GlassLibrary::default().with_places(&search.glasses);
    if let Some(name) = name {
        let (path, bytes) = find_file("glass catalogue", name, search, MAX_CATALOG_BYTES)?;
        library.add(&path, &bytes)?;
    }
    Ok(library)
}

/// Finds and reads a file as given or along `search`; `what` is its kind, for messages. Returns its path as text and at
/// most one byte more than `most`.
///
/// # Errors
/// No such file exists, the file is unreadable, or the name is too long.
pub fn find_file(
    what: &'static str,
    name: &str,
    search: &SearchPath,
    most: u64,
) -> Result<(String, Vec<u8>), SourceError> {
    check_length(what, name)?;
    let none = || SourceError::NoSuchFile { what, name: cut(name), searched: search.in_words() };
    let place = search.find(what, name).map_err(|no_file| no_file.unwrap_or_else(none))?;
    Ok((place.to_string(), place.bytes(what, most)?))
}

/// Checks that a name is no longer than the name of a file can be.
fn check_length(what: &'static str, name: &str) -> Result<(), SourceError> {
    let own = name.rsplit('/').next().unwrap_or(name);
    if own.len() <= MAX_NAME_BYTES && name.len() <= MAX_PATH_BYTES {
        return Ok(());
    }
    Err(SourceError::NameTooLong { what, start: name.chars().take(32).collect(), length: name.len() })
}

#[cfg(test)]
mod tests {
    use super::{place::unreachable_file, *};
    use crate::prescription::{MAX_FILE_BYTES, reader::read_with};
    use std::io::ErrorKind;

    #[test]
    fn a_file_is_read_up_to_the_limit_whatever_its_stated_size() {
        let endless = bounded(std::io::repeat(b'#'), MAX_FILE_BYTES).expect("bytes");
        assert_eq!(endless.len() as u64, MAX_FILE_BYTES + 1);
        let message =
            read_with("endless", &endless, &GlassLibrary::default()).expect_err("too large").to_string();
        assert!(message.starts_with("endless:1:1048577: "), "{message}");

        let directory = tempfile::tempdir().expect("a temporary directory");
        let path = directory.path().join("lens.dat");
        let mut text = b"20 5 1.5 10\n-20 0 1 10\n#".to_vec();
        text.resize(MAX_FILE_BYTES as usize, b' ');
        std::fs::write(&path, &text).expect("written");
        let read = || FilePlace::File(path.clone()).lens(&GlassLibrary::default());
        assert_eq!(read().expect("as large as may be").interfaces.len(), 2);
        text.push(b' ');
        std::fs::write(&path, &text).expect("written");
        let message = read().expect_err("a byte too large").to_string();
        let at = format!("lens.dat:3:{}: ", MAX_FILE_BYTES - 22);
        assert!(message.contains(&at) && message.contains("1048576 bytes"), "{message}");
        assert!(!message.contains("cannot be read"), "{message}");
    }

    #[test]
    fn a_name_that_no_file_can_have_is_refused_and_not_repeated() {
        let nowhere = SearchPath::default();
        let longest = "n".repeat(MAX_NAME_BYTES);
        assert!(split_scale(&longest, &nowhere).is_ok());
        assert!(split_scale(&format!("{longest}/{longest}"), &nowhere).is_ok(), "directories do not count");
        for name in [format!("{longest}n"), format!("/{longest}n"), "n".repeat(900_000), "n/".repeat(2049)] {
            let message = split_scale(&name, &nowhere).expect_err("too long").to_string();
            assert!(message.contains("at most 255") && message.len() < 200, "{message}");
            let message = glass_library(Some(&name), &nowhere).expect_err("too long").to_string();
            assert!(message.contains("the name of a glass catalogue") && message.len() < 200, "{message}");
        }
    }

    #[test]
    fn a_name_may_carry_a_focal_length() {
        let nowhere = SearchPath::default();
        let split = |name| split_scale(name, &nowhere).expect("valid");
        assert_eq!(split("dgauss.50mm@35mm"), ("dgauss.50mm", Some(35.0)));
        assert_eq!(split("dgauss.50mm"), ("dgauss.50mm", None));
        for wrong in ["dgauss.50mm@", "dgauss.50mm@35", "dgauss.50mm@-3mm", "dgauss.50mm@0mm", "x@infmm"] {
            let message = split_scale(wrong, &nowhere).expect_err(wrong).to_string();
            assert!(message.contains("\"dgauss.50mm@35mm\""), "{message}");
        }
    }

    #[test]
    fn an_unknown_lens_lists_where_it_was_sought_and_the_catalogue() {
        let search = SearchPath::default().then(Some(Path::new("/nowhere"))).without(" (not on the moon)");
        let error = load("zoom", &search, GlassLibrary::default()).expect_err("unknown");
        let message = error.to_string();
        for part in ["\"zoom\"", "the working directory, /nowhere (not on the moon), and", "telephoto.250mm"]
        {
            assert!(message.contains(part), "{message} lacks {part}");
        }
    }

    #[test]
    fn a_misspelt_lens_is_answered_with_the_nearest_name_alone() {
        let nowhere = SearchPath::default();
        for (given, meant) in [
            ("dgaus.50mm", "dgauss.50mm"),
            ("dgaus.50mm.dat", "dgauss.50mm"),
            ("lenses/wide22mm.dat", "wide.22mm"),
            ("../lenses/fisheye.10mm.dat", "fisheye.10mm"),
            ("Wide.22mm", "wide.22mm"),
            ("fisheye10mm", "fisheye.10mm"),
            ("zoom.70-20mm@85mm", "zoom.70-200mm"),
        ] {
            let (table, _) = split_scale(given, &nowhere).expect("a name");
            let message = load(table, &nowhere, GlassLibrary::default()).expect_err("misspelt").to_string();
            assert!(message.ends_with(&format!("; did you mean \"{meant}\"?")), "{message}");
            assert!(!message.contains("telephoto.250mm"), "{message}");
        }
    }

    #[test]
    fn a_file_is_found_along_the_search_path_before_the_catalogue() {
        let directory = tempfile::tempdir().expect("a temporary directory");
        let search = SearchPath::default().then(Some(directory.path()));
        for name in ["dgauss.50mm", "dgauss@home"] {
            std::fs::write(directory.path().join(name), "20 5 1.5 10\n-20 0 1 10\n").expect("written");
            let (table, _) = split_scale(name, &search).expect("a plain name");
            let lens = load(table, &search, GlassLibrary::default()).expect("found");
            assert_eq!(lens.interfaces.len(), 2);
            let is_built_in = name == "dgauss.50mm";
            assert_eq!(lens.remarks.len(), usize::from(is_built_in), "{:?}", lens.remarks);
            let path = directory.path().join(name).display().to_string();
            assert!(lens.remarks.iter().all(|remark| remark.contains(&path)), "{:?}", lens.remarks);
        }
        // A path is never a name in the catalogue.
        let path = directory.path().join("dgauss.50mm").display().to_string();
        assert_eq!(load(&path, &search, GlassLibrary::default()).expect("found").remarks, [""; 0]);
    }

    #[test]
    fn a_catalogue_beside_the_file_or_by_name_defines_a_glass() {
        let here = tempfile::tempdir().expect("a temporary directory");
        let lens = here.path().join("lens.dat");
        std::fs::write(&lens, "20 5 OWN1 10\n-20 0 1 10\n").expect("written");
        let name = lens.to_str().expect("UTF-8");
        let load = |library: GlassLibrary| load(name, &SearchPath::default(), library);
        let message = load(GlassLibrary::default()).expect_err("unknown").to_string();
        assert!(message.contains("nor a known glass"), "{message}");
        let glass = |b1: &str| format!("NM OWN1 2 0 1.5 60\nCD {b1} 0.006 0.23 0.02 1.01 103\n");
        std::fs::write(here.path().join("b.AGF"), glass("1.1")).expect("written");
        let beside = load(GlassLibrary::default()).expect("known").interfaces[0].medium;
        std::fs::write(here.path().join("other"), glass("1.2")).expect("written");
        let search = SearchPath::default().then(Some(here.path()));
        let given = load(glass_library(Some("other"), &search).expect("a catalogue")).expect("known");
        assert_ne!(given.interfaces[0].medium, beside);
        let message = glass_library(Some("none"), &search).expect_err("no file").to_string();
        assert!(message.starts_with("no glass catalogue \"none\" in the working directory, "), "{message}");
        let message = glass_library(Some("lens.dat"), &search).expect_err("no catalogue").to_string();
        assert!(
            message.contains("lens.dat:1:1: no glass; a glass catalogue (AGF) has lines NM"),
            "{message}"
        );
        assert!(glass_library(Some(here.path().to_str().expect("UTF-8")), &search).is_err());
    }

    #[test]
    fn a_directory_is_searched_once_and_the_first_before_the_others() {
        let here = tempfile::tempdir().expect("a temporary directory");
        let [a, b] = ["a", "b"].map(|name| here.path().join(name));
        std::fs::create_dir(&a).expect("made");
        std::fs::create_dir(&b).expect("made");
        std::fs::write(a.join("lens.dat"), "20 5 1.5 10\n-20 0 1 10\n").expect("written");
        std::fs::write(b.join("lens.dat"), "# b\n20 5 1.5 10\n-20 0 1 10\n").expect("written");
        let twice =
            SearchPath::default().then(Some(&a)).then(Some(&a.join("../a/"))).then(Some(Path::new("")));
        assert_eq!(twice.directories, [a.as_path()]);
        let both = twice.first(Some(&b)).first(Some(&a));
        assert_eq!(both.directories, [b.as_path(), &a]);
        // On a long search path, each directory is resolved once, and not once for each other directory.
        let many = (0..2000).fold(both.clone(), |path, i| path.then(Some(&here.path().join(format!("{i}")))));
        let again =
            (0..2000).fold(many.clone(), |path, i| path.then(Some(&here.path().join(format!("{i}")))));
        assert_eq!((many.canonical.len(), &again), (2002, &many));
        let lens = load("lens.dat", &both, GlassLibrary::default()).expect("found");
        assert_eq!(lens.title.as_deref(), Some("b"));
    }

    #[cfg(unix)]
    #[test]
    fn what_is_no_file_is_told_in_its_own_words_and_not_waited_for() {
        let here = tempfile::tempdir().expect("a temporary directory");
        let path = |name: &str| here.path().join(name);
        std::fs::create_dir(path("directory")).expect("made");
        std::os::unix::fs::symlink(path("loop"), path("loop")).expect("linked");
        let made = std::process::Command::new("mkfifo").arg(path("pipe")).status().expect("mkfifo runs");
        assert!(made.success());
        let nowhere = SearchPath::default();
        let message = |name: &Path| {
            let name = name.to_str().expect("UTF-8");
            load(name, &nowhere, GlassLibrary::default()).expect_err("no file").to_string()
        };
        for (name, words) in [
            (path("directory"), "directory\" is a directory; give a file in it"),
            (path("pipe"), "pipe\" is a pipe or a device, which is not waited for; write it to a file"),
            (Path::new("/dev/zero").to_owned(), "lens \"/dev/zero\" is a pipe or a device"),
            (path("loop"), "loop\" is a loop of symbolic links"),
            (path("directory/none"), "no lens file \""),
            (path("loop/none"), "none\" is a loop of symbolic links"),
        ] {
            let message = message(&name);
            assert!(message.contains(words), "{message}");
        }
        let denied = unreachable_file(&ErrorKind::PermissionDenied.into());
        assert_eq!(
            denied.as_deref(),
            Some("is in a directory that this user has no permission to look into")
        );
        let unreadable = SourceError::Unreadable {
            what: "lens file",
            path: "a.dat".into(),
            error: ErrorKind::PermissionDenied.into(),
        };
        assert_eq!(unreadable.to_string(), "lens file \"a.dat\" cannot be read: permission denied");
        // A directory with the name of a lens in the catalogue does not hide that lens.
        std::fs::create_dir(path("dgauss.50mm")).expect("made");
        let search = SearchPath::default().then(Some(here.path()));
        assert!(load("dgauss.50mm", &search, GlassLibrary::default()).is_ok());
    }
}

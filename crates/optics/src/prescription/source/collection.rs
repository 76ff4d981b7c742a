//! Collections: the files in a folder and in all folders and zip archives below it, those in a zip archive, or a single
//! file. A file's name in a collection is its path from there, with `/` between folders; it continues into archives
//! (`thorlabs/stock.zip/AC254-050-A.zmx`).
//!
//! A collection is only itself: links out of it are not followed. Files and folders whose names begin with a dot are
//! left out. At most [`MAX_FILES`] files and folders are looked at, and no folder deeper than [`MAX_DEPTH`].

use std::{
    fs::{DirEntry, Metadata},
    path::{Path, PathBuf},
    sync::Arc,
    time::SystemTime,
};

use super::{
    error::SourceError,
    place::{FilePlace, unreachable_file},
    zip::Zip,
};
use crate::prescription::{glass::GlassLibrary, interfaces::Prescription};

/// Maximum number of files and folders of a collection that are looked at. The largest public collections have some
/// 8,000 files.
pub const MAX_FILES: usize = 100_000;

/// Maximum depth of a folder in a collection.
const MAX_DEPTH: usize = 16;

/// Ends of the names of lens files, except for plain text. Files with these names that are no lenses are reported.
const LENS_ENDINGS: [&str; 11] =
    ["dat", "json", "len", "lens", "lhlt", "roa", "seq", "toml", "zar", "zmx", "zos"];

/// The files of a collection.
#[derive(Debug)]
pub struct Collection {
    /// The folder or file, without links.
    root: PathBuf,
    /// The files, in the order of their names.
    files: Vec<CollectionFile>,
    /// The parts that cannot be looked at, in the order of their names.
    faults: Vec<Fault>,
    seen: usize,
}

/// A file of a collection.
#[derive(Clone, Debug)]
pub struct CollectionFile {
    /// The name in the collection.
    pub name: String,
    /// The size, in bytes; for a member of an archive, the stated size.
    pub size: u64,
    /// The time of the last change, of the file or of its archive, if the system has it.
    pub modified: Option<SystemTime>,
    place: FilePlace,
}

/// A part of a collection that cannot be looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The name in the collection; empty for the whole collection.
    pub name: String,
    /// The reason, which completes a sentence that begins with the name.
    pub why: String,
}

impl CollectionFile {
    /// Returns whether the name ends as the names of lens files do. Other files may be lenses too, but few are.
    pub fn is_named_as_lens(&self) -> bool {
        let ending = self.name.rsplit_once('.').map_or("", |(_, ending)| ending);
        LENS_ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known))
    }

    /// Returns the path of the file, which is a name of its lens for every host.
    pub fn path(&self) -> String {
        self.place.to_string()
    }

    /// Returns the folder with the file or with the archive that holds it.
    pub fn folder(&self) -> &Path {
        self.place.file().parent().unwrap_or(Path::new("."))
    }

    /// Returns the library with the glass catalogues in [`folder`](Self::folder), for all files there.
    pub fn glasses(&self, library: &GlassLibrary) -> GlassLibrary {
        library.beside(self.place.file())
    }

    /// Reads the lens. Its glasses are looked up in `library`, which [`glasses`](Self::glasses) makes.
    ///
    /// # Errors
    /// The file cannot be read, or is not a lens.
    pub fn lens(&self, library: &GlassLibrary) -> Result<Prescription, SourceError> {
        self.place.lens(library)
    }

    pub(super) fn into_place(self) -> FilePlace {
        self.place
    }
}

impl Collection {
    /// Lists the files of a folder, an archive, or a single file.
    ///
    /// # Errors
    /// Nothing is at the path, or it is an archive that cannot be listed. Parts of a folder that cannot be looked at are
    /// [`faults`](Self::faults).
    pub fn open(path: &Path) -> Result<Self, SourceError> {
        let no_file = |why| SourceError::NoFile { what: "collection", path: path.to_owned(), why };
        let missing =
            |error| no_file(unreachable_file(&error).unwrap_or_else(|| "does not exist".to_owned()));
        let root = path.canonicalize().map_err(missing)?;
        let metadata = root.metadata().map_err(missing)?;
        let mut collection = Self { root: root.clone(), files: Vec::new(), faults: Vec::new(), seen: 0 };
        if metadata.is_dir() {
            collection.add_folders();
        } else if Zip::is_at(&root) {
            collection.add_archive(&root, "", &metadata).map_err(no_file)?;
        } else {
            let name = root.file_name().unwrap_or_default().to_string_lossy().into_owned();
            collection.add_file(root, name, &metadata);
        }
        collection.files.sort_by(|a, b| a.name.cmp(&b.name));
        collection.faults.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(collection)
    }

    /// Returns the path of the collection, without links.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Returns the files, in the order of their names.
    pub fn files(&self) -> &[CollectionFile] {
        &self.files
    }

    /// Returns the parts that cannot be looked at, in the order of their names.
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }

    pub(super) fn into_files(self) -> Vec<CollectionFile> {
        self.files
    }

    /// Adds the files of the root and of all folders below it.
    fn add_folders(&mut self) {
        // Folders with their names, each ending with a slash.
        let mut folders = vec![(self.root.clone(), String::new())];
        while let Some((folder, name)) = folders.pop() {
            let listed = match std::fs::read_dir(&folder) {
                Ok(listed) => listed,
                Err(error) => {
                    self.leave_out(name.trim_end_matches('/'), &format!("cannot be looked into: {error}"));
                    continue;
                }
            };
            let mut own: Vec<DirEntry> = listed.flatten().take(MAX_FILES + 1 - self.seen).collect();
            own.sort_by_key(DirEntry::file_name);
            for entry in own {
                if !self.may_look_further() {
                    return;
                }
                let own_name = entry.file_name();
                let Some(own_name) = own_name.to_str() else {
                    self.leave_out(
                        &format!("{name}{}", own_name.to_string_lossy()),
                        "has a name that is not UTF-8",
                    );
                    continue;
                };
                let own_name = format!("{name}{own_name}");
                if is_hidden(&own_name) {
                    continue;
                }
                match self.resolved(&entry) {
                    Ok((path, found)) if found.is_dir() => {
                        if own_name.matches('/').count() >= MAX_DEPTH {
                            self.leave_out(&own_name, &format!("is deeper than {MAX_DEPTH} folders"));
                        } else {
                            folders.push((path, own_name + "/"));
                        }
                    }
                    Ok((path, found)) => self.add_file(path, own_name, &found),
                    Err(why) => self.leave_out(&own_name, &why),
                }
            }
        }
    }

    /// Returns the path of a folder's entry and what is there. A link leads to another file of the collection.
    fn resolved(&self, entry: &DirEntry) -> Result<(PathBuf, Metadata), String> {
        let unreadable = |error| format!("cannot be looked at: {error}");
        let found = entry.metadata().map_err(unreadable)?;
        if found.is_file() || found.is_dir() {
            return Ok((entry.path(), found));
        }
        if !found.is_symlink() {
            return Err("is a pipe or a device".to_owned());
        }
        let target = within(&self.root, &entry.path())?;
        let found = target.metadata().map_err(unreadable)?;
        match found.is_file() {
            true => Ok((target, found)),
            false => Err("is a link to no file, and is not followed".to_owned()),
        }
    }

    /// Adds a file, or the members of an archive.
    fn add_file(&mut self, path: PathBuf, name: String, found: &Metadata) {
        if has_ending(&name, "zip") {
            if let Err(why) = self.add_archive(&path, &format!("{name}/"), found) {
                self.leave_out(&name, &why);
            }
            return;
        }
        let (size, modified) = (found.len(), found.modified().ok());
        self.files.push(CollectionFile { name, size, modified, place: FilePlace::File(path) });
    }

    /// Adds the members of an archive; their names begin with `name`.
    fn add_archive(&mut self, path: &Path, name: &str, found: &Metadata) -> Result<(), String> {
        let zip = Arc::new(Zip::open(path)?);
        for member in zip.members() {
            if !self.may_look_further() {
                break;
            }
            if is_hidden(&member.name) {
                continue;
            }
            self.files.push(CollectionFile {
                name: format!("{name}{}", member.name),
                size: member.size,
                modified: found.modified().ok(),
                place: FilePlace::Member(zip.clone(), member.clone()),
            });
        }
        Ok(())
    }

    fn leave_out(&mut self, name: &str, why: &str) {
        self.faults.push(Fault { name: name.to_owned(), why: why.to_owned() });
    }

    /// Counts a file or folder. Returns whether the collection may have it.
    fn may_look_further(&mut self) -> bool {
        self.seen += 1;
        if self.seen == MAX_FILES + 1 {
            self.leave_out("", &format!("has more than {MAX_FILES} files and folders; give a folder in it"));
        }
        self.seen <= MAX_FILES
    }
}

/// Returns a path without links, if it lies in a collection.
///
/// # Errors
/// The path cannot be followed, or leads out of the collection.
pub(super) fn within(root: &Path, path: &Path) -> Result<PathBuf, String> {
    let target = path.canonicalize().map_err(|error| format!("cannot be followed: {error}"))?;
    match target.starts_with(root) {
        true => Ok(target),
        false => Err("is a link out of the collection, and is not followed".to_owned()),
    }
}

fn has_ending(name: &str, ending: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, own)| own.eq_ignore_ascii_case(ending))
}

/// Returns whether a part of a name begins with a dot, or the file belongs to what macOS adds to archives.
fn is_hidden(name: &str) -> bool {
    name.split('/').any(|part| part.starts_with('.') || part == "__MACOSX")
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::prescription::source::zip::tests::packed;

    pub(in crate::prescription::source) const SINGLET: &str = "20 5 1.5 10\n-20 0 1 10\n";

    /// Makes a folder with files; a file whose name ends in `.zip` holds one lens.
    pub(in crate::prescription::source) fn folder(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a temporary directory");
        for name in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            let bytes = match name.ends_with(".zip") {
                true => packed(&[("in/lens.dat", SINGLET.as_bytes()), ("__MACOSX/in/._lens.dat", b"")]),
                false => SINGLET.into(),
            };
            std::fs::write(path, bytes).expect("written");
        }
        folder
    }

    fn names(collection: &Collection) -> Vec<&str> {
        collection.files().iter().map(|file| file.name.as_str()).collect()
    }

    fn faults(collection: &Collection) -> Vec<String> {
        collection.faults().iter().map(|Fault { name, why }| format!("{name} {why}")).collect()
    }

    #[test]
    fn a_folder_is_listed_with_its_folders_and_archives() {
        let here = folder(&["b.dat", "a/c.lhlt", "a/notes.txt", "a/stock.zip", ".git/d.dat"]);
        let collection = Collection::open(here.path()).expect("a folder");
        assert_eq!(names(&collection), ["a/c.lhlt", "a/notes.txt", "a/stock.zip/in/lens.dat", "b.dat"]);
        assert!(collection.faults().is_empty());
        let named: Vec<bool> = collection.files().iter().map(CollectionFile::is_named_as_lens).collect();
        assert_eq!(named, [true, false, true, true]);
        for file in collection.files() {
            let lens = file.lens(&GlassLibrary::default()).expect("a lens");
            assert!(lens.interfaces.len() == 2 && file.modified.is_some() && file.size == 23);
            assert!(file.path().ends_with(&file.name) && file.folder().is_dir());
        }
        let archive = Collection::open(&here.path().join("a/stock.zip")).expect("an archive");
        assert_eq!(names(&archive), ["in/lens.dat"]);
        let single = Collection::open(&here.path().join("b.dat")).expect("a file");
        assert_eq!(names(&single), ["b.dat"]);
        let message = Collection::open(Path::new("/nowhere")).expect_err("nothing").to_string();
        assert_eq!(message, "collection \"/nowhere\" does not exist");
    }

    #[test]
    fn parts_that_cannot_be_looked_at_are_faults() {
        let here = folder(&["a.dat", &format!("{}deep.dat", "d/".repeat(17))]);
        std::fs::write(here.path().join("b.zip"), "PK\x03\x04 no archive").expect("written");
        let collection = Collection::open(here.path()).expect("a folder");
        assert_eq!(names(&collection), ["a.dat"]);
        let deep = ["d"; 17].join("/");
        assert_eq!(
            faults(&collection),
            [
                "b.zip is damaged: its list of members is missing at the end; copy or pack it again"
                    .to_owned(),
                format!("{deep} is deeper than 16 folders"),
            ]
        );
        let broken = Collection::open(&here.path().join("b.zip")).expect_err("no archive").to_string();
        assert!(broken.contains("b.zip\" is damaged"), "{broken}");
    }

    #[test]
    fn a_collection_has_a_largest_number_of_files() {
        let mut collection = Collection::open(folder(&["a.dat"]).path()).expect("a folder");
        collection.seen = MAX_FILES - 1;
        assert_eq!([(); 3].map(|()| collection.may_look_further()), [true, false, false]);
        assert_eq!(faults(&collection), [" has more than 100000 files and folders; give a folder in it"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_to_files_of_the_collection_alone() {
        use std::os::unix::fs::symlink;
        let (here, there) = (folder(&["a/b.dat"]), folder(&["c.dat"]));
        for (target, name) in [
            (here.path().join("a/b.dat"), "inside.dat"),
            (there.path().join("c.dat"), "outside.dat"),
            (here.path().to_owned(), "loop"),
            (here.path().join("none"), "broken"),
        ] {
            symlink(target, here.path().join(name)).expect("linked");
        }
        let made = std::process::Command::new("mkfifo").arg(here.path().join("pipe")).status();
        assert!(made.expect("mkfifo runs").success());
        let collection = Collection::open(here.path()).expect("a folder");
        assert_eq!(names(&collection), ["a/b.dat", "inside.dat"]);
        let faults = faults(&collection);
        for (fault, words) in faults.iter().zip([
            "broken cannot be followed",
            "loop is a link to no file",
            "outside.dat is a link out of the collection",
            "pipe is a pipe or a device",
        ]) {
            assert!(fault.starts_with(words), "{fault}");
        }
        assert_eq!(faults.len(), 4);
    }
}

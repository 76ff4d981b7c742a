//! The cache of earlier runs' findings about the files of a collection: one file for each collection, in the user's
//! cache folder. An entry counts as long as the file has the same size and time of change. All entries count as long as the
//! program and the glass catalogues are the same. A cache that cannot be read or written is no error.

use super::outcome::Outcome;
use crate::files;
use realistic_optics::prescription::{Collection, CollectionFile};
use serde_json::{Map, Value, json};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Maximum size of a cache, bytes. A row takes some hundred.
const MOST_BYTES: u64 = 64 << 20;

/// The cache of one collection.
pub struct Cache {
    /// The file of the cache, if the cache is kept.
    path: Option<PathBuf>,
    /// Everything besides a file on which its row depends.
    state: Value,
    entries: Map<String, Value>,
}

impl Cache {
    /// Reads the cache of a collection in a folder; `catalogues` are glass catalogues outside the collection. Without a
    /// folder nothing is read or kept.
    pub fn of(folder: Option<&Path>, collection: &Collection, catalogues: &[CollectionFile]) -> Self {
        let mut hasher = DefaultHasher::new();
        collection.root().hash(&mut hasher);
        let path = folder.map(|folder| folder.join(format!("lenses-{:016x}.json", hasher.finish())));
        let own = collection.files().iter().filter(|file| is_catalogue(file));
        let stamps: Vec<Value> =
            own.chain(catalogues).map(|file| json!([file.path(), stamp(file.size, file.modified)])).collect();
        let program = std::env::current_exe().and_then(|path| path.metadata());
        let program = program.map(|found| stamp(found.len(), found.modified().ok())).ok();
        let state = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "program": program,
            "collection": collection.root().display().to_string(),
            "catalogues": stamps,
        });
        let read = path.as_deref().and_then(|path| files::read(path, MOST_BYTES).ok());
        let read = read.and_then(|bytes| serde_json::from_slice::<Map<String, Value>>(&bytes).ok());
        let same = read.filter(|read| read.get("state") == Some(&state));
        let entries = same.and_then(|mut read| match read.remove("files") {
            Some(Value::Object(entries)) => Some(entries),
            _ => None,
        });
        Self { path, state, entries: entries.unwrap_or_default() }
    }

    /// Returns what is known of a file.
    pub fn outcome(&self, file: &CollectionFile) -> Option<Outcome> {
        let entry = self.entries.get(&file.name)?;
        (entry.get(0) == Some(&stamp(file.size, file.modified)?))
            .then(|| entry.get(1).and_then(Outcome::of_json))
            .flatten()
    }

    /// Keeps what is known now.
    pub fn keep<'a>(self, found: impl Iterator<Item = (&'a CollectionFile, &'a Outcome)>) {
        let Some(path) = self.path else { return };
        let entry = |(file, outcome): (&CollectionFile, &Outcome)| {
            Some((file.name.clone(), json!([stamp(file.size, file.modified)?, outcome.json()])))
        };
        let entries: Map<String, Value> = found.filter_map(entry).collect();
        if entries != self.entries {
            let whole = json!({ "state": self.state, "files": entries });
            let _ = files::save(&path, whole.to_string().as_bytes());
        }
    }
}

/// Returns the program's folder for caches: in `XDG_CACHE_HOME`, or in `.cache` of the home folder.
pub fn folder() -> Option<PathBuf> {
    let absolute = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let caches = absolute("XDG_CACHE_HOME").or_else(|| absolute("HOME").map(|home| home.join(".cache")));
    caches.map(|caches| caches.join("realistic"))
}

/// Returns whether a file is a glass catalogue by its name.
pub fn is_catalogue(file: &CollectionFile) -> bool {
    file.name.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("agf"))
}

/// Returns the mark of a file that a change alters; `None` if the time of its change is unknown.
fn stamp(size: u64, modified: Option<SystemTime>) -> Option<Value> {
    let time = modified?.duration_since(UNIX_EPOCH).ok()?;
    Some(json!(format!("{size} {}.{:09}", time.as_secs(), time.subsec_nanos())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_changed_file_or_catalogue_is_read_again() {
        let (folder, caches) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        for name in ["a.dat", "b.dat", "c.agf"] {
            fs::write(folder.path().join(name), name).unwrap();
        }
        let list = || Collection::open(folder.path()).unwrap();
        let cache = |collection: &Collection| Cache::of(Some(caches.path()), collection, &[]);
        let known = || {
            let collection = list();
            let cache = cache(&collection);
            collection.files().iter().map(|file| cache.outcome(file).is_some()).collect::<Vec<_>>()
        };
        let keep = || {
            let collection = list();
            let outcome = Outcome::Unreadable("why".to_owned());
            cache(&collection).keep(collection.files().iter().map(|file| (file, &outcome)));
        };
        assert_eq!(known(), [false; 3]);
        keep();
        assert_eq!(known(), [true; 3]);
        fs::write(folder.path().join("b.dat"), "changed").unwrap();
        assert_eq!(known(), [true, false, true]);
        fs::write(folder.path().join("c.agf"), "changed").unwrap();
        assert_eq!(known(), [false; 3]);
        keep();
        // A broken cache is none, and one that cannot be written is no error.
        let own = fs::read_dir(caches.path()).unwrap().next().unwrap().unwrap().path();
        for text in ["", "{", "[]", "{\"files\": 3}", "null"] {
            fs::write(&own, text).unwrap();
            assert_eq!(known(), [false; 3], "{text}");
        }
        keep();
        assert_eq!(known(), [true; 3]);
        let collection = list();
        Cache::of(Some(Path::new("/dev/null/no")), &collection, &[])
            .keep(collection.files().iter().map(|file| (file, &Outcome::NoLens)));
        assert_eq!(Cache::of(None, &collection, &[]).path, None);
    }
}

//! Any bytes under the name of an archive give either a collection, each of whose files is a lens or an error that
//! names it, or an error.

use std::path::Path;

use realistic_optics::prescription::{Collection, GlassLibrary, MAX_FILES};

/// Checks the promises of the reader of archives, and panics if one is broken. Returns whether the bytes are an archive
/// with a lens in it.
pub fn run(data: &[u8]) -> bool {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let archive = folder.path().join("fuzz.zip");
    std::fs::write(&archive, data).expect("a file in a temporary folder");
    let is_lens = has_lens(&archive);
    let left: Vec<_> = std::fs::read_dir(folder.path()).expect("the folder").collect();
    assert_eq!(left.len(), 1, "nothing is unpacked to the disk");
    is_lens
}

/// Checks the promises for a file. Returns whether a file of the collection is a lens.
fn has_lens(archive: &Path) -> bool {
    let collection = match Collection::open(archive) {
        Ok(collection) => collection,
        Err(error) => {
            assert!(error.to_string().contains("fuzz.zip"), "{error}");
            return false;
        }
    };
    let root = collection.root().display().to_string();
    assert!(collection.files().len() + collection.faults().len() <= MAX_FILES + 1);
    assert!(collection.faults().iter().all(|fault| !fault.why.is_empty()));
    let mut has_lens = false;
    for file in collection.files().iter().take(32) {
        assert!(file.path().starts_with(&root), "{} is not in {root}", file.path());
        match file.lens(&file.glasses(&GlassLibrary::default())) {
            Ok(lens) => {
                assert!(!lens.interfaces.is_empty());
                has_lens = true;
            }
            Err(error) => assert!(error.to_string().contains(&root), "{error}"),
        }
    }
    has_lens
}

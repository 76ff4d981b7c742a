//! The crates depend on one another in the order of the table in ARCHITECTURE.md.

use std::{collections::BTreeSet, fs, path::Path};

/// Returns the names of the folders in `crates`, in the order of the table in ARCHITECTURE.md.
fn in_order(page: &str) -> Vec<&str> {
    let rows = page.lines().filter_map(|line| line.strip_prefix("| [`crates/"));
    rows.map(|row| row.split_once('`').expect("a closing backquote").0).collect()
}

/// Returns the folders of the project's crates that a manifest names.
fn dependencies(manifest: &str) -> impl Iterator<Item = &str> {
    manifest.split("path = \"../").skip(1).filter_map(|rest| Some(rest.split_once('"')?.0))
}

#[test]
fn a_crate_depends_only_on_those_before_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("ARCHITECTURE.md")).expect("the page");
    let order = in_order(&page);
    let folders = fs::read_dir(root.join("crates")).expect("a directory").flatten();
    let folders: BTreeSet<String> =
        folders.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    assert_eq!(order.iter().map(|name| (*name).to_owned()).collect::<BTreeSet<_>>(), folders);
    let mut backward = Vec::new();
    for (index, name) in order.iter().enumerate() {
        let manifest = root.join("crates").join(name).join("Cargo.toml");
        let manifest = fs::read_to_string(manifest).expect("a manifest");
        let later = dependencies(&manifest).filter(|used| !order[..index].contains(used));
        backward.extend(later.map(|used| format!("{name} uses {used}")));
    }
    super::nothing(&backward);
}

#[test]
fn dependencies_are_read_from_a_manifest() {
    let manifest =
        "[dependencies]\na = { path = \"../a\", version = \"0\" }\nb = \"1\"\nc = { path = \"../c\" }";
    assert_eq!(dependencies(manifest).collect::<Vec<_>>(), ["a", "c"]);
}

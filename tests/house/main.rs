//! Checks of the project's text: links, paths and promises of the pages, workflows, the order of the crates, and the
//! locations of `unsafe`.

mod crates;
mod links;
mod paths;
mod promises;
mod workflows;

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Folders that are searched for `unsafe`.
const SEARCHED: [&str; 4] = ["src", "crates", "cli/src", "lab/src"];
/// Folders and files that may contain `unsafe`; `refractions` reads the processor's clock.
const UNSAFE: [&str; 9] = [
    "cli/src/commands/refractions.rs",
    "cli/src/host/",
    "crates/camera/src/columns.rs",
    "crates/camera/src/rays.rs",
    "crates/camera/src/samples.rs",
    "crates/simd/src/",
    "crates/trace/src/kernel/group.rs",
    "crates/trace/src/kernel/instances.rs",
    "src/abi/",
];

/// Fails if there are findings, and lists one per line.
#[track_caller]
fn nothing(found: &[String]) {
    assert!(found.is_empty(), "{} found:\n{}", found.len(), found.join("\n"));
}

/// Collects the Rust files below a folder that contain the word `unsafe`, even in a comment.
fn with_unsafe(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a directory").flatten() {
        let path = entry.path();
        if path.is_dir() {
            with_unsafe(&path, found);
        } else if path.extension().is_some_and(|end| end == "rs") {
            let text = fs::read_to_string(&path).expect("text");
            if text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe") {
                found.push(path);
            }
        }
    }
}

#[test]
fn unsafe_code_is_only_in_listed_folders() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for folder in SEARCHED {
        with_unsafe(&root.join(folder), &mut found);
    }
    let found = found.iter().map(|path| path.strip_prefix(root).expect("below").display().to_string());
    let found: Vec<String> = found.collect();
    let others = found.iter().filter(|path| !UNSAFE.iter().any(|folder| path.starts_with(folder)));
    nothing(&others.cloned().collect::<Vec<_>>());
    for folder in UNSAFE {
        assert!(found.iter().any(|path| path.starts_with(folder)), "{folder} contains none");
    }
}

#[test]
fn an_unmaintained_crate_in_use_is_listed_with_the_reason() {
    let read = |file: &str| {
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect("a file of the project")
    };
    let (lock, list) = (read("Cargo.lock"), read("deny.toml"));
    let ignored = list.lines().filter(|line| line.contains("id = \"RUSTSEC-"));
    let named: Vec<&str> = ignored
        .map(|line| {
            line.split_once("reason = \"").and_then(|(_, reason)| reason.split_once(':')).expect("a name").0
        })
        .collect();
    // Crates of the RustSec advisories of 2026-11.
    for name in named.iter().copied().chain(["paste", "ttf-parser"]) {
        let is_in_use = lock.contains(&format!("name = \"{name}\"\n"));
        assert_eq!(named.contains(&name), is_in_use, "{name}");
    }
}

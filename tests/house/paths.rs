//! Files and folders mentioned by the project's pages exist.
//!
//! The pages are ARCHITECTURE.md, CONTRIBUTING.md, the pages in `docs` and the README.md of every folder. A path on a
//! page is a word with a slash that starts with a folder of code, or that has an extension that occurs in this tree.
//! The path starts at the root, at the page's own folder, or with the name of a crate: `base/message.rs` is
//! `crates/base/src/message.rs`.

use std::{
    fs,
    path::{Path, PathBuf},
};

const EXTENSIONS: [&str; 11] = ["rs", "c", "cpp", "h", "hpp", "md", "dat", "txt", "py", "toml", "sh"];

/// Folders of the root that contain code.
const CODE: [&str; 6] = ["cli/", "crates/", "include/", "lab/", "pbrt-shim/", "src/"];

/// Folders of another program that are mentioned by pages and do not exist in this tree.
const FOREIGN: [&str; 2] = ["pbrt/", "src/pbrt/"];

/// Returns the paths in a page's text, without duplicates.
fn paths(text: &str) -> Vec<&str> {
    let breaks = |c: char| c.is_whitespace() || "`'\"()[]<>{}|,;#".contains(c);
    let words = text.split(breaks).map(|word| word.trim_end_matches(['.', ':', '!', '?']));
    let is_path = |word: &&str| {
        let extension = word.rsplit('/').next().and_then(|file| file.rsplit_once('.')).map(|(_, last)| last);
        let is_code = CODE.iter().any(|folder| word.starts_with(folder));
        word.contains('/')
            && !word.contains(['*', '…'])
            && !word.contains("://")
            && (is_code || extension.is_some_and(|last| EXTENSIONS.contains(&last)))
    };
    let mut found: Vec<&str> = words.filter(is_path).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// Collects the pages below a folder that are called README.md.
fn read_me(folder: &Path, pages: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a directory").flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        if path.is_dir() && name != "target" && !name.to_string_lossy().starts_with('.') {
            read_me(&path, pages);
        } else if name == "README.md" {
            pages.push(path);
        }
    }
}

#[test]
fn every_path_in_a_page_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let crates = root.join("crates");
    let mut pages = vec![root.join("ARCHITECTURE.md"), root.join("CONTRIBUTING.md")];
    read_me(root, &mut pages);
    let docs = fs::read_dir(root.join("docs")).expect("a directory").flatten().map(|entry| entry.path());
    pages.extend(docs.filter(|page| page.extension().is_some_and(|end| end == "md")));
    let (mut checked, mut dead) = (0, Vec::new());
    for page in pages {
        let text = fs::read_to_string(&page).expect("text");
        let own = page.parent().expect("a folder");
        let is_own = |path: &&str| !FOREIGN.iter().any(|folder| path.starts_with(folder));
        for path in paths(&text).into_iter().filter(is_own) {
            checked += 1;
            let in_crate = path.split_once('/').map(|(name, file)| crates.join(name).join("src").join(file));
            let candidates = [Some(root.join(path)), Some(own.join(path)), in_crate];
            if !candidates.into_iter().flatten().any(|candidate| candidate.exists()) {
                dead.push(format!("{}: {path}", page.strip_prefix(root).expect("below the root").display()));
            }
        }
    }
    super::nothing(&dead);
    assert!(checked > 60, "only {checked} paths are named");
}

#[test]
fn a_path_differs_from_other_words() {
    let text = "See `a/b.rs`, [c](../d/e.md#part) and (f/g.txt). Not and/or, h.rs, https://i.org/j.md, k/l, m/n.o5, \
                12/34.5, p.q/r or u/*.rs; but s/t.toml, `src/v`: and a/b.rs again.";
    assert_eq!(paths(text), ["../d/e.md", "a/b.rs", "f/g.txt", "s/t.toml", "src/v"]);
}

//! The phrases that `docs/words.md` bans stand nowhere: not in a page, a comment, a message, the header or a docstring.
//!
//! A phrase is looked for in a file's text without regard to capitals and to where lines end: marks of comments at the
//! beginnings of lines count as spaces.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// What is read, from the root: files, and folders with all files of [`EXTENSIONS`] in them.
const READ: [&str; 12] = [
    "README.md",
    "ARCHITECTURE.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "docs",
    "include",
    "src",
    "cli/src",
    "lab/src",
    "python/src",
    "blender/extension",
    "examples",
];
const EXTENSIONS: [&str; 7] = ["md", "rs", "py", "h", "hpp", "c", "cpp"];
/// The page with the list.
const LIST: &str = "docs/words.md";

/// The first column of the list's table of banned phrases.
fn banned(page: &str) -> Vec<String> {
    let (_, section) = page.split_once("## Banned\n").expect("the section");
    let section = section.split("\n## ").next().expect("its text");
    let rows = section.lines().filter(|line| line.starts_with("| ")).skip(1);
    rows.map(|row| row.split('|').nth(1).expect("a cell").trim().to_lowercase()).collect()
}

/// A text in lower case, in one line, without marks of comments.
fn flat(text: &str) -> String {
    let lines = text
        .lines()
        .map(|line| line.trim_start().trim_start_matches(['/', '!', '#', '*']).trim_end_matches('\\'));
    let words = lines.flat_map(str::split_whitespace).map(str::to_lowercase);
    words.collect::<Vec<_>>().join(" ")
}

fn files(path: &Path, found: &mut Vec<PathBuf>) {
    if path.is_dir() {
        for entry in fs::read_dir(path).expect("a directory").flatten() {
            files(&entry.path(), found);
        }
    } else if path.extension().is_some_and(|end| EXTENSIONS.iter().any(|known| end == *known)) {
        found.push(path.to_owned());
    }
}

#[test]
fn no_banned_phrase_stands_anywhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let list = root.join(LIST);
    let banned = banned(&fs::read_to_string(&list).expect("the list"));
    assert!(banned.len() > 15, "only {} phrases", banned.len());
    let mut all = Vec::new();
    for path in READ {
        let before = all.len();
        files(&root.join(path), &mut all);
        assert!(all.len() > before, "nothing to read in {path}");
    }
    let mut found = Vec::new();
    for file in all.into_iter().filter(|file| *file != list) {
        let text = flat(&fs::read_to_string(&file).expect("text"));
        for phrase in banned.iter().filter(|phrase| text.contains(phrase.as_str())) {
            found.push(format!("{}: {phrase:?}", file.strip_prefix(root).expect("below the root").display()));
        }
    }
    super::nothing(&found);
}

#[test]
fn a_phrase_is_found_across_lines_of_a_comment() {
    let page = "## Banned\n\n| not | but |\n|---|---|\n| it worked | success |\n| So Many | n |\n\n## Former\n| not | but |\n";
    assert_eq!(banned(page), ["it worked", "so many"]);
    assert_eq!(flat("    /// It\n    /// worked.\n# so\n * many"), "it worked. so many");
}

//! Links between the project's pages have targets: each leads to a file of the project and, after a `#`, to one of its
//! headings.
//!
//! Links to the web are not followed, since tests do not use the network.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

/// Collects the project's pages: Markdown files below the root, without build folders.
pub fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a directory").flatten() {
        let (path, name) = (entry.path(), entry.file_name());
        let name = name.to_string_lossy();
        if path.is_dir() && !name.starts_with("target") && (!name.starts_with('.') || name == ".github") {
            pages(&path, found);
        } else if name.ends_with(".md") {
            found.push(path);
        }
    }
}

/// Returns a page without its code blocks.
fn prose(text: &str) -> String {
    let parts = text.split("\n```").enumerate().filter(|(i, _)| i % 2 == 0);
    parts.map(|(_, part)| part).collect::<Vec<_>>().join("\n")
}

/// Returns the targets of a page's links and pictures.
fn targets(text: &str) -> Vec<String> {
    let prose = prose(text);
    prose.split("](").skip(1).filter_map(|rest| Some(rest.split_once(')')?.0.to_owned())).collect()
}

/// Returns the anchors of a page's headings, as public forges form them: in lower case, with hyphens for spaces and
/// without punctuation.
fn anchors(text: &str) -> Vec<String> {
    let headings = prose(text);
    let headings = headings.lines().filter_map(|line| line.strip_prefix('#'));
    let anchor = |heading: &str| -> String {
        let is_kept = |c: &char| c.is_alphanumeric() || matches!(c, '-' | '_' | ' ');
        let text = heading.trim_start_matches('#').trim().to_lowercase();
        text.chars().filter(is_kept).map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(anchor).collect()
}

/// Returns the dead links of pages, and the number of links within the project.
fn dead(root: &Path, pages: &[PathBuf]) -> (Vec<String>, usize) {
    let mut headings: BTreeMap<PathBuf, Vec<String>> = BTreeMap::new();
    let (mut dead, mut followed) = (Vec::new(), 0);
    for page in pages {
        let text = fs::read_to_string(page).expect("text");
        for target in targets(&text) {
            if target.contains("://") || target.starts_with("mailto:") {
                continue;
            }
            followed += 1;
            let (file, anchor) = target.split_once('#').unwrap_or((&target, ""));
            let file =
                if file.is_empty() { page.clone() } else { page.parent().expect("a folder").join(file) };
            let is_there = file.exists();
            let has_anchor = anchor.is_empty()
                || is_there
                    && headings
                        .entry(file.clone())
                        .or_insert_with(|| anchors(&fs::read_to_string(&file).expect("a page")))
                        .iter()
                        .any(|heading| heading == anchor);
            if !is_there || !has_anchor {
                dead.push(format!("{}: {target}", page.strip_prefix(root).expect("below").display()));
            }
        }
    }
    (dead, followed)
}

#[test]
fn every_link_between_pages_leads_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = Vec::new();
    pages(root, &mut all);
    let (dead, followed) = dead(root, &all);
    super::nothing(&dead);
    assert!(followed > 250, "only {followed} links");
}

#[test]
fn dead_links_are_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("page.md");
    let text = "# The Page, 1\n[a](other.md) [b](#the-page-1) [c](none.md) [d](#page) [e](https://f.org)\n\n```\n[g](h)\n```\n\
                ![i](other.md#b--c)";
    fs::write(&page, text).expect("written");
    fs::write(folder.path().join("other.md"), "## `B` & c").expect("written");
    let (dead, followed) = dead(folder.path(), &[page]);
    assert_eq!(dead, ["page.md: none.md", "page.md: #page"]);
    assert_eq!(followed, 5);
}

#[test]
fn every_page_of_the_documentation_is_in_its_table_of_contents() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let contents = fs::read_to_string(docs.join("README.md")).expect("the table of contents");
    let listed = targets(&contents);
    let pages = fs::read_dir(&docs).expect("a directory").flatten().map(|entry| entry.file_name());
    let pages = pages.map(|name| name.to_string_lossy().into_owned());
    let missing: Vec<String> = pages
        .filter(|name| name.ends_with(".md") && name != "README.md")
        .filter(|name| !listed.iter().any(|target| target.split('#').next() == Some(name)))
        .collect();
    super::nothing(&missing);
}

/// Pages with their maximum numbers of words, including code and tables; the limits are low so that people read these
/// pages to the end.
const SHORT: [(&str, usize); 2] = [("README.md", 900), ("ARCHITECTURE.md", 900)];

#[test]
fn the_first_pages_are_short() {
    for (page, most) in SHORT {
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(page)).expect("text");
        let words = text.split_whitespace().count();
        assert!(words <= most, "{page}: {words} words; move some to a page of docs or to the code");
    }
}

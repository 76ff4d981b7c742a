//! Which file uses which, and what that must not be: an arrow up the rooms' order, or a circle.

use std::collections::{BTreeMap, BTreeSet};

use super::source::{Tree, below};

/// One file uses another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Arrow {
    /// The path of the file that uses.
    pub from: String,
    /// The path of the file that is used.
    pub to: String,
    /// What it is used for, as it is written: a path.
    pub path: String,
}

/// A file's module: what it is called, and what names stand for in it.
struct Module {
    file: String,
    imports: BTreeMap<String, Vec<String>>,
}

/// A path in the source, from the crate's root.
struct Mention {
    path: Vec<String>,
    /// The name that an import gives it.
    name: Option<String>,
    is_public: bool,
}

impl Arrow {
    /// All of a package.
    pub fn all(tree: &Tree) -> Vec<Self> {
        let mut modules: BTreeMap<Vec<String>, Module> = BTreeMap::new();
        for path in tree.files.keys() {
            modules.insert(module(path), Module { file: path.clone(), imports: BTreeMap::new() });
        }
        let names: BTreeSet<Vec<String>> = modules.keys().cloned().collect();
        let mut mentions = Vec::new();
        for (path, words) in &tree.files {
            let found =
                Reader { names: &names, words, at: 0, within: module(path), found: Vec::new() }.read();
            for mention in &found {
                if let (Some(name), Some(module)) = (&mention.name, modules.get_mut(&module(path))) {
                    module.imports.insert(name.clone(), mention.path.clone());
                }
            }
            mentions.push((path, words, found));
        }
        let mut arrows = BTreeSet::new();
        for (from, words, found) in mentions {
            for Mention { path, name, is_public } in found {
                let uses = |name: &String| words.iter().filter(|word| *word == name).count() > 1;
                if is_public && !name.as_ref().is_some_and(uses) {
                    continue;
                }
                let to = file(&modules, &path, 0);
                if to != *from {
                    arrows.insert(Self { from: from.clone(), to, path: path.join("::") });
                }
            }
        }
        arrows.into_iter().collect()
    }

    fn text(&self) -> String {
        format!("{} -> {} ({})", self.from, self.to, self.path)
    }
}

/// The module that a file holds, by the names on the way to it from the root.
fn module(path: &str) -> Vec<String> {
    below(path).split('/').filter(|part| !part.is_empty()).map(str::to_owned).collect()
}

/// The file that a path from the root leads to, re-exports followed.
fn file(modules: &BTreeMap<Vec<String>, Module>, path: &[String], steps: usize) -> String {
    let inner = (0..=path.len()).rev().find(|&n| modules.contains_key(&path[..n])).unwrap_or(0);
    let Some(module) = modules.get(&path[..inner]) else { return String::new() };
    let target = path.get(inner).and_then(|name| module.imports.get(name));
    match target {
        // A name that stands for itself ends here.
        Some(target) if steps < 16 && target.as_slice() != &path[..target.len().min(path.len())] => {
            let further: Vec<String> = target.iter().chain(&path[inner + 1..]).cloned().collect();
            file(modules, &further, steps + 1)
        }
        _ => module.file.clone(),
    }
}

/// Reads the paths of one file.
struct Reader<'a> {
    names: &'a BTreeSet<Vec<String>>,
    words: &'a [String],
    at: usize,
    within: Vec<String>,
    found: Vec<Mention>,
}

impl Reader<'_> {
    fn word(&self, ahead: usize) -> &str {
        self.words.get(self.at + ahead).map_or("", String::as_str)
    }

    fn read(mut self) -> Vec<Mention> {
        // Whether each open brace is that of a module within the file.
        let mut braces = Vec::new();
        let mut is_public = false;
        while self.at < self.words.len() {
            match self.word(0) {
                "mod" if self.word(2) == "{" => {
                    self.within.push(self.word(1).to_owned());
                    braces.push(true);
                    self.at += 3;
                }
                "{" => {
                    braces.push(false);
                    self.at += 1;
                }
                "}" => {
                    if braces.pop() == Some(true) {
                        self.within.pop();
                    }
                    self.at += 1;
                }
                "use" => {
                    self.at += 1;
                    self.tree(&[], Some(is_public));
                }
                "pub" => {
                    self.at += 1;
                    let is_restricted = self.word(0) == "(";
                    let end = self.words[self.at..].iter().position(|word| word == ")").unwrap_or(0);
                    is_public = self.words.get(self.at + if is_restricted { end + 1 } else { 0 })
                        == Some(&"use".to_owned());
                    if is_restricted && is_public {
                        self.at += end + 1;
                    }
                    continue;
                }
                _ if self.word(1) == "::" && (self.at == 0 || self.words[self.at - 1] != "::") => {
                    self.tree(&[], None);
                }
                _ => self.at += 1,
            }
            is_public = false;
        }
        self.found
    }

    /// Reads a path, or several in braces, that goes on from `start`. `import`: whether it is imported, and publicly.
    fn tree(&mut self, start: &[String], import: Option<bool>) {
        let mut path = start.to_vec();
        loop {
            if self.word(0) == "{" {
                self.at += 1;
                while self.at < self.words.len() && self.word(0) != "}" {
                    self.tree(&path, import);
                    self.at += usize::from(self.word(0) == ",");
                }
                self.at += 1;
                return;
            }
            path.push(self.word(0).to_owned());
            self.at += 1;
            // Not a path, but what belongs to its last part: `a::b::<T>`.
            if self.word(0) != "::" || self.word(1) == "<" {
                break;
            }
            self.at += 1;
        }
        let mut name = path.last().filter(|last| *last != "*").cloned();
        if path.last().is_some_and(|last| last == "self" || last == "*") && path.len() > 1 {
            path.pop();
            name = name.and_then(|_| path.last().cloned());
        }
        if import.is_some() && self.word(0) == "as" {
            name = Some(self.word(1).to_owned());
            self.at += 2;
        }
        if let Some(path) = self.absolute(&path) {
            let name = import.and(name);
            self.found.push(Mention { path, name, is_public: import == Some(true) });
        }
    }

    /// A path as from the crate's root; `None` where it leads to another crate or a local name.
    fn absolute(&self, path: &[String]) -> Option<Vec<String>> {
        let mut base = match path.first()?.as_str() {
            "crate" => Vec::new(),
            "self" | "super" => self.within.clone(),
            first => {
                let child: Vec<String> = self.within.iter().cloned().chain([first.to_owned()]).collect();
                return self
                    .names
                    .contains(&child)
                    .then(|| self.within.iter().chain(path).cloned().collect());
            }
        };
        for part in path {
            match part.as_str() {
                "crate" | "self" => {}
                "super" => drop(base.pop()),
                name => base.push(name.to_owned()),
            }
        }
        Some(base)
    }
}

/// Arrows from a room to one after it.
pub fn upward(arrows: &[Arrow], order: &[&str]) -> Vec<String> {
    let place = |path: &str| order.iter().position(|room| module(path).first().is_some_and(|m| m == room));
    let up = |arrow: &&Arrow| matches!((place(&arrow.from), place(&arrow.to)), (Some(a), Some(b)) if a < b);
    arrows.iter().filter(up).map(Arrow::text).collect()
}

/// Sets of files that lead to each other, each with the arrows within it.
pub fn circles(arrows: &[Arrow]) -> Vec<String> {
    let files: BTreeSet<&str> = arrows.iter().flat_map(|arrow| [&*arrow.from, &*arrow.to]).collect();
    let reached: BTreeMap<&str, BTreeSet<&str>> =
        files.iter().map(|&file| (file, reach(arrows, file))).collect();
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for &file in &files {
        let circle: BTreeSet<&str> =
            reached[file].iter().copied().filter(|other| reached[other].contains(file)).collect();
        if circle.is_empty() || !seen.insert(circle.clone()) {
            continue;
        }
        let within = |arrow: &&Arrow| circle.contains(&*arrow.from) && circle.contains(&*arrow.to);
        let lines: Vec<String> =
            arrows.iter().filter(within).map(|arrow| format!("    {}", arrow.text())).collect();
        found.push(format!("{} files in a circle:\n{}", circle.len(), lines.join("\n")));
    }
    found
}

/// The files that arrows lead to from one, in one step or more.
fn reach<'a>(arrows: &'a [Arrow], from: &str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from];
    while let Some(file) = open.pop() {
        for arrow in arrows.iter().filter(|arrow| arrow.from == file) {
            if reached.insert(&*arrow.to) {
                open.push(&arrow.to);
            }
        }
    }
    reached
}

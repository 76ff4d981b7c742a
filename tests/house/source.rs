//! Rust source as text: files to words, without comments, text and tests.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

/// A package's source.
pub struct Tree {
    /// The words of each file by its path in the package's source folder.
    pub files: BTreeMap<String, Vec<String>>,
}

impl Tree {
    /// All files below a folder.
    pub fn read(folder: &Path) -> Self {
        let mut files = Vec::new();
        collect(folder, "", &mut files);
        assert!(!files.is_empty(), "no source in {}", folder.display());
        Self::new(files.into_iter())
    }

    /// Files with the given paths and texts.
    pub fn of(files: &[(&str, &str)]) -> Self {
        Self::new(files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())))
    }

    fn new(files: impl Iterator<Item = (String, String)>) -> Self {
        let mut tests = BTreeSet::new();
        let mut words = BTreeMap::new();
        for (path, text) in files {
            let folder = below(&path);
            let (shipped, modules) = without_tests(&split(&text));
            tests.extend(modules.iter().map(|module| format!("{folder}{module}.rs")));
            words.insert(path, shipped);
        }
        words.retain(|path, _| !tests.contains(path));
        Self { files: words }
    }

    /// What the root declares: the first part of each path, without `.rs`.
    pub fn rooms(&self) -> Vec<String> {
        let parts = self.files.keys().map(|path| path.split('/').next().unwrap_or(path));
        let rooms: BTreeSet<String> = parts.map(|part| part.trim_end_matches(".rs").to_owned()).collect();
        rooms.into_iter().filter(|room| room != "lib" && room != "main").collect()
    }

    /// Files with unsafe code whose paths begin with none of `allowed`.
    pub fn unsafe_outside(&self, allowed: &[&str]) -> Vec<String> {
        let is_unsafe = |words: &[String]| words.iter().any(|word| word == "unsafe");
        let outside = |path: &str| !allowed.iter().any(|folder| path.starts_with(folder));
        let files = self.files.iter().filter(|(path, words)| outside(path) && is_unsafe(words));
        files.map(|(path, _)| path.clone()).collect()
    }
}

/// The folder in which the modules lie that a file declares, with `/` behind it unless it is the root.
pub fn below(path: &str) -> String {
    let (folder, file) = path.rsplit_once('/').map_or(("", path), |(folder, file)| (folder, file));
    let parts = match file {
        "mod.rs" => folder.to_owned(),
        "lib.rs" | "main.rs" if folder.is_empty() => return String::new(),
        _ => path.trim_end_matches(".rs").to_owned(),
    };
    format!("{parts}/")
}

fn collect(folder: &Path, prefix: &str, files: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.expect("an entry of a folder").path();
        let name = path.file_name().expect("a name").to_str().expect("a name in UTF-8");
        if path.is_dir() {
            collect(&path, &format!("{prefix}{name}/"), files);
        } else if name.ends_with(".rs") {
            files.push((format!("{prefix}{name}"), fs::read_to_string(&path).expect("source in UTF-8")));
        }
    }
}

/// Words, `::`, and single signs. Text becomes the word `""`; comments and lifetimes go.
fn split(text: &str) -> Vec<String> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut words = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let raw = rest.strip_prefix('b').unwrap_or(rest).strip_prefix('r');
        let fence = raw.map(|raw| raw.len() - raw.trim_start_matches('#').len());
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            comment(rest)
        } else if let (Some(raw), Some(fence)) = (raw, fence)
            && raw[fence..].starts_with('"')
        {
            words.push("\"\"".to_owned());
            let open = rest.len() - raw.len() + fence + 1;
            let close = format!("\"{}", "#".repeat(fence));
            rest[open..].find(&close).map_or(rest.len(), |at| open + at + close.len())
        } else if first == '"' {
            words.push("\"\"".to_owned());
            quoted(rest)
        } else if first == '\'' {
            let mut after = rest[1..].chars();
            match (after.next(), after.next()) {
                (Some('\\'), Some(_)) => rest[3..].find('\'').map_or(rest.len(), |at| at + 4),
                (Some(c), Some('\'')) => c.len_utf8() + 2,
                _ => 1 + rest[1..].find(|c| !is_word(c)).unwrap_or(rest.len() - 1),
            }
        } else if is_word(first) {
            let length = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            words.push(rest[..length].to_owned());
            length
        } else if rest.starts_with("::") {
            words.push("::".to_owned());
            2
        } else {
            if !first.is_whitespace() {
                words.push(first.to_string());
            }
            first.len_utf8()
        };
        rest = &rest[length..];
    }
    words
}

/// The length of the comment, which may hold others, that a text begins with.
fn comment(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        let rest = &text.as_bytes()[at..];
        match rest {
            [b'/', b'*', ..] => depth += 1,
            [b'*', b'/', ..] => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

/// The length of the quoted text that a text begins with.
fn quoted(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return at + 1,
            _ => escaped = c == '\\' && !escaped,
        }
    }
    text.len()
}

/// The words without what stands under `#[cfg(test)]` or the like, and the modules that are declared under it.
fn without_tests(words: &[String]) -> (Vec<String>, Vec<String>) {
    let (mut shipped, mut modules) = (Vec::new(), Vec::new());
    let mut at = 0;
    while at < words.len() {
        let starts = |expected: &[&str]| words[at..].iter().zip(expected).filter(|(a, b)| a == b).count();
        if starts(&["#", "[", "cfg", "("]) == 4 {
            let end = at + closing(&words[at + 1..]) + 1;
            if words[at..end].iter().any(|word| word == "test") && !words[at..end].iter().any(|w| w == "not")
            {
                let length = item(&words[end..]);
                if let [first, name, semicolon] = &words[end..end + length]
                    && (first.as_str(), semicolon.as_str()) == ("mod", ";")
                {
                    modules.push(name.clone());
                }
                at = end + length;
                continue;
            }
        }
        shipped.push(words[at].clone());
        at += 1;
    }
    (shipped, modules)
}

/// How many words there are to the bracket that closes the first, with it.
fn closing(words: &[String]) -> usize {
    let mut depth = 0;
    for (at, word) in words.iter().enumerate() {
        match word.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + 1;
        }
    }
    words.len()
}

/// How many words an item has: to its semicolon, or to the end of its braces (an import's are followed by one).
fn item(words: &[String]) -> usize {
    let is_import = words.iter().take_while(|word| *word != "{" && *word != ";").any(|word| word == "use");
    let mut at = 0;
    while at < words.len() {
        match words[at].as_str() {
            ";" => return at + 1,
            "{" if !is_import => return at + closing(&words[at..]),
            "(" | "[" | "{" => at += closing(&words[at..]),
            _ => at += 1,
        }
    }
    words.len()
}

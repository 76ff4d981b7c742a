//! Reads the files of a collection, several at a time, and those alone that no earlier run has read.

use super::cache::Cache;
use super::outcome::Outcome;
use super::row::{ListRow, facts};
use rayon::prelude::*;
use realistic_optics::prescription::{Collection, CollectionFile, GlassLibrary, SearchPath, catalogue};
use std::path::Path;

/// Maximum number of bytes of a collection's files that are read, 1 GiB. An archive of a few MB may state more.
const MOST_BYTES: u64 = 1 << 30;

/// Number of files that a thread reads one after the other, with one index of the glass catalogues beside them.
pub const AT_ONCE: usize = 128;

/// The rows of a list, and the files of the rows.
#[derive(Debug, Default)]
pub struct Listing {
    /// The rows, each with its file; a lens of the catalogue and a part that cannot be looked at have none.
    pub rows: Vec<(ListRow, Option<CollectionFile>)>,
    /// Number of files that are no lenses.
    pub others: usize,
}

impl Listing {
    /// Adds the lenses of the catalogue.
    pub fn add_catalogue(&mut self) {
        for name in catalogue::names() {
            let facts = catalogue::find(name).ok_or_else(String::new).and_then(|lens| facts(&lens));
            let row = match facts {
                Ok(facts) => ListRow::of_lens(name, name, &facts),
                Err(why) => ListRow::of_error(name, name, &why),
            };
            self.rows.push((row, None));
        }
    }

    /// Adds the lenses of a collection, and the reasons why other files of it cannot be read.
    pub fn add(&mut self, collection: &Collection, search: &SearchPath, cache: Cache) {
        let mut left = MOST_BYTES;
        let is_affordable = |file: &&CollectionFile| {
            left = left.saturating_sub(Outcome::cost(file));
            left > 0
        };
        let affordable = collection.files().iter().take_while(is_affordable).count();
        let (files, rest) = collection.files().split_at(affordable);
        let read = files.par_chunks(AT_ONCE).flat_map_iter(|files| read(files, search, &cache));
        let outcomes: Vec<Outcome> = read.collect();
        for fault in collection.faults() {
            let path = collection.root().join(&fault.name).display().to_string();
            self.rows.push((ListRow::of_error(&fault.name, &path, &fault.why), None));
        }
        for (file, outcome) in files.iter().zip(&outcomes) {
            let path = file.path();
            let row = match outcome {
                Outcome::Lens(facts) => ListRow::of_lens(&file.name, &path, facts),
                Outcome::Unreadable(why) => ListRow::of_error(&file.name, &path, why),
                Outcome::NoLens => {
                    self.others += 1;
                    continue;
                }
            };
            self.rows.push((row, Some(file.clone())));
        }
        if let Some(first) = rest.first() {
            let why = format!(
                "and {} files behind it are not read: those of a collection have at most {MOST_BYTES} bytes (1 GiB) together",
                rest.len() - 1
            );
            self.rows.push((ListRow::of_error(&first.name, &first.path(), &why), None));
        }
        cache.keep(files.iter().zip(&outcomes));
    }
}

/// Reads files that follow each other.
fn read(files: &[CollectionFile], search: &SearchPath, cache: &Cache) -> Vec<Outcome> {
    let mut glasses = Glasses::new(search);
    let mut outcomes = Vec::with_capacity(files.len());
    for file in files {
        let known = cache.outcome(file);
        outcomes.push(known.unwrap_or_else(|| Outcome::of(file, glasses.of(file))));
    }
    outcomes
}

/// The glasses of files that follow each other, which are indexed once for each folder.
pub struct Glasses<'f> {
    everywhere: GlassLibrary,
    beside: Option<(&'f Path, GlassLibrary)>,
}

impl<'f> Glasses<'f> {
    /// Returns the glasses of a search path, before the first file.
    pub fn new(search: &SearchPath) -> Self {
        Self { everywhere: GlassLibrary::default().with_places(search.glasses()), beside: None }
    }

    /// Returns the glasses of a file.
    pub fn of(&mut self, file: &'f CollectionFile) -> &GlassLibrary {
        let same = self.beside.take().filter(|(folder, _)| *folder == file.folder());
        let beside = same.unwrap_or_else(|| (file.folder(), file.glasses(&self.everywhere)));
        &self.beside.insert(beside).1
    }
}

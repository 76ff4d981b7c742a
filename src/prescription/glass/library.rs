//! Where a glass's name is looked up: in the catalogue that the user names, in those beside the lens file, among the
//! built-in ones. A name in, a medium out.

use std::{
    cell::OnceCell,
    io::Read,
    path::{Path, PathBuf},
};

use super::built_in;
use crate::{
    message::nearest,
    prescription::{
        error::LensFileError,
        interfaces::Medium,
        limits::{MAX_CATALOG_BYTES, MAX_CATALOGS},
        reader::agf::{self, Entry},
    },
};

/// The glasses that a lens file may name.
#[derive(Debug, Default)]
pub struct GlassLibrary {
    /// Of the catalogue that the user names.
    given: Vec<Entry>,
    /// The lens file's directory, if it has one; its catalogues are read when a glass is first looked for.
    directory: Option<PathBuf>,
    beside: OnceCell<Vec<Entry>>,
}

impl GlassLibrary {
    /// Adds the glasses of an AGF catalogue, `file` being its name in messages. They come before the built-in ones of the
    /// same name.
    ///
    /// # Errors
    /// The text is no such catalogue, or longer than [`MAX_CATALOG_BYTES`].
    pub fn add(&mut self, file: &str, bytes: &[u8]) -> Result<(), LensFileError> {
        self.given.extend(agf::read(file, bytes)?);
        Ok(())
    }

    /// The same with the catalogues (`*.agf`) that stand in the directory of `lens_file`.
    #[must_use]
    pub fn beside(mut self, lens_file: &Path) -> Self {
        self.directory = lens_file.parent().map(Path::to_owned);
        self
    }

    /// The glass of that name, capitals or not. `None`: no such glass.
    ///
    /// # Errors
    /// A catalogue has the glass, and what it says cannot be used: why.
    pub fn find(&self, name: &str) -> Option<Result<Medium, String>> {
        let entry = [&self.given, self.besides()]
            .into_iter()
            .flatten()
            .find(|entry| entry.name.eq_ignore_ascii_case(name));
        entry.map(|entry| entry.medium.clone()).or_else(|| built_in::find(name).map(Ok))
    }

    /// What the user may have meant by a name that is not known, as the end of a sentence.
    pub fn suggestion(&self, name: &str) -> String {
        let own = [&self.given, self.besides()].into_iter().flatten().map(|entry| entry.name.as_str());
        let known = own.chain(built_in::names().map(|known| -> &str { known }));
        let known: Vec<(String, &str)> = known.map(|known| (known.to_ascii_lowercase(), known)).collect();
        let nearest = nearest(name, known.iter().map(|(lower, _)| lower.as_str()));
        let nearest = nearest.and_then(|nearest| known.iter().find(|(lower, _)| lower == nearest));
        nearest.map_or_else(String::new, |(_, known)| format!("; the nearest that is known is {known}"))
    }

    fn besides(&self) -> &Vec<Entry> {
        self.beside.get_or_init(|| {
            let is_catalogue =
                |path: &PathBuf| path.extension().is_some_and(|end| end.eq_ignore_ascii_case("agf"));
            let directory = self.directory.as_ref().map(|path| match path.as_os_str().is_empty() {
                true => Path::new("."),
                false => path,
            });
            let Some(Ok(entries)) = directory.map(std::fs::read_dir) else { return Vec::new() };
            let mut files: Vec<PathBuf> =
                entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_catalogue).collect();
            files.sort();
            files.iter().take(MAX_CATALOGS).filter_map(|file| read_file(file).ok()).flatten().collect()
        })
    }
}

/// The glasses of a file that is there.
fn read_file(path: &Path) -> Result<Vec<Entry>, String> {
    let mut bytes = Vec::new();
    if !path.is_file() {
        return Err("no file".to_owned());
    }
    let file = std::fs::File::open(path).map_err(|error| error.to_string())?;
    file.take(MAX_CATALOG_BYTES + 1).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    agf::read(&path.display().to_string(), &bytes).map_err(|error| error.to_string())
}

//! Where a glass's name is looked up: in the catalogue that the user names, in those beside the lens file, among the
//! built-in ones. A name in, glasses out.

use std::{
    cell::OnceCell,
    io::Read,
    path::{Path, PathBuf},
};

use super::{built_in, loose};
use crate::{
    message::{cut, nearest},
    prescription::{
        LensFileError, MAX_CATALOG_BYTES, MAX_CATALOG_GLASSES, MAX_CATALOGS, interfaces::Glass,
        reader::agf::Catalogue,
    },
};

/// The glasses that a lens file may name.
#[derive(Debug, Default)]
pub struct GlassLibrary {
    /// The catalogue that the user names.
    given: Vec<Catalogue>,
    /// The lens file's directory, if it has one; its catalogues are indexed when a glass is first looked for.
    directory: Option<PathBuf>,
    beside: OnceCell<Beside>,
}

/// The catalogues beside a lens file, and a sentence for each that is left out.
#[derive(Debug, Default)]
struct Beside {
    catalogues: Vec<Catalogue>,
    told: Vec<String>,
}

impl GlassLibrary {
    /// Adds the glasses of an AGF catalogue, `file` being its name in messages. They come before the built-in ones of the
    /// same name.
    ///
    /// # Errors
    /// The text is no such catalogue, or has more than [`MAX_CATALOG_BYTES`] or [`MAX_CATALOG_GLASSES`].
    pub fn add(&mut self, file: &str, bytes: &[u8]) -> Result<(), LensFileError> {
        self.given.push(Catalogue::new(file, bytes)?);
        Ok(())
    }

    /// The same with the catalogues (`*.agf`) that stand in the directory of `lens_file`.
    #[must_use]
    pub fn beside(mut self, lens_file: &Path) -> Self {
        self.directory = lens_file.parent().map(Path::to_owned);
        self
    }

    /// The glass of that name, without regard to capitals, dashes, underscores and spaces; `CATALOGUE:NAME` is that of one
    /// catalogue. `None`: no such glass.
    ///
    /// # Errors
    /// A catalogue has the glass, and what it says cannot be used: why.
    pub fn find(&self, name: &str) -> Option<Result<Glass, String>> {
        self.candidates(name, &[]).into_iter().next()
    }

    /// All glasses of that name, as [`find`](Self::find) has it, in the order of preference; among the built-in ones those of
    /// the catalogues in `first` before the others.
    pub fn candidates(&self, name: &str, first: &[String]) -> Vec<Result<Glass, String>> {
        let (only, own) = match name.split_once(':') {
            Some((catalogue, own)) => (Some(loose(catalogue)), loose(own)),
            None => (None, loose(name)),
        };
        let only = only.as_deref();
        let files = self.files().filter(|file| only.is_none_or(|only| only == file.name));
        let found = files.filter_map(|file| file.find(&own));
        found.chain(built_in::candidates(&own, only, first).into_iter().map(Ok)).collect()
    }

    /// What the user may have meant by a name that is not known, and which catalogues were not looked into, as the end of a
    /// sentence.
    pub fn suggestion(&self, name: &str) -> String {
        let known =
            self.files().flat_map(Catalogue::names).chain(built_in::names().map(|known| -> &str { known }));
        let known: Vec<(String, &str)> = known.map(|known| (known.to_ascii_lowercase(), known)).collect();
        let nearest = nearest(name, known.iter().map(|(lower, _)| lower.as_str()));
        let nearest = nearest.and_then(|nearest| known.iter().find(|(lower, _)| lower == nearest));
        let nearest = nearest.map(|(_, known)| format!("; the nearest that is known is {known}"));
        let told = self.told().iter().map(|told| format!("; {told}"));
        nearest.into_iter().chain(told).collect()
    }

    /// What was left out of the catalogues beside the lens, if a glass was looked for there.
    pub fn told(&self) -> &[String] {
        self.beside.get().map_or(&[], |beside| &beside.told)
    }

    fn files(&self) -> impl Iterator<Item = &Catalogue> {
        let beside =
            self.beside.get_or_init(|| self.directory.as_deref().map_or_else(Beside::default, Beside::of));
        self.given.iter().chain(&beside.catalogues)
    }
}

impl Beside {
    /// The catalogues of a directory, in the order of their names, as far as the limits reach.
    fn of(directory: &Path) -> Self {
        let is_catalogue = |path: &PathBuf| {
            path.extension().is_some_and(|end| end.eq_ignore_ascii_case("agf")) && path.is_file()
        };
        let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
        let Ok(entries) = std::fs::read_dir(directory) else { return Self::default() };
        let mut files: Vec<PathBuf> =
            entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_catalogue).collect();
        files.sort();
        let mut all = Self::default();
        let (mut bytes_left, mut glasses_left) = (MAX_CATALOG_BYTES, MAX_CATALOG_GLASSES);
        let mut beyond: Vec<String> = Vec::new();
        for path in files {
            let file = path.display().to_string();
            let own = path.file_name().map_or_else(String::new, |own| cut(&own.to_string_lossy()));
            let is_full = all.catalogues.len() == MAX_CATALOGS;
            match if is_full { Ok(None) } else { bytes_of(&path, bytes_left) } {
                Ok(Some(bytes)) => {
                    bytes_left -= bytes.len() as u64;
                    match Catalogue::new(&file, &bytes) {
                        Ok(catalogue) if catalogue.len() <= glasses_left => {
                            glasses_left -= catalogue.len();
                            all.catalogues.push(catalogue);
                        }
                        Ok(_) => beyond.push(own),
                        Err(error) => all.told.push(format!("{error}: its glasses are left out")),
                    }
                }
                Ok(None) => beyond.push(own),
                Err(error) => all.told.push(format!("glass catalogue {own} cannot be read: {error}")),
            }
            if all.told.len() == MAX_CATALOGS {
                break;
            }
        }
        if !beyond.is_empty() {
            let some = beyond[..beyond.len().min(3)].join(", ");
            let more =
                if beyond.len() > 3 { format!(" and {} more", beyond.len() - 3) } else { String::new() };
            all.told.push(format!(
                "glass catalogues beside the lens that are not looked into: {some}{more}; those looked into have at most \
                 {MAX_CATALOGS} files, {MAX_CATALOG_BYTES} bytes and {MAX_CATALOG_GLASSES} glasses together; give the one that \
                 the lens needs as \"glasscatalog\""
            ));
        }
        all
    }
}

/// The bytes of a file, if they are no more than `most`; of a larger one not a byte is read.
fn bytes_of(path: &Path, most: u64) -> std::io::Result<Option<Vec<u8>>> {
    let file = std::fs::File::open(path)?;
    if file.metadata()?.len() > most {
        return Ok(None);
    }
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes)?;
    Ok(Some(bytes).filter(|bytes| bytes.len() as u64 <= most))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A directory with catalogues: their names, and how many glasses and bytes each has.
    fn directory(files: &[(&str, usize, usize)]) -> tempfile::TempDir {
        let directory = tempfile::tempdir().expect("a temporary directory");
        for (file, glasses, bytes) in files {
            let glass = |i: usize| format!("NM {}-{i} 1 0\nCD 2.25\n", file.trim_end_matches(".agf"));
            let mut text: String = (0..*glasses).map(glass).collect();
            text += &"!".repeat(bytes.saturating_sub(text.len()));
            std::fs::write(directory.path().join(file), text).expect("written");
        }
        directory
    }

    fn held(library: &GlassLibrary) -> [usize; 2] {
        let beside = &library.beside.get().expect("looked into").catalogues;
        [beside.len(), beside.iter().map(Catalogue::len).sum()]
    }

    #[test]
    fn catalogues_beside_a_lens_are_looked_into_up_to_the_limits_and_the_others_are_told() {
        let mib = 1 << 20;
        let here =
            directory(&[("a.agf", 3, 5 * mib), ("b.agf", 3, 5 * mib), ("c.agf", 3, 0), ("d.agf", 0, 9)]);
        let library = GlassLibrary::default().beside(&here.path().join("lens.dat"));
        assert!(library.told().is_empty(), "nothing is looked into before a glass is named");
        assert!(library.find("A1").is_some_and(|glass| glass.is_ok()) && library.find("c_2").is_some());
        assert!(library.find("B-1").is_none());
        assert_eq!(held(&library), [2, 6]);
        let [no_catalogue, beyond] = library.told() else { panic!("{:?}", library.told()) };
        assert!(no_catalogue.contains("d.agf:1:1: no glass"), "{no_catalogue}");
        assert!(
            beyond.contains("not looked into: b.agf; those") && beyond.contains("8388608 bytes"),
            "{beyond}"
        );
        assert!(library.suggestion("B-1").contains("b.agf"), "who misses a glass is told");

        let many: Vec<String> = (100..200).map(|i| format!("{i}.agf")).collect();
        let here = directory(&many.iter().map(|name| (name.as_str(), 400, 0)).collect::<Vec<_>>());
        let library = GlassLibrary::default().beside(&here.path().join("lens.dat"));
        assert!(library.find("149-399").is_some() && library.find("150-1").is_none());
        assert_eq!(held(&library), [50, 20_000]);
        assert!(library.told()[0].contains("150.agf, 151.agf, 152.agf and 47 more"), "{:?}", library.told());
        let here = directory(&many.iter().map(|name| (name.as_str(), 2, 0)).collect::<Vec<_>>());
        let library = GlassLibrary::default().beside(&here.path().join("lens.dat"));
        assert!(library.find("x").is_none());
        assert_eq!(held(&library), [64, 128]);
    }

    #[test]
    fn a_catalogue_is_named_before_its_glass() {
        let mut library = GlassLibrary::default();
        library.add("own/my glass.agf", b"NM N-BK7 1 0\nCD 2.25\n").expect("a catalogue");
        let index = |name: &str| {
            let glass = library.find(name)?.expect("right");
            Some(crate::prescription::glass::refractive_index(glass.medium, 500.0))
        };
        assert_eq!([index("nbk7"), index("MyGlass:n_bk7")], [Some(1.5); 2]);
        assert!(index("schott:N BK 7").is_some_and(|index| (index - 1.5214).abs() < 1e-4));
        assert_eq!([index("OHARA:N-BK7"), index("N-BK77"), index(":"), index("")], [None; 4]);
    }
}

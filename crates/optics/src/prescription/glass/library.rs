//! Finds a glass by its name: in the catalogue that the user names, in the catalogues inside the lens's archive and
//! beside the lens file, and among the built-in glasses.

use std::{
    cell::OnceCell,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{built_in, loose};
use crate::prescription::{
    LensFileError, MAX_CATALOG_BYTES, MAX_CATALOG_GLASSES, MAX_CATALOGS, interfaces::Glass,
    reader::agf::Catalogue, source::bounded,
};
use realistic_base::message::{cut, nearest};

/// The glasses that a lens file may name.
#[derive(Clone, Debug, Default)]
pub struct GlassLibrary {
    /// The catalogue that the user gives.
    given: Vec<Catalogue>,
    /// The catalogues in the archive that holds the lens file.
    archived: Vec<Catalogue>,
    /// The lens file's directory, if it has one. The catalogues in it are indexed when a glass is first looked up, as are
    /// those of the other places.
    directory: Option<PathBuf>,
    /// Catalogues, and directories of them, that are used for every lens.
    places: Arc<[PathBuf]>,
    indexed: OnceCell<Vec<PlaceCatalogues>>,
}

/// A glass found by name.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The `loose` name of the catalogue that has the glass.
    pub catalogue: String,
    /// Whether the glass is another maker's: the file names catalogues, and the glass's catalogue is not one of them.
    pub is_foreign: bool,
    /// The glass, or the reason why its catalogue entry cannot be used.
    pub glass: Result<Glass, String>,
}

/// The source of a glass.
enum GlassSource<'a> {
    /// A catalogue, whose entry for the glass is read when the search reaches it.
    Catalogue(&'a Catalogue),
    /// A built-in glass.
    BuiltIn(Glass),
}

/// The parts of a glass's name in a file, each part a `loose` word.
struct Name {
    /// The catalogue in `CATALOGUE:NAME`. Only this catalogue is searched.
    only: Option<String>,
    /// The group in `GROUP|NAME`, which begins with the maker's name.
    group: Option<String>,
    own: String,
}

impl Name {
    fn of(name: &str) -> Self {
        let part =
            |separator: char| name.split_once(separator).map(|(before, own)| (Some(loose(before)), own));
        let (only, own) = part(':').unwrap_or((None, name));
        let (group, own) = if only.is_none() { part('|').unwrap_or((None, own)) } else { (None, own) };
        Self { only, group, own: loose(own) }
    }
}

/// The catalogues in a directory, or a single one, and a warning for each catalogue left out.
#[derive(Clone, Debug, Default)]
struct PlaceCatalogues {
    catalogues: Vec<Catalogue>,
    warnings: Vec<String>,
}

impl GlassLibrary {
    /// Adds the glasses of an AGF catalogue, which precede built-in glasses of the same name. `file` is the name of the
    /// catalogue in messages.
    ///
    /// # Errors
    /// The text is not an AGF catalogue, or exceeds [`MAX_CATALOG_BYTES`] or [`MAX_CATALOG_GLASSES`].
    pub fn add(&mut self, file: &str, bytes: &[u8]) -> Result<(), LensFileError> {
        self.given.push(Catalogue::new(file, bytes)?);
        Ok(())
    }

    /// Returns the library with the catalogues of an archive, which precede those beside the archive.
    pub(in crate::prescription) fn with_archived(&self, archived: Vec<Catalogue>) -> Self {
        Self { archived, ..self.clone() }
    }

    /// Returns the catalogues of the archive that holds the lens file.
    pub(in crate::prescription) fn archived(&self) -> &[Catalogue] {
        &self.archived
    }

    /// Returns the library with the catalogues (`*.agf`) in the directory of `lens_file`.
    #[must_use]
    pub fn beside(&self, lens_file: &Path) -> Self {
        let directory = lens_file.parent().map(Path::to_owned);
        Self { directory, indexed: OnceCell::new(), ..self.clone() }
    }

    /// Returns the library with more catalogues, or directories of them, which follow those beside the lens file.
    #[must_use]
    pub fn with_places(&self, places: &[PathBuf]) -> Self {
        Self { places: places.into(), indexed: OnceCell::new(), ..self.clone() }
    }

    /// Returns the glass of that name; case, dashes, underscores and spaces are ignored. `CATALOGUE:NAME` searches only
    /// that catalogue; `GROUP|NAME` prefers the catalogue of that group. Returns `None` if no such glass exists.
    ///
    /// # Errors
    /// A catalogue has the glass, but its entry cannot be used; the text gives the reason.
    pub fn find(&self, name: &str) -> Option<Result<Glass, String>> {
        self.candidates(name, &[]).next().map(|found| found.glass)
    }

    /// Returns all glasses of that name, as [`find`](Self::find) interprets it. The order of preference is: the user's
    /// catalogue, the catalogues in `first` (`loose` names, in order), the catalogues in the lens's archive, those beside
    /// the lens file, those of the other places, the built-in glasses. The iterator reads an entry only when it reaches
    /// the entry, so that [`warnings`](Self::warnings) reports nothing about later entries.
    pub fn candidates<'a>(&'a self, name: &str, first: &[String]) -> impl Iterator<Item = Found> + use<'a> {
        let Name { only, group, own } = Name::of(name);
        let first: Vec<&str> = group.iter().chain(first).map(String::as_str).collect();
        let rank = |catalogue: &str| {
            let is_one =
                |word: &&str| !word.is_empty() && (word.contains(catalogue) || catalogue.contains(word));
            first.iter().position(is_one)
        };
        let has = |file: &&Catalogue| file.has(&own);
        let given = self
            .given
            .iter()
            .filter(has)
            .map(|file| (Some(0), file.name.as_str(), GlassSource::Catalogue(file)));
        let beside = self.archived.iter().chain(self.indexed()).filter(has);
        let beside = beside.map(|file| (file.name.as_str(), GlassSource::Catalogue(file)));
        let built_in = built_in::candidates(&own)
            .into_iter()
            .map(|(catalogue, glass)| (catalogue, GlassSource::BuiltIn(glass)));
        let others = beside.chain(built_in).map(|(catalogue, source)| (rank(catalogue), catalogue, source));
        let mut all: Vec<_> = given.chain(others).collect();
        all.retain(|(_, catalogue, _)| only.as_deref().is_none_or(|only| only == *catalogue));
        all.sort_by_key(|(rank, ..)| rank.unwrap_or(usize::MAX));
        let is_free = only.is_some() || first.is_empty();
        all.into_iter().filter_map(move |(rank, catalogue, source)| {
            let glass = match source {
                GlassSource::Catalogue(file) => file.find(&own)?,
                GlassSource::BuiltIn(glass) => Ok(glass),
            };
            Some(Found { catalogue: catalogue.to_owned(), is_foreign: !is_free && rank.is_none(), glass })
        })
    }

    /// Returns the reason why a name is unknown, as the end of a sentence. The text states the catalogue that is
    /// missing or lacks the glass, a catalogue that has a glass of that name or otherwise the most similar name, the
    /// catalogues that were not searched, and a remedy.
    pub fn unknown(&self, name: &str) -> String {
        let Name { only, own, .. } = Name::of(name);
        let mut known: Vec<(&str, &str)> = Vec::new();
        for file in self.files() {
            known.extend(file.names().map(|known| (known, file.name.as_str())));
        }
        known.extend(built_in::names().map(|(known, catalogue)| -> (&str, &str) { (known, catalogue) }));
        let mut parts = Vec::new();
        if let Some(only) = &only {
            let is_known = known.iter().any(|(_, catalogue)| catalogue == only);
            parts.push(match is_known {
                true => format!("catalogue {} has no such glass", cut(only)),
                false => format!("no catalogue is called {}", cut(only)),
            });
        }
        // A misspelt name is first compared with the names in its own catalogue, if that catalogue is known.
        let of_same = known.iter().find(|(known, _)| loose(known) == own);
        let is_own = |(_, catalogue): &&(&str, &str)| only.as_deref() == Some(*catalogue);
        let of_own: Vec<(&str, &str)> = known.iter().filter(is_own).copied().collect();
        let nearest = |known: &[(&str, &str)]| {
            let lower: Vec<String> = known.iter().map(|(known, _)| known.to_ascii_lowercase()).collect();
            let word = name.rsplit([':', '|']).next().unwrap_or(name);
            let nearest = nearest(word, lower.iter().map(String::as_str))?;
            let index = lower.iter().position(|lower| lower == nearest)?;
            Some(known[index].0.to_owned())
        };
        if let Some((known, catalogue)) = of_same {
            parts.push(format!("{catalogue} has {known}: write {catalogue}:{known}"));
        } else if let Some(nearest) = nearest(&of_own).or_else(|| nearest(&known)) {
            parts.push(format!("the nearest that is known is {nearest}"));
        }
        parts.extend(self.warnings());
        parts.push(
            "put its maker's catalogue (AGF) beside the lens file or give it as \"glass_catalog\"".to_owned(),
        );
        parts.join("; ")
    }

    /// Returns a warning for each part of the searched catalogues that was left out.
    pub fn warnings(&self) -> Vec<String> {
        let indexed = self.indexed.get().into_iter().flatten();
        let files = self.given.iter().chain(&self.archived);
        let files = files.chain(indexed.clone().flat_map(|place| &place.catalogues));
        indexed.flat_map(|place| place.warnings.clone()).chain(files.flat_map(Catalogue::warnings)).collect()
    }

    /// Returns the catalogues beside the lens file and of the other places.
    fn indexed(&self) -> impl Iterator<Item = &Catalogue> {
        let indexed = self.indexed.get_or_init(|| {
            let beside = self.directory.iter().map(|directory| PlaceCatalogues::of_directory(directory));
            beside.chain(self.places.iter().map(|place| PlaceCatalogues::of(place))).collect()
        });
        indexed.iter().flat_map(|place| &place.catalogues)
    }

    fn files(&self) -> impl Iterator<Item = &Catalogue> {
        self.given.iter().chain(&self.archived).chain(self.indexed())
    }
}

impl PlaceCatalogues {
    /// Reads a catalogue, or the catalogues of a directory.
    fn of(place: &Path) -> Self {
        match place.metadata() {
            Ok(found) if found.is_dir() => Self::of_directory(place),
            Ok(found) if found.is_file() => Self::of_files(vec![place.to_owned()]),
            other => {
                let why =
                    other.map_or_else(|error| error.to_string(), |_| "no file and no directory".to_owned());
                let warning = format!("glass catalogue {} cannot be read: {why}", place.display());
                Self { warnings: vec![warning], ..Self::default() }
            }
        }
    }

    /// Reads the catalogues of a directory, in the order of their names.
    fn of_directory(directory: &Path) -> Self {
        let is_catalogue = |path: &PathBuf| {
            path.extension().is_some_and(|end| end.eq_ignore_ascii_case("agf")) && path.is_file()
        };
        let directory = if directory.as_os_str().is_empty() { Path::new(".") } else { directory };
        let Ok(entries) = std::fs::read_dir(directory) else { return Self::default() };
        let mut files: Vec<PathBuf> =
            entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_catalogue).collect();
        files.sort();
        Self::of_files(files)
    }

    /// Reads catalogues within the limits on number and size.
    fn of_files(files: Vec<PathBuf>) -> Self {
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
                        Err(error) => all.warnings.push(format!("{error}: its glasses are left out")),
                    }
                }
                Ok(None) => beyond.push(own),
                Err(error) => all.warnings.push(format!("glass catalogue {own} cannot be read: {error}")),
            }
            if all.warnings.len() == MAX_CATALOGS {
                break;
            }
        }
        if !beyond.is_empty() {
            let some = beyond[..beyond.len().min(3)].join(", ");
            let more =
                if beyond.len() > 3 { format!(" and {} more", beyond.len() - 3) } else { String::new() };
            all.warnings.push(format!(
                "glass catalogues that are not looked into: {some}{more}; those looked into have at most \
                 {MAX_CATALOGS} files, {MAX_CATALOG_BYTES} bytes and {MAX_CATALOG_GLASSES} glasses together; give the one that \
                 the lens needs as \"glass_catalog\""
            ));
        }
        all
    }
}

/// Returns the bytes of a file if it has at most `most` bytes; a larger file is not read.
fn bytes_of(path: &Path, most: u64) -> std::io::Result<Option<Vec<u8>>> {
    let file = std::fs::File::open(path)?;
    if file.metadata()?.len() > most {
        return Ok(None);
    }
    Ok(Some(bounded(file, most)?).filter(|bytes| bytes.len() as u64 <= most))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes a directory of catalogues. Each catalogue has a given file name, number of glasses and size in bytes.
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

    fn counts(library: &GlassLibrary) -> [usize; 2] {
        let beside = &library.indexed.get().expect("looked into")[0].catalogues;
        [beside.len(), beside.iter().map(Catalogue::len).sum()]
    }

    #[test]
    fn catalogues_beyond_the_limits_are_reported() {
        let mib = 1 << 20;
        let here =
            directory(&[("a.agf", 3, 5 * mib), ("b.agf", 3, 5 * mib), ("c.agf", 3, 0), ("d.agf", 0, 9)]);
        let library = GlassLibrary::default().beside(&here.path().join("lens.dat"));
        assert!(library.warnings().is_empty(), "nothing is looked into before a glass is named");
        assert!(library.find("A1").is_some_and(|glass| glass.is_ok()) && library.find("c_2").is_some());
        assert!(library.find("B-1").is_none());
        assert_eq!(counts(&library), [2, 6]);
        let warnings = library.warnings();
        let [no_catalogue, beyond] = &warnings[..] else { panic!("{warnings:?}") };
        assert!(no_catalogue.contains("d.agf:1:1: no glass"), "{no_catalogue}");
        assert!(
            beyond.contains("not looked into: b.agf; those") && beyond.contains("8388608 bytes"),
            "{beyond}"
        );
        assert!(library.unknown("B-1").contains("b.agf"), "who misses a glass is told");

        let many: Vec<String> = (100..200).map(|i| format!("{i}.agf")).collect();
        let here = directory(&many.iter().map(|name| (name.as_str(), 400, 0)).collect::<Vec<_>>());
        let library = GlassLibrary::default().beside(&here.path().join("lens.dat"));
        assert!(library.find("149-399").is_some() && library.find("150-1").is_none());
        assert_eq!(counts(&library), [50, 20_000]);
        assert!(
            library.warnings()[0].contains("150.agf, 151.agf, 152.agf and 47 more"),
            "{:?}",
            library.warnings()
        );
        let here = directory(&many.iter().map(|name| (name.as_str(), 2, 0)).collect::<Vec<_>>());
        let library = GlassLibrary::default().beside(&here.path().join("lens.dat"));
        assert!(library.find("x").is_none());
        assert_eq!(counts(&library), [64, 128]);
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

    #[test]
    fn the_catalogues_that_are_named_come_before_the_others() {
        let n_d = |name: &str, first: &[&str]| {
            let first: Vec<String> = first.iter().map(|word| (*word).to_owned()).collect();
            let library = GlassLibrary::default();
            let index = |glass: Glass| crate::prescription::glass::refractive_index(glass.medium, 587.5618);
            library
                .candidates(name, &first)
                .map(|found| {
                    (
                        found.catalogue,
                        found.is_foreign,
                        (1e4 * index(found.glass.expect("right"))).round() / 1e4,
                    )
                })
                .collect::<Vec<_>>()
        };
        let of = |catalogue: &str, is_foreign: bool, n_d: f64| (catalogue.to_owned(), is_foreign, n_d);
        assert_eq!(
            n_d("F4", &[]),
            [
                of("SCHOTT", false, 1.6166),
                of("HOYA", false, 1.6166),
                of("CDGM", false, 1.62),
                of("SUMITA", false, 1.6166)
            ]
        );
        assert_eq!(n_d("CDGM:F4", &["SCHOTT"]), [of("CDGM", false, 1.62)]);
        assert_eq!(n_d("OHARA:F4", &[]), []);
        // Names of catalogues as files write them, and names of groups.
        for first in [&["MISC", "CDGM201409"][..], &["CDGM"]] {
            assert_eq!(n_d("F4", first)[..2], [of("CDGM", false, 1.62), of("SCHOTT", true, 1.6166)]);
        }
        assert_eq!(n_d("CDGM-F|F4", &["SCHOTT"])[0], of("CDGM", false, 1.62));
        assert_eq!(n_d("SCHOTT-BK|N-BK7", &[]), [of("SCHOTT", false, 1.5168)]);
        assert_eq!(n_d("N-BK7", &["OHARA"]), [of("SCHOTT", true, 1.5168)]);
        // The user's catalogue comes first; the catalogues beside the lens rank by their names.
        let here = directory(&[("cdgm.agf", 0, 0), ("own.agf", 0, 0)]);
        for name in ["cdgm", "own"] {
            std::fs::write(here.path().join(format!("{name}.agf")), "NM F4 1 0\nCD 2.25\n").expect("written");
        }
        let mut library = GlassLibrary::default().beside(&here.path().join("lens.zmx"));
        let order = |library: &GlassLibrary, first: &str| {
            let found = library.candidates("F4", &[first.to_owned()]);
            found.map(|found| found.catalogue).collect::<Vec<_>>()
        };
        assert_eq!(order(&library, "SCHOTT"), ["SCHOTT", "CDGM", "OWN", "HOYA", "CDGM", "SUMITA"]);
        assert_eq!(order(&library, "CDGM")[..2], ["CDGM"; 2]);
        library.add("mine.agf", b"NM F4 1 0\nCD 4\n").expect("a catalogue");
        assert_eq!(order(&library, "SCHOTT")[..2], ["MINE", "SCHOTT"]);
        assert!(library.candidates("F4", &["SCHOTT".to_owned()]).take(2).all(|found| !found.is_foreign));
    }

    #[test]
    fn a_glass_is_read_when_the_search_reaches_it() {
        let here = directory(&[]);
        let text = "NM X 1 0\nCD 2.25\nIT 0.4 1.2 10\n";
        for name in ["a", "b"] {
            std::fs::write(here.path().join(format!("{name}.agf")), text).expect("written");
        }
        let mut library = GlassLibrary::default().beside(&here.path().join("lens.zmx"));
        library.add("a.agf", text.as_bytes()).expect("a catalogue");
        let mut candidates = library.candidates("X", &["B".to_owned()]);
        for (count, catalogue) in ["A", "B", "A"].into_iter().enumerate() {
            assert_eq!(library.warnings().len(), count);
            assert_eq!(candidates.next().map(|found| found.catalogue).as_deref(), Some(catalogue));
        }
        assert!(candidates.next().is_none());
        // Each catalogue warns once, however often the glass is looked up.
        assert!(library.find("X").is_some_and(|glass| glass.is_ok()));
        assert_eq!(library.warnings().len(), 3);
    }

    #[test]
    fn an_unknown_name_says_who_has_the_glass_or_what_is_near() {
        let library = GlassLibrary::default();
        for (name, start) in [
            ("NIKON:J-SK16", "no catalogue is called NIKON; HIKARI has J-SK16: write HIKARI:J-SK16; put"),
            ("OHARA:BAFL2", "catalogue OHARA has no such glass; HOYA has BAFL2: write HOYA:BAFL2; put"),
            ("HOYA:BAFL9", "catalogue HOYA has no such glass; the nearest that is known is BAF"),
            ("N-BK77", "the nearest that is known is N-BK7; put"),
            ("ACME|N-BK77", "the nearest that is known is N-BK7; put"),
        ] {
            let text = library.unknown(name);
            assert!(text.starts_with(start) && text.ends_with("\"glass_catalog\""), "{text}");
        }
    }
}

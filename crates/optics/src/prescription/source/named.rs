//! Finds a lens of the collections by its name: its path in a collection, or the end of that path that no other lens
//! has, with or without the ending of the file. `AC254-050-A` is the lens `thorlabs/AC254-050-A.lhlt`.
//!
//! A whole path is looked up directly. Only if there is no such file, the collections are listed.

use std::path::{Component, Path, PathBuf};

use super::{
    collection::{Collection, CollectionFile, within},
    error::SourceError,
    place::FilePlace,
};
use crate::prescription::catalogue;
use realistic_base::message::{cut, nearest, nearest_or_all, some_of};

/// Returns the file with this path in the collection `root`; `None` if no such file exists, or the path
/// leads upward.
///
/// # Errors
/// The path leads to something other than a file, or out of the collection.
pub(super) fn by_path(root: &Path, name: &str) -> Result<Option<FilePlace>, SourceError> {
    let is_plain = |part| matches!(part, Component::Normal(_));
    let Some(root) = root.canonicalize().ok().filter(|_| Path::new(name).components().all(is_plain)) else {
        return Ok(None);
    };
    let path = root.join(name);
    let no_file = |why| SourceError::NoFile { what: "lens", path: path.clone(), why };
    let Some(place) = FilePlace::at(&path).map_err(no_file)? else { return Ok(None) };
    let target = within(&root, place.file()).map_err(no_file)?;
    Ok(Some(match place {
        FilePlace::File(_) => FilePlace::File(target),
        member @ FilePlace::Member(..) => member,
    }))
}

/// The lenses of all collections that a name may mean.
pub(super) struct Candidates {
    files: Vec<CollectionFile>,
    /// The collections, and the parts of them that cannot be looked at, for messages.
    searched: String,
}

impl Candidates {
    /// Lists the collections.
    pub(super) fn of(roots: &[PathBuf]) -> Self {
        let (mut files, mut searched, mut faults) = (Vec::new(), Vec::new(), Vec::new());
        for root in roots {
            searched.push(root.display().to_string());
            match Collection::open(root) {
                Ok(collection) => {
                    let fault =
                        |fault: &super::Fault| format!("{}/{} {}", root.display(), fault.name, fault.why);
                    faults.extend(collection.faults().iter().map(fault));
                    files.extend(collection.into_files());
                }
                Err(error) => faults.push(error.to_string()),
            }
        }
        let mut searched = match searched.is_empty() {
            true => String::new(),
            false => format!(" or in the collections {}", searched.join(", ")),
        };
        if !faults.is_empty() {
            searched += &format!(" ({})", some_of(&faults));
        }
        Self { files, searched }
    }

    /// Returns the file that a name means; `None` if no file has the name.
    ///
    /// # Errors
    /// Several files have the name.
    pub(super) fn named(&self, name: &str) -> Result<Option<FilePlace>, SourceError> {
        let mut found: Vec<&CollectionFile> =
            self.files.iter().filter(|file| is_called(&file.name, name)).collect();
        // A drawing or a data sheet often has the name of the lens.
        if found.iter().any(|file| file.is_named_as_lens()) {
            found.retain(|file| file.is_named_as_lens());
        }
        // Collections may lie in each other.
        found.sort_by_cached_key(|file| file.path());
        found.dedup_by_key(|file| file.path());
        match &found[..] {
            [] => Ok(None),
            [one] => Ok(Some((*one).clone().into_place())),
            several => {
                let paths: Vec<String> = several.iter().map(|file| file.path()).collect();
                Err(SourceError::Ambiguous { name: cut(name), candidates: some_of(&paths) })
            }
        }
    }

    /// Returns the collections for a message about an unknown name.
    pub(super) fn searched(&self) -> &str {
        &self.searched
    }

    /// Returns the end of a message about an unknown name: the most similar name of the catalogue and the collections,
    /// or else the names of the catalogue.
    pub(super) fn near(&self, name: &str) -> String {
        let own = file_name(name);
        let own = own.strip_suffix(".dat").unwrap_or(own);
        let known: Vec<&str> = catalogue::names().collect();
        let lenses = self.files.iter().filter(|file| file.is_named_as_lens());
        let spellings = lenses.flat_map(|file| {
            let own = file_name(&file.name).to_ascii_lowercase();
            [(without_ending(&own).to_owned(), file.name.as_str()), (own, file.name.as_str())]
        });
        let spellings: Vec<(String, &str)> =
            known.iter().map(|name| ((*name).to_owned(), *name)).chain(spellings).collect();
        let near = nearest(own, spellings.iter().map(|(spelling, _)| spelling.as_str()));
        let near = near.and_then(|near| spellings.iter().find(|(spelling, _)| spelling == near));
        match near {
            Some((_, name)) => format!("did you mean \"{name}\"?"),
            None => nearest_or_all(own, &known),
        }
    }
}

/// Returns whether a name is the end of a file's path, with or without the ending.
fn is_called(path: &str, name: &str) -> bool {
    [path, without_ending(path)].into_iter().any(|path| {
        path.strip_suffix(name)
            .is_some_and(|before| !name.is_empty() && (before.is_empty() || before.ends_with('/')))
    })
}

/// Returns the part of a path without its folders.
fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

fn without_ending(path: &str) -> &str {
    let own = file_name(path);
    match own.rfind('.') {
        Some(end) if end > 0 => &path[..path.len() - own.len() + end],
        _ => path,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prescription::source::collection::tests::{SINGLET, folder};
    use crate::prescription::{GlassLibrary, SearchPath, load, split_scale};

    fn search(folders: &[&tempfile::TempDir]) -> SearchPath {
        SearchPath::default()
            .with_collections(folders.iter().map(|folder| folder.path().to_owned()).collect())
    }

    fn found(search: &SearchPath, name: &str) -> Result<String, String> {
        let lens = load(name, search, GlassLibrary::default());
        lens.map(|lens| lens.name).map_err(|error| error.to_string())
    }

    #[test]
    fn a_lens_is_named_by_its_path_or_the_end_of_it() {
        let here =
            folder(&["thorlabs/AC254-050-A.lhlt", "thorlabs/AC254-050-A.pdf", "b/stock.zip", "b/x@home.dat"]);
        let search = search(&[&here]);
        for name in ["thorlabs/AC254-050-A.lhlt", "thorlabs/AC254-050-A", "AC254-050-A.lhlt", "AC254-050-A"] {
            assert_eq!(found(&search, name).as_deref(), Ok("AC254-050-A.lhlt"), "{name}");
        }
        for name in ["b/stock.zip/in/lens.dat", "stock.zip/in/lens", "in/lens", "lens"] {
            assert_eq!(found(&search, name).as_deref(), Ok("lens.dat"), "{name}");
        }
        assert_eq!(split_scale("b/x@home.dat", &search).expect("a name"), ("b/x@home.dat", None));
        assert_eq!(split_scale("lens@35mm", &search).expect("a name"), ("lens", Some(35.0)));
        for name in ["labs/AC254-050-A", "C254-050-A", "050-A", "", "thorlabs"] {
            assert!(found(&search, name).is_err(), "{name}");
        }
        // An explicit path needs no collection.
        let path = here.path().join("b/stock.zip/in/lens.dat");
        let name = path.to_str().expect("UTF-8");
        assert_eq!(found(&SearchPath::default(), name).as_deref(), Ok("lens.dat"));
        let message = found(&SearchPath::default(), &name.replace("lens", "lense")).expect_err("no member");
        assert!(
            message.ends_with("in/lense.dat\" is not in the archive; did you mean \"in/lens.dat\"?"),
            "{message}"
        );
        let archive = SearchPath::default().with_collections(vec![here.path().join("b/stock.zip")]);
        assert_eq!(found(&archive, "in/lens.dat").as_deref(), Ok("lens.dat"));
        assert_eq!(found(&archive, "lens").as_deref(), Ok("lens.dat"));
    }

    #[test]
    fn several_lenses_of_a_name_are_listed() {
        let (one, two) = (folder(&["a/x.dat", "b/x.zmx", "y.dat"]), folder(&["y.dat"]));
        let search = search(&[&one, &two]);
        for (name, count) in [("x", 2), ("y", 2), ("y.dat", 2)] {
            let message = found(&search, name).expect_err("ambiguous");
            assert!(message.starts_with(&format!("lens \"{name}\" may be one of /")), "{message}");
            assert!(
                message.matches(one.path().to_str().expect("UTF-8")).count()
                    + message.matches(two.path().to_str().expect("UTF-8")).count()
                    == count,
                "{message}"
            );
            assert!(message.ends_with("; give more of its path"), "{message}");
        }
        assert_eq!(found(&search, "a/x").as_deref(), Ok("x.dat"));
        let twice = SearchPath::default().with_collections(vec![
            one.path().join("a"),
            one.path().to_owned(),
            one.path().to_owned(),
        ]);
        for name in ["x.dat", "a/x.dat", "a/x"] {
            assert_eq!(found(&twice, name).as_deref(), Ok("x.dat"), "{name}");
        }
    }

    #[test]
    fn a_misspelt_name_is_answered_from_the_catalogue_and_the_collections() {
        let here = folder(&["thorlabs/AC254-050-A.lhlt", "README.txt"]);
        let search = search(&[&here]);
        for (name, meant) in [
            ("ac254-050-A", "thorlabs/AC254-050-A.lhlt"),
            ("thorlab/AC254-50-A.lhlt", "thorlabs/AC254-050-A.lhlt"),
            ("wide22mm", "wide.22mm"),
        ] {
            let message = found(&search, name).expect_err("misspelt");
            let collections = format!("catalogue or in the collections {}; ", here.path().display());
            assert!(message.ends_with(&format!("{collections}did you mean \"{meant}\"?")), "{message}");
        }
        let nowhere = SearchPath::default().with_collections(vec!["/nowhere".into()]);
        let message = found(&nowhere, "something").expect_err("unknown");
        assert!(
            message.contains("in the collections /nowhere (collection \"/nowhere\" does not exist); the names are dgauss.50mm"),
            "{message}"
        );
        assert!(found(&nowhere, "dgauss.50mm").is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn a_name_leads_to_nothing_outside_the_collection() {
        let (here, there) = (folder(&["a/b.dat"]), folder(&["c.dat"]));
        std::fs::write(here.path().join("d.dat"), SINGLET).expect("written");
        std::os::unix::fs::symlink(there.path().join("c.dat"), here.path().join("link.dat")).expect("linked");
        std::os::unix::fs::symlink(there.path(), here.path().join("folder")).expect("linked");
        let search =
            SearchPath::default().with_collections(vec![here.path().join("a"), here.path().to_owned()]);
        for name in ["link.dat", "folder/c.dat"] {
            let message = found(&search, name).expect_err("outside");
            assert!(message.ends_with("is a link out of the collection, and is not followed"), "{message}");
        }
        let message = found(&search, "a/../d.dat").expect_err("upward");
        assert!(message.starts_with("no lens file"), "{message}");
        assert!(found(&search, "d.dat").is_ok());
    }

    #[test]
    fn glasses_of_the_search_path_are_known_to_every_lens() {
        let here = tempfile::tempdir().expect("a temporary directory");
        let file = |name: &str, text: &str| {
            std::fs::write(here.path().join(name), text).expect("written");
            here.path().join(name)
        };
        let lens = file("lens.dat", "20 5 OWN1 10\n-20 0 1 10\n");
        let name = lens.to_str().expect("UTF-8");
        let glasses = tempfile::tempdir().expect("a temporary directory");
        std::fs::write(glasses.path().join("own.agf"), "NM OWN1 1 0\nCD 2.25\n").expect("written");
        let open = |places: &[PathBuf]| {
            let search = SearchPath::default().with_glasses(places.to_vec());
            let library = crate::prescription::glass_library(None, &search).expect("no catalogue is named");
            load(name, &search, library).map_err(|error| error.to_string())
        };
        for place in [glasses.path().to_owned(), glasses.path().join("own.agf")] {
            assert!(open(&[place]).is_ok());
        }
        let message = open(&["/nowhere".into()]).expect_err("unknown");
        assert!(message.contains("glass catalogue /nowhere cannot be read: No such file"), "{message}");
    }
}

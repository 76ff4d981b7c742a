//! `realistic lenses`, and lenses of collections by their names.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const SINGLET: &str = "# by Nikon\n50 2 1.5 10\n-50 0 1 10\n";

/// Runs the program with a cache folder and a collection of its own.
fn run(caches: &Path, collection: Option<&Path>, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_realistic"));
    command.env("XDG_CACHE_HOME", caches).args(arguments);
    if let Some(collection) = collection {
        command.env("REALISTIC_LENSES", collection);
    }
    command.output().unwrap()
}

fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// Makes a folder with two lenses, a broken one, and other files.
fn collection() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("nikon")).unwrap();
    for (name, text) in [
        ("nikon/fifty.dat", SINGLET),
        ("twenty.txt", "20 2 1.5 10\n-20 0 1 10\n"),
        ("broken.zmx", "SURF 0\nSURF 1\n  CURV x\n"),
        ("no-lens.json", "{}"),
        ("README.txt", "lenses\n"),
        ("picture.png", "\u{1}\u{0}"),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

#[test]
fn a_folder_is_listed_with_what_cannot_be_read() {
    let (folder, caches) = (collection(), tempfile::tempdir().unwrap());
    let path = folder.path().to_str().unwrap();
    let output = run(caches.path(), None, &["lenses", path]);
    let text = printed(&output);
    for line in
        ["nikon/fifty.dat ", "twenty.txt ", "files that cannot be read", "broken.zmx: ", "no-lens.json: "]
    {
        assert!(text.lines().any(|own| own.starts_with(line)), "{line} is not in\n{text}");
    }
    assert!(!text.contains("README") && !text.contains("picture"), "{text}");
    let note = String::from_utf8(output.stderr).unwrap();
    assert_eq!(note, "realistic: 2 lenses; 2 files that cannot be read; 2 other files\n");

    let rows = |arguments: &[&str]| -> Vec<Value> {
        let output = run(caches.path(), None, &[&["lenses", path, "--json"], arguments].concat());
        serde_json::from_str(&printed(&output)).unwrap()
    };
    let names = |arguments: &[&str]| {
        rows(arguments).iter().map(|row| row["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names(&[]), ["broken.zmx", "nikon/fifty.dat", "no-lens.json", "twenty.txt"]);
    assert_eq!(names(&["--focal", "40-60"]), ["nikon/fifty.dat"]);
    assert_eq!(names(&["--fnumber", "-3"]), ["twenty.txt"]);
    assert_eq!(names(&["--maker", "NIK"]), ["nikon/fifty.dat"]);
    assert_eq!(names(&["--focal", "100-"]), [""; 0]);
    let fifty = &rows(&["--focal", "40-60"])[0];
    let lens = run(caches.path(), None, &["lens", "--json", fifty["lens_file"].as_str().unwrap()]);
    let lens: Value = serde_json::from_str(&printed(&lens)).unwrap();
    for key in ["focal_length_mm", "fnumber"] {
        let [own, other] = [fifty, &lens].map(|value| value[key].as_f64().unwrap());
        assert!((own - other).abs() < 1e-7 * other, "{key}: {own} {other}");
    }
    assert_eq!(fs::read_dir(caches.path().join("realistic")).unwrap().count(), 1);

    let again =
        |arguments: &[&str]| printed(&run(caches.path(), None, &[&["lenses", path], arguments].concat()));
    assert_eq!(again(&[]), text, "the rows of the cache");
    fs::write(folder.path().join("twenty.txt"), "30 2 1.5 10\n-30 0 1 10\n ").unwrap();
    assert_ne!(again(&[]), text, "a changed file is read again");
    assert_eq!(again(&["--no-cache"]), again(&[]));
    assert!(again(&["--csv"]).starts_with("lens_file,name,title,maker,year,focal_length_mm,"));
}

#[test]
fn the_page_has_a_drawing_of_each_lens() {
    let (folder, caches) = (collection(), tempfile::tempdir().unwrap());
    let path = folder.path().to_str().unwrap();
    let page = printed(&run(caches.path(), None, &["lenses", path, "--quiet", "--sheet", "-"]));
    assert_eq!((page.matches("<svg").count(), page.matches("</figure>").count()), (2, 2));
    assert!(page.contains("<figcaption>nikon/fifty.dat<") && !page.contains("NaN"), "{page}");
    let out = folder.path().join("made/sheet.html");
    let output = run(caches.path(), None, &["lenses", "--sheet", out.to_str().unwrap()]);
    assert_eq!(printed(&output), format!("{}\n", out.display()));
    assert_eq!(fs::read_to_string(&out).unwrap().matches("<svg").count(), 27, "the catalogue");
    let wrong = run(caches.path(), None, &["lenses", "--sheet", "a.png"]);
    assert_eq!(wrong.status.code(), Some(2));
}

#[test]
fn a_collection_of_the_environment_is_listed_and_named() {
    let (folder, caches) = (collection(), tempfile::tempdir().unwrap());
    let own = |arguments: &[&str]| run(caches.path(), Some(folder.path()), arguments);
    assert!(printed(&own(&["lenses"])).contains("nikon/fifty.dat"));
    for name in ["fifty", "nikon/fifty.dat", "fifty@25mm"] {
        assert!(printed(&own(&["lens", name])).contains("fifty"), "{name}");
    }
    let message = String::from_utf8(own(&["lens", "fifti"]).stderr).unwrap();
    assert!(message.ends_with("did you mean \"nikon/fifty.dat\"?\n"), "{message}");
    let elsewhere = run(caches.path(), Some(Path::new("/nowhere")), &["lenses"]);
    assert!(printed(&elsewhere).contains("collection \"/nowhere\" does not exist"));
    let message = String::from_utf8(run(caches.path(), None, &["lenses", "/nowhere"]).stderr).unwrap();
    assert_eq!(message, "realistic: error: collection \"/nowhere\" does not exist\n");
}

#[test]
fn a_cache_that_cannot_be_used_is_no_error() {
    let folder = collection();
    let path = folder.path().to_str().unwrap();
    let text = printed(&run(Path::new("/dev/null"), None, &["lenses", path]));
    assert!(text.contains("nikon/fifty.dat"), "{text}");
}

//! The rooms of the house: who may use whom.
//!
//! Reads the source as text. Held, for the library, the program and the laboratory:
//! - an arrow between the library's rooms points only down their order;
//! - no two files import each other, in however many steps;
//! - `unsafe` stands only where the processor's instructions or another language are met.
//!
//! Of the pages: every file and every test that they name exists, every link leads somewhere, and no banned phrase stands
//! in them or in the source's comments.
//!
//! What stands under `#[cfg(test)]` is left out: a test may look anywhere. A re-export (`pub use`) is no arrow of its
//! own: who imports the name has an arrow to the file that it comes from.

mod arrows;
mod lecture;
mod links;
mod paths;
mod source;
mod words;
mod workflows;

use std::path::Path;

use arrows::{Arrow, circles, upward};
use source::Tree;

/// The library's rooms, each of which may use those before it.
const ROOMS: [&str; 11] = [
    "numeric",
    "message",
    "prescription",
    "lens",
    "trace",
    "imaging",
    "light",
    "sampling",
    "plan",
    "camera",
    "abi",
];

/// Where `unsafe` may stand, by package; `refractions` reads the processor's clock.
const UNSAFE: [(&str, &[&str]); 3] =
    [("src", &["abi/", "trace/"]), ("cli/src", &["commands/refractions.rs", "host/"]), ("lab/src", &[])];

fn tree(package: &str) -> Tree {
    Tree::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(package))
}

/// Fails with a finding per line.
#[track_caller]
fn nothing(found: &[String]) {
    assert!(found.is_empty(), "{} found:\n{}", found.len(), found.join("\n"));
}

#[test]
fn rooms_use_only_what_comes_before_them() {
    nothing(&upward(&Arrow::all(&tree("src")), &ROOMS));
}

#[test]
fn every_room_has_its_place_in_the_order() {
    let mut rooms: Vec<String> = tree("src").rooms();
    let mut known = ROOMS.map(str::to_owned).to_vec();
    rooms.sort_unstable();
    known.sort_unstable();
    assert_eq!(rooms, known);
}

#[test]
fn no_two_files_of_the_library_import_each_other() {
    nothing(&circles(&Arrow::all(&tree("src"))));
}

#[test]
fn no_two_files_of_the_program_import_each_other() {
    nothing(&circles(&Arrow::all(&tree("cli/src"))));
}

#[test]
fn no_two_files_of_the_laboratory_import_each_other() {
    nothing(&circles(&Arrow::all(&tree("lab/src"))));
}

#[test]
fn unsafe_code_stands_only_at_the_edges() {
    for (package, allowed) in UNSAFE {
        nothing(&tree(package).unsafe_outside(allowed));
    }
}

#[test]
fn a_crate_that_nobody_maintains_is_named_with_the_reason_while_it_is_in_use() {
    let read = |file: &str| {
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file))
            .expect("a file of the project")
    };
    let (lock, list) = (read("Cargo.lock"), read("deny.toml"));
    let ignored = list.lines().filter(|line| line.contains("id = \"RUSTSEC-"));
    let named: Vec<&str> = ignored
        .map(|line| {
            line.split_once("reason = \"").and_then(|(_, reason)| reason.split_once(':')).expect("a name").0
        })
        .collect();
    // Those of the RustSec advisories of 2026-11.
    for name in named.iter().copied().chain(["paste", "ttf-parser"]) {
        let is_in_use = lock.contains(&format!("name = \"{name}\"\n"));
        assert_eq!(named.contains(&name), is_in_use, "{name}");
    }
}

/// The checks above, on small trees of which the answer is known.
mod checks {
    use super::*;

    fn arrows(files: &[(&str, &str)]) -> Vec<Arrow> {
        Arrow::all(&Tree::of(files))
    }

    fn texts(files: &[(&str, &str)]) -> Vec<String> {
        let mut all: Vec<String> =
            arrows(files).iter().map(|Arrow { from, to, .. }| format!("{from} {to}")).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    const ORDER: [&str; 2] = ["low", "high"];

    #[test]
    fn an_upward_arrow_is_found_and_a_downward_one_is_not() {
        let library = ("lib.rs", "mod high; mod low;");
        let down = [library, ("low.rs", "pub struct L;"), ("high.rs", "use crate::low::L;")];
        assert_eq!(texts(&down), ["high.rs low.rs"]);
        assert_eq!(upward(&arrows(&down), &ORDER), [""; 0]);
        for text in ["use crate::high::H;", "fn f() { crate::high::g(1) }", "use super::{high::{self, H}};"] {
            let found = upward(&arrows(&[library, ("low.rs", text), ("high.rs", "")]), &ORDER);
            assert!(!found.is_empty(), "{text}");
            assert!(found.iter().all(|arrow| arrow.starts_with("low.rs -> high.rs")), "{found:?}");
        }
    }

    #[test]
    fn a_name_leads_to_the_file_that_it_is_reexported_from() {
        let files = [
            ("lib.rs", "pub mod low; pub mod high;"),
            ("low.rs", "use crate::high::Name;"),
            ("high/mod.rs", "mod inner; pub use inner::{deep as Name, Other};"),
            ("high/inner.rs", "pub fn deep() {} pub struct Other; use super::Other as Again;"),
        ];
        assert_eq!(texts(&files), ["low.rs high/inner.rs"]);
    }

    #[test]
    fn tests_comments_and_text_are_no_arrows() {
        let files = [
            ("lib.rs", "mod low; mod high;"),
            (
                "low.rs",
                r##"//! use crate::high::A;
                /* crate::high::A /* nested */ crate::high::A */
                const TEXT: &str = "crate::high::A"; const RAW: &str = r#"crate::high::"A"#; const C: char = '"';
                fn f<'a>(x: &'a str) {}
                #[cfg(test)] use crate::high::A;
                #[cfg(test)] mod tests { use crate::high::A; fn f() { if true { crate::high::A } } }"##,
            ),
            ("high.rs", "pub struct A;"),
        ];
        assert_eq!(texts(&files), [""; 0]);
        // What follows the test module counts again.
        let text = format!("{} use crate::high::A;", files[1].1);
        assert_eq!(texts(&[files[0], ("low.rs", &text), files[2]]), ["low.rs high.rs"]);
        let test_file = [("lib.rs", "mod a; mod b;"), ("a/mod.rs", "#[cfg(test)] mod tests;"), ("b.rs", "")];
        let outside = [test_file[0], test_file[1], test_file[2], ("a/tests.rs", "use crate::b;")];
        assert_eq!(texts(&outside), [""; 0]);
    }

    #[test]
    fn circles_are_found_whatever_their_length_and_way() {
        let library = ("lib.rs", "mod a; mod b; mod c;");
        let circle = [
            library,
            ("a.rs", "use crate::b::B;"),
            ("b.rs", "use super::c;"),
            ("c.rs", "fn f() { crate::a::f() }"),
        ];
        let found = circles(&arrows(&circle));
        assert_eq!(found.len(), 1);
        assert!(["a.rs", "b.rs", "c.rs"].iter().all(|file| found[0].contains(file)), "{found:?}");
        let chain = [library, circle[1], circle[2], ("c.rs", "")];
        assert_eq!(circles(&arrows(&chain)), [""; 0]);
        // A folder's file and one below it, by an import, by a path, and by the use of a name that it re-exports.
        let below = ("a/below.rs", "use super::Shared;");
        for text in [
            "mod below; use below::f; pub struct Shared;",
            "mod below; pub struct Shared; fn g() { below::f() }",
            "mod below; pub use below::f; pub struct Shared; fn g() { f() }",
            "mod below; pub(crate) use self::below::f; pub struct Shared; fn g() { f() }",
        ] {
            let found = circles(&arrows(&[("lib.rs", "mod a;"), ("a/mod.rs", text), below]));
            assert_eq!(found.len(), 1, "{text}");
        }
        let listed = ("a/mod.rs", "mod below; pub use below::f; pub struct Shared;");
        assert_eq!(circles(&arrows(&[("lib.rs", "mod a;"), listed, below])), [""; 0]);
    }

    #[test]
    fn paths_of_a_module_within_a_file_start_in_it() {
        let files = [
            ("lib.rs", "mod a; mod b;"),
            ("a.rs", "mod inner { use super::super::b::B; mod more { use super::super::f; } } use super::b;"),
            ("b.rs", ""),
        ];
        assert_eq!(texts(&files), ["a.rs b.rs"]);
    }

    #[test]
    fn stray_unsafe_code_is_found() {
        let tree = Tree::of(&[
            ("lib.rs", "mod a; mod abi;"),
            ("a/mod.rs", "// unsafe\n mod x;"),
            ("a/x.rs", "fn f() { unsafe { g() } }"),
            ("abi/mod.rs", "unsafe fn f() {}"),
        ]);
        assert_eq!(tree.unsafe_outside(&["abi/"]), ["a/x.rs"]);
        assert_eq!(tree.rooms(), ["a", "abi"]);
    }
}

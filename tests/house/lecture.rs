//! The tables in `docs/lecture.md`, `docs/beyond.md` and `docs/trust.md` name files and tests that exist.

use std::{fs, path::Path};

fn sources(directory: &Path, all: &mut String) {
    for entry in fs::read_dir(directory).expect("a directory").flatten() {
        let path = entry.path();
        if path.is_dir() {
            sources(&path, all);
        } else if path.extension().is_some_and(|extension| extension == "rs" || extension == "py") {
            all.push_str(&fs::read_to_string(path).expect("text"));
        }
    }
}

/// Checks that every test that a page in `docs` names exists, and that there are as many links (which `links` follows) and
/// named tests as a page of tables has at least.
fn page(name: &str, least_links: usize, least_tests: usize) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("docs").join(name)).expect("the page");
    let links = text.matches("](").count();
    assert!(links > least_links, "only {links} links in {name}");
    let tests = named_tests(&text);
    assert!(tests > least_tests, "only {tests} tests are named in {name}");
}

#[test]
fn every_file_and_every_test_in_the_table_exists() {
    page("lecture.md", 20, 30);
    page("beyond.md", 3, 9);
}

#[test]
fn every_test_that_a_promise_names_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("docs/trust.md")).expect("the table");
    let tests = named_tests(&text);
    assert!(tests > 15, "only {tests} tests are named");
}

/// How many tests the last cells of a text's tables name, each of which exists. What has a space in it is a command.
fn named_tests(text: &str) -> usize {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut code = String::new();
    ["src", "tests", "cli", "lab", "python/tests", "blender/tests"]
        .iter()
        .for_each(|directory| sources(&root.join(directory), &mut code));
    // A sweep runs in `.ci/run`: it is a test like any other.
    let is_sweep = |line: &&str| line.trim_start().starts_with("#[ignore = \"a sweep");
    let code: String = code.split_inclusive('\n').filter(|line| !is_sweep(line)).collect();
    let rows = text.lines().filter(|line| line.starts_with("| ") && line.ends_with('|'));
    let mut tests = 0;
    for cell in rows.filter_map(|row| row.trim_end_matches('|').rsplit('|').next()) {
        for name in cell.split('`').skip(1).step_by(2).filter(|name| !name.contains(' ')) {
            assert!(
                code.contains(&format!("#[test]\nfn {name}("))
                    || code.contains(&format!("#[test]\n    fn {name}("))
                    || code.contains(&format!("\ndef {name}(")),
                "no test is called {name}"
            );
            tests += 1;
        }
    }
    tests
}

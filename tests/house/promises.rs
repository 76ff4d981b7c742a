//! Tests listed in `docs/trust.md` exist.

use std::{fs, path::Path};

/// The page of promises.
const PAGE: &str = "docs/trust.md";

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

#[test]
fn every_test_that_a_promise_names_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join(PAGE)).expect("the table");
    let mut code = String::new();
    for directory in ["src", "crates", "tests", "cli", "lab", "python/tests", "blender/tests"] {
        sources(&root.join(directory), &mut code);
    }
    // A sweep runs in `.ci/run`, so it counts as a test.
    let is_sweep = |line: &&str| line.trim_start().starts_with("#[ignore = \"a sweep");
    let code: String = code.split_inclusive('\n').filter(|line| !is_sweep(line)).collect();
    let rows = text.lines().filter(|line| line.starts_with("| ") && line.ends_with('|'));
    let cells = rows.filter_map(|row| row.trim_end_matches('|').rsplit('|').next());
    // A name with a space in it is a command.
    let names = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).filter(|name| !name.contains(' '));
    let names: Vec<&str> = names.collect();
    assert!(names.len() > 100, "only {} tests are named", names.len());
    let is_test = |name: &str| {
        ["#[test]\nfn ", "#[test]\n    fn ", "\ndef "]
            .iter()
            .any(|start| code.contains(&format!("{start}{name}(")))
    };
    super::nothing(&names.into_iter().filter(|name| !is_test(name)).map(str::to_owned).collect::<Vec<_>>());
}

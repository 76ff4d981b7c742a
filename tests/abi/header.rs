//! The checked-in header equals cbindgen's output from the source.

use std::path::Path;

use crate::parameters::{compare, options_source};

#[test]
fn the_header_is_up_to_date() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config =
        cbindgen::Config::from_file(root.join("include/cbindgen.toml")).expect("a valid configuration");
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in [
        "types",
        "boundary/mod",
        "library",
        "options",
        "camera",
        "ray",
        "batch",
        "importance",
        "autofocus",
        "lens/handle",
        "lens/facts",
        "lens/trace",
        "lens/catalogue",
    ] {
        builder = builder.with_src(root.join(format!("src/abi/{file}.rs")));
    }
    let directory = tempfile::tempdir().expect("a directory");
    let options = directory.path().join("options.rs");
    std::fs::write(&options, options_source()).expect("the options are written");
    builder = builder.with_src(options);
    let mut made = Vec::new();
    builder.generate().expect("bindings").write(&mut made);
    let made = String::from_utf8(made).expect("UTF-8");
    compare("include/realistic.h", &made);
}

/// Returns C code without its comments.
fn plain(code: &str) -> String {
    let mut plain = String::new();
    for (i, part) in code.split("/*").enumerate() {
        plain.push_str(if i == 0 { part } else { part.split_once("*/").map_or("", |(_, after)| after) });
    }
    plain.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Returns the names that begin with `realistic_` and precede a parenthesis, in C code outside comments.
fn functions(code: &str) -> Vec<String> {
    let plain = plain(code);
    let words =
        |before: &str| before.rsplit(|c: char| !c.is_alphanumeric() && c != '_').next().map(str::to_owned);
    let called = plain.match_indices('(').filter_map(|(at, _)| words(&plain[..at]));
    called.filter(|name| name.starts_with("realistic_")).collect()
}

fn read(file: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect("a file of the project")
}

/// Returns the library's exported functions, found in its source.
fn exported() -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src/abi")];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path())
        {
            if entry.is_dir() {
                folders.push(entry);
            } else {
                let text = std::fs::read_to_string(entry).expect("text");
                let names = text.split("#[unsafe(no_mangle)]").skip(1).filter_map(|rest| {
                    let (_, rest) = rest.split_once("extern \"C\" fn ")?;
                    rest.split('(').next().map(str::to_owned)
                });
                found.extend(names);
            }
        }
    }
    found
}

#[test]
fn every_exported_function_is_declared_and_called_outside_tests() {
    let names = exported();
    assert!(names.len() <= 29 && names.contains(&"realistic_generate_ray".to_owned()), "{names:?}");
    let declared = functions(&read("include/realistic.h"));
    let callers = ["include/realistic.hpp", "examples/host.c"].map(|file| plain(&read(file)));
    // The two other exports are called by pbrt-v1 and by the assignment's host.
    for name in names.iter().filter(|name| name.starts_with("realistic_")) {
        assert!(declared.contains(name), "{name} is not in the header");
        // `realistic.hpp` calls the members of its `Api`.
        let member = name.trim_start_matches("realistic_");
        let calls =
            [format!("api_.{member}"), format!("api.{member}"), format!(" {member}("), format!("{name}(")];
        let is_called = callers.iter().any(|text| calls.iter().any(|call| text.contains(call)));
        assert!(is_called, "nobody calls {name}");
    }
}

#[test]
fn realistic_hpp_reaches_every_function_of_the_header() {
    let (header, hpp) = (read("include/realistic.h"), read("include/realistic.hpp"));
    // The header's inline functions call some of the other functions.
    let (_, inlined) = header.split_once("static inline").expect("inlined functions");
    let mut all = functions(&header);
    all.retain(|name| !functions(inlined).contains(name) || exported().contains(name));
    assert!(all.len() >= 25 && all.contains(&"realistic_capabilities".to_owned()), "{all:?}");
    // A function is used if its name occurs, or if it is a line of the list that defines the members of `Api`.
    let lacking = all.iter().filter(|name| {
        let listed = format!("X({})", name.trim_start_matches("realistic_"));
        !hpp.contains(&listed) && !functions(&hpp).contains(name)
    });
    assert_eq!(lacking.collect::<Vec<_>>(), [""; 0]);
}

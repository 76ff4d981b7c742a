//! The header and README say of each parameter what the table says.

use std::path::Path;

use realistic::camera::{Kind, PARAMETERS, Parameter, Range};

fn read(file: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect("a file of the project")
}

/// The comment on a member of the header's options, on one line.
fn comment(header: &str, member: &str) -> String {
    let start = header.find("typedef struct realistic_options").expect("the options");
    let options = &header[start..];
    let end = [" ", "*"]
        .into_iter()
        .flat_map(|before| [";", "["].map(|after| format!("{before}{member}{after}")))
        .find_map(|declared| options.find(&declared));
    let above = &options[..end.unwrap_or_else(|| panic!("no member {member}"))];
    let (_, comment) = above.rsplit_once("/*").expect("a comment");
    let (comment, _) = comment.split_once("*/").expect("the comment's end");
    comment.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn the_headers_options_say_meaning_range_and_default() {
    let header = read("include/realistic.h");
    // For scene files only.
    for row in PARAMETERS.iter().filter(|row| row.name != "af_zones") {
        let expected = format!("Parameter `{}`: {}.", row.name, row.description());
        let found = comment(&header, row.name);
        assert!(found.starts_with(&expected), "{}:\n{found}\nis not\n{expected}", row.name);
    }
}

/// The first cells of a parameter's line in README's table.
fn cells(row: &Parameter) -> [String; 3] {
    let names: Vec<String> =
        std::iter::once(row.name).chain(row.alias).map(|name| format!("`{name}`")).collect();
    let kind = match row.kind {
        Kind::Float => row.unit,
        Kind::Text => "string",
        Kind::Bool => "bool",
        Kind::Four => "four numbers",
    };
    let default = match row.default {
        name if row.kind == Kind::Text && !name.is_empty() => format!("`{name}`"),
        other => other.to_owned(),
    };
    [names.join(", "), kind.to_owned(), default]
}

#[test]
fn readmes_table_has_every_parameter_with_its_unit_default_and_names() {
    let readme = read("README.md");
    let (_, section) = readme.split_once("## Parameters").expect("the section");
    let (section, _) = section.split_once("### ").expect("the next section");
    let lines: Vec<Vec<&str>> = section
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    assert_eq!(lines.len(), PARAMETERS.len());
    for (row, line) in PARAMETERS.iter().zip(lines) {
        assert_eq!(line[..3], cells(row), "{}", row.name);
        if let Range::Names(names) = row.range {
            let lacking = names.iter().find(|name| !line[3].contains(&format!("`{name}`")));
            assert_eq!(lacking, None, "{}", row.name);
        }
    }
}

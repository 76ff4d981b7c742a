//! Files for use outside Rust that are generated from the table of parameters: the options in the header, the Python
//! package's types, and the table of docs/parameters.md. `REALISTIC_WRITE_HEADER=1 cargo test --test abi up_to_date`
//! regenerates all of them.

use std::{fmt::Write, fs, path::Path};

use ::realistic_camera::{Kind, Model, PARAMETERS, Parameter, Parameters, Range, Value};

fn read(file: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect("a file of the project")
}

/// Compares a checked-in file with its generated content; writes the file first if requested.
///
/// # Panics
/// The file differs from the generated content.
pub fn compare(file: &str, made: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    if std::env::var_os("REALISTIC_WRITE_HEADER").is_some() {
        fs::write(&path, made).expect("the file is written");
    }
    assert!(
        fs::read_to_string(&path).is_ok_and(|text| text == made),
        "{file} is not what the source says; run `REALISTIC_WRITE_HEADER=1 cargo test --test abi up_to_date`"
    );
}

/// Returns the members of `realistic_options` as Rust source, for cbindgen, which does not expand macros: the host's
/// members from `src/abi/options.rs`, followed by one member for each parameter.
pub fn options_source() -> String {
    let source = read("src/abi/options.rs");
    let after = |text: &str, mark: &str| text.split_once(mark).expect("the macro's call").1.to_owned();
    let doc: String = source
        .lines()
        .skip_while(|line| !line.contains("/// What a camera is built from"))
        .take_while(|line| line.trim_start().starts_with("///"))
        .map(|line| format!("{}\n", line.trim_start()))
        .collect();
    let host = after(&source, "\n    options {\n");
    let (host, _) = host.split_once("\n    }\n}").expect("its end");
    let mut members = format!("{doc}#[repr(C)]\npub struct realistic_options {{\n{host}\n");
    for row in PARAMETERS {
        let kind = match row.kind {
            Kind::Float => "f64",
            Kind::Four => "[f64; 4]",
            Kind::Bool => "i32",
            Kind::Text => "*const c_char",
        };
        for line in wrapped(&format!("Parameter `{}`: {}.", row.name, row.description()), 105) {
            writeln!(members, "/// {line}").expect("a string grows");
        }
        writeln!(members, "pub {}: {kind},", row.name).expect("a string grows");
    }
    members + "}\n"
}

/// Wraps a text into lines of at most `width` characters, unless a single word is longer.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.last_mut().expect("there is one");
        if last.is_empty() {
            last.push_str(word);
        } else if last.chars().count() + 1 + word.chars().count() <= width {
            *last += " ";
            *last += word;
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

/// Returns Python's type of a parameter's values.
fn python_type(row: &Parameter) -> String {
    match (row.kind, row.range) {
        (Kind::Float, _) => "float".to_owned(),
        (Kind::Bool, _) => "bool".to_owned(),
        (Kind::Four, _) => "Iterable[float]".to_owned(),
        (Kind::Text, Range::Names(names)) => {
            let names: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
            format!("Literal[{}]", names.join(", "))
        }
        (Kind::Text, _) if Parameters::default().set(row.name, Value::Float(1.0)).is_ok() => {
            "float | str".to_owned()
        }
        (Kind::Text, _) => "str | os.PathLike[str]".to_owned(),
    }
}

fn python_module() -> String {
    let mut text = String::from(
        "\"\"\"The parameters of a camera, their types, and their members of the C options.

Made from the library's table by `REALISTIC_WRITE_HEADER=1 cargo test --test abi up_to_date`.
\"\"\"

from __future__ import annotations

from ctypes import c_char_p, c_double, c_int32
from typing import TYPE_CHECKING, Any, Literal, TypedDict

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable


class Parameters(TypedDict, total=False):
    \"\"\"What a `Camera` takes besides its lens, its resolution and its pose. None: not given.\"\"\"

    lens_text: str | bytes | None
    \"\"\"The text of a lens file, read instead of `lens_file`; at most 1 MiB.\"\"\"
",
    );
    let mut member = |name: &str, kind: &str, help: &str| {
        let (first, rest) = help.split_at(1);
        let help = first.to_uppercase() + rest;
        let help = wrapped(&format!("\"\"\"{help}\"\"\""), 112).join("\n    ");
        writeln!(text, "    {name}: {kind} | None\n    {help}").expect("a string grows");
    };
    for row in PARAMETERS {
        // The lens is the first argument of a `Camera`.
        if row.name != "lens_file" {
            member(row.name, &python_type(row), &format!("{}.", row.description()));
        }
    }
    text += "\n\nMEMBERS: list[tuple[str, Any]] = [\n";
    for row in PARAMETERS {
        let kind = match row.kind {
            Kind::Float => "c_double",
            Kind::Four => "c_double * 4",
            Kind::Bool => "c_int32",
            Kind::Text => "c_char_p",
        };
        writeln!(text, "    (\"{}\", {kind}),", row.name).expect("a string grows");
    }
    text + "]\n\"\"\"Their members of `realistic_options`, which stand after the host's.\"\"\"\n"
}

#[test]
fn the_python_packages_parameters_are_up_to_date() {
    compare("python/src/realistic/_parameters.py", &python_module());
}

/// Returns a parameter's line in the table of docs/parameters.md.
fn line(row: &Parameter) -> String {
    let code = |name: &&str| format!("`{name}`");
    // The page states the rule for names without underscores.
    let plain = row.name.replace('_', "");
    let names: Vec<String> =
        row.names().filter(|name| *name == row.name || *name != plain).map(|name| code(&name)).collect();
    let kind = match row.kind {
        Kind::Float => row.unit,
        Kind::Text => "string",
        Kind::Bool => "bool",
        Kind::Four => "four numbers",
    };
    let default = match row.default {
        name if row.kind == Kind::Text && !name.is_empty() => code(&name),
        other => other.to_owned(),
    };
    // The line of a parameter of models without a lens starts with the model.
    let of = if row.models.contains(&Model::Lens) {
        String::new()
    } else {
        let models: Vec<String> = row.models.iter().map(|model| format!("`{model}`")).collect();
        format!("{}: ", models.join(" and "))
    };
    let mut help = of + row.help;
    let range = row.range.in_words(if row.kind == Kind::Float { "" } else { row.unit });
    if !range.is_empty() {
        help += ": ";
        help += &range.replace('"', "`");
    }
    format!("| {} | {kind} | {default} | {help} |\n", names.join(", "))
}

#[test]
fn the_pages_table_is_up_to_date() {
    const HEAD: &str = "| name | unit or type | default | |\n|---|---|---|---|\n";
    let page = read("docs/parameters.md");
    let (before, rest) = page.split_once(HEAD).expect("the table");
    let (_, after) = rest.split_once("\n\n").expect("the table's end");
    let table: String = PARAMETERS.iter().map(line).collect();
    compare("docs/parameters.md", &format!("{before}{HEAD}{table}\n{after}"));
}

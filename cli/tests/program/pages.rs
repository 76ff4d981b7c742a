//! The commands on the pages of the documentation work as shown. Every line `realistic …` of a block marked `sh` runs
//! in an empty folder, one folder per page, after the lens files from blocks marked `lens NAME` are written. A block
//! marked `output` has lines that the last command before it prints, with as many digits as the page shows.

use super::{realistic, run_in};
use std::fs;
use std::path::Path;

/// Size and number of samples of the pictures rendered here, unless the page renders tiles.
const SMALL: [(&str, &str); 2] = [("--size", "24x16"), ("--spp", "1")];

/// Returns the blocks of a page: for each, the text after its three backticks, and its content.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let parts = page.split("\n```").skip(1).step_by(2);
    parts.filter_map(|part| part.split_once('\n')).collect()
}

/// Returns the words of a line without its comment, and the input that is piped into the command; `None` for a line
/// of another program.
fn command(line: &str) -> Option<(Vec<String>, String)> {
    let line = line.split_once(" #").map_or(line, |(line, _)| line).trim();
    let (input, line) = match line.strip_prefix("echo ").and_then(|rest| rest.split_once(" | ")) {
        Some((input, line)) => (format!("{input}\n"), line),
        None => (String::new(), line),
    };
    let words = line.strip_prefix("realistic ")?.split_whitespace().map(str::to_owned).collect();
    Some((words, input))
}

/// Returns the command with a small picture.
fn small(mut words: Vec<String>) -> Vec<String> {
    if words[0] == "render" && !words.iter().any(|word| word == "--crop") {
        for (name, value) in SMALL {
            match words.iter().position(|word| word == name) {
                Some(at) => value.clone_into(&mut words[at + 1]),
                None => words.extend([name.to_owned(), value.to_owned()]),
            }
        }
    }
    words
}

/// Returns the words and numbers of a line, without the commas between them.
fn words(line: &str) -> Vec<&str> {
    line.split([' ', ',']).filter(|word| !word.is_empty()).collect()
}

/// Whether a printed word matches a word on a page: it is the same word, it rounds to a whole number that the page
/// shows, or it is a number within a unit of the last digit shown.
fn is_shown(shown: &str, printed: &str) -> bool {
    let (Ok(expected), Ok(number)) = (shown.parse::<f64>(), printed.parse::<f64>()) else {
        return shown == printed;
    };
    let (mantissa, power) = shown.split_once('e').unwrap_or((shown, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len() as i32);
    let unit = 10.0_f64.powi(power.parse::<i32>().unwrap_or(0) - decimals);
    (expected - number).abs() <= if decimals > 0 { 1.000_001 * unit } else { 0.5 * unit }
}

/// Returns the lines of an output block that are not among the printed lines; `...` matches the rest of a line.
fn not_printed<'a>(block: &'a str, printed: &str) -> Vec<&'a str> {
    let is_printed = |line: &&str| {
        let shown = words(line);
        let (shown, is_beginning) = match shown.as_slice() {
            [beginning @ .., "..."] => (beginning, true),
            all => (all, false),
        };
        printed.lines().map(words).any(|found| {
            let fits = if is_beginning { found.len() >= shown.len() } else { found.len() == shown.len() };
            fits && shown.iter().zip(found).all(|(shown, found)| is_shown(shown, found))
        })
    };
    block.lines().filter(|line| !is_printed(line)).collect()
}

#[test]
fn every_command_on_a_page_runs_and_prints_what_the_page_shows() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let (mut ran, mut shown, mut failed) = (0, 0, String::new());
    for entry in fs::read_dir(docs).unwrap() {
        let page = entry.unwrap().path();
        if page.extension().is_none_or(|end| end != "md") {
            continue;
        }
        let folder = tempfile::tempdir().unwrap();
        let mut printed = String::new();
        for (mark, text) in blocks(&fs::read_to_string(&page).unwrap()) {
            if let Some(name) = mark.strip_prefix("lens ") {
                fs::write(folder.path().join(name), text).unwrap();
            }
            // A compiled program has a test of its own.
            if mark == "output" && !printed.is_empty() {
                shown += 1;
                for line in not_printed(text, &printed) {
                    failed += &format!(
                        "{}: the page shows\n    {line}\nand the command before it prints\n{printed}",
                        page.display()
                    );
                }
            }
            for (words, input) in text.lines().filter(|_| mark == "sh").filter_map(command) {
                let words = small(words);
                let words: Vec<&str> = words.iter().map(String::as_str).collect();
                let output = if input.is_empty() {
                    realistic(folder.path(), &words)
                } else {
                    run_in(folder.path(), &words, &input)
                };
                ran += 1;
                printed = String::from_utf8_lossy(&output.stdout).into_owned();
                if !output.status.success() {
                    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
                    failed += &format!("{}: realistic {}\n{stderr}", page.display(), words.join(" "));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{failed}");
    assert!(ran >= 40 && shown >= 6, "only {ran} commands and {shown} outputs");
}

#[test]
fn outputs_are_compared_within_the_digits_that_a_page_shows() {
    let printed =
        "irradiance        1.228830e-2 for unit radiance\n0.0e0,7.17e-2,ok\nfused   1   1   7   28.11\n";
    for shown in
        ["irradiance 0.0123 for unit radiance", "0, 0.072, ok", "fused 1 1 7 ...", "fused 1 1 7 28.1"]
    {
        assert!(not_printed(shown, printed).is_empty(), "{shown}");
    }
    for shown in
        ["irradiance 0.0125 for unit radiance", "irradiance 0.0123", "0, 0.072, blocked", "fused 1 2 ..."]
    {
        assert_eq!(not_printed(shown, printed), [shown]);
    }
}

#[test]
fn commands_are_found_on_a_page() {
    let page = "a\n```sh\nrealistic lens x.dat    # why\ncargo run\necho 1,2 | realistic trace y\n```\nb\n```lens x.dat\n1 2\n```\n";
    let found = blocks(page);
    assert_eq!(found.iter().map(|(mark, _)| *mark).collect::<Vec<_>>(), ["sh", "lens x.dat"]);
    assert_eq!(found[1].1, "1 2");
    let commands: Vec<_> = found[0].1.lines().filter_map(command).collect();
    let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(commands, [(words("lens x.dat"), String::new()), (words("trace y"), "1,2\n".to_owned())]);
    assert_eq!(small(words("render --spp 64")), words("render --spp 1 --size 24x16"));
}

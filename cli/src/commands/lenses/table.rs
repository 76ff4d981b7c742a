//! The rows of the list as text, JSON and CSV.

use super::row::{COLUMNS, ListRow};
use realistic_base::message::printable;
use serde_json::Value;
use std::fmt::Write as _;

/// Width of the widest name that is kept in its column.
const WIDEST: usize = 48;

/// Formats the rows as text: a table of the lenses, and below it the files that cannot be read.
pub fn text(rows: &[ListRow]) -> String {
    let (lenses, unreadable): (Vec<&ListRow>, Vec<&ListRow>) =
        rows.iter().partition(|row| row.text("error").is_none());
    let name = |row: &ListRow| row.text("name").unwrap_or_default().to_owned();
    let widths = lenses.iter().map(|row| name(row).chars().count());
    let width = widths.max().unwrap_or(0).clamp(20, WIDEST);
    let mut text = String::new();
    if !lenses.is_empty() {
        let _ = writeln!(
            text,
            "{:<width$} {:>13} {:>6} {:>9} {:>5} {:>5}  {:<11} what it is",
            "name", "focal mm", "f/", "field deg", "year", "round", "maker"
        );
    }
    for row in lenses {
        let number = |column: &str, digits: usize| {
            row.number(column).map_or_else(|| "-".to_owned(), |number| format!("{number:.digits$}"))
        };
        let _ = writeln!(
            text,
            "{:<width$} {:>13} {:>6} {:>9} {:>5} {:>5}  {:<11} {}",
            name(row),
            focal_lengths(row),
            number("fnumber", 2),
            number("widest_field_of_view_deg", 1),
            number("year", 0),
            if row.json()["is_symmetric"] == true { "yes" } else { "no" },
            row.text("maker").unwrap_or("-"),
            row.text("title").unwrap_or("-"),
        );
    }
    if !unreadable.is_empty() {
        text += "\nfiles that cannot be read\n";
    }
    for row in unreadable {
        let _ = writeln!(text, "{}: {}", name(row), row.text("error").unwrap_or_default());
    }
    printable(&text).into_owned()
}

/// Formats the focal length, or the range of a zoom lens.
pub fn focal_lengths(row: &ListRow) -> String {
    match row.focal_range() {
        None => "-".to_owned(),
        Some([shortest, longest]) if shortest == longest => format!("{shortest:.1}"),
        Some([shortest, longest]) => format!("{shortest:.1}-{longest:.1}"),
    }
}

/// Formats the rows as a JSON array.
pub fn json(rows: &[ListRow]) -> String {
    let rows: Value = rows.iter().map(|row| Value::Object(row.json().clone())).collect();
    format!("{rows:#}\n")
}

/// Formats the rows as CSV (RFC 4180), with a header line. A value that is unknown is an empty cell.
pub fn csv(rows: &[ListRow]) -> String {
    let cell = |row: &ListRow, column: &str| match &row.json()[column] {
        Value::Null => String::new(),
        Value::String(text) if text.contains([',', '"', '\n', '\r']) => {
            format!("\"{}\"", text.replace('"', "\"\""))
        }
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let line = |row: &ListRow| COLUMNS.map(|column| cell(row, column)).join(",");
    let lines = std::iter::once(COLUMNS.join(",")).chain(rows.iter().map(line));
    lines.map(|line| line + "\n").collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn rows() -> [ListRow; 2] {
        let facts = json!({
            "title": "a, \"b\"", "focal_length_mm": 24.5, "shortest_focal_length_mm": 24.5,
            "longest_focal_length_mm": 68.0, "fnumber": 2.8, "year": 1958, "is_symmetric": true, "is_zoom": true,
        });
        [
            ListRow::of_lens("z", "/z", facts.as_object().unwrap()),
            ListRow::of_error("w", "/w", "why\u{1b}[0m"),
        ]
    }

    #[test]
    fn a_line_has_the_numbers_of_a_lens_and_another_the_reason() {
        let text = text(&rows());
        let lines: Vec<&str> = text.lines().collect();
        let words: Vec<&str> = lines[1].split_whitespace().collect();
        assert_eq!(words, ["z", "24.5-68.0", "2.80", "-", "1958", "yes", "-", "a,", "\"b\""]);
        assert_eq!(lines[2..], ["", "files that cannot be read", "w: why\\u{1b}[0m"]);
        assert_eq!(super::text(&[]), "");
    }

    #[test]
    fn the_columns_of_csv_are_the_keys_of_json() {
        let csv = csv(&rows());
        let lines: Vec<&str> = csv.lines().collect();
        assert_eq!(lines[0], COLUMNS.join(","));
        assert_eq!(lines[1], "/z,z,\"a, \"\"b\"\"\",,1958,24.5,true,24.5,68.0,2.8,,true,,");
        let json: Value = serde_json::from_str(&json(&rows())).unwrap();
        let keys: Vec<&String> = json[1].as_object().unwrap().keys().collect();
        assert_eq!(keys.len(), COLUMNS.len());
        assert!(COLUMNS.iter().all(|column| keys.iter().any(|key| key == column)));
    }
}

//! The fate of every statement of the lens file: replaced, left out, informative or used.

use realistic_optics::prescription::{Fate, Finding};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Formats the findings as a JSON array; each finding lists the places of its statements.
pub fn json(findings: &[Finding]) -> Value {
    let finding = |finding: &Finding| {
        let places = finding.places.iter().map(
            |place| json!({ "line": place.line, "column": place.column, "surface": place.surface.as_deref() }),
        );
        json!({
            "fate": finding.fate.name(),
            "statement": finding.statement,
            "reason": (!finding.reason.is_empty()).then_some(&finding.reason),
            "may_differ": finding.may_differ,
            "member": finding.member.as_deref(),
            "places": places.collect::<Value>(),
        })
    };
    findings.iter().map(finding).collect()
}

/// Formats the findings as a table with a row for each statement, in the order of the file. Statements without a place
/// come first.
pub fn report(findings: &[Finding]) -> String {
    let mut rows = vec![(0, 0, ["place", "fate", "statement", "surface", "reason"].map(str::to_owned))];
    for finding in findings {
        let row = |place: String, surface: &str| {
            let reason = if finding.reason.is_empty() { "-" } else { &finding.reason };
            [&place, finding.fate.name(), &finding.statement, surface, reason].map(str::to_owned)
        };
        if finding.places.is_empty() {
            rows.push((0, 1, row("-".to_owned(), "-")));
        }
        rows.extend(finding.places.iter().map(|place| {
            let surface = place.surface.as_deref().unwrap_or("-");
            (place.line, place.column, row(finding.location(place), surface))
        }));
    }
    rows.sort_by_key(|(line, column, _)| (*line, *column));
    let width = |column: usize| rows.iter().map(|(.., row)| row[column].chars().count()).max().unwrap_or(0);
    let [place, fate, statement, surface] = [0, 1, 2, 3].map(width);
    let mut text = String::new();
    for (.., row) in &rows {
        let [own_place, own_fate, own_statement, own_surface, reason] = row;
        let _ = writeln!(
            text,
            "{own_place:<place$}  {own_fate:<fate$}  {own_statement:<statement$}  {own_surface:<surface$}  {reason}"
        );
    }
    text
}

/// Largest number of reasons that the text lists for one fate.
const MOST_REASONS: usize = 40;

/// Formats the findings as text, which is empty for a lens without a file. Statements that are replaced or left out
/// with the same reason share a line; the others are counted.
pub fn text(findings: &[Finding]) -> String {
    if findings.is_empty() {
        return String::new();
    }
    let mut text = "\nof the lens file\n".to_owned();
    for fate in Fate::ALL {
        let of_fate = || findings.iter().filter(|finding| finding.fate == fate);
        // Statements that have no effect on the lens need no reason.
        if matches!(fate, Fate::Informative | Fate::Used) {
            let count: usize = of_fate().map(|finding| finding.places.len().max(1)).sum();
            if count > 0 {
                let _ = writeln!(text, "{:<17} {count} statements", fate.name());
            }
            continue;
        }
        let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
        for finding in of_fate() {
            let (reason, words) = (finding.reason.as_str(), finding.located());
            match groups.iter_mut().find(|(known, _)| *known == reason) {
                Some((_, statements)) => statements.push(words),
                None => groups.push((reason, vec![words])),
            }
        }
        for (reason, statements) in groups.iter().take(MOST_REASONS) {
            let because = if reason.is_empty() { String::new() } else { format!(": {reason}") };
            let _ = writeln!(text, "{:<17} {}{because}", fate.name(), statements.join(", "));
        }
        if let Some(more) = groups.len().checked_sub(MOST_REASONS).filter(|more| *more > 0) {
            let _ = writeln!(text, "{:<17} for {more} more reasons", fate.name());
        }
    }
    text + "--report lists every statement with its place\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::read;

    const FILE: &str = "UNIT MM\nNAME x\nNOTE 0 y\nNOTE 0 z\nXYZW 1\nSURF 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  CURV 0.02\n  \
                        DISZ 4\n  GLAS ___BLANK 1 0 1.5 0\n  DIAM 5 1\n  COAT A\nSURF 2\n  CURV -0.02\n  DISZ 48\n  DIAM 8 1\n  \
                        COAT A\nSURF 3\n  CURV 0\n  DISZ 0\n";

    #[test]
    fn a_line_tells_the_fate_of_each_kind_of_statement() {
        let lens = read("x.zmx", FILE.as_bytes()).unwrap();
        let text = text(&lens.findings);
        for line in [
            "left out          XYZW (line 5): a keyword that this reader does not know\n",
            "left out          COAT of surfaces 1, 2 (lines 14, 19): coating A is known",
            "informative       3 statements\n",
            "used              16 statements\n--report lists every statement with its place\n",
        ] {
            assert!(text.contains(line), "{line} is not in:\n{text}");
        }
        let json = json(&lens.findings);
        let unknown = json.as_array().unwrap().iter().find(|own| own["statement"] == "XYZW").unwrap();
        assert_eq!(
            unknown,
            &json!({
                "fate": "left out", "statement": "XYZW", "reason": "a keyword that this reader does not know",
                "may_differ": true, "member": null, "places": [{ "line": 5, "column": 1, "surface": null }],
            })
        );
    }

    #[test]
    fn the_report_has_a_row_for_every_statement_in_the_order_of_the_file() {
        let lens = read("x.zmx", FILE.as_bytes()).unwrap();
        let report = report(&lens.findings);
        let rows: Vec<&str> = report.lines().collect();
        assert_eq!(rows.len(), 1 + 22, "{report}");
        assert_eq!(rows[0], "place  fate         statement  surface  reason");
        assert_eq!(
            rows[5],
            "5      left out     XYZW       -        a keyword that this reader does not know"
        );
        assert_eq!(rows[7], "7      used         DISZ       -        -");
        assert!(
            rows[14].starts_with("14     left out     COAT       1        coating A is known to"),
            "{report}"
        );
        assert!(rows[19].starts_with("19     left out     COAT       2        "), "{report}");
    }
}

//! The fate of every statement of the lens file: replaced, left out, informative or used.

use realistic_base::message::counted;
use realistic_optics::prescription::{Fate, Finding};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Formats the findings as a JSON array; each finding lists its lines.
pub fn json(findings: &[Finding]) -> Value {
    let finding = |finding: &Finding| {
        json!({
            "fate": finding.fate.name(),
            "statement": finding.statement,
            "surfaces": finding.surfaces,
            "reason": (!finding.reason.is_empty()).then_some(&finding.reason),
            "lines": finding.lines,
        })
    };
    findings.iter().map(finding).collect()
}

/// Largest number of reasons that the text lists for one fate.
const MOST_REASONS: usize = 40;

/// Formats the findings as text, which is empty for a lens without a file. Statements with the same fate and the same
/// reason share a line.
pub fn text(findings: &[Finding]) -> String {
    if findings.is_empty() {
        return String::new();
    }
    let mut text = "\nof the lens file\n".to_owned();
    for fate in Fate::ALL {
        let mut groups: Vec<(&str, Vec<String>)> = Vec::new();
        for finding in findings.iter().filter(|finding| finding.fate == fate) {
            // Statements that have no effect on the lens need no reason.
            let (reason, words) = match fate {
                Fate::Replaced | Fate::LeftOut => (finding.reason.as_str(), located(finding)),
                Fate::Informative | Fate::Used => ("", number(finding)),
            };
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
            let _ = writeln!(text, "{:<17} for {more} more reasons, which --json lists", fate.name());
        }
    }
    text
}

/// Formats a statement with the numbers of its surfaces and lines.
fn located(Finding { statement, surfaces, lines, .. }: &Finding) -> String {
    let of = match surfaces.as_slice() {
        [] => String::new(),
        some => format!(" of {}", counted("surface", "surfaces", some)),
    };
    let at = if lines.is_empty() { String::new() } else { format!(" ({})", counted("line", "lines", lines)) };
    format!("{statement}{of}{at}")
}

/// Formats a statement with its number of occurrences in the file.
fn number(finding: &Finding) -> String {
    match finding.lines.len() {
        0 | 1 => finding.statement.clone(),
        count => format!("{count} {}", finding.statement),
    }
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
            "informative       2 NOTE, ",
            "used              ",
        ] {
            assert!(text.contains(line), "{line} is not in:\n{text}");
        }
        assert!(text.contains("NAME") && text.contains("3 DISZ") && text.contains("3 CURV"), "{text}");
        let json = json(&lens.findings);
        let unknown = json.as_array().unwrap().iter().find(|own| own["statement"] == "XYZW").unwrap();
        assert_eq!(
            unknown,
            &json!({
                "fate": "left out", "statement": "XYZW", "surfaces": [], "lines": [5],
                "reason": "a keyword that this reader does not know",
            })
        );
        // The list contains every line that has a statement at least once.
        let mut lines: Vec<u64> = json
            .as_array()
            .unwrap()
            .iter()
            .flat_map(|own| own["lines"].as_array().unwrap().iter())
            .map(|line| line.as_u64().unwrap())
            .collect();
        lines.sort_unstable();
        lines.dedup();
        assert_eq!(lines, (1..=22).collect::<Vec<u64>>());
    }
}

//! The lenses of the catalogue, one per line.

use crate::drawing::catalogue::Entry;
use realistic_optics::imaging::axial_beam::AxialBeam;
use realistic_optics::lens::{Lens, first_order::FirstOrder};
use realistic_optics::prescription::{Position, Prescription, catalogue};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Formats the list as text. Focal lengths are computed at the first position and stated at the others. f-numbers are
/// as stated; if the file states none, the computed number is in parentheses. Fields of view and years are as stated.
pub fn text() -> String {
    let mut text = format!(
        "{:<20} {:>12} {:>9} {:>12} {:>10} {:>5}  {}\n",
        "name", "focal mm", "stated f/", "field deg", "interfaces", "year", "what it is"
    );
    for name in catalogue::names() {
        let lens = catalogue::find(name).expect("listed");
        let _ = writeln!(
            text,
            "{name:<20} {:>12} {:>9} {:>12} {:>10} {:>5}  {}",
            focal_lengths(&lens),
            fnumbers(&lens),
            range(lens.stated.fields.iter().copied().flatten(), 1),
            lens.interfaces.len(),
            lens.stated.year.map_or_else(|| "-".to_owned(), |year| year.to_string()),
            lens.title.as_deref().unwrap_or("-"),
        );
    }
    text
}

/// Formats the list as JSON, with the keys of a single lens's report; values that are stated per position form an
/// array.
pub fn json() -> Value {
    let entry = |name| {
        let prescription = catalogue::find(name).expect("listed");
        let positions = prescription.positions.as_ref().map_or(&[][..], |positions| &positions.columns);
        let of_positions =
            |value: fn(&Position) -> Option<f64>| positions.iter().map(value).collect::<Vec<_>>();
        let lens = Lens::at_d_line(&prescription);
        let focal_length = FirstOrder::of(&lens).ok().map(|optics| optics.focal_length);
        let beam = AxialBeam::of(&lens);
        json!({
            "name": name,
            "title": prescription.title,
            "focal_length_mm": focal_length,
            "fnumber": focal_length.map(|length| beam.fnumber(length)),
            "fnumber_paraxial": focal_length.map(|length| beam.paraxial_fnumber(length)),
            "stated_focal_length_mm": prescription.stated_focal_length,
            "stated_fnumber": prescription.stated.fnumber,
            "stated_field_of_view_deg": prescription.stated.fields,
            "year": prescription.stated.year,
            "interfaces": prescription.interfaces.len(),
            "positions": {
                "stated_focal_length_mm": of_positions(|position| position.focal_length),
                "stated_fnumber": of_positions(|position| position.fnumber),
            },
        })
    };
    catalogue::names().map(entry).collect()
}

/// Returns the lenses, each with a line of text, for one page of drawings.
pub fn drawn() -> Vec<Entry> {
    let entry = |name| {
        let prescription = catalogue::find(name).expect("listed");
        let lens = Lens::at_d_line(&prescription);
        let focused = || FirstOrder::of(&lens).map_or(0.0, |optics| optics.back_focal_distance());
        Entry {
            film_distance: prescription.nominal_film_distance.unwrap_or_else(focused),
            text: prescription.title.unwrap_or_default(),
            lens,
        }
    };
    catalogue::names().map(entry).collect()
}

/// Formats the least and the greatest value, or the single value if they are equal.
fn range(values: impl Iterator<Item = f64>, digits: usize) -> String {
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values {
        (least, greatest) = (least.min(value), greatest.max(value));
    }
    let [least, greatest] = [least, greatest].map(|value| format!("{value:.digits$}"));
    match (least.as_str(), least == greatest) {
        ("inf", _) => "-".to_owned(),
        (_, true) => least,
        (_, false) => format!("{least}-{greatest}"),
    }
}

fn focal_lengths(lens: &Prescription) -> String {
    let own = FirstOrder::of(&Lens::at_d_line(lens)).ok().map(|optics| optics.focal_length);
    let others = lens.positions.iter().flat_map(|positions| &positions.columns[1..]);
    range(own.into_iter().chain(others.filter_map(|column| column.focal_length)), 1)
}

fn fnumbers(lens: &Prescription) -> String {
    let columns = lens.positions.iter().flat_map(|positions| &positions.columns);
    let stated: Vec<f64> =
        lens.stated.fnumber.into_iter().chain(columns.filter_map(|column| column.fnumber)).collect();
    if !stated.is_empty() {
        return range(stated.into_iter(), 1);
    }
    let lens = Lens::at_d_line(lens);
    let computed = FirstOrder::of(&lens).ok().map(|optics| AxialBeam::of(&lens).fnumber(optics.focal_length));
    format!("({})", range(computed.into_iter(), 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_lens_has_a_line_with_its_numbers() {
        let text = text();
        assert_eq!(text.lines().count(), catalogue::names().count() + 1);
        let line =
            |name: &str| text.lines().find(|line| line.split_whitespace().next() == Some(name)).unwrap();
        let words: Vec<&str> = line("dgauss.100mm").split_whitespace().collect();
        assert_eq!(words[1], "100.7", "{words:?}");
        // The file states no f-number.
        assert!(words[2].starts_with('('), "{words:?}");
        assert_eq!(line("planar.50mm").split_whitespace().nth(2), Some("1.4"));
        assert_eq!(range([3.0, 2.0].into_iter(), 1), "2.0-3.0");
        assert_eq!(range([2.01, 2.0].into_iter(), 1), "2.0");
        assert_eq!(range(std::iter::empty(), 1), "-");
    }
}

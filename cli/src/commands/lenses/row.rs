//! A row of the list: the facts of a file's lens, or the reason why the file cannot be read.

use realistic_optics::imaging::moving::MovingGroups;
use realistic_optics::imaging::open::{StopSize, set_up};
use realistic_optics::prescription::Prescription;
use serde_json::{Map, Value, json};

/// The keys of a row, in the order of a CSV file. Units are in the names; null is a value that does not exist or that
/// the file does not state.
pub const COLUMNS: [&str; 14] = [
    "lens_file",
    "name",
    "title",
    "maker",
    "year",
    "focal_length_mm",
    "is_zoom",
    "shortest_focal_length_mm",
    "longest_focal_length_mm",
    "fnumber",
    "widest_field_of_view_deg",
    "is_symmetric",
    "interfaces",
    "error",
];

/// Makers of lenses, as they are written in titles and names of folders. The first one counts: Zeiss is often named
/// together with the maker of a camera.
const MAKERS: [&str; 33] = [
    "Zeiss",
    "Agfa",
    "Angenieux",
    "Canon",
    "Comar",
    "Cooke",
    "Edmund",
    "Fujifilm",
    "Goerz",
    "Kodak",
    "Konica",
    "Leica",
    "Leitz",
    "Mamiya",
    "Minolta",
    "Newport",
    "Nikon",
    "Olympus",
    "Optosigma",
    "Panasonic",
    "Pentax",
    "Qioptiq",
    "Ricoh",
    "Rodenstock",
    "Ross",
    "Samyang",
    "Schneider",
    "Sigma",
    "Sony",
    "Tamron",
    "Thorlabs",
    "Tokina",
    "Voigtlander",
];

/// A row: a value for each of [`COLUMNS`].
#[derive(Clone, Debug, PartialEq)]
pub struct ListRow(Map<String, Value>);

impl ListRow {
    /// Makes the row of a lens from its facts.
    pub fn of_lens(name: &str, lens_file: &str, facts: &Map<String, Value>) -> Self {
        let mut row = Self::empty(name, lens_file);
        row.0.extend(facts.clone());
        let title = row.text("title").unwrap_or_default();
        row.0.insert("maker".to_owned(), json!(maker(title).or_else(|| maker(lens_file))));
        row
    }

    /// Makes the row of a file that cannot be read.
    pub fn of_error(name: &str, lens_file: &str, error: &str) -> Self {
        let mut row = Self::empty(name, lens_file);
        row.0.insert("error".to_owned(), error.into());
        row
    }

    fn empty(name: &str, lens_file: &str) -> Self {
        let mut row: Map<String, Value> =
            COLUMNS.iter().map(|column| ((*column).to_owned(), Value::Null)).collect();
        row.insert("name".to_owned(), name.into());
        row.insert("lens_file".to_owned(), lens_file.into());
        Self(row)
    }

    /// Returns the row as a JSON object.
    pub fn json(&self) -> &Map<String, Value> {
        &self.0
    }

    /// Returns the number of a column, if it has one.
    pub fn number(&self, column: &str) -> Option<f64> {
        self.0[column].as_f64()
    }

    /// Returns the text of a column, if it has one.
    pub fn text(&self, column: &str) -> Option<&str> {
        self.0[column].as_str()
    }

    /// Returns the range of focal lengths, mm; `None` if the lens has no focal length.
    pub fn focal_range(&self) -> Option<[f64; 2]> {
        let zoom = ["shortest_focal_length_mm", "longest_focal_length_mm"].map(|column| self.number(column));
        match zoom {
            [Some(shortest), Some(longest)] => Some([shortest, longest]),
            _ => self.number("focal_length_mm").map(|length| [length; 2]),
        }
    }
}

/// Returns the facts of a lens: its title, its numbers as computed at its own wavelength, and the statements of its file.
///
/// # Errors
/// The lens cannot be set up.
pub fn facts(prescription: &Prescription) -> Result<Map<String, Value>, String> {
    let wavelength = prescription.own_wavelength();
    let opened = set_up(prescription, wavelength, StopSize::Listed, &mut |_, _| ());
    let opened = opened.map_err(|error| error.to_string())?;
    let focal_length = opened.first_order.as_ref().ok().map(|optics| optics.focal_length);
    let zoom =
        MovingGroups::of(prescription).filter(MovingGroups::is_zoom).map(|groups| groups.focal_range());
    let fields = prescription.stated.fields.iter().copied().flatten();
    let facts = json!({
        "title": prescription.title,
        "year": prescription.stated.year,
        "focal_length_mm": focal_length.and_then(rounded),
        "is_zoom": zoom.is_some(),
        "shortest_focal_length_mm": zoom.and_then(|[shortest, _]| rounded(shortest)),
        "longest_focal_length_mm": zoom.and_then(|[_, longest]| rounded(longest)),
        "fnumber": focal_length.and_then(|length| rounded(opened.beam.fnumber(length))),
        "widest_field_of_view_deg": fields.reduce(f64::max).and_then(rounded),
        "is_symmetric": prescription.is_symmetric(),
        "interfaces": prescription.interfaces.len(),
    });
    match facts {
        Value::Object(facts) => Ok(facts),
        _ => unreachable!("an object, as written"),
    }
}

/// Rounds a finite number to nine digits, which a cache keeps exactly.
fn rounded(number: f64) -> Option<f64> {
    format!("{number:.8e}").parse().ok().filter(|number: &f64| number.is_finite())
}

/// Returns the maker whose name is a word of a text, or the beginning of a joined word such as `EdmundOptics`.
fn maker(text: &str) -> Option<&'static str> {
    let begins_word = |rest: &str| {
        let mut letters = rest.chars();
        letters.next().is_none_or(char::is_uppercase) && letters.next().is_none_or(char::is_lowercase)
    };
    let is_by = |word: &str, maker: &str| {
        word.split_at_checked(maker.len())
            .is_some_and(|(own, rest)| own.eq_ignore_ascii_case(maker) && begins_word(rest))
    };
    let words = || text.split(|letter: char| !letter.is_alphabetic());
    MAKERS.into_iter().find(|maker| words().any(|word| is_by(word, maker)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::{catalogue, read};

    fn row(name: &str, text: &str) -> ListRow {
        let facts = facts(&read(name, text.as_bytes()).unwrap()).unwrap();
        ListRow::of_lens(name, &format!("/stock/thorlabs/{name}"), &facts)
    }

    #[test]
    fn a_row_has_a_value_for_each_column() {
        let singlet = row("a.dat", "# Carl Zeiss Jena, for Sony\n50 2 1.5 10\n-50 0 1 10\n");
        assert_eq!(singlet.json().len(), COLUMNS.len());
        // 1/f = 0.5 (1/50 + 1/50 - 0.5 * 2/(1.5 * 2500))
        let f = 1.0 / (0.5 * (0.04 - 1.0 / 3750.0));
        let own = singlet.number("focal_length_mm").unwrap();
        assert!((own - f).abs() < 1e-6 * f, "{own} {f}");
        assert_eq!(singlet.focal_range(), Some([own; 2]));
        assert_eq!((singlet.text("maker"), &singlet.json()["is_zoom"]), (Some("Zeiss"), &json!(false)));
        assert_eq!(singlet.json()["is_symmetric"], true);
        assert_eq!(row("a.dat", "50 2 1.5 10\n-50 0 1 10\n").text("maker"), Some("Thorlabs"));
        let afocal = row("b.dat", "0 2 1.5 10\n0 0 1 10\n");
        assert_eq!((afocal.focal_range(), afocal.number("fnumber")), (None, None));
        for (text, known) in
            [("/EdmundOptics/a", Some("Edmund")), ("ThorLabs", Some("Thorlabs")), ("ROSSINI, Sonya", None)]
        {
            assert_eq!(maker(text), known, "{text}");
        }
        let error = ListRow::of_error("c.dat", "/c.dat", "why");
        assert_eq!((error.json().len(), error.text("error")), (COLUMNS.len(), Some("why")));
    }

    #[test]
    fn a_zoom_lens_has_a_range() {
        let zoom = catalogue::find("zoom.24-70mm").unwrap();
        let row = ListRow::of_lens("zoom", "zoom", &facts(&zoom).unwrap());
        let [shortest, longest] = row.focal_range().unwrap();
        assert!((23.0..26.0).contains(&shortest) && (66.0..72.0).contains(&longest), "{shortest} {longest}");
        assert_eq!(row.json()["is_zoom"], true);
    }
}

//! The lenses that the user looks for: ranges of focal length and f-number, and the maker.

use super::row::ListRow;

/// A range of numbers; both ends belong to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberRange([f64; 2]);

impl NumberRange {
    /// Parses `A-B`, `-B` (from 0) or `A-` (to infinity).
    ///
    /// # Errors
    /// The text is not a range; the message says how to write one.
    pub fn parse(text: &str) -> Result<Self, String> {
        let number = |text: &str, open: f64| match text.trim() {
            "" => Some(open),
            text => text.parse().ok().filter(|number: &f64| number.is_finite()),
        };
        let ends = text.split_once('-').filter(|ends| *ends != ("", ""));
        ends.and_then(|(least, most)| Some([number(least, 0.0)?, number(most, f64::INFINITY)?]))
            .filter(|[least, most]| (0.0..=*most).contains(least))
            .map(Self)
            .ok_or_else(|| "write a range of numbers: 40-60, -60 (up to 60) or 40- (from 40 on)".to_owned())
    }

    /// Returns whether the range has a number in common with another range.
    fn meets(self, [least, most]: [f64; 2]) -> bool {
        least <= self.0[1] && most >= self.0[0]
    }
}

/// The conditions for a lens to be listed.
#[derive(Clone, Debug, Default)]
pub struct Filter {
    /// A focal length, mm; one of a zoom lens's.
    pub focal: Option<NumberRange>,
    /// The f-number.
    pub fnumber: Option<NumberRange>,
    /// A part of the maker's name or, if the maker is unknown, of the title or the path.
    pub maker: Option<String>,
}

impl Filter {
    /// Returns whether every row passes.
    pub fn is_open(&self) -> bool {
        self.focal.is_none() && self.fnumber.is_none() && self.maker.is_none()
    }

    /// Returns whether a row passes. A file that cannot be read passes an open filter alone.
    pub fn passes(&self, row: &ListRow) -> bool {
        let within = |range: Option<NumberRange>, own: Option<[f64; 2]>| {
            range.is_none_or(|range| own.is_some_and(|own| range.meets(own)))
        };
        let fnumber = row.number("fnumber").map(|number| [number; 2]);
        within(self.focal, row.focal_range()) && within(self.fnumber, fnumber) && self.is_by_maker(row)
    }

    fn is_by_maker(&self, row: &ListRow) -> bool {
        let Some(maker) = self.maker.as_ref().map(|maker| maker.to_lowercase()) else { return true };
        let places: &[&str] = match row.text("maker") {
            Some(_) => &["maker"],
            None => &["title", "lens_file"],
        };
        row.text("error").is_none()
            && places
                .iter()
                .filter_map(|place| row.text(place))
                .any(|text| text.to_lowercase().contains(&maker))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn row(facts: &serde_json::Value) -> ListRow {
        ListRow::of_lens("x", "/own/x", facts.as_object().unwrap())
    }

    #[test]
    fn ranges_are_open_where_a_number_is_missing() {
        let range = |text: &str| NumberRange::parse(text).map(|range| range.0);
        assert_eq!(range("40-60"), Ok([40.0, 60.0]));
        assert_eq!((range("-2"), range("1.4-")), (Ok([0.0, 2.0]), Ok([1.4, f64::INFINITY])));
        for wrong in ["", "-", "40", "60-40", "a-b", "1-2-3", "--2", "nan-", "inf-"] {
            assert!(range(wrong).unwrap_err().starts_with("write a range"), "{wrong}");
        }
    }

    #[test]
    fn a_lens_passes_by_its_numbers_and_its_maker() {
        let prime = row(&json!({ "focal_length_mm": 50.2, "fnumber": 2.0, "title": "Nikon 50 mm" }));
        let zoom = row(&json!({
            "focal_length_mm": 24.5, "shortest_focal_length_mm": 24.5, "longest_focal_length_mm": 68.0,
            "title": "by Acme",
        }));
        let diverging = row(&json!({ "focal_length_mm": -50.0, "fnumber": 5.0 }));
        let error = ListRow::of_error("nikon", "/nikon", "why");
        let passing = |focal: Option<&str>, fnumber: Option<&str>, maker: Option<&str>| {
            let range = |text: Option<&str>| text.map(|text| NumberRange::parse(text).unwrap());
            let filter =
                Filter { focal: range(focal), fnumber: range(fnumber), maker: maker.map(str::to_owned) };
            [&prime, &zoom, &diverging, &error].map(|row| filter.passes(row))
        };
        assert_eq!(passing(None, None, None), [true; 4]);
        assert_eq!(passing(Some("40-60"), None, None), [true, true, false, false]);
        assert_eq!(passing(Some("-60"), None, None), [true, true, false, false]);
        assert_eq!(passing(Some("70-"), None, None), [false; 4]);
        assert_eq!(passing(None, Some("-2"), None), [true, false, false, false]);
        assert_eq!(passing(None, None, Some("nikon")), [true, false, false, false]);
        assert_eq!(passing(None, None, Some("ACME")), [false, true, false, false]);
        assert_eq!(passing(None, None, Some("own")), [false, true, true, false]);
    }
}

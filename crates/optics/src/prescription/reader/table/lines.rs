//! Lines of words with their locations. A table is read from these lines.

use crate::prescription::{
    LensFileError,
    reader::text::{Cell, Location, no_number},
};
use realistic_base::message::cut;

/// The values of a line, of which there is at least one.
pub(super) type Line<'t> = Vec<Cell<'t>>;

/// The lines of a file that have values.
#[derive(Debug)]
pub(super) struct Lines<'t> {
    file: &'t str,
    pub lines: Vec<Line<'t>>,
    /// The text of the first comment that is not empty.
    pub title: Option<String>,
    /// The number of lines of the file, including those without values.
    count: usize,
    /// The first line whose commas are probably decimal commas.
    decimal_comma: Option<usize>,
    /// The comment that labels the last column as radii: the number of its line, and the label.
    radii: Option<(usize, String)>,
}

impl<'t> Lines<'t> {
    /// Splits decoded bytes into lines. Comments may be in any encoding.
    pub(super) fn split(file: &'t str, bytes: &'t [u8]) -> Result<Self, LensFileError> {
        let mut all =
            Self { file, lines: Vec::new(), title: None, count: 0, decimal_comma: None, radii: None };
        // Lines of old Macintosh files end in CR alone.
        let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
        for (number, line) in bytes.split(|&byte| byte == end).enumerate() {
            all.count = number + 1;
            let data_end = line.iter().position(|&byte| byte == b'#').unwrap_or(line.len());
            let (data, comment) = line.split_at(data_end);
            if !comment.is_empty() && (all.title.is_none() || all.radii.is_none()) {
                let text = String::from_utf8_lossy(comment);
                let text = text.trim_matches(|c: char| c == '#' || c.is_whitespace());
                all.title = all.title.or_else(|| (!text.is_empty()).then(|| text.to_owned()));
                if data.trim_ascii().is_empty() {
                    all.radii = all.radii.or_else(|| Some((all.count, heading_of_radii(text)?)));
                }
            }
            if all.decimal_comma.is_none() && has_decimal_commas(data) {
                all.decimal_comma = Some(all.count);
            }
            let words = all.words(all.count, data)?;
            if !words.is_empty() {
                all.lines.push(words);
            }
        }
        Ok(all)
    }

    fn words(&self, line: usize, data: &'t [u8]) -> Result<Line<'t>, LensFileError> {
        let is_separator = |byte: u8| byte == b',' || byte.is_ascii_whitespace();
        let mut words = Vec::new();
        let mut at = 0;
        let mut comma: Option<usize> = None;
        while at < data.len() {
            if is_separator(data[at]) {
                if data[at] == b',' {
                    if comma.is_some() || words.is_empty() {
                        return Err(self.error_at(
                            line,
                            at + 1,
                            "nothing stands before this comma; expected a value (- for one left out)",
                        ));
                    }
                    comma = Some(at);
                }
                at += 1;
                continue;
            }
            comma = None;
            let end = data[at..].iter().position(|&byte| is_separator(byte)).map_or(data.len(), |n| at + n);
            let text = std::str::from_utf8(&data[at..end])
                .ok()
                .filter(|text| text.chars().all(|c| !c.is_control()))
                .ok_or_else(|| {
                    self.error_at(line, at + 1, "not text; expected a number (comments begin with #)")
                })?;
            words.push(Cell { text, location: Location { line, column: at + 1 } });
            at = end;
        }
        match comma {
            Some(at) => Err(self.error_at(
                line,
                at + 1,
                "nothing stands after this comma; expected a value (- for one left out)",
            )),
            None => Ok(words),
        }
    }

    /// Returns the finite number that a word states.
    pub(super) fn number(&self, word: &Cell<'_>, expected: &str) -> Result<f64, LensFileError> {
        let number = word.text.parse().map_err(|_| self.error(word, &no_number(word.text, expected)))?;
        if f64::is_finite(number) {
            Ok(number)
        } else {
            Err(self.error(word, &format!("\"{word}\" is not finite; expected {expected}")))
        }
    }

    /// Returns the only line in `lines`, if there is one. `problem` continues the error message "a second line".
    pub(super) fn at_most_one<'a>(
        &self,
        lines: &'a [Line<'t>],
        problem: &str,
    ) -> Result<Option<&'a Line<'t>>, LensFileError> {
        match lines {
            [_, second, ..] => Err(self.error(&second[0], &format!("a second line {problem}"))),
            _ => Ok(lines.first()),
        }
    }

    /// Returns the row, counted from 0, that a word states as a row's number. `rows` is the number of rows; `form`
    /// describes the line in messages.
    pub(super) fn row_number(
        &self,
        word: &Cell<'_>,
        rows: usize,
        form: &str,
    ) -> Result<usize, LensFileError> {
        let row = word.text.parse().ok().filter(|row| (1..=rows).contains(row));
        row.map(|row: usize| row - 1).ok_or_else(|| {
            self.error(
                word,
                &format!("\"{word}\" is not a row of the table, which has rows 1 to {rows}; {form}"),
            )
        })
    }

    /// Returns the remark that the last column is read as radii, and the location of the remark; `None` if no comment
    /// labels that column as radii.
    pub(super) fn radius_column_remark(&self) -> Option<(Location, String)> {
        let (line, heading) = self.radii.as_ref()?;
        let message = format!(
            "the last column is headed \"{}\": its numbers are taken for radii, half as wide as clear diameters",
            cut(heading)
        );
        Some((Location { line: *line, column: 1 }, message))
    }

    /// Returns whether commas of the file are probably decimal commas.
    pub(super) fn has_decimal_comma(&self) -> bool {
        self.decimal_comma.is_some()
    }

    /// Checks the number of lines of one kind against its maximum.
    pub(super) fn at_most(&self, lines: &[Line<'_>], most: usize, limit: &str) -> Result<(), LensFileError> {
        lines.get(most).map_or(Ok(()), |beyond| {
            let message = format!("row {} of {}; {limit}", most + 1, lines.len());
            Err(self.error(&beyond[0], &message))
        })
    }

    pub(super) fn error(&self, word: &Cell<'_>, message: &str) -> LensFileError {
        self.error_at(word.location.line, word.location.column, message)
    }

    /// Takes out the lines that begin with one of these words, in any case.
    pub(super) fn take(&mut self, keywords: &[&str]) -> Vec<Line<'t>> {
        self.take_where(|line| keywords.iter().any(|keyword| line[0].is(keyword)))
    }

    /// Takes out the lines that pass a test.
    pub(super) fn take_where(&mut self, is_taken: impl Fn(&Line<'t>) -> bool) -> Vec<Line<'t>> {
        let (taken, rest) = std::mem::take(&mut self.lines).into_iter().partition(|line| is_taken(line));
        self.lines = rest;
        taken
    }

    /// Returns the index in `names` of a constant such as `B1=1.04`, and the value of that constant.
    pub(super) fn constant(
        &self,
        word: &Cell<'_>,
        names: &[String],
        expected: &str,
    ) -> Result<(usize, f64), LensFileError> {
        let split = word.text.split_once('=');
        let index =
            split.and_then(|(name, _)| names.iter().position(|known| known.eq_ignore_ascii_case(name)));
        let (Some((name, number)), Some(index)) = (split, index) else {
            return Err(self.error(word, &format!("\"{word}\" is not a constant such as {expected}")));
        };
        let column = word.location.column + name.len() + 1;
        let value = Cell { text: number, location: Location { column, ..word.location } };
        Ok((index, self.number(&value, &format!("a constant such as {expected}"))?))
    }

    /// Returns the values of constants such as `B1=1.04`, in the order of `names`; `None` for a constant that is not
    /// given. `form` describes the line in messages, and `example` is one of the constants of the line.
    pub(super) fn constants(
        &self,
        words: &[Cell<'_>],
        names: &[String],
        example: &str,
        form: &str,
    ) -> Result<Vec<Option<f64>>, LensFileError> {
        let mut constants = vec![None; names.len()];
        for word in words {
            let (index, number) = self.constant(word, names, &format!("{example}; {form}"))?;
            if constants[index].replace(number).is_some() {
                return Err(self.error(word, &format!("\"{word}\": given twice; {form}")));
            }
        }
        Ok(constants)
    }

    pub(super) fn error_at_end(&self, message: &str) -> LensFileError {
        self.error_at(self.count, 1, message)
    }

    fn error_at(&self, line: usize, column: usize, message: &str) -> LensFileError {
        let mut message = message.to_owned();
        if let Some(comma) = self.decimal_comma {
            message += &format!(" (a decimal comma on line {comma}? write 1.5, not 1,5)");
        }
        LensFileError { file: self.file.to_owned(), line, column, message }
    }
}

/// Returns the label of the last column if a comment labels the columns, the first as radii of curvature and the last
/// as half of a clear aperture. Such comments are `radius thickness index aperture_radius` and `R, d, n, semi diameter
/// (mm)`.
fn heading_of_radii(comment: &str) -> Option<String> {
    let is_separator = |c: char| c.is_whitespace() || matches!(c, ',' | ';' | '|');
    let words =
        comment.split(is_separator).map(|word| word.trim_matches(|c: char| "()[]{}:*.\"".contains(c)));
    let words: Vec<&str> = words
        .filter(|word| !["", "mm", "cm", "in", "inch"].contains(&word.to_ascii_lowercase().as_str()))
        .collect();
    let [first, _, .., before, last] = words.as_slice() else { return None };
    let is_number = |word: &&str| word.starts_with(|c: char| c.is_ascii_digit());
    let [first, lower_before, lower_last] = [first, before, last].map(|word| word.to_ascii_lowercase());
    let heads = first.starts_with("rad") || ["r", "roc", "curvature"].contains(&first.as_str());
    if !heads || words.iter().any(is_number) {
        return None;
    }
    let is_half = |word: &str| ["radi", "semi", "half"].iter().any(|part| word.contains(part));
    if is_half(&lower_last) {
        Some((*last).to_owned())
    } else {
        let is_width = ["ap", "dia"].iter().any(|part| lower_last.starts_with(part));
        (is_width && is_half(&lower_before)).then(|| format!("{before} {last}"))
    }
}

/// Returns whether a line seems to have decimal commas. Such a line has commas between two digits although other
/// separators divide its values, or it has more than the four commas that can separate a row's values.
fn has_decimal_commas(line: &[u8]) -> bool {
    let digits_around =
        |three: &&[u8]| three[1] == b',' && three[0].is_ascii_digit() && three[2].is_ascii_digit();
    let commas = line.windows(3).filter(digits_around).count();
    let parts = line.split(|byte| byte.is_ascii_whitespace() || *byte == b';');
    commas > 0 && (commas > 4 || parts.filter(|part| !part.is_empty() && *part != b",").count() > 1)
}

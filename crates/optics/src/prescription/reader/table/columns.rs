//! Lines with a value for each position of the moving groups: `positions NAME …`, `gap ROW …`, `film …`, `stopdiameter
//! …`, `focal …`, `fnumber …`, `object …`, `field …`. A lens without positions states its facts on the same lines. The
//! line `year` states the year of the design.

use super::lines::{Line, Lines};
use crate::prescription::{
    LensFileError, MAX_INTERFACES, MAX_NAME_BYTES, MAX_POSITIONS,
    interfaces::{Medium, Stated},
    positions::{Position, Positions},
    reader::{
        surface_rows::{Role, SurfaceRow},
        text::Cell,
    },
};

/// The first words of the lines that this module reads.
pub(super) const KEYWORDS: [&str; 9] =
    ["positions", "gap", "film", "stopdiameter", "focal", "fnumber", "object", "field", "year"];

const GAP: &str = "a gap that moves is: gap ROW and the thickness behind that row in mm at each position";

/// The lines that this module reads, sorted by kind.
#[derive(Debug, Default)]
pub(super) struct TableColumns<'t> {
    /// All lines except those of gaps, one line of each kind.
    single: Vec<Line<'t>>,
    gaps: Vec<Line<'t>>,
}

impl<'t> TableColumns<'t> {
    /// Takes the lines that this module reads out of `lines`.
    pub(super) fn take(lines: &mut Lines<'t>) -> Result<Self, LensFileError> {
        let mut columns = Self::default();
        for line in lines.take(&KEYWORDS) {
            let keyword = &line[0];
            if line.len() == 1 {
                return Err(lines.error(keyword, &format!("no values behind \"{keyword}\"")));
            }
            if keyword.is("gap") {
                columns.gaps.push(line);
            } else if columns.single.iter().any(|known| known[0].is(keyword.text)) {
                return Err(lines.error(keyword, &format!("a second line \"{keyword}\"; a lens has one")));
            } else {
                columns.single.push(line);
            }
        }
        lines.at_most(&columns.gaps, MAX_INTERFACES, &format!("a lens has at most {MAX_INTERFACES} gaps"))?;
        Ok(columns)
    }

    fn line(&self, keyword: &str) -> Option<&Line<'t>> {
        self.single.iter().find(|line| line[0].is(keyword))
    }

    /// Reads the lines for a lens with these rows. Returns the positions of the lens, if it has any, and the facts that
    /// the file states. On entry, `focal_length` holds the value that stands alone on the first line, if there is one;
    /// it is then set to the stated focal length.
    pub(super) fn read(
        &self,
        lines: &Lines<'_>,
        rows: &[SurfaceRow],
        focal_length: &mut Option<f64>,
    ) -> Result<(Option<Positions>, Stated), LensFileError> {
        let mut stated = Stated::default();
        if let Some(line) = self.line("year") {
            let [_, year] = line.as_slice() else {
                return Err(lines.error(&line[2], "one year, such as 1975"));
            };
            let number = year.text.parse().ok().filter(|year| (1600..=2999).contains(year));
            stated.year =
                Some(number.ok_or_else(|| lines.error(year, &format!("\"{year}\" is not a year")))?);
        }
        let Some(names) = self.line("positions") else {
            for keyword in ["film", "stopdiameter", "object"] {
                if let Some(line) = self.line(keyword) {
                    return Err(no_positions(lines, line));
                }
            }
            if let Some(line) = self.gaps.first() {
                return Err(no_positions(lines, line));
            }
            if let Some(own) = self.values(lines, "focal", 1, focal_or_fnumber)? {
                if focal_length.is_some() {
                    let keyword = &self.line("focal").expect("read")[0];
                    return Err(lines
                        .error(keyword, "the focal length stands on a line of its own, too; give it once"));
                }
                *focal_length = own[0];
            }
            stated.fnumber = self.values(lines, "fnumber", 1, focal_or_fnumber)?.and_then(|values| values[0]);
            stated.fields = self.values(lines, "field", 1, field)?.unwrap_or_default();
            return Ok((None, stated));
        };
        let columns = self.positions(lines, names)?;
        let mut positions = Positions { gaps: Vec::new(), columns };
        let count = positions.columns.len();
        self.gaps(lines, rows, &mut positions)?;
        for (i, value) in
            self.values(lines, "focal", count, focal_or_fnumber)?.into_iter().flatten().enumerate()
        {
            positions.columns[i].focal_length = value;
        }
        for (i, value) in
            self.values(lines, "fnumber", count, focal_or_fnumber)?.into_iter().flatten().enumerate()
        {
            positions.columns[i].fnumber = value;
        }
        for (i, value) in self.values(lines, "object", count, object)?.into_iter().flatten().enumerate() {
            positions.columns[i].object_distance = value;
        }
        if let Some(diameters) = self.values(lines, "stopdiameter", count, stop_diameter)? {
            let line = self.line("stopdiameter").expect("read");
            let Some(stop) = stop(rows) else {
                return Err(lines.error(&line[0], "the table has no stop, a plane between air and air"));
            };
            self.same(lines, &line[1], stop, "clear diameter", rows[stop].diameter, diameters[0])?;
            for (column, diameter) in positions.columns.iter_mut().zip(diameters) {
                column.stop_diameter = diameter;
            }
        }
        stated.fields = self.values(lines, "field", count, field)?.unwrap_or_default();
        if focal_length.is_none() {
            *focal_length = positions.columns[0].focal_length;
        }
        Ok((Some(positions), stated))
    }

    /// Reads the names of the positions, and returns the named positions.
    fn positions(&self, lines: &Lines<'_>, line: &[Cell<'_>]) -> Result<Vec<Position>, LensFileError> {
        let names = &line[1..];
        if let Some(beyond) = names.get(MAX_POSITIONS) {
            let message = format!("{} positions; a lens has at most {MAX_POSITIONS}", names.len());
            return Err(lines.error(beyond, &message));
        }
        let mut positions: Vec<Position> = Vec::new();
        for word in names {
            let name = (word.text != "-").then(|| word.text.to_owned());
            if word.text.len() > MAX_NAME_BYTES {
                let message = format!("\"{word}\": a name has at most {MAX_NAME_BYTES} bytes");
                return Err(lines.error(word, &message));
            }
            if name.is_some() && positions.iter().any(|known| known.name == name) {
                return Err(
                    lines.error(word, &format!("two positions are called \"{word}\"; - is one without name"))
                );
            }
            positions.push(Position { name, ..Position::default() });
        }
        Ok(positions)
    }

    /// Reads the gaps into the positions. The line `film` states the gap behind the last row.
    fn gaps(
        &self,
        lines: &Lines<'_>,
        rows: &[SurfaceRow],
        positions: &mut Positions,
    ) -> Result<(), LensFileError> {
        let mut gaps: Vec<(usize, &Line<'t>, &[Cell<'t>])> = Vec::new();
        for line in &self.gaps {
            gaps.push((lines.row_number(&line[1], rows.len(), GAP)?, line, &line[2..]));
        }
        gaps.extend(self.line("film").map(|line| (rows.len() - 1, line, &line[1..])));
        gaps.sort_by_key(|(row, line, _)| (*row, line[0].location.line));
        if let Some(twice) = gaps.windows(2).find(|two| two[0].0 == two[1].0) {
            let message =
                format!("the gap behind row {} is given twice (film is the last row's)", twice[0].0 + 1);
            return Err(lines.error(&twice[1].1[0], &message));
        }
        for (row, line, words) in gaps {
            let values = values_of(lines, line, words, positions.columns.len(), gap)?;
            self.same(lines, &words[0], row, "thickness", rows[row].thickness, values[0])?;
            positions.gaps.push(row);
            for (column, gap) in positions.columns.iter_mut().zip(values) {
                column.gaps.push(gap.expect("a gap is never left out"));
            }
        }
        Ok(())
    }

    /// Checks that the table has the same value as the first position.
    fn same(
        &self,
        lines: &Lines<'_>,
        word: &Cell<'_>,
        row: usize,
        what: &str,
        in_table: f64,
        first: Option<f64>,
    ) -> Result<(), LensFileError> {
        if first.is_none_or(|first| first == in_table) {
            return Ok(());
        }
        let row = row + 1;
        let message = format!(
            "\"{word}\" at the first position, and row {row} of the table has {what} {in_table}; write the first \
             position's there, too"
        );
        Err(lines.error(word, &message))
    }

    /// Reads the values of a line, one for each position, if the file has such a line.
    fn values(
        &self,
        lines: &Lines<'_>,
        keyword: &str,
        count: usize,
        read: ReadValue,
    ) -> Result<Option<Vec<Option<f64>>>, LensFileError> {
        self.line(keyword).map(|line| values_of(lines, line, &line[1..], count, read)).transpose()
    }
}

/// Returns the row of the stop, counted from 0.
fn stop(rows: &[SurfaceRow]) -> Option<usize> {
    let stated = rows.iter().position(|row| row.role == Role::Stop);
    let is_air = |row: usize| rows[row].behind.medium == Medium::Air;
    let in_air = || {
        (0..rows.len()).find(|&row| {
            rows[row].radius.is_infinite()
                && rows[row].role != Role::FlareStop
                && is_air(row)
                && (row == 0 || is_air(row - 1))
        })
    };
    stated.or_else(in_air)
}

type ReadValue = fn(&Lines<'_>, &Cell<'_>) -> Result<Option<f64>, LensFileError>;

fn values_of(
    lines: &Lines<'_>,
    line: &[Cell<'_>],
    words: &[Cell<'_>],
    count: usize,
    read: ReadValue,
) -> Result<Vec<Option<f64>>, LensFileError> {
    if words.len() != count {
        let word = line.get(line.len() - words.len() + count).unwrap_or(&line[0]);
        let keyword = &line[0];
        let expected =
            if count == 1 { "one value".to_owned() } else { format!("{count} values, one per position") };
        return Err(
            lines.error(word, &format!("{} value(s) of \"{keyword}\"; expected {expected}", words.len()))
        );
    }
    words.iter().map(|word| read(lines, word)).collect()
}

fn no_positions(lines: &Lines<'_>, line: &[Cell<'_>]) -> LensFileError {
    let keyword = &line[0];
    let message = format!(
        "\"{keyword}\" is a value per position, and no line names the positions, as in: positions wide tele"
    );
    lines.error(keyword, &message)
}

/// Reads a positive number, or `-` for a value that the file does not state.
fn positive(lines: &Lines<'_>, word: &Cell<'_>, what: &str) -> Result<Option<f64>, LensFileError> {
    if word.text == "-" {
        return Ok(None);
    }
    let number = lines.number(word, &format!("{what}, or - where it is not stated"))?;
    if number > 0.0 { Ok(Some(number)) } else { Err(lines.error(word, &format!("{what} is positive"))) }
}

fn focal_or_fnumber(lines: &Lines<'_>, word: &Cell<'_>) -> Result<Option<f64>, LensFileError> {
    positive(lines, word, "a focal length in mm or an f-number")
}

fn stop_diameter(lines: &Lines<'_>, word: &Cell<'_>) -> Result<Option<f64>, LensFileError> {
    positive(lines, word, "a clear diameter of the stop in mm")
}

fn field(lines: &Lines<'_>, word: &Cell<'_>) -> Result<Option<f64>, LensFileError> {
    let degrees = positive(lines, word, "a full field of view in degrees")?;
    if degrees.is_some_and(|degrees| degrees > 360.0) {
        return Err(lines.error(word, "a full field of view has at most 360 degrees"));
    }
    Ok(degrees)
}

/// Reads the distance in mm from the object to the first vertex, or `inf`.
fn object(lines: &Lines<'_>, word: &Cell<'_>) -> Result<Option<f64>, LensFileError> {
    if word.is("inf") || word.is("infinity") {
        return Ok(None);
    }
    positive(lines, word, "a distance from the object to the first vertex in mm (inf for a distant object)")
}

fn gap(lines: &Lines<'_>, word: &Cell<'_>) -> Result<Option<f64>, LensFileError> {
    lines.number(word, "a thickness in mm").map(Some)
}

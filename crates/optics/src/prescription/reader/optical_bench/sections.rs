//! The sections of the text: lines of cells under headings in brackets. `[variable distances]` has a line for each
//! variable, and a column for each position of the lens as it zooms or focuses. Thicknesses refer to variables by name.
//! Some variables have a fixed meaning: `Focal Length`, `F-Number`, `Angle of View`, `Aperture Diameter`, and the
//! object distance, which is `d0` if counted from the first vertex and `S` if counted from the film.

use crate::prescription::{
    Fate, LensFileError, MAX_INTERFACES, MAX_POSITIONS,
    interfaces::Stated,
    positions::{Position, Positions},
    reader::{
        ledger::Ledger,
        surface_rows::SurfaceRow,
        text::{Cell, Location, Text, cells},
    },
};
use realistic_base::message::nearest;

/// The reason recorded for a section that does not describe the lens itself.
const UNREAD: &str = "stands in a section that is not read";
/// Names of the variables with a fixed meaning.
const NAMES: [&str; 6] = ["Focal Length", "F-Number", "Angle of View", "Aperture Diameter", "d0", "S"];
/// The reason recorded for any other variable.
const UNNAMED: &str = "a variable that no thickness names and that is not known";

/// A line of a section.
#[derive(Clone, Debug)]
pub(super) struct BenchRow<'t> {
    pub location: Location,
    cells: Vec<Cell<'t>>,
}

impl<'t> BenchRow<'t> {
    /// Returns the cell of a given number, counted from 0. Beyond the last cell, the result is an empty cell at the end
    /// of the line.
    pub(super) fn cell(&self, cell: usize) -> Cell<'t> {
        let last = self.cells.last().expect("a line has cells");
        let end = Location { column: last.location.column + last.text.len(), ..last.location };
        self.cells.get(cell).copied().unwrap_or(Cell { text: "", location: end })
    }

    /// Returns whether the line has only one cell, without separators.
    pub(super) fn is_one_cell(&self) -> bool {
        self.cells.len() == 1
    }

    /// Returns the cells from the second cell to the last cell that is not empty.
    pub(super) fn values(&self) -> &[Cell<'t>] {
        let end = self.cells.iter().rposition(|cell| !cell.text.is_empty()).map_or(1, |last| last + 1);
        &self.cells[1..end.max(1)]
    }
}

/// The sections that describe the lens. Other sections are for human readers and for drawing programs.
#[derive(Debug)]
pub(super) struct Sections<'t> {
    pub title: Option<String>,
    pub constants: Vec<BenchRow<'t>>,
    pub variables: Vec<BenchRow<'t>>,
    pub lens: Vec<BenchRow<'t>>,
    pub aspheres: Vec<BenchRow<'t>>,
    /// The last line of the text.
    pub end: Location,
}

impl<'t> Sections<'t> {
    /// Splits a text into sections. Headings such as `[!aspherical data]` or `[aspherical data(p)]` begin other
    /// sections, which are left out.
    pub(super) fn of(text: &'t Text<'_>, ledger: &mut Ledger<'_>) -> Result<Self, LensFileError> {
        let mut all = Self {
            title: None,
            constants: Vec::new(),
            variables: Vec::new(),
            lens: Vec::new(),
            aspheres: Vec::new(),
            end: Location { line: 1, column: 1 },
        };
        let mut headings: Vec<String> = Vec::new();
        for (number, line) in text.lines() {
            let location = Location { line: number, column: 1 };
            all.end = location;
            let trimmed = line.trim();
            if trimmed.is_empty() || trimmed.starts_with('#') {
                continue;
            }
            if let Some(heading) = trimmed.strip_prefix('[') {
                let heading = heading.split(']').next().unwrap_or("").trim().to_ascii_lowercase();
                let is_read = ["constants", "variable distances", "lens data", "aspherical data"];
                if is_read.contains(&heading.as_str()) && headings.contains(&heading) {
                    return Err(text.error(location, format!("a second section [{heading}]; a lens has one")));
                }
                match heading.as_str() {
                    "descriptive data" => ledger.note(Fate::Informative, location, "heading", None, ""),
                    own if is_read.contains(&own) => ledger.note(Fate::Used, location, "heading", None, ""),
                    _ => ledger.unknown(location, trimmed, None, UNREAD),
                }
                headings.push(heading);
                continue;
            }
            let row = BenchRow { location, cells: cells(number, line, |c| c == '\t') };
            let rows = match headings.last().map(String::as_str) {
                Some("constants") => &mut all.constants,
                Some("variable distances") => &mut all.variables,
                Some("lens data") => &mut all.lens,
                Some("aspherical data") => &mut all.aspheres,
                Some("descriptive data") => {
                    let is_title = |key: &str| row.cell(0).is(key);
                    if is_title("title") || is_title("lens name") && all.title.is_none() {
                        let title: String =
                            row.cell(1).text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
                        all.title = Some(title).filter(|title| !title.is_empty());
                    }
                    ledger.note(Fate::Informative, location, "description", None, "");
                    continue;
                }
                _ => {
                    ledger.unknown(location, "line", None, UNREAD);
                    continue;
                }
            };
            if rows.len() == MAX_INTERFACES {
                let message = format!(
                    "more than {MAX_INTERFACES} lines in this section; a lens has at most {MAX_INTERFACES} interfaces"
                );
                return Err(text.error(location, message));
            }
            rows.push(row);
        }
        let beyond = all.variables.iter().find_map(|row| row.values().get(MAX_POSITIONS));
        match beyond {
            Some(beyond) => Err(text.error(beyond.location, format!("more than {MAX_POSITIONS} positions"))),
            None => Ok(all),
        }
    }

    fn variable(&self, name: &str) -> Option<&BenchRow<'t>> {
        let exact = self.variables.iter().find(|row| row.cell(0).text == name);
        exact.or_else(|| self.variables.iter().find(|row| row.cell(0).is(name)))
    }

    /// Returns the value that a variable states at a position, if the value is positive.
    fn stated(&self, name: &str, column: usize) -> Option<f64> {
        let row = self.variable(name)?;
        row.cell(column + 1).number().filter(|number| *number > 0.0)
    }

    /// Sets each surface's thickness at the first position from the surface's cell, and the stop's diameter at that
    /// position. Returns the facts that the variables state about the lens: its positions, its focal length and other
    /// facts.
    pub(super) fn resolve(
        &self,
        text: &Text<'_>,
        rows: &mut [SurfaceRow],
        cells: &[Cell<'_>],
        stop: Option<usize>,
        ledger: &mut Ledger<'_>,
    ) -> Result<(Option<Positions>, Option<f64>, Stated), LensFileError> {
        let mut gaps: Vec<(usize, &[Cell<'_>])> = Vec::new();
        for (surface, cell) in cells.iter().enumerate() {
            if let Some(thickness) = cell.number() {
                rows[surface].thickness = thickness;
            } else if cell.text.is_empty() && surface + 1 == cells.len() {
                // The film distance is not stated.
            } else if let Some(row) = self.variable(cell.text).filter(|_| !cell.text.is_empty()) {
                gaps.push((surface, row.values()));
            } else {
                return Err(self.unknown(text, cell));
            }
        }
        let complete = columns(text, &gaps, ledger)?;
        for row in &self.variables {
            let name = row.cell(0);
            let is_known =
                NAMES.iter().any(|known| name.is(known)) || cells.iter().any(|cell| cell.is(name.text));
            match is_known {
                true => ledger.note(Fate::Used, name.location, "variable", None, ""),
                false => ledger.unknown(name.location, name.text, None, UNNAMED),
            }
        }
        for (surface, values) in &gaps {
            let first = complete[0];
            let thickness = values[first].number().expect("a kept column has numbers");
            rows[*surface].thickness = thickness;
        }
        let track = |column: usize| -> f64 {
            let moves = |surface: usize| gaps.iter().find(|gap| gap.0 == surface);
            let thickness = |(surface, row): (usize, &SurfaceRow)| {
                moves(surface).and_then(|(_, values)| values[column].number()).unwrap_or(row.thickness)
            };
            rows.iter().enumerate().map(thickness).sum()
        };
        let object = |column: usize| {
            let from_film = || self.stated("S", column).map(|s| s - track(column)).filter(|d| *d > 0.0);
            self.stated("d0", column).or_else(from_film)
        };
        let stated =
            |name: &str| complete.iter().map(|&column| self.stated(name, column)).collect::<Vec<_>>();
        let stop_diameters = stop.map_or(Vec::new(), |_| stated("Aperture Diameter"));
        let [focal_lengths, fnumbers] = ["Focal Length", "F-Number"].map(stated);
        let fields = stated("Angle of View");
        let columns: Vec<Position> = complete
            .iter()
            .enumerate()
            .map(|(i, &column)| Position {
                name: None,
                gaps: gaps.iter().map(|(_, values)| values[column].number().expect("kept")).collect(),
                stop_diameter: stop_diameters.get(i).copied().flatten(),
                focal_length: focal_lengths[i],
                fnumber: fnumbers[i],
                object_distance: object(column),
            })
            .collect();
        if let (Some(stop), Some(diameter)) = (stop, columns[0].stop_diameter) {
            rows[stop].diameter = diameter;
        }
        let is_moving = columns.len() > 1 || columns[0].object_distance.is_some();
        let stated = Stated {
            year: None,
            fnumber: fnumbers[0].filter(|_| !is_moving),
            fields: if fields.iter().all(Option::is_none) { Vec::new() } else { fields },
        };
        let gaps = gaps.iter().map(|(surface, _)| *surface).collect();
        Ok((is_moving.then_some(Positions { gaps, columns }), focal_lengths[0], stated))
    }

    fn unknown(&self, text: &Text<'_>, cell: &Cell<'_>) -> LensFileError {
        let names = self.variables.iter().map(|row| row.cell(0).text);
        let hint = nearest(cell.text, names).map_or_else(String::new, |name| format!("; \"{name}\"?"));
        let message = if cell.is_infinite() {
            "a thickness without end; a lens's surfaces stand at finite distances".to_owned()
        } else {
            format!("\"{cell}\" is neither a thickness in mm nor a line of [variable distances]{hint}")
        };
        text.error(cell.location, message)
    }
}

/// Returns the columns in which every gap has a number. Warnings about the other columns go to `ledger`.
fn columns(
    text: &Text<'_>,
    gaps: &[(usize, &[Cell<'_>])],
    ledger: &mut Ledger<'_>,
) -> Result<Vec<usize>, LensFileError> {
    let Some((_, longest)) = gaps.iter().max_by_key(|(_, values)| values.len()) else {
        return Ok(vec![0]);
    };
    let is_stated = |column: usize| {
        gaps.iter().all(|(_, values)| values.get(column).is_some_and(|value| value.number().is_some()))
    };
    let (complete, dropped): (Vec<usize>, Vec<usize>) =
        (0..longest.len()).partition(|&column| is_stated(column));
    if complete.is_empty() {
        let (_, values) =
            gaps.iter().find(|(_, values)| !values.iter().any(|v| v.number().is_some())).unwrap_or(&gaps[0]);
        let location =
            values.first().map_or(longest.first().map(|cell| cell.location), |cell| Some(cell.location));
        let location = location.unwrap_or(Location { line: 1, column: 1 });
        return Err(
            text.error(location, "at no position do all the variable distances that are used have numbers")
        );
    }
    for column in dropped {
        let message = format!("position {} is left out: not all of its distances are numbers", column + 1);
        ledger.warn(Fate::LeftOut, longest[column].location, "variable", None, message);
    }
    Ok(complete)
}

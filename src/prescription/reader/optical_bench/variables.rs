//! `[variable distances]`: a line per variable and a column per position of the lens, zoomed or focused. Thicknesses
//! name the variables; some are known by their names: `Focal Length`, `F-Number`, `Angle of View`, `Aperture Diameter`,
//! and the object's distance, `d0` from the first vertex or `S` from the film.

use super::sections::Row;
use crate::{
    message::{cut, nearest},
    prescription::{
        error::LensFileError,
        limits::MAX_POSITIONS,
        positions::{Position, Positions},
        reader::{
            surfaces::SurfaceRow,
            text::{Cell, Place, Text},
        },
        stated::Stated,
    },
};

/// The variables by name.
#[derive(Debug)]
pub(super) struct Variables<'a, 't> {
    rows: &'a [Row<'t>],
}

/// What the variables say of a lens.
#[derive(Debug)]
pub(super) struct Moving {
    pub positions: Option<Positions>,
    pub focal_length: Option<f64>,
    pub stated: Stated,
    pub remarks: Vec<String>,
}

impl<'a, 't> Variables<'a, 't> {
    pub(super) fn of(text: &Text<'_>, rows: &'a [Row<'t>]) -> Result<Self, LensFileError> {
        for row in rows {
            if let Some(beyond) = row.values().get(MAX_POSITIONS) {
                let message = format!("more than {MAX_POSITIONS} positions");
                return Err(text.error(beyond.place, message));
            }
        }
        Ok(Self { rows })
    }

    fn find(&self, name: &str) -> Option<&'a Row<'t>> {
        let exact = self.rows.iter().find(|row| row.cell(0).text == name);
        exact.or_else(|| self.rows.iter().find(|row| row.cell(0).text.eq_ignore_ascii_case(name)))
    }

    /// A stated value at a position, positive.
    fn stated(&self, name: &str, column: usize) -> Option<f64> {
        let row = self.find(name)?;
        row.cell(column + 1).number().filter(|number| *number > 0.0)
    }

    /// Gives each surface its thickness at the first position, from its cell, and the stop its diameter there.
    pub(super) fn resolve(
        &self,
        text: &Text<'_>,
        rows: &mut [SurfaceRow],
        cells: &[Cell<'_>],
        stop: Option<usize>,
    ) -> Result<Moving, LensFileError> {
        let mut gaps: Vec<(usize, &[Cell<'_>])> = Vec::new();
        for (surface, cell) in cells.iter().enumerate() {
            if let Some(thickness) = cell.number() {
                rows[surface].thickness = thickness;
            } else if cell.text.is_empty() && surface + 1 == cells.len() {
                // Nothing is said of the film's place.
            } else if let Some(row) = self.find(cell.text).filter(|_| !cell.text.is_empty()) {
                gaps.push((surface, row.values()));
            } else {
                return Err(self.unknown(text, cell));
            }
        }
        let (kept, remarks) = columns(text, &gaps)?;
        for (surface, values) in &gaps {
            let first = kept[0];
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
        let stated = |name: &str| kept.iter().map(|&column| self.stated(name, column)).collect::<Vec<_>>();
        let stop_diameters = stop.map_or(Vec::new(), |_| stated("Aperture Diameter"));
        let [focal_lengths, fnumbers] = ["Focal Length", "F-Number"].map(stated);
        let fields = stated("Angle of View");
        let columns: Vec<Position> = kept
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
        Ok(Moving {
            focal_length: focal_lengths[0],
            stated: Stated {
                year: None,
                fnumber: fnumbers[0].filter(|_| !is_moving),
                fields: if fields.iter().all(Option::is_none) { Vec::new() } else { fields },
            },
            positions: is_moving
                .then(|| Positions { gaps: gaps.iter().map(|(surface, _)| *surface).collect(), columns }),
            remarks,
        })
    }

    fn unknown(&self, text: &Text<'_>, cell: &Cell<'_>) -> LensFileError {
        let names = self.rows.iter().map(|row| row.cell(0).text);
        let hint = nearest(cell.text, names).map_or_else(String::new, |name| format!("; \"{name}\"?"));
        let message = if cell.is_infinite() {
            "a thickness without end; a lens's surfaces stand at finite distances".to_owned()
        } else {
            format!(
                "\"{}\" is neither a thickness in mm nor a line of [variable distances]{hint}",
                cut(cell.text)
            )
        };
        text.error(cell.place, message)
    }
}

/// The columns at which every gap has a number, and what is told of the others.
fn columns(
    text: &Text<'_>,
    gaps: &[(usize, &[Cell<'_>])],
) -> Result<(Vec<usize>, Vec<String>), LensFileError> {
    let Some((_, longest)) = gaps.iter().max_by_key(|(_, values)| values.len()) else {
        return Ok((vec![0], Vec::new()));
    };
    let is_stated = |column: usize| {
        gaps.iter().all(|(_, values)| values.get(column).is_some_and(|value| value.number().is_some()))
    };
    let (kept, dropped): (Vec<usize>, Vec<usize>) = (0..longest.len()).partition(|&column| is_stated(column));
    if kept.is_empty() {
        let (_, values) =
            gaps.iter().find(|(_, values)| !values.iter().any(|v| v.number().is_some())).unwrap_or(&gaps[0]);
        let place = values.first().map_or(longest.first().map(|cell| cell.place), |cell| Some(cell.place));
        let place = place.unwrap_or(Place { line: 1, column: 1 });
        return Err(
            text.error(place, "at no position do all the variable distances that are used have numbers")
        );
    }
    let told = dropped.iter().map(|&column| {
        let message = format!("position {} is left out: not all of its distances are numbers", column + 1);
        text.error(longest[column].place, message).to_string()
    });
    Ok((kept, told.collect()))
}

//! The text's sections: lines of cells under headings in brackets.

use crate::prescription::{
    error::LensFileError,
    limits::MAX_INTERFACES,
    reader::text::{Cell, Place, Text, cells},
};

/// A line of a section.
#[derive(Clone, Debug)]
pub(super) struct Row<'t> {
    pub place: Place,
    cells: Vec<Cell<'t>>,
}

impl<'t> Row<'t> {
    /// A cell, counted from 0; an empty one at the line's end where there are not so many.
    pub(super) fn cell(&self, cell: usize) -> Cell<'t> {
        let last = self.cells.last().expect("a line has cells");
        let end = Place { column: last.place.column + last.text.len(), ..last.place };
        self.cells.get(cell).copied().unwrap_or(Cell { text: "", place: end })
    }

    /// Whether nothing separates its cells.
    pub(super) fn is_one_cell(&self) -> bool {
        self.cells.len() == 1
    }

    /// The cells from the second to the last that is not empty.
    pub(super) fn values(&self) -> &[Cell<'t>] {
        let end = self.cells.iter().rposition(|cell| !cell.text.is_empty()).map_or(1, |last| last + 1);
        &self.cells[1..end.max(1)]
    }
}

/// The sections that say what the lens is; others are for people and programs that draw.
#[derive(Debug)]
pub(super) struct Sections<'t> {
    pub title: Option<String>,
    pub constants: Vec<Row<'t>>,
    pub variables: Vec<Row<'t>>,
    pub lens: Vec<Row<'t>>,
    pub aspheres: Vec<Row<'t>>,
    /// The text's last line.
    pub end: Place,
}

impl<'t> Sections<'t> {
    /// Of a text. A heading such as `[!aspherical data]` or `[aspherical data(p)]` is that of another section, which is
    /// left out.
    pub(super) fn of(text: &'t Text<'_>) -> Result<Self, LensFileError> {
        let mut all = Self {
            title: None,
            constants: Vec::new(),
            variables: Vec::new(),
            lens: Vec::new(),
            aspheres: Vec::new(),
            end: Place { line: 1, column: 1 },
        };
        let mut headings: Vec<String> = Vec::new();
        for (number, line) in text.lines() {
            let place = Place { line: number, column: 1 };
            all.end = place;
            let trimmed = line.trim();
            if trimmed.is_empty() || trimmed.starts_with('#') {
                continue;
            }
            if let Some(heading) = trimmed.strip_prefix('[') {
                let heading = heading.split(']').next().unwrap_or("").trim().to_ascii_lowercase();
                let is_read = ["constants", "variable distances", "lens data", "aspherical data"];
                if is_read.contains(&heading.as_str()) && headings.contains(&heading) {
                    return Err(text.error(place, format!("a second section [{heading}]; a lens has one")));
                }
                headings.push(heading);
                continue;
            }
            let row = Row { place, cells: cells(number, line, |c| c == '\t') };
            let rows = match headings.last().map(String::as_str) {
                Some("constants") => &mut all.constants,
                Some("variable distances") => &mut all.variables,
                Some("lens data") => &mut all.lens,
                Some("aspherical data") => &mut all.aspheres,
                Some("descriptive data") => {
                    let is_title = |key: &str| row.cell(0).text.eq_ignore_ascii_case(key);
                    if is_title("title") || is_title("lens name") && all.title.is_none() {
                        let title: String =
                            row.cell(1).text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
                        all.title = Some(title).filter(|title| !title.is_empty());
                    }
                    continue;
                }
                _ => continue,
            };
            if rows.len() == MAX_INTERFACES {
                let message = format!(
                    "more than {MAX_INTERFACES} lines in this section; a lens has at most {MAX_INTERFACES} interfaces"
                );
                return Err(text.error(place, message));
            }
            rows.push(row);
        }
        Ok(all)
    }
}

//! The cross-sections of many lenses on one page, each in its own cell and at its own scale.

use super::shapes::{AXIS, Anchor, Page, SMALL, Stroke, fitted, wrapped};
use super::view::View;
use super::{FAINT, INK, glass};
use realistic_optics::lens::Lens;

/// A lens with the text under its name.
#[derive(Debug)]
pub struct Entry {
    /// The lens.
    pub lens: Lens,
    /// Distance from the last vertex to the film, mm.
    pub film_distance: f64,
    /// Description of the lens.
    pub text: String,
}

const COLUMNS: usize = 4;
const CELL: [f64; 2] = [300.0, 276.0];
const MARGIN: f64 = 14.0;
/// Largest number of lines of text under a name.
const LINES: usize = 3;
/// Height under the drawing for the name and these lines of text.
const FOOT: f64 = 28.0 + 18.0 * LINES as f64;
const GLASS: &str = "#d6e6f2";
const EDGE: Stroke = Stroke::new("#4a6b85", 1.0);

/// Draws the page; light comes from the left.
pub fn draw(entries: &[Entry]) -> Page {
    let rows = entries.len().div_ceil(COLUMNS);
    let mut page = Page::new(COLUMNS as f64 * CELL[0], rows as f64 * CELL[1]);
    for (i, entry) in entries.iter().enumerate() {
        let corner = [(i % COLUMNS) as f64 * CELL[0], (i / COLUMNS) as f64 * CELL[1]];
        cell(&mut page, corner, entry);
    }
    page
}

/// Draws one lens, in a cell of its own.
pub fn draw_one(entry: &Entry) -> Page {
    let mut page = Page::new(CELL[0], CELL[1]);
    cell(&mut page, [0.0; 2], entry);
    page
}

fn cell(page: &mut Page, [left, top]: [f64; 2], entry: &Entry) {
    let lens = &entry.lens;
    let film = lens.rear().vertex - entry.film_distance;
    let ends = lens.surfaces.iter().flat_map(|s| s.sagitta_range().map(|sagitta| s.vertex + sagitta));
    let (rear, front) = ends.fold((film, 0.0), |(rear, front): (f64, f64), z| (rear.min(z), front.max(z)));
    let radius = lens.surfaces.iter().map(|surface| surface.semi_diameter).fold(0.0, f64::max);
    let height = CELL[1] - FOOT - 2.0 * MARGIN;
    let width = CELL[0] - 2.0 * MARGIN;
    let view = View::fit(
        [left + MARGIN, top + MARGIN],
        width,
        [height, height],
        [-front, -rear],
        [-1.05 * radius, 1.05 * radius],
    );
    let on_page = |points: &[[f64; 2]]| points.iter().map(|&[z, y]| view.at([-z, y])).collect::<Vec<_>>();
    page.line(on_page(&[[front, 0.0], [rear, 0.0]]), AXIS);
    for element in glass::elements(lens) {
        page.area(on_page(&element), GLASS, EDGE);
    }
    for surface in lens.surfaces.iter().filter(|surface| surface.is_stop) {
        for side in [-1.0, 1.0] {
            let bar = [surface.semi_diameter, 0.15_f64.mul_add(radius, surface.semi_diameter)];
            page.line(on_page(&bar.map(|y| [surface.vertex, side * y])), Stroke::new(INK, 3.0));
        }
    }
    page.line(on_page(&[[film, -0.5 * radius], [film, 0.5 * radius]]), Stroke::new(INK, 2.0));
    let under = top + CELL[1] - FOOT;
    let name = (fitted(&lens.name, SMALL, width), INK);
    let texts = wrapped(&entry.text, SMALL, width, LINES).into_iter().map(|line| (line, FAINT));
    for (line, (text, colour)) in std::iter::once(name).chain(texts).enumerate() {
        let point = [left + MARGIN, under + 16.0 + 18.0 * line as f64];
        page.text(&text, point, SMALL, Anchor::Start, colour);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::catalogue;

    #[test]
    fn every_lens_has_its_cell() {
        let entry = |name| Entry {
            lens: Lens::at_d_line(&catalogue::find(name).unwrap()),
            film_distance: 20.0,
            text: format!("what {name} is"),
        };
        let entries: Vec<Entry> = catalogue::names().map(entry).collect();
        let svg = draw(&entries).to_string();
        for name in catalogue::names() {
            assert!(svg.contains(&format!(">{name}<")), "{name}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        // Titles are not cut.
        for lens in catalogue::names().filter_map(catalogue::find) {
            let lines = wrapped(&lens.title.expect("a title"), SMALL, CELL[0] - 2.0 * MARGIN, LINES);
            assert!(lines.iter().all(|line| !line.ends_with("...")), "{lines:?}");
        }
        let rows = entries.len().div_ceil(COLUMNS);
        assert!(svg.contains(&format!("height=\"{}\"", rows as f64 * CELL[1])), "{:.200}", svg);
    }
}

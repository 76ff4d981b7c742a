//! A lens whose groups move, drawn at several positions, one below the other, at the same scale and with the films
//! aligned. Lines between the drawings show the movements of the groups.

use super::rays::Rays;
use super::section::{self, MARGIN, WIDTH};
use super::shapes::{Anchor, LEADER, Page, SMALL, Stroke};
use super::view::{Frame, View};
use super::{FAINT, INK};
use realistic_optics::lens::Lens;

/// A position.
#[derive(Clone, Debug)]
pub struct PositionPanel {
    /// The lens at this position.
    pub lens: Lens,
    /// Name of the position.
    pub name: String,
    /// Distance from the last vertex to the film, mm.
    pub film_distance: f64,
}

/// Data of the drawing besides the lens.
#[derive(Clone, Copy, Debug)]
pub struct PositionsOptions<'a> {
    /// The lens file's title.
    pub title: Option<&'a str>,
    /// Indices of the surfaces before the gaps that change.
    pub gaps: &'a [usize],
    /// Diagonal of the film, mm.
    pub film_diagonal: f64,
    /// Rays per bundle.
    pub rays: u32,
}

/// Height of title and subtitle.
const HEAD: f64 = 84.0;
/// Height above each position, for its name and for the lines from the position above.
const BETWEEN: f64 = 46.0;
const FOOT: f64 = 80.0;
/// Least and greatest height of a drawing of one position.
const HEIGHTS: [f64; 2] = [100.0, 300.0];

/// Draws the positions, at least one.
pub fn draw(panels: &[PositionPanel], options: &PositionsOptions<'_>) -> Page {
    let half = options.film_diagonal / 2.0;
    let film = |panel: &PositionPanel| panel.lens.rear().vertex - panel.film_distance;
    // Distances are measured from the film, to the left.
    let reach = |panel: &PositionPanel| {
        let surfaces = panel.lens.surfaces.iter();
        let front =
            surfaces.flat_map(|s| [s.vertex, s.vertex + s.sagitta(s.semi_diameter)]).fold(0.0, f64::max);
        front - film(panel)
    };
    let length = panels.iter().map(reach).fold(0.0, f64::max);
    let up = panels.iter().flat_map(|panel| {
        let lens = &panel.lens;
        let bar =
            |index: usize| if lens.surfaces[index].is_stop { section::stop_bar(lens, index) } else { 0.0 };
        (0..lens.surfaces.len()).map(move |index| lens.surfaces[index].semi_diameter.max(bar(index)))
    });
    let up = 1.08 * up.fold(half, f64::max);
    let across = [-1.2 * length, 0.04 * length];
    let shared = View::fit([MARGIN, 0.0], WIDTH - 2.0 * MARGIN, HEIGHTS, across, [-up, up]);
    let step = BETWEEN + shared.frame.height;
    let mut page = Page::new(WIDTH, HEAD + panels.len() as f64 * step + FOOT);
    let first = &panels[0].lens;
    section::title(&mut page, first, &format!("{} positions", panels.len()), options.title);

    let views: Vec<View> = panels
        .iter()
        .enumerate()
        .map(|(row, panel)| View {
            frame: Frame { top: HEAD + row as f64 * step + BETWEEN, ..shared.frame },
            across: shared.across.map(|x| x - film(panel)),
            ..shared
        })
        .collect();
    let mut legend = Vec::new();
    for (panel, view) in panels.iter().zip(&views) {
        let text = format!("{}:  {}", panel.name, section::numbers(&panel.lens));
        page.text(&text, [MARGIN, view.frame.top - 8.0], SMALL, Anchor::Start, INK);
        section::draw_lens(&mut page, view, &panel.lens);
        let rays = Rays::new(&panel.lens, film(panel));
        legend = section::bundles(&mut page, view, &rays, half, options.rays);
        section::film_line(&mut page, view, &panel.lens, film(panel), half);
    }
    // A line starts at the first vertex of each group; behind the last gap is the film, not a group.
    let last = first.surfaces.len() - 1;
    let groups = std::iter::once(0).chain(options.gaps.iter().filter(|gap| **gap < last).map(|gap| gap + 1));
    for surface in groups {
        let axis = |panel: &PositionPanel, view: &View| view.at([-panel.lens.surfaces[surface].vertex, 0.0]);
        for (pair, view) in panels.windows(2).zip(views.windows(2)) {
            let ends = [0, 1].map(|i| axis(&pair[i], &view[i]));
            page.line(ends, LEADER.dashed("3 3"));
        }
    }
    let y = HEAD + panels.len() as f64 * step + FOOT - 22.0;
    let bar = shared.round_length(180.0);
    page.scale_bar([MARGIN, y], bar * shared.scale, bar);
    legend.push(("a group's way".to_owned(), Stroke::new(FAINT, 1.0).dashed("3 3")));
    page.legend([MARGIN + 260.0, y], legend);
    page
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::catalogue;

    #[test]
    fn positions_stand_above_each_other_with_their_films_in_line() {
        let lens = Lens::at_d_line(&catalogue::find("dgauss.50mm").unwrap());
        let panel = |name: &str, film_distance| PositionPanel {
            lens: lens.clone(),
            name: name.to_owned(),
            film_distance,
        };
        let panels = [panel("far", 36.0), panel("near", 46.0)];
        let options =
            PositionsOptions { title: Some("a title"), gaps: &[2, 9], film_diagonal: 35.0, rays: 5 };
        let text = draw(&panels, &options).to_string();
        assert!(text.contains("far:") && text.contains("near:") && text.contains("2 positions"));
        assert!(!text.contains("NaN") && !text.contains("inf"));
        // The films are the thickest lines.
        let films: Vec<&str> = text.lines().filter(|line| line.contains("stroke-width=\"3\"")).collect();
        let x = |line: &str| line.split('"').nth(1).unwrap().split(',').next().unwrap().to_owned();
        assert_eq!(films.len(), 2);
        assert_eq!(x(films[0]), x(films[1]));
    }
}

//! The cross-section of a lens: light comes from the left, the film is at the right.

use super::ghost::{self, Pair};
use super::labels::spread;
use super::marks::{self, AxialMark, MarkForm};
use super::rays::{Rays, TracedRay};
use super::shapes::{AXIS, Anchor, LARGE, LEADER, Page, SMALL, Stroke, fitted, text_width};
use super::view::View;
use super::{COLORS, FAINT, INK, glass};
use realistic_base::message::fixed;
use realistic_optics::imaging::axial_beam::AxialBeam;
use realistic_optics::lens::{Lens, first_order::FirstOrder};

/// Data of the drawing besides the lens.
#[derive(Clone, Copy, Debug)]
pub struct SectionOptions<'a> {
    /// The lens file's title.
    pub title: Option<&'a str>,
    /// Distance from the last vertex to the film, mm.
    pub film_distance: f64,
    /// Diagonal of the film, mm.
    pub film_diagonal: f64,
    /// Rays per bundle.
    pub rays: u32,
    /// Two surfaces whose ghost is drawn, in place of the rays of the image.
    pub ghost: Option<Pair>,
}

/// Width of the page.
pub(super) const WIDTH: f64 = 1200.0;
/// Margin of the page, on every side.
pub(super) const MARGIN: f64 = 40.0;
/// Height of the title and the row of names above the drawing.
const HEAD: f64 = 122.0;
/// Height of the two rows of names below the drawing, and of the scale and legend below them.
const FOOT: f64 = 130.0;
const GLASS: &str = "#d6e6f2";
const EDGE: Stroke = Stroke::new("#4a6b85", 1.2);
const BLOCKED: f64 = 0.35;
/// Largest width of a pupil drawn to scale, as a multiple of the width of lens and film; the size of a wider pupil is
/// written as text.
const PUPIL_MOST: f64 = 2.0;

/// Draws the lens.
pub fn draw(lens: &Lens, options: &SectionOptions<'_>) -> Page {
    let film = lens.rear().vertex - options.film_distance;
    // Points and planes of the film's side lie in image space, which is lens space for a round lens.
    let marks = if lens.is_round() { marks::all(lens) } else { Vec::new() };
    let view = window(lens, film, options.film_diagonal, &marks);
    let mut page = Page::new(WIDTH, HEAD + view.frame.height + FOOT);
    title(&mut page, lens, &numbers(lens), options.title);

    draw_lens(&mut page, &view, lens);
    let half = options.film_diagonal / 2.0;
    let legend = match options.ghost {
        None => bundles(&mut page, &view, &Rays::new(lens, film), half, options.rays),
        Some(pair) => {
            let traced = ghost::rays(lens, film, pair, options.rays);
            lines(&mut page, &view, traced, COLORS[2]);
            let [near, far] = pair.map(|surface| surface + 1);
            let name = format!("reflected at surface {far}, and then {near}, light along the axis");
            vec![(name, Stroke::new(COLORS[2], 2.0))]
        }
    };
    film_line(&mut page, &view, lens, film, half);
    name_marks(&mut page, &view, lens, film, half, &marks);
    footer(&mut page, &view, legend);
    page
}

/// Draws the axis, glass, interfaces and stop.
pub(super) fn draw_lens(page: &mut Page, view: &View, lens: &Lens) {
    let on_page = |points: &[[f64; 2]]| points.iter().map(|&[z, y]| view.at([-z, y])).collect::<Vec<_>>();
    page.line(on_page(&[[-view.across[0], 0.0], [-view.across[1], 0.0]]), AXIS);
    for element in glass::elements(lens) {
        page.area(on_page(&element), GLASS, EDGE);
    }
    for ((index, surface), arc) in lens.surfaces.iter().enumerate().zip(glass::arcs(lens)) {
        if surface.is_mirror {
            page.line(on_page(&arc), Stroke::new(INK, 2.5));
            continue;
        }
        // An interface beside no element would otherwise be invisible. The media of scene and film are not drawn.
        let ends_element = index > 0 && surface.n_scene != 1.0;
        let begins_element = index + 1 < lens.surfaces.len() && surface.n_film != 1.0;
        if !ends_element && !begins_element && !surface.is_stop {
            page.line(on_page(&arc), EDGE.dashed("4 3"));
        } else if surface.is_stop {
            for bar in glass::stop_bars(lens, index, stop_bar(lens, index)) {
                page.line(on_page(&bar), Stroke::new(INK, 4.0));
            }
        }
    }
}

/// Draws the film.
pub(super) fn film_line(page: &mut Page, view: &View, lens: &Lens, film: f64, half: f64) {
    let ends = glass::film_ends(lens, film, half);
    page.line(ends.map(|[z, y]| view.at([-z, y])), Stroke::new(INK, 3.0));
}

pub(super) fn stop_bar(lens: &Lens, index: usize) -> f64 {
    let neighbours = &lens.surfaces[index.saturating_sub(1)..(index + 2).min(lens.surfaces.len())];
    let widest = neighbours.iter().map(|surface| surface.semi_diameter).fold(0.0, f64::max);
    widest.max(1.3 * lens.surfaces[index].semi_diameter)
}

/// Returns the drawing's window, in which -z is the horizontal coordinate.
fn window(lens: &Lens, film: f64, diagonal: f64, marks: &[AxialMark]) -> View {
    if !lens.is_round() {
        return around(lens, film, diagonal);
    }
    let ends = |edge: fn(f64, f64) -> f64, start: f64| {
        lens.surfaces
            .iter()
            .flat_map(|s| s.sagitta_range().map(|sagitta| s.vertex + sagitta))
            .fold(start, edge)
    };
    let (rear, front) = (ends(f64::min, film), ends(f64::max, 0.0));
    // A margin shows where the rays go.
    let length = front - rear;
    let [rear, front] = marks::range([rear - 0.03 * length, front + 0.25 * length], marks);
    let spare = 0.02 * (front - rear);
    let radii =
        lens.surfaces.iter().enumerate().map(|(index, surface)| {
            if surface.is_stop { stop_bar(lens, index) } else { surface.semi_diameter }
        });
    let radius = radii.fold(diagonal / 2.0, f64::max);
    let pupils = marks.iter().filter_map(|mark| match mark.form {
        MarkForm::Pupil(pupil) if pupil < PUPIL_MOST * radius => Some(pupil),
        _ => None,
    });
    let up = 1.12 * pupils.fold(radius, f64::max);
    let across = [-front - spare, -rear + spare];
    View::fit([MARGIN, HEAD], WIDTH - 2.0 * MARGIN, [160.0, 620.0], across, [-up, up])
}

/// Returns a window around all surfaces and the film.
fn around(lens: &Lens, film: f64, diagonal: f64) -> View {
    let mut points = glass::arcs(lens).concat();
    points.extend(glass::film_ends(lens, film, diagonal / 2.0));
    let range = |i: usize| {
        let low = points.iter().map(|point| point[i]).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|point| point[i]).fold(f64::NEG_INFINITY, f64::max);
        let margin = 0.08 * (high - low);
        [low - margin, high + margin]
    };
    let ([rear, front], [low, high]) = (range(0), range(1));
    let across = [-front - 0.15 * (front - rear), -rear];
    View::fit([MARGIN, HEAD], WIDTH - 2.0 * MARGIN, [160.0, 620.0], across, [low, high])
}

/// Formats focal length and f-number.
pub(super) fn numbers(lens: &Lens) -> String {
    FirstOrder::of(lens).map_or_else(
        |_| "afocal".to_owned(),
        |optics| {
            let number = AxialBeam::of(lens).fnumber(optics.focal_length);
            let number =
                if number.is_finite() { format!("f/{}", fixed(number, 2)) } else { "no f-number".to_owned() };
            format!("f = {} mm, {number}", fixed(optics.focal_length, 2))
        },
    )
}

/// Writes the lens's name and `facts`, and below them the title in the lens file.
pub(super) fn title(page: &mut Page, lens: &Lens, facts: &str, subtitle: Option<&str>) {
    // A path is cut to the file's name.
    let name = lens.name.rsplit('/').next().unwrap_or(&lens.name);
    let room = WIDTH - 2.0 * MARGIN;
    let name = fitted(name, LARGE, room - text_width(facts, LARGE) - 40.0);
    page.text(&format!("{name}:  {facts}"), [MARGIN, 38.0], LARGE, Anchor::Start, INK);
    if let Some(subtitle) = subtitle {
        page.text(&fitted(subtitle, SMALL, room), [MARGIN, 60.0], SMALL, Anchor::Start, FAINT);
    }
}

/// Draws three bundles: on the axis, at the film's corner (or at the edge of the light) and between these two;
/// returns names and strokes for the legend.
pub(super) fn bundles(
    page: &mut Page,
    view: &View,
    rays: &Rays,
    half: f64,
    count: u32,
) -> Vec<(String, Stroke)> {
    let Some(lit) = rays.lit_radius(half) else {
        return vec![("no light reaches the film's centre".to_owned(), Stroke::new(FAINT, 2.0))];
    };
    // A point just inside the edge of the light still has a beam to draw.
    let (outer, name) =
        if lit < half { (0.97 * lit, " mm (the corner is dark)") } else { (half, " mm, the corner") };
    let mut legend = Vec::new();
    for (height, color, name) in [
        (0.0, COLORS[0], "on the axis".to_owned()),
        (0.7 * outer, COLORS[1], format!("film at {} mm", fixed(0.7 * outer, 1))),
        (outer, COLORS[2], format!("film at {}{name}", fixed(outer, 1))),
    ] {
        lines(page, view, rays.bundle(height, count), color);
        legend.push((name, Stroke::new(color, 2.0)));
    }
    legend
}

/// Draws rays of one colour.
fn lines(page: &mut Page, view: &View, mut traced: Vec<TracedRay>, color: &'static str) {
    // Blocked rays are drawn first, so that they lie under the others.
    traced.sort_by_key(|ray| ray.onward.is_some());
    for ray in &traced {
        let opacity = if ray.onward.is_some() { 1.0 } else { BLOCKED };
        page.line(on_page(view, ray), Stroke::new(color, 1.1).faded(opacity));
    }
}

fn on_page(view: &View, ray: &TracedRay) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = ray.points.iter().map(|&[z, y]| [-z, y]).collect();
    if let (Some([dz, dy]), Some(&last)) = (ray.onward, points.last()) {
        let out = view.distance_to_edge(last, [-dz, dy]);
        points.push([last[0] - out * dz, last[1] + out * dy]);
    }
    points.into_iter().map(|point| view.at(point)).collect()
}

/// A name, its preferred position, and the point that it labels, if that point is on the page.
struct Label {
    text: String,
    anchor: f64,
    leader: Option<[f64; 2]>,
}

/// Writes the names of pupils, stop and film above the drawing, of points and planes below it, and of
/// marks outside it in a row of their own.
fn name_marks(page: &mut Page, view: &View, lens: &Lens, film: f64, half: f64, marks: &[AxialMark]) {
    let [_, film_top] = glass::film_ends(lens, film, half).map(|[z, y]| view.at([-z, y]));
    let mut over = vec![Label { text: "film".to_owned(), anchor: film_top[0], leader: Some(film_top) }];
    if let Some(stop) = lens.stop_index() {
        let [_, [_, [z, y]]] = glass::stop_bars(lens, stop, stop_bar(lens, stop));
        let top = view.at([-z, y]);
        over.push(Label { text: "stop".to_owned(), anchor: top[0], leader: Some(top) });
    }
    let (mut under, mut outside) = (Vec::new(), Vec::new());
    for mark in marks {
        let AxialMark { name, z, form } = *mark;
        if -z < view.across[0] {
            let text = format!("< {name}: {} mm before the lens", fixed(z, 1));
            outside.push(Label { text, anchor: MARGIN, leader: None });
        } else if -z > view.across[1] {
            let text = format!("{name}: {} mm behind the film >", fixed(film - z, 1));
            outside.push(Label { text, anchor: WIDTH - MARGIN, leader: None });
        } else {
            let row = if matches!(form, MarkForm::Pupil(_)) { &mut over } else { &mut under };
            row.push(draw_mark(page, view, mark));
        }
    }
    let [top, bottom] = [view.frame.top, view.frame.top + view.frame.height];
    name_row(page, over, top - 20.0, top - 12.0);
    name_row(page, under, bottom + 26.0, bottom + 10.0);
    name_row(page, outside, bottom + 50.0, bottom + 50.0);
}

/// Draws a mark and returns its label.
fn draw_mark(page: &mut Page, view: &View, mark: &AxialMark) -> Label {
    let axis = view.at([-mark.z, 0.0]);
    let [top, bottom] = [view.frame.top, view.frame.top + view.frame.height];
    let mut text = mark.name.to_owned();
    let end = match mark.form {
        MarkForm::Point => {
            page.line([axis, [axis[0], bottom]], LEADER.dashed("2 3"));
            page.circle(axis, 4.0, INK, Stroke::new("none", 0.0));
            bottom
        }
        MarkForm::Plane => {
            page.line([[axis[0], top], [axis[0], bottom]], Stroke::new(INK, 0.9).dashed("7 4"));
            bottom
        }
        MarkForm::Pupil(radius) => {
            let [lower, upper] = [-1.0, 1.0].map(|side| view.at([-mark.z, side * radius])[1]);
            if upper > top {
                // Two brackets start at the pupil's edge and point away from it.
                let length = (0.08 * view.frame.height).min(upper - top);
                for (y, away) in [(upper, -length), (lower, length)] {
                    page.line([[axis[0], y], [axis[0], y + away]], Stroke::new(INK, 2.0).dashed("5 2"));
                    page.line([[axis[0] - 5.0, y], [axis[0] + 5.0, y]], Stroke::new(INK, 2.0));
                }
                page.line([[axis[0], upper], [axis[0], top]], LEADER.dashed("2 3"));
            } else {
                text = format!("{text}, {} mm wide", fixed(2.0 * radius, 1));
            }
            top
        }
    };
    Label { text, anchor: axis[0], leader: Some([axis[0], end]) }
}

/// Writes names in a row at `y`, with leaders from the height `near` to the points that they label.
fn name_row(page: &mut Page, mut row: Vec<Label>, y: f64, near: f64) {
    row.sort_by(|a, b| a.anchor.total_cmp(&b.anchor));
    let anchors: Vec<f64> = row.iter().map(|label| label.anchor).collect();
    let widths: Vec<f64> = row.iter().map(|label| text_width(&label.text, SMALL)).collect();
    let centers = spread(&anchors, &widths, [MARGIN / 2.0, WIDTH - MARGIN / 2.0]);
    for (label, center) in row.iter().zip(centers) {
        page.text(&label.text, [center, y], SMALL, Anchor::Middle, INK);
        if let Some(end) = label.leader {
            page.line([[center, near], end], LEADER);
        }
    }
}

fn footer(page: &mut Page, view: &View, mut legend: Vec<(String, Stroke)>) {
    let y = view.frame.top + view.frame.height + FOOT - 22.0;
    let length = view.round_length(180.0);
    page.scale_bar([MARGIN, y], length * view.scale, length);
    legend.push(("lighter: blocked".to_owned(), Stroke::new(INK, 2.0).faded(BLOCKED)));
    page.legend([MARGIN + 260.0, y], legend);
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_optics::prescription::{catalogue, read};

    fn drawn(table: &str) -> String {
        let lens = Lens::at_d_line(&read("t", table.as_bytes()).unwrap());
        let options = SectionOptions {
            title: Some("a <b> & c"),
            film_distance: 20.0,
            film_diagonal: 10.0,
            rays: 5,
            ghost: None,
        };
        draw(&lens, &options).to_string()
    }

    #[test]
    fn every_lens_is_drawn_with_its_marks_and_three_bundles() {
        for name in catalogue::round() {
            let lens = Lens::at_d_line(&catalogue::find(name).unwrap());
            let optics = FirstOrder::of(&lens).unwrap();
            let film_diagonal = if optics.focal_length < 5.0 { 5.0 } else { 35.0 };
            let options = SectionOptions {
                title: None,
                film_distance: optics.back_focal_distance(),
                film_diagonal,
                rays: 7,
                ghost: None,
            };
            let text = draw(&lens, &options).to_string();
            for part in
                ["entrance pupil", "exit pupil", "stop", "film", "lighter: blocked", COLORS[0], COLORS[2]]
            {
                assert!(text.contains(part), "{name} lacks {part}");
            }
            assert!(!text.contains("NaN") && !text.contains("inf"), "{name}");
        }
    }

    #[test]
    fn lenses_of_one_interface_or_without_power_are_drawn() {
        for table in ["0 0 0 4\n", "20 0 1 10\n", "0 3 1.5 10\n0 0 1 10\n", "-10 1 1.5 8\n10 0 1 8\n"] {
            let text = drawn(table);
            assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
            assert!(text.contains("a &lt;b&gt; &amp; c"));
        }
        assert!(drawn("20 0 1 10\n").contains("afocal"));
    }
}

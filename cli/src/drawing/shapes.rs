//! The page of a drawing: lines, areas and texts in pixels in, an SVG 1.1 file's text out.

use std::fmt::{Display, Write as _};

use super::{FAINT, INK};

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// Colour.
    pub color: &'static str,
    /// Pixels.
    pub width: f64,
    /// 0 to 1.
    pub opacity: f64,
    /// Lengths of dashes and gaps in pixels; "none" for a whole line.
    pub dashes: &'static str,
}

impl Stroke {
    /// A whole line.
    pub const fn new(color: &'static str, width: f64) -> Self {
        Self { color, width, opacity: 1.0, dashes: "none" }
    }

    /// The same, dashed.
    pub const fn dashed(self, dashes: &'static str) -> Self {
        Self { dashes, ..self }
    }

    /// The same, so much of it that it covers what is under it by this share.
    pub const fn faded(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// A line from a text to what it names.
pub const LEADER: Stroke = Stroke::new(FAINT, 0.8);
/// The optical axis.
pub const AXIS: Stroke = LEADER.dashed("12 3 2 3");

/// Where a text's given point is, in SVG's words.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    /// At its start.
    Start,
    /// In its middle.
    Middle,
}

/// A page under the pen.
#[derive(Clone, Debug)]
pub struct Page {
    svg: String,
}

/// Points as SVG has them: a hundredth of a pixel is all that shows.
fn points(points: impl IntoIterator<Item = [f64; 2]>) -> String {
    let rounded = points.into_iter().map(|point| point.map(|x| (x * 100.0).round() / 100.0));
    rounded.map(|[x, y]| format!("{x},{y}")).collect::<Vec<_>>().join(" ")
}

impl Page {
    /// A white page of this size in pixels.
    pub fn new(width: f64, height: f64) -> Self {
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
        );
        Self { svg }
    }

    /// The page as it is, as an SVG file's text.
    pub fn finish(self) -> String {
        self.svg + "</svg>\n"
    }

    /// An element drawn with a stroke; `own` are its further attributes.
    fn shape(&mut self, element: &str, fill: &str, stroke: Stroke, own: impl Display) {
        let Stroke { color, width, opacity, dashes } = stroke;
        // Infallible, as below: a string takes whatever is written to it.
        let _ = writeln!(
            self.svg,
            "<{element} {own} fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"{width}\" \
             stroke-opacity=\"{opacity}\" stroke-dasharray=\"{dashes}\" stroke-linejoin=\"round\"/>"
        );
    }

    /// A line through points.
    pub fn line(&mut self, through: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        self.shape("polyline", "none", stroke, format_args!("points=\"{}\"", points(through)));
    }

    /// A filled area with an edge.
    pub fn area(&mut self, corners: impl IntoIterator<Item = [f64; 2]>, fill: &str, stroke: Stroke) {
        self.shape("polygon", fill, stroke, format_args!("points=\"{}\"", points(corners)));
    }

    /// A circle's line, filled or with `fill` none.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, fill: &str, stroke: Stroke) {
        self.shape("circle", fill, stroke, format_args!("cx=\"{x}\" cy=\"{y}\" r=\"{radius}\""));
    }

    /// A text on its base line.
    pub fn text(&mut self, text: &str, [x, y]: [f64; 2], size: f64, anchor: Anchor, fill: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let anchor = if matches!(anchor, Anchor::Start) { "start" } else { "middle" };
        let _ = writeln!(
            self.svg,
            "<text x=\"{x}\" y=\"{y}\" font-family=\"Ubuntu, sans-serif\" font-weight=\"300\" \
             font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{fill}\">{text}</text>"
        );
    }

    /// The title, as much of it as fits into `room` pixels.
    pub fn title(&mut self, title: &str, left: f64, room: f64) {
        self.text(&fitted(title, LARGE, room), [left, 38.0], LARGE, Anchor::Start, INK);
    }

    /// A bar of `pixels` that stands for `mm`, its left end at `left`, with its length above it.
    pub fn scale_bar(&mut self, [left, y]: [f64; 2], pixels: f64, mm: f64) {
        let tick = |x: f64| [[x, y - 4.0], [x, y + 4.0]];
        for line in [tick(left), [[left, y], [left + pixels, y]], tick(left + pixels)] {
            self.line(line, Stroke::new(INK, 1.5));
        }
        self.text(&format!("{mm} mm"), [left, y - 9.0], SMALL, Anchor::Start, INK);
    }

    /// Lines with their names, from `left` to the right.
    pub fn legend(&mut self, [mut left, y]: [f64; 2], entries: impl IntoIterator<Item = (String, Stroke)>) {
        for (name, stroke) in entries {
            self.line([[left, y - 5.0], [left + 26.0, y - 5.0]], stroke);
            self.text(&name, [left + 34.0, y], SMALL, Anchor::Start, INK);
            left += 34.0 + text_width(&name, SMALL) + 18.0;
        }
    }
}

/// Font size of labels.
pub const SMALL: f64 = 14.0;
/// Font size of the title.
pub const LARGE: f64 = 20.0;

/// Room that a text needs, pixels: an upper bound for the usual sans-serif fonts.
pub fn text_width(text: &str, size: f64) -> f64 {
    0.58 * size * text.chars().count() as f64
}

/// The text without control characters, and no longer than fits in `width` pixels.
pub fn fitted(text: &str, size: f64, width: f64) -> String {
    let most = (width / text_width("x", size)) as usize;
    let clean: Vec<char> = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if clean.len() <= most {
        return clean.into_iter().collect();
    }
    clean[..most.saturating_sub(3)].iter().collect::<String>() + "..."
}

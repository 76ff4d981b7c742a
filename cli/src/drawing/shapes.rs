//! Lines, areas and texts of the page.

use svg::Document;
use svg::node::element::{Circle, Path, Polyline, Rectangle, Text, path::Data};

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// Colour.
    pub color: &'static str,
    /// Pixels.
    pub width: f64,
    /// 0 to 1.
    pub opacity: f64,
    /// Lengths of dashes and gaps in pixels; empty for a whole line.
    pub dashes: &'static str,
}

impl Stroke {
    /// A whole line.
    pub const fn new(color: &'static str, width: f64) -> Self {
        Self { color, width, opacity: 1.0, dashes: "" }
    }

    /// The same, dashed.
    pub const fn dashed(self, dashes: &'static str) -> Self {
        Self { dashes, ..self }
    }
}

/// Where a text's given point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At its start.
    Start,
    /// In its middle.
    Middle,
}

/// A page under the pen.
#[derive(Clone, Debug)]
pub struct Page {
    document: Document,
}

/// A hundredth of a pixel is all that shows.
fn rounded(points: impl IntoIterator<Item = [f64; 2]>) -> impl Iterator<Item = [f64; 2]> {
    points.into_iter().map(|point| point.map(|x| (x * 100.0).round() / 100.0))
}

impl Page {
    /// A white page of this size in pixels.
    pub fn new(width: f64, height: f64) -> Self {
        let document = Document::new()
            .set("viewBox", (0, 0, width, height))
            .set("width", width)
            .set("height", height)
            .add(Rectangle::new().set("width", width).set("height", height).set("fill", "white"));
        Self { document }
    }

    /// The page as it is.
    pub fn finish(self) -> Document {
        self.document
    }

    fn add(&mut self, node: impl Into<Box<dyn svg::Node>>) {
        svg::Node::append(&mut self.document, node);
    }

    /// A line through points.
    pub fn line(&mut self, points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        let points: Vec<String> = rounded(points).map(|[x, y]| format!("{x},{y}")).collect();
        let mut line = Polyline::new()
            .set("points", points.join(" "))
            .set("fill", "none")
            .set("stroke", stroke.color)
            .set("stroke-width", stroke.width)
            .set("stroke-linejoin", "round");
        if stroke.opacity < 1.0 {
            line = line.set("stroke-opacity", stroke.opacity);
        }
        if !stroke.dashes.is_empty() {
            line = line.set("stroke-dasharray", stroke.dashes);
        }
        self.add(line);
    }

    /// A filled area with an edge.
    pub fn area(&mut self, points: impl IntoIterator<Item = [f64; 2]>, fill: &str, stroke: Stroke) {
        let mut data = Data::new();
        for (number, [x, y]) in rounded(points).enumerate() {
            data = if number == 0 { data.move_to((x, y)) } else { data.line_to((x, y)) };
        }
        self.add(
            Path::new()
                .set("d", data.close())
                .set("fill", fill)
                .set("stroke", stroke.color)
                .set("stroke-width", stroke.width)
                .set("stroke-linejoin", "round"),
        );
    }

    /// A dot.
    pub fn dot(&mut self, [x, y]: [f64; 2], radius: f64, fill: &str) {
        self.add(Circle::new().set("cx", x).set("cy", y).set("r", radius).set("fill", fill));
    }

    /// A circle's line.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, stroke: Stroke) {
        self.add(
            Circle::new()
                .set("cx", x)
                .set("cy", y)
                .set("r", radius)
                .set("fill", "none")
                .set("stroke", stroke.color)
                .set("stroke-width", stroke.width)
                .set("stroke-dasharray", if stroke.dashes.is_empty() { "none" } else { stroke.dashes }),
        );
    }

    /// A text on its base line.
    pub fn text(&mut self, text: &str, [x, y]: [f64; 2], size: f64, anchor: Anchor, fill: &str) {
        self.add(
            Text::new(text)
                .set("x", x)
                .set("y", y)
                .set("font-family", "Ubuntu, sans-serif")
                .set("font-weight", 300)
                .set("font-size", size)
                .set("text-anchor", if anchor == Anchor::Start { "start" } else { "middle" })
                .set("fill", fill),
        );
    }

    /// A bar of `pixels` that stands for `mm`, its left end at `left`, with its length above it.
    pub fn scale_bar(&mut self, [left, y]: [f64; 2], pixels: f64, mm: f64) {
        let stroke = Stroke::new(super::INK, 1.5);
        let tick = 4.0;
        self.line([[left, y - tick], [left, y + tick]], stroke);
        self.line([[left, y], [left + pixels, y]], stroke);
        self.line([[left + pixels, y - tick], [left + pixels, y + tick]], stroke);
        self.text(&format!("{mm} mm"), [left, y - 9.0], SMALL, Anchor::Start, super::INK);
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

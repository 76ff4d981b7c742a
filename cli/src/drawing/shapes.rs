//! Lines, areas and texts of a page, as SVG and as pixels.

use crate::image::SrgbImage;
use crate::image::lettering::outline;
use std::fmt;
use svg::Node;
use svg::node::element::{Element, Rectangle, Text};
use tiny_skia::{Color, FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};

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

/// What is drawn, in order.
#[derive(Clone, Debug)]
enum Shape {
    /// A line through points; closed, where it is filled.
    Line {
        points: Vec<[f64; 2]>,
        fill: Option<String>,
        stroke: Stroke,
    },
    Disk {
        center: [f64; 2],
        radius: f64,
        fill: Option<String>,
        stroke: Option<Stroke>,
    },
    Text {
        text: String,
        start: [f64; 2],
        size: f64,
        anchor: Anchor,
        fill: String,
    },
}

/// A finished drawing; [`Display`](fmt::Display) writes it as SVG.
#[derive(Clone, Debug)]
pub struct Document {
    size: [f64; 2],
    ground: String,
    shapes: Vec<Shape>,
}

/// A page under the pen. Colours are `#rrggbb`.
#[derive(Clone, Debug)]
pub struct Page {
    document: Document,
}

/// A hundredth of a pixel is all that shows.
fn rounded(points: impl IntoIterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    points.into_iter().map(|point| point.map(|x| (x * 100.0).round() / 100.0)).collect()
}

impl Page {
    /// A white page of this size in pixels.
    pub fn new(width: f64, height: f64) -> Self {
        Self::on("#ffffff", width, height)
    }

    /// A page of a colour.
    pub fn on(ground: impl Into<String>, width: f64, height: f64) -> Self {
        Self { document: Document { size: [width, height], ground: ground.into(), shapes: Vec::new() } }
    }

    /// The page as it is.
    pub fn finish(self) -> Document {
        self.document
    }

    /// A line through points.
    pub fn line(&mut self, points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        self.document.shapes.push(Shape::Line { points: rounded(points), fill: None, stroke });
    }

    /// A filled area with an edge.
    pub fn area(&mut self, points: impl IntoIterator<Item = [f64; 2]>, fill: &str, stroke: Stroke) {
        self.document.shapes.push(Shape::Line {
            points: rounded(points),
            fill: Some(fill.to_owned()),
            stroke,
        });
    }

    /// A dot.
    pub fn dot(&mut self, center: [f64; 2], radius: f64, fill: &str) {
        self.document.shapes.push(Shape::Disk { center, radius, fill: Some(fill.to_owned()), stroke: None });
    }

    /// A circle's line.
    pub fn circle(&mut self, center: [f64; 2], radius: f64, stroke: Stroke) {
        self.document.shapes.push(Shape::Disk { center, radius, fill: None, stroke: Some(stroke) });
    }

    /// A text on its base line.
    pub fn text(&mut self, text: &str, start: [f64; 2], size: f64, anchor: Anchor, fill: &str) {
        let (text, fill) = (text.to_owned(), fill.to_owned());
        self.document.shapes.push(Shape::Text { text, start, size, anchor, fill });
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

impl fmt::Display for Document {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size;
        let ground = Rectangle::new().set("width", width).set("height", height).set("fill", &*self.ground);
        let mut document = svg::Document::new()
            .set("viewBox", (0, 0, width, height))
            .set("width", width)
            .set("height", height)
            .add(ground);
        for shape in &self.shapes {
            document.append(shape.node());
        }
        document.fmt(out)
    }
}

impl Document {
    /// Its pixels at `zoom` pixels a unit; nothing for a page without an area.
    pub fn pixels(&self, zoom: f32) -> Option<SrgbImage> {
        let [width, height] = self.size.map(|side| (side as f32 * zoom).round() as u32);
        let mut pixmap = Pixmap::new(width, height)?;
        pixmap.fill(color(&self.ground));
        for shape in &self.shapes {
            shape.paint(&mut pixmap, Transform::from_scale(zoom, zoom));
        }
        let pixels = pixmap.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]);
        Some(SrgbImage { size: [width, height], pixels: pixels.collect() })
    }
}

impl Shape {
    /// As an element of SVG.
    fn node(&self) -> Element {
        let mut node = match self {
            Self::Line { points, .. } => {
                let points: Vec<String> = points.iter().map(|[x, y]| format!("{x},{y}")).collect();
                let name =
                    if matches!(self, Self::Line { fill: Some(_), .. }) { "polygon" } else { "polyline" };
                let mut node = Element::new(name);
                node.assign("points", points.join(" "));
                node.assign("stroke-linejoin", "round");
                node
            }
            Self::Disk { center: [x, y], radius, .. } => {
                let mut node = Element::new("circle");
                for (name, value) in [("cx", x), ("cy", y), ("r", radius)] {
                    node.assign(name, *value);
                }
                node
            }
            Self::Text { text, start: [x, y], size, anchor, fill } => {
                let text = Text::new(text)
                    .set("x", *x)
                    .set("y", *y)
                    .set("font-family", "DejaVu Sans Condensed, sans-serif")
                    .set("font-size", *size)
                    .set("text-anchor", if *anchor == Anchor::Start { "start" } else { "middle" })
                    .set("fill", &**fill);
                return text.into();
            }
        };
        let (fill, stroke) = self.colours();
        node.assign("fill", fill.unwrap_or("none"));
        if let Some(stroke) = stroke {
            node.assign("stroke", stroke.color);
            node.assign("stroke-width", stroke.width);
            if stroke.opacity < 1.0 {
                node.assign("stroke-opacity", stroke.opacity);
            }
            if !stroke.dashes.is_empty() {
                node.assign("stroke-dasharray", stroke.dashes);
            }
        }
        node
    }

    /// What it is filled with, and its line.
    fn colours(&self) -> (Option<&str>, Option<Stroke>) {
        match self {
            Self::Line { fill, stroke, .. } => (fill.as_deref(), Some(*stroke)),
            Self::Disk { fill, stroke, .. } => (fill.as_deref(), *stroke),
            Self::Text { fill, .. } => (Some(fill), None),
        }
    }

    fn path(&self) -> Option<Path> {
        match self {
            Self::Line { points, fill, .. } => {
                let mut path = PathBuilder::new();
                for (number, [x, y]) in points.iter().map(|point| point.map(|x| x as f32)).enumerate() {
                    if number == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
                }
                if fill.is_some() {
                    path.close();
                }
                path.finish()
            }
            Self::Disk { center: [x, y], radius, .. } => {
                PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32)
            }
            Self::Text { text, start: [x, y], size, anchor, .. } => {
                let (path, width) = outline(text, *size as f32);
                let left = if *anchor == Anchor::Start { 0.0 } else { width / 2.0 };
                path?.transform(Transform::from_translate(*x as f32 - left, *y as f32))
            }
        }
    }

    fn paint(&self, pixmap: &mut Pixmap, zoom: Transform) {
        let Some(path) = self.path() else { return };
        let (fill, stroke) = self.colours();
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        if let Some(fill) = fill {
            paint.set_color(color(fill));
            pixmap.fill_path(&path, &paint, FillRule::Winding, zoom, None);
        }
        if let Some(stroke) = stroke {
            let mut own = color(stroke.color);
            own.set_alpha(stroke.opacity as f32);
            paint.set_color(own);
            let dashes: Vec<f32> =
                stroke.dashes.split(' ').filter_map(|length| length.parse().ok()).collect();
            let line = tiny_skia::Stroke {
                width: stroke.width as f32,
                line_join: LineJoin::Round,
                dash: StrokeDash::new(dashes, 0.0),
                ..tiny_skia::Stroke::default()
            };
            pixmap.stroke_path(&path, &paint, &line, zoom, None);
        }
    }
}

/// The colour of `#rrggbb`.
fn color(text: &str) -> Color {
    let bits = u32::from_str_radix(text.trim_start_matches('#'), 16).unwrap_or(0);
    let [_, red, green, blue] = bits.to_be_bytes();
    Color::from_rgba8(red, green, blue, 255)
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

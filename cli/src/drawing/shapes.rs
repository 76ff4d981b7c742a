//! The page of a drawing: lines, areas and texts in pixels, written as an SVG 1.1 file or rasterised.

use super::{FAINT, INK};
use crate::image::SrgbImage;
use crate::image::lettering::outline;
use std::fmt;
use tiny_skia::{Color, FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};

/// The stroke of a line.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// Colour.
    pub color: &'static str,
    /// Width, pixels.
    pub width: f64,
    /// Opacity, 0 to 1.
    pub opacity: f64,
    /// Lengths of dashes and gaps in pixels; "none" for a solid line.
    pub dashes: &'static str,
}

impl Stroke {
    /// Makes a solid line.
    pub const fn new(color: &'static str, width: f64) -> Self {
        Self { color, width, opacity: 1.0, dashes: "none" }
    }

    /// Returns the stroke with dashes.
    pub const fn dashed(self, dashes: &'static str) -> Self {
        Self { dashes, ..self }
    }

    /// Returns the stroke with this opacity.
    pub const fn faded(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// A line from a text to the point that it labels.
pub const LEADER: Stroke = Stroke::new(FAINT, 0.8);
/// The optical axis.
pub const AXIS: Stroke = LEADER.dashed("12 3 2 3");

/// The anchor of a text, as in SVG.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    /// The point is at the text's start.
    Start,
    /// The point is in the text's middle.
    Middle,
}

/// The geometry of a shape.
#[derive(Clone, Debug)]
enum Geometry {
    /// A line through points.
    Line(Vec<[f64; 2]>),
    /// An area with these corners.
    Area(Vec<[f64; 2]>),
    /// A circle with this centre and radius.
    Circle([f64; 2], f64),
    /// A text with its anchor point and its font size.
    Text(String, [f64; 2], f64, Anchor),
}

/// An outline with its colours.
#[derive(Clone, Debug)]
struct PageShape {
    geometry: Geometry,
    fill: Option<String>,
    stroke: Option<Stroke>,
}

/// A page that is being drawn; [`Display`](fmt::Display) writes it as an SVG file's text. Colours are `#rrggbb`.
#[derive(Clone, Debug)]
pub struct Page {
    size: [f64; 2],
    ground: String,
    shapes: Vec<PageShape>,
}

/// Rounds to a hundredth of a pixel; finer differences do not show.
fn rounded(points: impl IntoIterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    points.into_iter().map(|point| point.map(|x| (x * 100.0).round() / 100.0)).collect()
}

impl Page {
    /// Makes a white page of this size in pixels.
    pub fn new(width: f64, height: f64) -> Self {
        Self::on("#ffffff".to_owned(), width, height)
    }

    /// Makes a page with a background colour.
    pub fn on(ground: String, width: f64, height: f64) -> Self {
        Self { size: [width, height], ground, shapes: Vec::new() }
    }

    fn add(&mut self, geometry: Geometry, fill: &str, stroke: Option<Stroke>) {
        let fill = (fill != "none").then(|| fill.to_owned());
        self.shapes.push(PageShape { geometry, fill, stroke });
    }

    /// Draws a line through points.
    pub fn line(&mut self, through: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        self.add(Geometry::Line(rounded(through)), "none", Some(stroke));
    }

    /// Draws a filled area with an edge.
    pub fn area(&mut self, corners: impl IntoIterator<Item = [f64; 2]>, fill: &str, stroke: Stroke) {
        self.add(Geometry::Area(rounded(corners)), fill, Some(stroke));
    }

    /// Draws a filled disk without an edge.
    pub fn dot(&mut self, center: [f64; 2], radius: f64, fill: &str) {
        self.add(Geometry::Circle(center, radius), fill, None);
    }

    /// Draws a circle, filled unless `fill` is "none".
    pub fn circle(&mut self, center: [f64; 2], radius: f64, fill: &str, stroke: Stroke) {
        self.add(Geometry::Circle(center, radius), fill, Some(stroke));
    }

    /// Writes a text on its baseline.
    pub fn text(&mut self, text: &str, point: [f64; 2], size: f64, anchor: Anchor, fill: &str) {
        self.add(Geometry::Text(text.to_owned(), point, size, anchor), fill, None);
    }

    /// Rasterises the page at `zoom` pixels per unit; `None` for a page without an area.
    pub fn pixels(&self, zoom: f32) -> Option<SrgbImage> {
        let [width, height] = self.size.map(|side| (side as f32 * zoom).round() as u32);
        let mut pixmap = Pixmap::new(width, height)?;
        pixmap.fill(color(&self.ground, 1.0));
        for shape in &self.shapes {
            shape.paint(&mut pixmap, Transform::from_scale(zoom, zoom));
        }
        let pixels = pixmap.pixels().iter().map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]);
        Some(SrgbImage { size: [width, height], pixels: pixels.collect() })
    }

    /// Writes the title, cut to `room` pixels.
    pub fn title(&mut self, title: &str, left: f64, room: f64) {
        self.text(&fitted(title, LARGE, room), [left, 38.0], LARGE, Anchor::Start, INK);
    }

    /// Draws a scale bar of `pixels` that represents `mm`, with its left end at `left` and its length in words above
    /// it.
    pub fn scale_bar(&mut self, [left, y]: [f64; 2], pixels: f64, mm: f64) {
        let tick = |x: f64| [[x, y - 4.0], [x, y + 4.0]];
        for line in [tick(left), [[left, y], [left + pixels, y]], tick(left + pixels)] {
            self.line(line, Stroke::new(INK, 1.5));
        }
        self.text(&format!("{mm} mm"), [left, y - 9.0], SMALL, Anchor::Start, INK);
    }

    /// Draws lines with their names, from `left` to the right.
    pub fn legend(&mut self, [mut left, y]: [f64; 2], entries: impl IntoIterator<Item = (String, Stroke)>) {
        for (name, stroke) in entries {
            self.line([[left, y - 5.0], [left + 26.0, y - 5.0]], stroke);
            self.text(&name, [left + 34.0, y], SMALL, Anchor::Start, INK);
            left += 34.0 + text_width(&name, SMALL) + 18.0;
        }
    }
}

impl fmt::Display for Page {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ([width, height], ground) = (self.size, &self.ground);
        writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"{ground}\"/>"
        )?;
        self.shapes.iter().try_for_each(|shape| writeln!(out, "{shape}"))?;
        writeln!(out, "</svg>")
    }
}

/// Formats the shape as an element of SVG.
impl fmt::Display for PageShape {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let points = |points: &[[f64; 2]]| {
            points.iter().map(|[x, y]| format!("{x},{y}")).collect::<Vec<_>>().join(" ")
        };
        let fill = self.fill.as_deref().unwrap_or("none");
        match &self.geometry {
            Geometry::Line(through) => write!(out, "<polyline points=\"{}\"", points(through))?,
            Geometry::Area(corners) => write!(out, "<polygon points=\"{}\"", points(corners))?,
            Geometry::Circle([x, y], radius) => write!(out, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"")?,
            Geometry::Text(text, [x, y], size, anchor) => {
                let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
                let anchor = if matches!(anchor, Anchor::Start) { "start" } else { "middle" };
                return write!(
                    out,
                    "<text x=\"{x}\" y=\"{y}\" font-family=\"DejaVu Sans Condensed, sans-serif\" \
                     font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{fill}\">{text}</text>"
                );
            }
        }
        write!(out, " fill=\"{fill}\"")?;
        if let Some(Stroke { color, width, opacity, dashes }) = self.stroke {
            write!(out, " stroke=\"{color}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"")?;
            if opacity < 1.0 {
                write!(out, " stroke-opacity=\"{opacity}\"")?;
            }
            if dashes != "none" {
                write!(out, " stroke-dasharray=\"{dashes}\"")?;
            }
        }
        write!(out, "/>")
    }
}

impl PageShape {
    fn path(&self) -> Option<Path> {
        let mut path = PathBuilder::new();
        match &self.geometry {
            Geometry::Line(points) | Geometry::Area(points) => {
                for (number, [x, y]) in points.iter().map(|point| point.map(|x| x as f32)).enumerate() {
                    if number == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
                }
                if matches!(self.geometry, Geometry::Area(_)) {
                    path.close();
                }
            }
            Geometry::Circle([x, y], radius) => path.push_circle(*x as f32, *y as f32, *radius as f32),
            Geometry::Text(text, [x, y], size, anchor) => {
                let (letters, width) = outline(text, *size as f32);
                let left = if matches!(anchor, Anchor::Start) { 0.0 } else { width / 2.0 };
                return letters?.transform(Transform::from_translate(*x as f32 - left, *y as f32));
            }
        }
        path.finish()
    }

    fn paint(&self, pixmap: &mut Pixmap, zoom: Transform) {
        let Some(path) = self.path() else { return };
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        if let Some(fill) = &self.fill {
            paint.set_color(color(fill, 1.0));
            pixmap.fill_path(&path, &paint, FillRule::Winding, zoom, None);
        }
        if let Some(stroke) = self.stroke {
            paint.set_color(color(stroke.color, stroke.opacity));
            let dashes = stroke.dashes.split(' ').filter_map(|length| length.parse().ok()).collect();
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

/// Parses the colour `#rrggbb`.
fn color(text: &str, opacity: f64) -> Color {
    let bits = u32::from_str_radix(text.trim_start_matches('#'), 16).unwrap_or(0);
    let [_, red, green, blue] = bits.to_be_bytes();
    Color::from_rgba8(red, green, blue, (255.0 * opacity).round() as u8)
}

/// Font size of labels.
pub const SMALL: f64 = 14.0;
/// Font size of the title.
pub const LARGE: f64 = 20.0;

/// Returns an upper bound for the width of a text in the usual sans-serif fonts, pixels.
pub fn text_width(text: &str, size: f64) -> f64 {
    0.58 * size * text.chars().count() as f64
}

/// Breaks the text between words into at most `lines` lines (1 or more), each at most `width` pixels wide.
pub fn wrapped(text: &str, size: f64, width: f64, lines: usize) -> Vec<String> {
    let most = (width / text_width("x", size)) as usize;
    let mut broken: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let is_last = broken.len() == lines;
        match broken.last_mut() {
            Some(line) if is_last || line.chars().count() + 1 + word.chars().count() <= most => {
                line.push(' ');
                line.push_str(word);
            }
            _ => broken.push(word.to_owned()),
        }
    }
    broken.iter().map(|line| fitted(line, size, width)).collect()
}

/// Returns the text without control characters, cut to `width` pixels.
pub fn fitted(text: &str, size: f64, width: f64) -> String {
    let most = (width / text_width("x", size)) as usize;
    let clean: Vec<char> = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if clean.len() <= most {
        return clean.into_iter().collect();
    }
    clean[..most.saturating_sub(3)].iter().collect::<String>() + "..."
}

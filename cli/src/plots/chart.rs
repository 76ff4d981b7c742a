//! Log-log charts of error against cost, with names at the marks or at the ends of the lines.

use super::PALETTE;
use super::placement::{Area, beside};
use crate::drawing::axis::LogScale;
use crate::drawing::labels::spread;
use crate::drawing::shapes::{Anchor, Page, Stroke, text_width};
use crate::drawing::{FAINT, INK};
use std::f64::consts::TAU;

/// A point of a series.
#[derive(Clone, Debug, Default)]
pub struct Mark {
    /// Cost and error.
    pub at: [f64; 2],
    /// Smallest and largest error of the spread, which a thin line shows.
    pub reach: Option<[f64; 2]>,
    /// Name beside the mark.
    pub name: Option<String>,
    /// Whether the mark is on the Pareto front; such marks are filled.
    pub on_front: bool,
}

/// A group of marks.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name of the series; the name of a line is written at its end.
    pub name: String,
    /// Colour.
    pub color: &'static str,
    /// Index of the shape of the marks.
    pub symbol: usize,
    /// Dashes of the line that joins the marks, if any.
    pub line: Option<&'static str>,
    /// Marks in order of rising cost.
    pub marks: Vec<Mark>,
}

/// A chart.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    /// Title above the chart.
    pub title: String,
    /// Name and unit of the cost.
    pub cost: &'static str,
    /// Name and unit of the error.
    pub error: &'static str,
    /// Errors at which horizontal lines are drawn, with the names of these lines.
    pub levels: Vec<(f64, String)>,
    /// Series of marks and lines.
    pub series: Vec<Series>,
}

/// Width and height of a chart, pixels.
const PAGE: [f64; 2] = [680.0, 540.0];
/// Gap beside a name, pixels, so that two names never read as one.
const APART: f64 = 9.0;
const SIZE: f64 = 14.0;
const SMALL: f64 = 12.0;
const LINE: f64 = 17.0;
const LEFT: f64 = 70.0;
const TOP: f64 = 62.0;

impl Series {
    /// Makes the series with index `number` of a chart, of single marks.
    pub fn marks(name: &str, number: usize, marks: impl Iterator<Item = Mark>) -> Self {
        Self {
            name: name.to_owned(),
            color: PALETTE[number % PALETTE.len()],
            symbol: number,
            line: None,
            marks: marks.collect(),
        }
    }

    /// Makes a line with the colour of index `color` and the dashes of index `dash`.
    pub fn line(name: String, color: usize, dash: usize, points: impl Iterator<Item = [f64; 2]>) -> Self {
        // Solid or dashed strokes are the most visible difference.
        const DASHES: [&str; 3] = ["none", "6 4", "2 3"];
        Self {
            name,
            color: PALETTE[color % PALETTE.len()],
            symbol: dash,
            line: Some(DASHES[dash % DASHES.len()]),
            marks: points.map(|at| Mark { at, ..Mark::default() }).collect(),
        }
    }
}

impl Chart {
    /// Draws the chart on its own page.
    pub fn draw(&self) -> Page {
        let [width, height] = PAGE;
        let (lines, keys): (Vec<&Series>, Vec<&Series>) =
            self.series.iter().filter(|s| !s.marks.is_empty()).partition(|s| s.line.is_some());
        let beside_lines = lines.iter().map(|s| text_width(&s.name, SIZE)).fold(0.0, f64::max);
        let right = width - if lines.is_empty() { 20.0 } else { beside_lines + 34.0 };
        let key_rows = key_rows(&keys, right - LEFT);
        let bottom = height - 56.0 - LINE * key_rows.len() as f64;
        let marks = || self.series.iter().flat_map(|s| &s.marks);
        let x = LogScale::around(marks().map(|m| m.at[0]), [LEFT, right]);
        let errors = marks().flat_map(|m| [m.at[1]].into_iter().chain(m.reach.into_iter().flatten()));
        let y = LogScale::around(errors.chain(self.levels.iter().map(|(at, _)| *at)), [bottom, TOP]);
        let frame = Area { from: [LEFT, TOP], to: [right, bottom] };

        let mut page = Page::new(width, height);
        page.text(&self.title, [LEFT, 24.0], 17.0, Anchor::Start, INK);
        page.text(self.error, [12.0, TOP - 14.0], SIZE, Anchor::Start, INK);
        let middle = f64::midpoint(LEFT, right);
        page.text(self.cost, [middle, bottom + 42.0], SIZE, Anchor::Middle, INK);
        grid(&mut page, x, y);
        let mut obstacles = self.front(&mut page, x, y, right);
        for (at, name) in &self.levels {
            // The name is above its line, or below if all marks lie above.
            let lowest = marks().map(|m| m.at[1]).fold(f64::INFINITY, f64::min);
            let base = if *at < lowest { SMALL + 2.0 } else { -5.0 };
            let (at, width) = (y.position(*at), text_width(name, SMALL));
            page.line([[LEFT, at], [right, at]], Stroke::new(FAINT, 1.5).dashed("2 4"));
            page.text(name, [right - width, at + base], SMALL, Anchor::Start, FAINT);
            obstacles.push(Area { from: [right - width, at + base - SMALL], to: [right, at + base + 2.0] });
            obstacles.push(Area { from: [LEFT, at - 2.0], to: [right, at + 2.0] });
        }
        let position = |m: &Mark| [x.position(m.at[0]), y.position(m.at[1])];
        for series in &self.series {
            if let Some(dashes) = series.line {
                page.line(series.marks.iter().map(position), Stroke::new(series.color, 2.0).dashed(dashes));
            }
            for mark in &series.marks {
                if let Some([low, high]) = mark.reach {
                    let at = x.position(mark.at[0]);
                    page.line(
                        [[at, y.position(low)], [at, y.position(high)]],
                        Stroke::new(series.color, 1.2),
                    );
                }
                symbol(&mut page, series, position(mark), mark.on_front);
            }
        }
        self.names(&mut page, &position, y, frame, obstacles);
        line_ends(&mut page, &lines, &position, frame);
        for (row, keys) in key_rows.iter().enumerate() {
            let at = bottom + 42.0 + LINE * (row as f64 + 1.0) + 3.0;
            for (offset, series) in keys {
                let from = LEFT + offset;
                symbol(&mut page, series, [from + 6.0, at - 5.0], true);
                page.text(&series.name, [from + 16.0, at], SIZE, Anchor::Start, INK);
            }
        }
        page
    }

    /// Draws the Pareto front of its marks as a staircase, and returns the areas that it covers.
    fn front(&self, page: &mut Page, x: LogScale, y: LogScale, right: f64) -> Vec<Area> {
        let mut front: Vec<[f64; 2]> =
            self.series.iter().flat_map(|s| &s.marks).filter(|m| m.on_front).map(|m| m.at).collect();
        front.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut corners: Vec<[f64; 2]> = Vec::new();
        for at in front {
            let [px, py] = [x.position(at[0]), y.position(at[1])];
            if let Some(&[_, above]) = corners.last() {
                corners.push([px, above]);
            }
            corners.push([px, py]);
        }
        if let Some(&[_, last]) = corners.last() {
            corners.push([right, last]);
            page.line(corners.iter().copied(), Stroke::new(FAINT, 5.0).faded(0.55));
        }
        let segment = |pair: &[[f64; 2]]| Area {
            from: [0, 1].map(|i| pair[0][i].min(pair[1][i]) - 3.0),
            to: [0, 1].map(|i| pair[0][i].max(pair[1][i]) + 3.0),
        };
        corners.windows(2).map(segment).collect()
    }

    /// Writes the names of single marks.
    fn names(
        &self,
        page: &mut Page,
        position: &dyn Fn(&Mark) -> [f64; 2],
        y: LogScale,
        frame: Area,
        mut obstacles: Vec<Area>,
    ) {
        let all = self.series.iter().flat_map(|s| s.marks.iter().map(move |m| (s, m)));
        for (_, mark) in all.clone() {
            let [px, py] = position(mark);
            obstacles.push(Area::about([px, py], [14.0, 14.0]));
            if let Some(reach) = mark.reach {
                let [low, high] = reach.map(|error| y.position(error));
                obstacles.push(Area { from: [px - 2.0, high.min(low)], to: [px + 2.0, high.max(low)] });
            }
        }
        let named: Vec<_> = all.filter_map(|(s, m)| Some((s, position(m), m.name.as_deref()?))).collect();
        let marks: Vec<_> = named.iter().map(|(_, at, _)| *at).collect();
        let sizes: Vec<_> = named.iter().map(|(.., name)| [text_width(name, SIZE) + APART, LINE]).collect();
        for ((series, at, name), area) in named.iter().zip(beside(&marks, &sizes, frame, &obstacles)) {
            let nearest = area.nearest(*at);
            if (nearest[0] - at[0]).hypot(nearest[1] - at[1]) > 16.0 {
                page.line([*at, nearest], Stroke::new(series.color, 0.8).faded(0.6));
            }
            page.text(name, [area.center()[0], area.to[1] - 5.0], SIZE, Anchor::Middle, series.color);
        }
    }
}

/// Draws ticks, labels and faint lines.
fn grid(page: &mut Page, x: LogScale, y: LogScale) {
    let [left, right] = x.pixels;
    let [bottom, top] = y.pixels;
    let faint = |strong: bool| Stroke::new(FAINT, 1.0).faded(if strong { 0.35 } else { 0.12 });
    for tick in x.ticks(58.0) {
        let at = x.position(tick.value);
        page.line([[at, bottom], [at, top]], faint(tick.label.is_some()));
        if let Some(label) = tick.label {
            page.text(&label, [at, bottom + 19.0], SIZE, Anchor::Middle, INK);
        }
    }
    for tick in y.ticks(30.0) {
        let at = y.position(tick.value);
        page.line([[left, at], [right, at]], faint(tick.label.is_some()));
        if let Some(label) = tick.label {
            page.text(&label, [left - 30.0, at + 5.0], SIZE, Anchor::Middle, INK);
        }
    }
    page.line([[left, top], [left, bottom], [right, bottom]], Stroke::new(INK, 1.2));
}

/// Writes names at the ends of lines, in the margin.
fn line_ends(page: &mut Page, lines: &[&Series], position: &dyn Fn(&Mark) -> [f64; 2], frame: Area) {
    let mut ends: Vec<_> =
        lines.iter().filter_map(|series| Some((*series, position(series.marks.last()?)))).collect();
    ends.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]));
    let anchors: Vec<f64> = ends.iter().map(|(_, at)| at[1]).collect();
    // [`spread`] adds its own gap of 14 pixels.
    let heights = vec![LINE - 14.0; ends.len()];
    let positions = spread(&anchors, &heights, [frame.from[1], frame.to[1]]);
    for ((series, at), y) in ends.iter().zip(positions) {
        let text = frame.to[0] + 24.0;
        page.line([*at, [frame.to[0], at[1]], [text - 4.0, y]], Stroke::new(series.color, 0.8).faded(0.5));
        page.text(&series.name, [text, y + 5.0], SIZE, Anchor::Start, series.color);
    }
}

/// Returns the entries of the key in rows of at most `width` pixels, with the left edge of each entry.
fn key_rows<'a>(series: &[&'a Series], width: f64) -> Vec<Vec<(f64, &'a Series)>> {
    let mut rows: Vec<Vec<(f64, &Series)>> = Vec::new();
    let mut left = f64::INFINITY;
    for &entry in series {
        let own = text_width(&entry.name, SIZE) + 30.0;
        if left + own > width {
            rows.push(Vec::new());
            left = 0.0;
        }
        if let Some(row) = rows.last_mut() {
            row.push((left, entry));
        }
        left += own;
    }
    rows
}

/// Draws a mark, filled or hollow: a disk, a square, a triangle, a diamond, an inverted triangle, a
/// cross.
fn symbol(page: &mut Page, series: &Series, [x, y]: [f64; 2], filled: bool) {
    let polygon = |corners: u32, first: f64, radius: f64| -> Vec<[f64; 2]> {
        let angles = (0..corners).map(|i| (f64::from(i) / f64::from(corners) + first) * TAU);
        angles.map(|angle| [x + radius * angle.cos(), y + radius * angle.sin()]).collect()
    };
    let corners = match series.symbol % 6 {
        0 => polygon(16, 0.0, 5.0),
        1 => polygon(4, 0.125, 7.0),
        2 => polygon(3, 0.75, 6.5),
        3 => polygon(4, 0.0, 6.5),
        4 => polygon(3, 0.25, 6.5),
        _ => {
            // The inner corners lie between the ends of the arms.
            let (inner, outer) = (polygon(4, 0.125, 3.2), polygon(8, 0.053, 6.9));
            let ends = polygon(8, -0.053, 6.9);
            (0..4).flat_map(|arm| [ends[2 * arm], outer[2 * arm], inner[arm]]).collect()
        }
    };
    let fill = if filled { series.color } else { "#ffffff" };
    page.area(corners, fill, Stroke::new(series.color, 1.6));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the texts of a drawing with the upper left and lower right corners of their boxes.
    fn texts(svg: &str) -> Vec<(String, [f64; 2], [f64; 2])> {
        let number = |line: &str, key: &str| -> f64 {
            let rest = &line[line.find(key).unwrap() + key.len()..];
            rest[..rest.find('"').unwrap()].parse().unwrap()
        };
        let text = |line: &str| {
            let name = &line[line.find('>').unwrap() + 1..line.rfind("</text>").unwrap()];
            let (x, y) = (number(line, " x=\""), number(line, " y=\""));
            let width = text_width(name, number(line, "font-size=\""));
            let from = if line.contains("\"middle\"") { x - width / 2.0 } else { x };
            (name.to_owned(), [from, y - SMALL], [from + width, y + 2.0])
        };
        svg.lines().filter(|line| line.starts_with("<text")).map(text).collect()
    }

    fn crowded() -> Chart {
        let mark = |i: u32, name: String| Mark {
            at: [10.0 + 0.02 * f64::from(i), 1e-3 * (1.0 + 0.03 * f64::from(i * 7 % 5))],
            name: Some(name),
            ..Mark::default()
        };
        let marks = (0..7).map(|i| mark(i, format!("P{}", 2 * i + 3)));
        let lines = ["warped, Sobol' (-0.97)", "rear, random (-0.50)", "disk, stratified (-0.75)"];
        let line = |(number, name): (usize, &&str)| {
            let points = [[1.0, 0.1], [40.0, 0.1 / (number + 2) as f64]];
            Series::line((*name).to_owned(), number, number, points.into_iter())
        };
        let series = std::iter::once(Series::marks("polynomials", 0, marks));
        let series = series.chain(lines.iter().enumerate().map(line)).collect();
        Chart { title: "a lens".to_owned(), cost: "ns", error: "pixels", series, ..Chart::default() }
    }

    #[test]
    fn names_are_on_the_page_and_none_overlaps_another() {
        let texts = texts(&crowded().draw().to_string());
        for name in ["P3", "P15", "warped, Sobol' (-0.97)", "disk, stratified (-0.75)"] {
            assert_eq!(texts.iter().filter(|text| text.0 == name).count(), 1, "{name}");
        }
        for (number, (name, from, to)) in texts.iter().enumerate() {
            assert!(from[0] >= 0.0 && to[0] <= PAGE[0] + 1.0, "{name} at {from:?}");
            for (other, other_from, other_to) in &texts[..number] {
                let over = (0..2).all(|i| from[i] < other_to[i] && other_from[i] < to[i]);
                assert!(!over, "\"{name}\" over \"{other}\"");
                // Two names side by side must not read as one.
                let beside = from[1] < other_to[1] - 4.0 && other_from[1] < to[1] - 4.0;
                let gap = (from[0] - other_to[0]).max(other_from[0] - to[0]);
                assert!(!beside || gap > 4.0, "\"{name}\" beside \"{other}\", {gap}");
            }
        }
    }
}

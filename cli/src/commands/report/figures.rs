//! The figures of the report: which results each chart shows.

use super::stability_figures;
use crate::plots::PALETTE;
use crate::plots::chart::{Chart, Mark, Series, Shape};
use realistic_lab::irradiance;
use realistic_lab::picture;
use realistic_lab::pupil_table;
use realistic_lab::ray_map::{self, Family, Measured, Spread};
use realistic_lab::statistics::pareto_front;
use realistic_lab::suite::Results;
use realistic_lab::table::Table;

/// A chart with the name of its files.
pub struct Figure {
    /// File name without ending.
    pub file: String,
    /// What it shows.
    pub chart: Chart,
}

/// Charts that answer one question, one a lens.
pub struct Section {
    /// Its place in the page.
    pub anchor: &'static str,
    /// The question.
    pub title: &'static str,
    /// How to read the charts.
    pub text: &'static str,
    /// The table behind them.
    pub table: &'static str,
    /// The charts.
    pub figures: Vec<Figure>,
    /// A table to read under them.
    pub summary: Option<Table>,
}

/// A section as its line in the table below.
type Kind = (&'static str, &'static str, &'static str, &'static str, fn(&Results, &str) -> Chart);

const KINDS: &[Kind] = &[
    ("pixels", "The ray map: pixels", IN_PIXELS, "ray-map", in_pixels),
    ("direction", "The ray map: direction", DIRECTION, "ray-map", direction),
    ("position", "The ray map: position", POSITION, "ray-map", position),
    (
        "irradiance",
        "The estimator: film irradiance by pupil and sequence",
        IRRADIANCE,
        "irradiance",
        by_sequence,
    ),
    ("mapping", "The estimator: film irradiance by disk mapping", MAPPING, "irradiance", by_mapping),
    ("estimator", "The estimator: a rendered picture", ESTIMATOR, "estimators", estimators),
    ("set-up", "Set-up: polynomials", SET_UP, "set-up", set_up),
    ("pupils", "Set-up: the pupil", PUPILS, "pupils", pupils),
    ("picture", "The picture: whole renders", PICTURE, "renderers", renderers),
];

const IN_PIXELS: &str = "How far from its film point a ray belongs that leaves the lens where the method says, \
    against the time a ray takes. A mark is the 99.9 % quantile; its thin line reaches from the median to the worst \
    ray. Filled marks and the grey staircase are the Pareto front: nothing else is both faster and nearer. The dotted \
    lines are one pixel and a hundredth. A number by itself is a polynomial's order; those in batches are in f32 but \
    where f64 is said. \"one\" and \"three\" are rays traced at once, f32x16 is a batch on registers of 16 numbers.";
const DIRECTION: &str = "Angle between the ray that leaves the lens and the exact one, against the time a ray \
    takes; marks as above.";
const POSITION: &str = "Distance between the ray that leaves the lens and the exact point on the front surface, \
    against the time a ray takes. Marks as above; the front is that of this chart.";
const IRRADIANCE: &str = "RMS relative error of the estimate of film irradiance under a flat field, over the lit ones \
    of five film points from the centre to the corner and independent repetitions, against time, sample numbers \
    included. Whole lines draw on the rear element's disk, dashed ones on the thick lens's exit pupil, whose bias \
    makes them level off, dotted ones on the true pupil (warped). In brackets: the exponent of the noise as a power \
    of the number of samples (-0.5 is Monte Carlo).";
const MAPPING: &str =
    "The same, drawn on the rear element's disk, for the three ways from lens numbers to the disk.";
const ESTIMATOR: &str = "RMS error of a picture (chequerboard, lights out of focus, sky) over its mean, against \
    time on one core, for 1, 4, 16, ... samples a pixel; the f64 walk under every sampler. In brackets: the fitted \
    exponent.";
const PUPILS: &str = "What each way to know the pupil misses of it, and which share of its samples the lens blocks, \
    against the time to build its table: the rear element's disk, the thick lens's exit pupil (disk), boxes for rings \
    of the film, and the warped pupil. What is less than 1e-6, and what takes less than a microsecond to build, \
    stands there.";
const SET_UP: &str = "Error of fitted polynomials on fresh rays (99.9 % quantile) against the time to build them; \
    along a line the number of rays that they are fitted to doubles.";
const PICTURE: &str = "RMS error of the same picture against time on one core, for whole ways to render, with \
    Sobol' numbers: \"blocks\" are a batch host's, \"0.1 pixel\" is the cheapest model that the planner allows at that \
    tolerance, the others ask for one ray at a time. What models or samples the pupil wrongly levels off at its bias.";

/// Every section with its charts.
pub fn all(results: &Results) -> Vec<Section> {
    let by_lens = KINDS.iter().map(|&(anchor, title, text, table, draw)| Section {
        anchor,
        title,
        text,
        table,
        figures: results
            .lenses
            .iter()
            .map(|lens| Figure { file: format!("{anchor}-{lens}"), chart: draw(results, lens) })
            .collect(),
        summary: summary(results, anchor),
    });
    by_lens.chain([stability_figures::section(results)]).collect()
}

/// The table under a section's charts.
fn summary(results: &Results, anchor: &str) -> Option<Table> {
    match anchor {
        "pixels" => Some(ray_map::table(&results.ray_map)),
        "pupils" => Some(pupil_table::table(&results.pupils)),
        _ => None,
    }
}

/// The forms of marks, one a series.
pub const SHAPES: [Shape; 6] =
    [Shape::Disk, Shape::Square, Shape::Triangle, Shape::Diamond, Shape::Drop, Shape::Cross];

fn scatter(results: &Results, lens: &str, spread: fn(&Measured) -> Spread) -> Vec<Series> {
    let own: Vec<&Measured> = results.ray_map.iter().filter(|m| m.lens == lens).collect();
    let points: Vec<_> = own.iter().map(|m| (m.time.median, spread(m).most)).collect();
    let front = pareto_front(&points);
    let series = |(number, (name, family)): (usize, &(&str, Family))| Series {
        name: (*name).to_owned(),
        color: PALETTE[number % PALETTE.len()],
        shape: SHAPES[number % SHAPES.len()],
        line: None,
        marks: own
            .iter()
            .zip(&front)
            .filter(|(m, _)| m.method.family == *family)
            .map(|(m, &on_front)| {
                let Spread { median, most, worst } = spread(m);
                Mark {
                    at: [m.time.median * 1e9, most],
                    reach: Some([median, worst]),
                    name: Some(label(m)),
                    on_front,
                }
            })
            .collect(),
    };
    Family::NAMES.iter().enumerate().map(series).collect()
}

/// A method's name beside its mark: of a polynomial the order will do, its colour and form say the rest.
fn label(m: &Measured) -> String {
    let name = m.method.name;
    name.strip_prefix("order ").unwrap_or(name).trim_end_matches(", f32").replace(", ", " ")
}

fn in_pixels(results: &Results, lens: &str) -> Chart {
    Chart {
        title: lens.to_owned(),
        cost: "time a ray, ns",
        error: "error, pixels",
        levels: vec![(1.0, "one pixel".to_owned()), (0.01, "a hundredth of a pixel".to_owned())],
        series: scatter(results, lens, |m| m.pixels),
    }
}

fn direction(results: &Results, lens: &str) -> Chart {
    Chart {
        title: lens.to_owned(),
        cost: "time a ray, ns",
        error: "direction error, rad",
        levels: Vec::new(),
        series: scatter(results, lens, |m| m.direction),
    }
}

fn position(results: &Results, lens: &str) -> Chart {
    Chart {
        title: lens.to_owned(),
        cost: "time a ray, ns",
        error: "position error, mm",
        levels: Vec::new(),
        series: scatter(results, lens, |m| m.position),
    }
}

/// Lines in whole or dashed strokes: the first thing that tells two apart.
const DASHES: [&str; 3] = ["none", "6 4", "2 3"];

/// One line, in the colour of the `color`th and the dashes of the `dash`th of their kinds.
fn line(name: String, color: usize, dash: usize, points: impl Iterator<Item = [f64; 2]>) -> Series {
    Series {
        name,
        color: PALETTE[color % PALETTE.len()],
        shape: SHAPES[dash % SHAPES.len()],
        line: Some(DASHES[dash % DASHES.len()]),
        marks: points.map(|at| Mark { at, reach: None, name: None, on_front: false }).collect(),
    }
}

/// Marks what no other mark of the chart beats.
fn with_front(mut series: Vec<Series>) -> Vec<Series> {
    let points: Vec<_> = series.iter().flat_map(|s| &s.marks).map(|m| (m.at[0], m.at[1])).collect();
    let front = pareto_front(&points);
    series.iter_mut().flat_map(|s| &mut s.marks).zip(front).for_each(|(mark, on)| mark.on_front = on);
    series
}

/// The number of a word among those seen before it.
fn rank<'a>(seen: &mut Vec<&'a str>, word: &'a str) -> usize {
    seen.iter().position(|other| *other == word).unwrap_or_else(|| {
        seen.push(word);
        seen.len() - 1
    })
}

fn flat_field(
    results: &Results,
    lens: &str,
    wanted: impl Fn(&irradiance::Curve) -> bool,
    dashed_by: fn(&irradiance::Curve) -> &'static str,
) -> Chart {
    let (mut colors, mut dashes) = (Vec::new(), Vec::new());
    let curves = results.irradiance.iter().filter(|c| c.lens == lens && wanted(c));
    let series = curves.map(|curve| {
        let name = format!("{}, {} ({:.2})", dashed_by(curve), curve.sequence, curve.slope);
        let points = curve.points.iter().map(|p| [p.time * 1e6, p.error]);
        line(name, rank(&mut colors, curve.sequence), rank(&mut dashes, dashed_by(curve)), points)
    });
    Chart {
        title: lens.to_owned(),
        cost: "time an estimate, µs",
        error: "RMS relative error",
        levels: Vec::new(),
        series: with_front(series.collect()),
    }
}

fn by_sequence(results: &Results, lens: &str) -> Chart {
    flat_field(results, lens, |curve| curve.disk == "concentric", |curve| curve.pupil)
}

fn by_mapping(results: &Results, lens: &str) -> Chart {
    let shown = ["random", "Sobol'"];
    flat_field(
        results,
        lens,
        |curve| curve.pupil == "rear" && shown.contains(&curve.sequence),
        |curve| curve.disk,
    )
}

fn pictures(lens: &str, curves: &[picture::Curve], estimators: bool) -> Chart {
    let (mut colors, mut dashes) = (Vec::new(), Vec::new());
    let series = curves.iter().filter(|c| c.lens == lens).enumerate().map(|(number, curve)| {
        let points = curve.points.iter().map(|p| [p.time * 1e3, p.error]);
        if estimators {
            let name = format!("{} ({:.2})", curve.name, curve.slope);
            line(name, rank(&mut colors, curve.second), rank(&mut dashes, curve.first), points)
        } else {
            line(curve.first.to_owned(), number, number / PALETTE.len(), points)
        }
    });
    Chart {
        title: lens.to_owned(),
        cost: "time on one core, ms",
        error: "RMS error over the mean",
        levels: Vec::new(),
        series: with_front(series.collect()),
    }
}

fn estimators(results: &Results, lens: &str) -> Chart {
    pictures(lens, &results.estimators, true)
}

fn renderers(results: &Results, lens: &str) -> Chart {
    let mut chart = pictures(lens, &results.renderers, false);
    let floor = results.floors.iter().find(|(name, _)| *name == lens);
    let lowest = chart.series.iter().flat_map(|s| &s.marks).map(|m| m.at[1]).fold(f64::INFINITY, f64::min);
    let floor = floor.filter(|(_, error)| *error > lowest / 4.0);
    chart.levels.extend(floor.map(|&(_, error)| (error, "the reference's own error".to_owned())));
    chart
}

fn set_up(results: &Results, lens: &str) -> Chart {
    let mut series: Vec<Series> = Vec::new();
    let mut names = Vec::new();
    for m in results.set_up.iter().filter(|m| m.lens == lens) {
        let number = rank(&mut names, m.family);
        if number == series.len() {
            series.push(line(m.family.to_owned(), number, 0, std::iter::empty()));
        }
        let mark = Mark { at: [m.time * 1e3, m.direction.most], reach: None, name: None, on_front: false };
        series[number].marks.push(mark);
    }
    Chart {
        title: lens.to_owned(),
        cost: "time to build, ms",
        error: "direction error, rad",
        levels: Vec::new(),
        series: with_front(series),
    }
}

/// Shares below this are shown as this.
const LEAST_SHARE: f64 = 1e-6;
/// Building times below this, ms, likewise.
const LEAST_TIME: f64 = 1e-3;

fn pupils(results: &Results, lens: &str) -> Chart {
    let own: Vec<_> = results.pupils.iter().filter(|m| m.lens == lens).collect();
    let series = |name: &str, number: usize, share: fn(&pupil_table::Measured) -> f64| Series {
        name: name.to_owned(),
        color: PALETTE[number],
        shape: SHAPES[number],
        line: None,
        marks: own
            .iter()
            .map(|m| Mark {
                at: [(m.time * 1e3).max(LEAST_TIME), share(m).max(LEAST_SHARE)],
                reach: None,
                name: Some(m.name.to_owned()),
                on_front: false,
            })
            .collect(),
    };
    let series = [
        series("share of the pupil missed", 0, |m| m.missed),
        series("share of the samples blocked", 1, |m| m.excess),
    ];
    Chart {
        title: lens.to_owned(),
        cost: "time to build, ms",
        error: "share",
        levels: Vec::new(),
        series: series.into(),
    }
}

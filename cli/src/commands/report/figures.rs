//! The figures of the report: measured results in, sections with their charts out.

use crate::plots::PALETTE;
use crate::plots::chart::{Chart, Mark, Series};
use realistic_lab::accuracy::pupils::{self, Coverage};
use realistic_lab::accuracy::ray_map::{self, RayErrors};
use realistic_lab::accuracy::suite::{Results, stability_table};
use realistic_lab::methods::Family;
use realistic_lab::results::statistics::{Spread, pareto_front};
use realistic_lab::results::table::Table;
use realistic_lab::{accuracy::curve::Curve, reference::condition::Norm, stability};
use std::collections::BTreeSet;

/// A chart with the name of its files.
pub struct Figure {
    /// File name without ending.
    pub file: String,
    /// What it shows.
    pub chart: Chart,
}

/// Charts that answer one question.
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

/// Anchor, title, text and table of a section with a chart for each lens.
type ByLens = (&'static str, &'static str, &'static str, &'static str, fn(&Results, &str) -> Chart);

const BY_LENS: &[ByLens] = &[
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
    against the time per ray. A mark is the 99.9 % quantile; its thin line reaches from the median to the worst \
    ray. Filled marks and the grey staircase are the Pareto front: nothing else is both faster and nearer. The dotted \
    lines are one pixel and a hundredth. A number by itself is a polynomial's order; those in batches are in f32 but \
    where f64 is said. \"one\" and \"three\" are rays traced at once, f32x16 is a batch on registers of 16 numbers.";
const DIRECTION: &str = "Angle between the ray that leaves the lens and the exact one, against the time per ray; \
    marks as above.";
const POSITION: &str = "Distance between the ray that leaves the lens and the exact point on the front surface, \
    against the time per ray. Marks as above; the front is that of this chart.";
const IRRADIANCE: &str = "RMS relative error of the estimate of film irradiance under a flat field, over the lit ones \
    of five film points from the centre to the corner and independent repetitions, against time, that of \
    the lens samples included. Whole lines sample the rear element's disk, dashed ones the thick lens's exit pupil, whose bias \
    makes them level off, dotted ones the true pupil (warped). In brackets: the exponent of the noise as a power \
    of the number of samples (-0.5 is Monte Carlo).";
const MAPPING: &str =
    "The same, on the rear element's disk, for the three ways from lens samples (u, v) to the disk.";
const ESTIMATOR: &str = "RMS error of a picture (chequerboard, lights out of focus, sky) over its mean, against \
    time on one core, for 1, 4, 16, ... samples per pixel; the f64 walk under every sampler. In brackets: the fitted \
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
const STABILITY: &str = "Extreme cases with known answers: a mark is a case, its error over what a perfect tracer must \
    expect from the condition number of the case and its own rounding unit. A figure of order one, whatever the \
    condition, is a backward stable tracer; what is below 1e-6, or exact, stands there. The dotted lines are the \
    bounds that the tests hold. A kernel's points are as good as the size of the surface that they lie on, those of a \
    walk as good as their own distance from the vertex: the condition numbers are reckoned so. Kernels that give the \
    same bits are drawn once. The table has the worst of each group, the CSV every case.";

/// Every section with its charts.
pub fn all(results: &Results) -> Vec<Section> {
    let by_lens = BY_LENS.iter().map(|&(anchor, title, text, table, draw)| {
        let figure = |lens: &&str| Figure {
            file: format!("{anchor}-{lens}"),
            chart: Chart { title: (*lens).to_owned(), ..draw(results, lens) },
        };
        let figures = results.lenses.iter().map(figure).collect();
        let summary = match anchor {
            "pixels" => Some(ray_map::table(&results.ray_map)),
            "pupils" => Some(pupils::table(&results.pupils)),
            _ => None,
        };
        Section { anchor, title, text, table, figures, summary }
    });
    by_lens.chain([of_stability(results)]).collect()
}

/// Ray errors against time, in the units of `error`.
fn scatter(results: &Results, lens: &str, error: &'static str, spread: fn(&RayErrors) -> Spread) -> Chart {
    let own: Vec<&RayErrors> = results.ray_map.iter().filter(|m| m.lens == lens).collect();
    let points: Vec<_> = own.iter().map(|m| (m.time.median, spread(m).most)).collect();
    let front = pareto_front(&points);
    let mark = |(m, &on_front): (&&RayErrors, &bool)| {
        let Spread { median, most, worst } = spread(m);
        // Of a polynomial the order will do: its colour and form say the rest.
        let name = m.method.name.strip_prefix("order ").unwrap_or(m.method.name);
        Mark {
            at: [m.time.median * 1e9, most],
            reach: Some([median, worst]),
            name: Some(name.trim_end_matches(", f32").replace(", ", " ")),
            on_front,
        }
    };
    let series = Family::NAMES.iter().enumerate().map(|(number, (name, family))| {
        let own = own.iter().zip(&front).filter(|(m, _)| m.method.family() == *family);
        Series::marks(name, number, own.map(mark))
    });
    Chart { cost: "time per ray, ns", error, series: series.collect(), ..Chart::default() }
}

fn in_pixels(results: &Results, lens: &str) -> Chart {
    let levels = vec![(1.0, "one pixel".to_owned()), (0.01, "a hundredth of a pixel".to_owned())];
    Chart { levels, ..scatter(results, lens, "error, pixels", |m| m.pixels) }
}

fn direction(results: &Results, lens: &str) -> Chart {
    scatter(results, lens, "direction error, rad", |m| m.direction)
}

fn position(results: &Results, lens: &str) -> Chart {
    scatter(results, lens, "position error, mm", |m| m.position)
}

/// Marks what no other mark of the chart beats.
fn with_front(series: impl Iterator<Item = Series>) -> Vec<Series> {
    let mut series: Vec<Series> = series.collect();
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

/// Axes of the charts of light against time: units a second, and what they are called.
type Axes = (f64, &'static str, &'static str);
const FLAT_FIELD: Axes = (1e6, "time per estimate, µs", "RMS relative error");
const WHOLE: Axes = (1e3, "time on one core, ms", "RMS error over the mean");

/// Errors of curves against time; `line` gives a curve's name, colour and dashes.
fn lines<'a>(
    (second, cost, error): Axes,
    curves: impl Iterator<Item = &'a Curve>,
    mut line: impl FnMut(usize, &'a Curve) -> (String, usize, usize),
) -> Chart {
    let series = curves.enumerate().map(|(number, curve)| {
        let (name, color, dash) = line(number, curve);
        Series::line(name, color, dash, curve.points.iter().map(|p| [p.time * second, p.error]))
    });
    Chart { cost, error, series: with_front(series), ..Chart::default() }
}

/// The same with a colour for each sequence.
fn samplers<'a>(
    axes: Axes,
    curves: impl Iterator<Item = &'a Curve>,
    dashed_by: fn(&Curve) -> &'static str,
) -> Chart {
    let (mut colors, mut dashes) = (Vec::new(), Vec::new());
    lines(axes, curves, |_, curve| {
        let name = format!("{}, {} ({:.2})", dashed_by(curve), curve.sequence, curve.slope());
        (name, rank(&mut colors, curve.sequence), rank(&mut dashes, dashed_by(curve)))
    })
}

fn by_sequence(results: &Results, lens: &str) -> Chart {
    let shown = results.irradiance.iter().filter(|c| c.lens == lens && c.disk == "concentric");
    samplers(FLAT_FIELD, shown, |curve| curve.pupil)
}

fn by_mapping(results: &Results, lens: &str) -> Chart {
    let shown =
        |c: &&Curve| c.lens == lens && c.pupil == "rear" && ["random", "Sobol'"].contains(&c.sequence);
    samplers(FLAT_FIELD, results.irradiance.iter().filter(shown), |curve| curve.disk)
}

fn estimators(results: &Results, lens: &str) -> Chart {
    samplers(WHOLE, results.estimators.iter().filter(|c| c.lens == lens), |curve| curve.pupil)
}

fn renderers(results: &Results, lens: &str) -> Chart {
    let line = |number, curve: &Curve| (curve.pupil.to_owned(), number, number / PALETTE.len());
    let mut chart = lines(WHOLE, results.renderers.iter().filter(|c| c.lens == lens), line);
    let floor = results.floors.iter().find(|(name, _)| *name == lens);
    let lowest = chart.series.iter().flat_map(|s| &s.marks).map(|m| m.at[1]).fold(f64::INFINITY, f64::min);
    let floor = floor.filter(|(_, error)| *error > lowest / 4.0);
    chart.levels.extend(floor.map(|&(_, error)| (error, "the reference's own error".to_owned())));
    chart
}

fn set_up(results: &Results, lens: &str) -> Chart {
    let own = || results.set_up.iter().filter(|m| m.lens == lens);
    let mut orders: Vec<&str> = own().map(|m| m.order).collect();
    orders.dedup();
    let series = orders.iter().enumerate().map(|(number, order)| {
        let points = own().filter(|m| m.order == *order).map(|m| [m.time * 1e3, m.direction.most]);
        Series::line((*order).to_owned(), number, 0, points)
    });
    let (cost, error) = ("time to build, ms", "direction error, rad");
    Chart { cost, error, series: with_front(series), ..Chart::default() }
}

fn pupils(results: &Results, lens: &str) -> Chart {
    // What is less is shown as this: a share, and a time in ms.
    const LEAST: (f64, f64) = (1e-6, 1e-3);
    let series = |name: &str, number: usize, share: fn(&Coverage) -> f64| {
        let marks = results.pupils.iter().filter(|m| m.lens == lens).map(|m| Mark {
            at: [(m.time * 1e3).max(LEAST.1), share(m).max(LEAST.0)],
            name: Some(m.name.to_owned()),
            ..Mark::default()
        });
        Series::marks(name, number, marks)
    };
    let series = vec![
        series("share of the pupil missed", 0, |m| m.missed),
        series("share of the samples blocked", 1, |m| m.excess),
    ];
    Chart { cost: "time to build, ms", error: "share", series, ..Chart::default() }
}

/// Stability cases by their condition number: of which tracers, and the bounds that are drawn.
fn cases(results: &Results, title: &str, shown: &[&'static str], levels: Vec<(f64, String)>) -> Chart {
    // Marks that would cover each other all but for a pixel are drawn once, exact ones as this ratio.
    const GRAIN: f64 = 20.0;
    const EXACT: f64 = 1e-6;
    let mut drawn = BTreeSet::new();
    let series = shown.iter().enumerate().map(|(number, &tracer)| {
        // What is evaluated by rays without number has no condition number; it is in the table.
        let own = results.stability.iter().filter(|case| case.tracer == tracer && case.condition > 0.0);
        let places = own
            .map(|case| [case.condition, case.ratio.max(EXACT)])
            .filter(|at| drawn.insert((number, at.map(|x| (x.log10() * GRAIN).round() as i64))));
        Series::marks(tracer, number, places.map(|at| Mark { at, ..Mark::default() }))
    });
    let (cost, error) = ("condition number of the ray map", "error / (condition x epsilon)");
    Chart { title: title.to_owned(), cost, error, levels, series: series.collect() }
}

/// The section of stability with its three charts.
fn of_stability(results: &Results) -> Section {
    let tracers = stability::tracers();
    let of = |norm: Norm| tracers.iter().filter(move |t| t.norm == norm);
    let named = |norm| of(norm).filter(|t| t.like == t.name).map(|t| t.name).collect::<Vec<_>>();
    let level = |bound: f64| (bound, format!("bound, {bound}"));
    let mut walk_levels = vec![level(stability::BOUND)];
    let looser = of(Norm::Own).filter(|t| t.bound > stability::BOUND);
    walk_levels.extend(looser.map(|t| (t.bound, format!("bound of {}, {}", t.name, t.bound))));
    let kernel_bound = of(Norm::Surface).map(|t| t.bound).fold(f64::INFINITY, f64::min);
    let (design, design_levels) = (["first order", "focus"], vec![level(stability::BOUND)]);
    let charts = [
        ("walks", cases(results, "walks", &named(Norm::Own), walk_levels)),
        ("kernels", cases(results, "compiled kernels", &named(Norm::Surface), vec![level(kernel_bound)])),
        ("design", cases(results, "focal length, pupil and focus", &design, design_levels)),
    ];
    let figure = |(name, chart)| Figure { file: format!("stability-{name}"), chart };
    Section {
        anchor: "stability",
        title: "Stability on stiff and extreme cases",
        text: STABILITY,
        table: "stability",
        figures: charts.map(figure).into(),
        summary: Some(stability_table(&results.stability_by_group())),
    }
}

//! The figures of the report: converts measured results to sections with charts.

use crate::plots::PALETTE;
use crate::plots::chart::{Chart, Mark, Series};
use realistic_camera::plan::Entry;
use realistic_lab::accuracy::leaving_out::{self, Asked, Saving};
use realistic_lab::accuracy::pupils::{self, Coverage};
use realistic_lab::accuracy::ray_map::{self, RayErrors};
use realistic_lab::accuracy::suite::Results;
use realistic_lab::accuracy::vignetting::{self, Vignetting};
use realistic_lab::methods::Family;
use realistic_lab::results::statistics::{Spread, pareto_front};
use realistic_lab::results::table::Table;
use realistic_lab::{accuracy::curve::Curve, reference::condition::Norm, stability};
use std::collections::BTreeSet;

/// A chart with its file name.
pub struct Figure {
    /// File name without ending.
    pub file: String,
    /// The chart.
    pub chart: Chart,
}

/// A section: charts that answer one question.
pub struct Section {
    /// Anchor of the section in the page.
    pub anchor: &'static str,
    /// Title, which is the question.
    pub title: &'static str,
    /// Explanation of the charts.
    pub text: &'static str,
    /// Name of the table that holds the data of the charts.
    pub table: &'static str,
    /// The charts.
    pub figures: Vec<Figure>,
    /// A table below the charts.
    pub summary: Option<Table>,
}

/// Anchor, title, text and table of a section with a chart for each lens.
type ByLens = (&'static str, &'static str, &'static str, &'static str, fn(&Results, &str) -> Chart);

const BY_LENS: &[ByLens] = &[
    ("pixels", "How far off a ray is, in pixels", IN_PIXELS, "ray-map", in_pixels),
    ("stopped-down", "The same at f/8", AT_F8, "stopped-down", stopped_down),
    ("direction", "How far off a ray is, in direction", DIRECTION, "ray-map", direction),
    ("position", "How far off a ray is, in position", POSITION, "ray-map", position),
    ("vignetting", "What happens to vignetting", VIGNETTING, "vignetting", vignetting),
    (
        "leaving-out",
        "What leaving out saves, without a tolerance and with one",
        LEAVING_OUT,
        "leaving-out",
        savings,
    ),
    ("irradiance", "Noise of a flat field, by pupil and sequence", IRRADIANCE, "irradiance", by_sequence),
    ("mapping", "Noise of a flat field, by mapping to the disk", MAPPING, "irradiance", by_mapping),
    ("estimator", "Noise of a picture, by pupil and sequence", ESTIMATOR, "estimators", estimators),
    ("picture", "Error of a picture, by way to render", PICTURE, "renderers", renderers),
    ("set-up", "What fitting polynomials costs", SET_UP, "set-up", set_up),
    ("pupils", "What knowing the pupil costs", PUPILS, "pupils", pupils),
];

const IN_PIXELS: &str = "How far from its film point a ray belongs that leaves the lens where the method says, \
    against the time per sample. The samples are those of a camera with the default pupil, over all of its film, those that an \
    aperture blocks among them; all but the thick and the thin lens test the apertures that block. A mark is the error that 99.9 % of the rays keep; \
    its thin line reaches from the median to the worst ray. Filled marks and the grey staircase are what nothing else beats: \
    nothing is nearer and faster, or nearer and as fast but for a tie. The dotted lines are one pixel and a hundredth. P5 is \
    a polynomial of order 5, in batches in single precision (f32) but where f64 is said. \"one\" and \"three\" are rays traced \
    at once, f32x16 is a batch on registers of 16 numbers. \"Plain loop\" goes over the surfaces as textbooks do, with each of \
    their refractions; \"compiled\" is the lens made ready for that.";
const AT_F8: &str = "The same with the stop at f/8, where polynomials need fewer terms: fitted anew to the rays that get \
    through, and without the slow loops.";
const VIGNETTING: &str = "By how much film irradiance is off where rays pass that the lens blocks, or are blocked that pass: \
    the largest error over five film points from the centre to the corner, as a part of the light on the axis, against the \
    time per sample. Here the whole rear element is sampled (pupil \"rear\"), so that the lens's own apertures make the \
    vignetting. Polynomials stand here twice, with the apertures that block rays and without; the thick lens has none. Less \
    than 1e-6 stands there. With the default pupil, \"warped\", only samples inside the true pupil are asked for, and \
    vignetting is right whatever traces them.";
const LEAVING_OUT: &str = "The share of a camera ray's time that is saved by what its plan leaves out. With a tolerance of 1, 0.1 or \
    0.01 pixel the camera may take another model of the lens, and stands beside double precision with everything kept; \
    tolerances that chose the same way to trace are one mark. A mark is the median, its thin line the quartiles; what saves \
    less than a thousandth, or nothing, stands there. The dotted line is what counts as a tie in this run.";
const DIRECTION: &str = "Angle between the ray that leaves the lens and the exact one, against the time per sample; \
    marks as above.";
const POSITION: &str = "Distance between the ray that leaves the lens and the exact point on the front surface, \
    against the time per sample. Marks as above; the staircase is that of this chart.";
const IRRADIANCE: &str = "RMS relative error of the estimate of film irradiance under a flat field, over the lit ones \
    of five film points from the centre to the corner and independent repetitions, against time, that of \
    the lens samples included. Whole lines sample the rear element's disk, dashed ones the thick lens's exit pupil, whose bias \
    makes them level off, dotted ones the true pupil (warped). In brackets: the exponent of the noise as a power \
    of the number of samples (-0.5 is Monte Carlo).";
const MAPPING: &str =
    "The same, on the rear element's disk, for the three ways from lens samples (u, v) to the disk.";
const ESTIMATOR: &str = "RMS error of a picture (chequerboard, lights out of focus, sky) over its mean, against \
    time on one core, for 1, 4, 16, ... samples per pixel; traced ray by ray in double precision under every sampler. In \
    brackets: the fitted exponent.";
const PUPILS: &str = "What each way to know the pupil misses of it, and which share of its samples the lens blocks, \
    against the time to build its table: the rear element's disk, the thick lens's exit pupil (disk), boxes for rings \
    of the film, and the warped pupil. What is less than 1e-6, and what takes less than a microsecond to build, \
    stands there.";
const SET_UP: &str = "Error of fitted polynomials on fresh rays (99.9 % of them keep it) against the time to build them; \
    along a line the number of rays that they are fitted to doubles.";
const PICTURE: &str = "RMS error of the same picture against time on one core, for whole ways to render, with \
    Sobol' samples: \"blocks\" ask for many rays at once, \"0.1 pixel\" is a camera with that tolerance, the others ask for one \
    ray at a time. Where the camera with the tolerance chose what another one traces by, the pictures are the same in every \
    digit and the two are one line. What models or samples the pupil wrongly levels off at its bias.";
const STABILITY: &str = "Extreme lenses and rays with known answers: a mark is a case, its error over what rounding alone must \
    be expected to do, which is the case's condition number (how much a small change of a ray grows) times the precision's \
    rounding unit. A figure of order one, whatever the condition number, is as good as the precision allows; what is below \
    1e-6, or exact, stands there. The dotted lines are the bounds that the tests hold. Compiled lenses are measured by the \
    size of the surface that a point lies on, the plain loops by the point's own distance from the vertex. What gives the \
    same bits is drawn once. What is left of the compiled lenses' errors comes from weakly curved surfaces that are met without \
    a division: divisions for the 2 of 120 000 random lenses that exceed 20 would cost the double Gauss 3 to 4 % of a ray \
    (benches/record/2026-11-22-weak-surfaces-epyc-avx512.md). Whitted's and Heckbert's refractions have the bound 1000: where \
    a ray grazes a surface between nearly equal media they lose digits that nothing else loses, Heckbert's half a rounding \
    unit over the cosine. Random lenses have numbers, and each makes the same lens and rays everywhere: \
    \"realistic report --case\" with the name of one repeats it; three beyond those of a full run are known to fail, and stand in \
    docs/accuracy.md. The table has the worst of each group, the CSV every case.";

/// Returns the charts at the top of the page, which show cost and error of a camera's rays in batches and one by one.
pub fn overview(results: &Results) -> Vec<Figure> {
    let of = |file: &str, title: &str, entry: Entry| Figure {
        file: file.to_owned(),
        chart: Chart { title: title.to_owned(), ..cameras(results, entry) },
    };
    if results.leaving_out.is_empty() {
        return Vec::new();
    }
    vec![
        of("overview-batches", "Many rays in one call", Entry::Many),
        of("overview-single", "One ray per call", Entry::One),
    ]
}

/// Smallest error shown, pixels; smaller errors, 0 included, are drawn at this value.
const NEAREST: f64 = 1e-6;

/// Draws the time and error of cameras wide open, with a colour for each lens.
fn cameras(results: &Results, entry: Entry) -> Chart {
    let series = results.lenses.iter().enumerate().map(|(number, lens)| {
        let own = results.leaving_out.iter();
        let own: Vec<&Saving> =
            own.filter(|s| s.lens == *lens && s.entry == entry && !s.stopped_down).collect();
        let marks = one_each(&own).into_iter().map(|(name, saving)| {
            let pixels = saving.pixels.or_else(|| single_precision(results, lens)).unwrap_or(NEAREST);
            Mark {
                at: [saving.left_out.median * 1e9, pixels.max(NEAREST)],
                name: Some(name),
                ..Mark::default()
            }
        });
        Series::marks(lens, number, marks)
    });
    let levels = vec![(1.0, "one pixel".to_owned()), (NEAREST, "exact".to_owned())];
    Chart {
        cost: "time per ray, ns",
        error: "error, pixels",
        levels,
        series: series.collect(),
        ..Chart::default()
    }
}

/// Returns the largest error, pixels, among the best 99.9 % of the rays in single precision.
fn single_precision(results: &Results, lens: &str) -> Option<f64> {
    let own = results.ray_map.iter().find(|m| m.lens == lens && m.method.name == "one f32");
    own.map(|m| m.pixels.most)
}

/// Merges the cameras that trace by the same method into one entry with all of their names.
fn one_each<'a>(savings: &[&'a Saving]) -> Vec<(String, &'a Saving)> {
    let mut all: Vec<(String, &Saving)> = Vec::new();
    for saving in savings {
        let name = match saving.request {
            Asked::Precision(precision) => precision.to_string(),
            Asked::Tolerance(pixels) => format!("{pixels}"),
        };
        match all.iter_mut().find(|(_, other)| other.tracing == saving.tracing) {
            Some((names, _)) => *names = format!("{names}, {name}"),
            None => all.push((name, saving)),
        }
    }
    all
}

/// Returns every section with its charts.
pub fn all(results: &Results) -> Vec<Section> {
    let by_lens = BY_LENS.iter().map(|&(anchor, title, text, table, draw)| {
        let figure = |lens: &&str| Figure {
            file: format!("{anchor}-{lens}"),
            chart: Chart { title: (*lens).to_owned(), ..draw(results, lens) },
        };
        let figures = results.lenses.iter().map(figure).collect();
        let tie = results.ties().times.ratio;
        let summary = match anchor {
            "pixels" => Some(ray_map::summary("ray-map", &results.ray_map, tie)),
            "stopped-down" => Some(ray_map::summary("stopped-down", &results.stopped_down, tie)),
            "vignetting" => Some(vignetting::table(&results.vignetting)),
            "leaving-out" => Some(leaving_out::table(&results.leaving_out)),
            "pupils" => Some(pupils::table(&results.pupils)),
            _ => None,
        };
        Section { anchor, title, text, table, figures, summary }
    });
    by_lens.chain([of_stability(results)]).collect()
}

/// Draws ray errors against time, in the unit of `error`.
fn scatter(
    rays: &[RayErrors],
    tie: f64,
    lens: &str,
    error: &'static str,
    spread: fn(&RayErrors) -> Spread,
) -> Chart {
    let own: Vec<&RayErrors> = rays.iter().filter(|m| m.lens == lens).collect();
    let points: Vec<_> = own.iter().map(|m| (m.time.median, spread(m).most)).collect();
    let front = pareto_front(&points, tie);
    let mark = |(m, &on_front): (&&RayErrors, &bool)| {
        let Spread { median, most, worst } = spread(m);
        Mark {
            at: [m.time.median * 1e9, most],
            reach: Some([median, worst]),
            name: Some(short(m.method.name)),
            on_front,
        }
    };
    let series = Family::NAMES.iter().enumerate().map(|(number, (name, family))| {
        let own = own.iter().zip(&front).filter(|(m, _)| m.method.family() == *family);
        Series::marks(name, number, own.map(mark))
    });
    Chart { cost: "time per sample, ns", error, series: series.collect(), ..Chart::default() }
}

/// Returns the name of a method for its mark; for a polynomial only the order, because colour and shape show the
/// rest.
fn short(name: &str) -> String {
    let name = name.strip_prefix("order ").map_or_else(|| name.to_owned(), |order| format!("P{order}"));
    name.trim_end_matches(", f32").replace(", ", " ")
}

fn of_pixels(rays: &[RayErrors], tie: f64, lens: &str) -> Chart {
    let levels = vec![(1.0, "one pixel".to_owned()), (0.01, "a hundredth of a pixel".to_owned())];
    Chart { levels, ..scatter(rays, tie, lens, "error, pixels", |m| m.pixels) }
}

fn in_pixels(results: &Results, lens: &str) -> Chart {
    of_pixels(&results.ray_map, results.ties().times.ratio, lens)
}

fn stopped_down(results: &Results, lens: &str) -> Chart {
    of_pixels(&results.stopped_down, results.ties().times.ratio, lens)
}

/// Draws the share of the time that is saved by leaving parts out, against the time of a ray with all parts kept.
fn savings(results: &Results, lens: &str) -> Chart {
    // Smallest share shown; smaller shares are drawn at this value.
    const LEAST: f64 = 1e-3;
    let kinds = [
        ("in batches, wide open", Entry::Many, false),
        ("in batches, f/8", Entry::Many, true),
        ("one by one, wide open", Entry::One, false),
        ("one by one, f/8", Entry::One, true),
    ];
    let series = kinds.iter().enumerate().map(|(number, &(kind, entry, stopped_down))| {
        let own: Vec<&Saving> = results
            .leaving_out
            .iter()
            .filter(|s| s.lens == lens && s.entry == entry && s.stopped_down == stopped_down)
            .filter(|s| matches!(s.request, Asked::Tolerance(_)))
            .collect();
        let marks = one_each(&own).into_iter().map(|(name, saving)| {
            let [low, median, high] = saving.share().map(|share| share.max(LEAST));
            Mark {
                at: [saving.kept.median * 1e9, median],
                reach: Some([low, high]),
                name: Some(name),
                ..Mark::default()
            }
        });
        Series::marks(kind, number, marks)
    });
    let tie = results.ties().times.ratio;
    let levels =
        if tie.is_finite() { vec![(1.0 - 1.0 / tie, "what counts as a tie".to_owned())] } else { vec![] };
    let cost = "time per ray with everything kept, ns";
    Chart { cost, error: "share of the time saved", levels, series: series.collect(), ..Chart::default() }
}

/// Draws the errors in vignetting against time.
fn vignetting(results: &Results, lens: &str) -> Chart {
    type Kind = (&'static str, fn(&Vignetting) -> bool);
    let kinds: [Kind; 4] = [
        ("thick lens", |m| m.method.family() == Family::Gaussian),
        ("polynomials without apertures", |m| m.method.family() == Family::PolynomialBatch && !m.apertures),
        ("polynomials with apertures", |m| m.method.family() == Family::PolynomialBatch && m.apertures),
        ("compiled, in batches", |m| m.method.family() == Family::KernelBatch),
    ];
    let series = kinds.iter().enumerate().map(|(number, (kind, is_one))| {
        let own = results.vignetting.iter().filter(|m| m.lens == lens && is_one(m));
        let marks = own.map(|m| Mark {
            at: [m.time.median * 1e9, m.worst().max(NEAREST)],
            name: Some(short(m.method.name)),
            ..Mark::default()
        });
        Series::marks(kind, number, marks)
    });
    let error = "error of film irradiance, part of the light on the axis";
    let series = with_front(series, results.ties().times.ratio);
    Chart { cost: "time per sample, ns", error, series, ..Chart::default() }
}

fn direction(results: &Results, lens: &str) -> Chart {
    scatter(&results.ray_map, results.ties().times.ratio, lens, "direction error, rad", |m| m.direction)
}

fn position(results: &Results, lens: &str) -> Chart {
    scatter(&results.ray_map, results.ties().times.ratio, lens, "position error, mm", |m| m.position)
}

/// Flags the marks on the Pareto front of the chart.
fn with_front(series: impl Iterator<Item = Series>, tie: f64) -> Vec<Series> {
    let mut series: Vec<Series> = series.collect();
    let points: Vec<_> = series.iter().flat_map(|s| &s.marks).map(|m| (m.at[0], m.at[1])).collect();
    let front = pareto_front(&points, tie);
    series.iter_mut().flat_map(|s| &mut s.marks).zip(front).for_each(|(mark, on)| mark.on_front = on);
    series
}

/// Returns the index of a word in the list of words seen, to which a new word is added.
fn rank<'a>(seen: &mut Vec<&'a str>, word: &'a str) -> usize {
    seen.iter().position(|other| *other == word).unwrap_or_else(|| {
        seen.push(word);
        seen.len() - 1
    })
}

/// Axes of the charts of light against time: units per second, then the two labels.
type Axes = (f64, &'static str, &'static str);
const FLAT_FIELD: Axes = (1e6, "time per estimate, µs", "RMS relative error");
const WHOLE: Axes = (1e3, "time on one core, ms", "RMS error over the mean");

/// Draws the errors of curves against time; `line` returns the name, colour and dashes of a curve.
fn lines<'a>(
    (second, cost, error): Axes,
    tie: f64,
    curves: impl Iterator<Item = &'a Curve>,
    mut line: impl FnMut(usize, &'a Curve) -> (String, usize, usize),
) -> Chart {
    let series = curves.enumerate().map(|(number, curve)| {
        let (name, color, dash) = line(number, curve);
        Series::line(name, color, dash, curve.points.iter().map(|p| [p.time * second, p.error]))
    });
    Chart { cost, error, series: with_front(series, tie), ..Chart::default() }
}

/// Draws curves with a colour for each sequence.
fn samplers<'a>(
    axes: Axes,
    tie: f64,
    curves: impl Iterator<Item = &'a Curve>,
    dashed_by: fn(&Curve) -> &'static str,
) -> Chart {
    let (mut colors, mut dashes) = (Vec::new(), Vec::new());
    lines(axes, tie, curves, |_, curve| {
        let name = format!("{}, {} ({:.2})", dashed_by(curve), curve.sequence, curve.slope());
        (name, rank(&mut colors, curve.sequence), rank(&mut dashes, dashed_by(curve)))
    })
}

fn by_sequence(results: &Results, lens: &str) -> Chart {
    let shown = results.irradiance.iter().filter(|c| c.lens == lens && c.disk == "concentric");
    samplers(FLAT_FIELD, results.ties().irradiance.ratio, shown, |curve| curve.pupil)
}

fn by_mapping(results: &Results, lens: &str) -> Chart {
    let shown =
        |c: &&Curve| c.lens == lens && c.pupil == "rear" && ["random", "Sobol'"].contains(&c.sequence);
    samplers(FLAT_FIELD, results.ties().irradiance.ratio, results.irradiance.iter().filter(shown), |curve| {
        curve.disk
    })
}

fn estimators(results: &Results, lens: &str) -> Chart {
    samplers(
        WHOLE,
        results.ties().pictures.ratio,
        results.estimators.iter().filter(|c| c.lens == lens),
        |curve| curve.pupil,
    )
}

fn renderers(results: &Results, lens: &str) -> Chart {
    let line = |number, curve: &Curve| (curve.pupil.to_owned(), number, number / PALETTE.len());
    let mut chart = lines(
        WHOLE,
        results.ties().pictures.ratio,
        results.renderers.iter().filter(|c| c.lens == lens),
        line,
    );
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
    Chart { cost, error, series: with_front(series, results.ties().times.ratio), ..Chart::default() }
}

fn pupils(results: &Results, lens: &str) -> Chart {
    // Smallest values shown, as a share and a time in ms; smaller values are drawn here.
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

/// Draws stability cases by condition number, for the tracers in `shown`, with horizontal lines at `levels`.
fn cases(results: &Results, title: &str, shown: &[&'static str], levels: Vec<(f64, String)>) -> Chart {
    // Marks closer than about a pixel are drawn once, and exact results are drawn at the ratio `EXACT`.
    const GRAIN: f64 = 20.0;
    const EXACT: f64 = 1e-6;
    let mut drawn = BTreeSet::new();
    let series = shown.iter().enumerate().map(|(number, &tracer)| {
        // Cases without numbered rays have no condition number; only the table lists them.
        let own = results.stability.iter().filter(|case| case.tracer == tracer && case.condition > 0.0);
        let points = own
            .map(|case| [case.condition, case.ratio.max(EXACT)])
            .filter(|at| drawn.insert((number, at.map(|x| (x.log10() * GRAIN).round() as i64))));
        Series::marks(tracer, number, points.map(|at| Mark { at, ..Mark::default() }))
    });
    let (cost, error) = ("condition number", "error over what rounding is expected to do");
    Chart { title: title.to_owned(), cost, error, levels, series: series.collect() }
}

/// Makes the section on stability with its three charts.
fn of_stability(results: &Results) -> Section {
    let tracers = stability::tracers();
    let of = |norm: Norm| tracers.iter().filter(move |t| t.norm == norm);
    let named = |norm| of(norm).filter(|t| t.like == t.name).map(|t| t.name).collect::<Vec<_>>();
    let level = |bound: f64| (bound, format!("bound, {bound}"));
    let mut walk_levels = vec![level(stability::BOUND)];
    let looser = of(Norm::Own).filter(|t| t.bound > stability::BOUND);
    for tracer in looser {
        match walk_levels.iter_mut().skip(1).find(|(bound, _)| *bound == tracer.bound) {
            Some((_, name)) => *name = format!("{} and {name}", tracer.name),
            None => walk_levels.push((tracer.bound, format!("{}: bound, {}", tracer.name, tracer.bound))),
        }
    }
    let kernel_bound = of(Norm::Surface).map(|t| t.bound).fold(f64::INFINITY, f64::min);
    let (design, design_levels) = (["first order", "focus"], vec![level(stability::BOUND)]);
    let charts = [
        ("walks", cases(results, "plain loop", &named(Norm::Own), walk_levels)),
        ("kernels", cases(results, "compiled", &named(Norm::Surface), vec![level(kernel_bound)])),
        ("design", cases(results, "focal length, pupil and focus", &design, design_levels)),
    ];
    let figure = |(name, chart)| Figure { file: format!("stability-{name}"), chart };
    Section {
        anchor: "stability",
        title: "Stability: extreme lenses and rays",
        text: STABILITY,
        table: "stability",
        figures: charts.map(figure).into(),
        summary: Some(results.stability_summary()),
    }
}

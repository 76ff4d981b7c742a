//! The method for each need, according to the results: a table of needs by lens, and sentences about each lens.

use super::advice::percent;
use super::findings::{camera, exact, gain, listed, seconds, soonest, tracing};
use realistic_camera::Precision;
use realistic_camera::plan::Entry;
use realistic_lab::accuracy::curve::Curve;
use realistic_lab::accuracy::leaving_out::{Asked, Saving, TOLERANCES};
use realistic_lab::accuracy::ray_map::RayErrors;
use realistic_lab::accuracy::suite::{Results, Tie};
use realistic_lab::accuracy::{irradiance, pictures};
use realistic_lab::methods::Family;
use realistic_lab::stability;
use realistic_lab::subject::STOPPED_DOWN;

/// A need, and for each lens the method that meets it.
pub struct Answer {
    /// The need in words.
    pub need: String,
    /// Answers for each lens, in the report's order.
    pub by_lens: Vec<String>,
}

/// Error of a direction, rad, up to which a method counts as double precision.
const DOUBLE: f64 = 1e-12;

/// Returns every need with its answers. For rays, an answer is the method that a camera with the tolerance chose,
/// because a camera can use no other; a separate row states its cost.
pub fn answers(results: &Results) -> Vec<Answer> {
    let mut answers = Vec::new();
    let mut answer = |need: String, of: &dyn Fn(&str) -> Option<String>| {
        let by_lens = results.lenses.iter().map(|lens| of(lens).unwrap_or_else(|| "not measured".to_owned()));
        answers.push(Answer { need, by_lens: by_lens.collect() });
    };
    let double = Asked::Precision(Precision::F64);
    for (stopped_down, stop) in [(false, String::new()), (true, format!(" at f/{STOPPED_DOWN}"))] {
        for (entry, called) in [(Entry::Many, "rays in batches"), (Entry::One, "one ray at a time")] {
            for pixels in TOLERANCES {
                answer(format!("{called}{stop}, 99.9 % within {pixels} pixel"), &|lens| {
                    let own = camera(results, lens, stopped_down, entry, Asked::Tolerance(pixels))?;
                    Some(in_words(results, own))
                });
            }
            answer(format!("{called}{stop}, to double precision"), &|lens| {
                let own = camera(results, lens, stopped_down, entry, double)?;
                Some(format!("{}, {}", tracing(own.tracing), seconds(own.left_out.median)))
            });
        }
    }
    let [_, tolerance, _] = TOLERANCES;
    answer(format!("what \"tolerance\" {tolerance} chose wide open, and what it cost"), &|lens| {
        let [many, one] = [Entry::Many, Entry::One]
            .map(|entry| camera(results, lens, false, entry, Asked::Tolerance(tolerance)));
        Some(cost(results, many?, one?))
    });
    for error in irradiance::NEEDS {
        answer(format!("film irradiance within {} %", 100.0 * error), &|lens| {
            let curves = results.irradiance.iter().filter(|c| c.lens == lens);
            let name = |c: &Curve| format!("{}, {}, {}", c.pupil, c.disk, c.sequence);
            Some(soonest_in_words(curves, error, results.ties().irradiance, name))
        });
    }
    for error in pictures::NEEDS {
        answer(format!("the picture within {} % of its mean", 100.0 * error), &|lens| {
            let curves = results.renderers.iter().filter(|c| c.lens == lens);
            Some(soonest_in_words(curves, error, results.ties().pictures, |c| c.pupil.to_owned()))
        });
    }
    answers
}

/// Describes the method that a tolerance chose, the method's time, and its gain.
fn in_words(results: &Results, own: &Saving) -> String {
    let gain = match gain(results, own) {
        Some(share) if share > 0.0 => format!("{:.0} % less than double precision", 100.0 * share),
        Some(share) => format!("{:.0} % more than double precision", -100.0 * share),
        None => "a tie with double precision".to_owned(),
    };
    format!("{}, {}, {gain}", tracing(own.tracing), seconds(own.left_out.median))
}

/// Describes the methods that a tolerance chose in batches and one by one, the errors stated for them, and the time
/// to build such a camera.
fn cost(results: &Results, many: &Saving, one: &Saving) -> String {
    let chose = |own: &Saving| {
        let beside = exact(results, own).map_or(f64::NAN, |exact| exact.left_out.median);
        let error = own.pixels.map_or_else(String::new, |pixels| format!(", {pixels:.1e} pixel"));
        format!(
            "{}: {}{error}, {} against {}",
            own.entry,
            tracing(own.tracing),
            seconds(own.left_out.median),
            seconds(beside)
        )
    };
    let [build, exact_build] = many.build.map(seconds);
    format!("{}; {}; the camera is built in {build} instead of {exact_build}", chose(many), chose(one))
}

/// Describes the first curve to reach an error, and the curves that tie with it.
fn soonest_in_words<'a>(
    curves: impl Iterator<Item = &'a Curve>,
    error: f64,
    tie: Tie,
    name: impl Fn(&Curve) -> String,
) -> String {
    let soonest = soonest(curves, error, tie);
    let named: Vec<String> =
        soonest.first.iter().map(|(curve, time)| format!("{} ({})", name(curve), seconds(*time))).collect();
    match named.as_slice() {
        [] => "none within what was measured".to_owned(),
        [one] => one.clone(),
        [first, others @ ..] if others.len() > 2 => format!("{first}, a tie with {} others", others.len()),
        [first, others @ ..] => format!("{first}, a tie with {}", listed(others)),
    }
}

/// Describes the figures of each lens, and stability, in sentences under headings.
pub fn sentences(results: &Results) -> Vec<(&str, Vec<String>)> {
    let of_lens = |lens| {
        [kernels, polynomials, savings, pupils, estimators]
            .iter()
            .filter_map(|describe| describe(results, lens))
            .collect()
    };
    let lenses = results.lenses.iter().map(|&lens| (lens, of_lens(lens)));
    lenses.chain([("stability", stability(results))]).collect()
}

/// Returns the fastest of the selected methods on a lens.
fn fastest<'a>(
    results: &'a Results,
    lens: &str,
    is_selected: impl Fn(&RayErrors) -> bool,
) -> Option<&'a RayErrors> {
    let own = results.ray_map.iter().filter(|m| m.lens == lens && is_selected(m));
    own.min_by(|a, b| a.time.median.total_cmp(&b.time.median))
}

/// Whether the method traces to double precision.
fn is_exact(m: &RayErrors) -> bool {
    m.direction.worst <= DOUBLE
}

/// Describes the gain from compiling a lens.
fn kernels(results: &Results, lens: &str) -> Option<String> {
    let own = |is_selected: &dyn Fn(&RayErrors) -> bool| fastest(results, lens, is_selected);
    let walk = own(&|m| m.method.family() == Family::Walk && is_exact(m))?;
    let one = own(&|m| m.method.name.starts_with("one") && is_exact(m))?;
    let batch = own(&|m| m.method.family() == Family::KernelBatch && is_exact(m))?;
    let single = own(&|m| m.method.family() == Family::KernelBatch && !is_exact(m))?;
    let times = |m: &RayErrors| walk.time.median / m.time.median;
    Some(format!(
        "The compiled lens traces one ray exactly in {}, {:.0} times faster than the plain loop over the surfaces ({}); in \
         batches of {} it takes {} per ray ({:.0} times), and in {} {} ({:.0} times), 99.9 % of whose rays are within \
         {:.1e} pixel.",
        seconds(one.time.median),
        times(one),
        seconds(walk.time.median),
        batch.method.name,
        seconds(batch.time.median),
        times(batch),
        single.method.name,
        seconds(single.time.median),
        times(single),
        single.pixels.most,
    ))
}

/// Largest share of samples with a wrong fate (passed by the method and blocked by the lens, or the reverse); the
/// planner uses the same value.
const WRONG_FATES: f64 = 1e-3;

/// Describes the range in which polynomials are worth it.
fn polynomials(results: &Results, lens: &str) -> Option<String> {
    let kernel = fastest(results, lens, |m| m.method.family() == Family::KernelBatch)?;
    let tie = results.ties().times.ratio;
    let polynomials =
        results.ray_map.iter().filter(|m| m.lens == lens && m.method.family() == Family::PolynomialBatch);
    let faster = polynomials
        .filter(|m| tie * m.time.median <= kernel.time.median && m.wrong_fates() <= WRONG_FATES)
        .min_by(|a, b| a.pixels.most.total_cmp(&b.pixels.most));
    Some(match faster {
        Some(best) => format!(
            "Wide open, on a camera's samples and with the apertures that block them, of the polynomials in batches {} is \
             the nearest that is still faster than the exact trace: {:.1} times, within {:.1e} pixel against {:.1e}.",
            best.method.name,
            kernel.time.median / best.time.median,
            best.pixels.most,
            kernel.pixels.most,
        ),
        None => "Wide open, on a camera's samples and with the apertures that block them, no polynomial in batches is \
                 faster than the exact trace by more than a tie, or those that are send more than a thousandth of the rays \
                 past an aperture."
            .to_owned(),
    })
}

/// Describes the savings of the plan with a tolerance.
fn savings(results: &Results, lens: &str) -> Option<String> {
    let tie = results.ties().times.ratio;
    let is_own = |saving: &&Saving| saving.lens == lens && matches!(saving.request, Asked::Tolerance(_));
    let shares = results.leaving_out.iter().filter(is_own).map(|saving| saving.share()[1]);
    let (low, high) = shares.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    let is_tie = high <= 1.0 - 1.0 / tie && low >= 1.0 - tie;
    (low <= high).then(|| {
        format!(
            "What the plan leaves out with a tolerance of 0.01 to 1 pixel changes a camera ray's time, beside double precision \
             with everything kept, by {:+.1} to {:+.1} %{}.",
            -100.0 * high,
            -100.0 * low,
            if is_tie { ", a tie everywhere" } else { "" },
        )
    })
}

/// Describes the cost and gain of the pupil's table.
fn pupils(results: &Results, lens: &str) -> Option<String> {
    let own = |name: &str| results.pupils.iter().find(|m| m.lens == lens && m.name == name);
    let (rear, disk, warped) = (own("rear")?, own("disk")?, own("warped")?);
    Some(format!(
        "The warped pupil's table is built in {}; it misses {} of the pupil, and the lens blocks {} of its \
         samples. On the rear element's disk it blocks {}. The thick lens's exit pupil misses {}.",
        seconds(warped.time),
        percent(warped.missed),
        percent(warped.excess),
        percent(rear.excess),
        percent(disk.missed),
    ))
}

/// Describes the time that a sampler saves.
fn estimators(results: &Results, lens: &str) -> Option<String> {
    let own = |pupil: &str, sequence: &str| {
        let own = |c: &&Curve| (c.pupil, c.disk, c.sequence) == (pupil, "concentric", sequence);
        results.irradiance.iter().filter(|c| c.lens == lens).find(own)
    };
    let (random, rear, warped) = (own("rear", "random")?, own("rear", "Sobol'")?, own("warped", "Sobol'")?);
    let biased = own("disk", "Sobol'")?;
    let last = random.points.last()?;
    let saved = |curve: &Curve| curve.time_to(last.error).map(|time| format!("1/{:.0}", last.time / time));
    let bias = match 100.0 * biased.bias() {
        small if small < 0.1 => "less than 0.1 % off".to_owned(),
        percent => format!("{percent:.1} % off"),
    };
    Some(format!(
        "Film irradiance to {:.2} %, which random numbers on the rear disk reach with {} samples, takes Sobol' \
         numbers {} of that time on the same disk and {} on the warped pupil. The noise falls with the exponents \
         {:.2}, {:.2} and {:.2}. By the thick lens's exit pupil irradiance stays {bias} whatever the number of \
         samples.",
        100.0 * last.error,
        last.samples,
        saved(rear)?,
        saved(warped)?,
        random.slope(),
        rear.slope(),
        warped.slope(),
    ))
}

/// Returns one sentence for each tracer; tracers that give the same bits share a sentence.
fn stability(results: &Results) -> Vec<String> {
    let tracers = stability::tracers();
    let mut names: Vec<&'static str> = Vec::new();
    for case in &results.stability {
        if !names.contains(&case.tracer) {
            names.push(case.tracer);
        }
    }
    let of = |name: &str| results.stability.iter().filter(move |c| c.tracer == name).collect::<Vec<_>>();
    let figures = |name: &str| of(name).iter().map(|c| (c.ratio, c.fails_because())).collect::<Vec<_>>();
    // The first of the tracers with the same bits; a tracer whose figures differ nevertheless has its own sentence.
    let first = |name: &'static str| {
        let like = tracers.iter().find(|t| t.name == name).map_or(name, |t| t.like);
        if figures(like) == figures(name) { like } else { name }
    };
    let sentence = |&name: &&'static str| {
        let cases = of(name);
        let failed: Vec<_> = cases.iter().filter(|c| !c.holds()).collect();
        let verdict = match failed.as_slice() {
            [] => "none fails".to_owned(),
            some => {
                let list: Vec<String> =
                    some.iter().map(|c| format!("{}: {}", c.name, c.fails_because())).collect();
                format!("{} fail ({})", some.len(), list.join("; "))
            }
        };
        let same: Vec<&str> =
            names.iter().filter(|other| **other != name && first(other) == name).copied().collect();
        let same = if same.is_empty() {
            String::new()
        } else {
            format!(" ({}: the same figures in every case)", same.join("; "))
        };
        let worst = cases.iter().filter(|c| c.ratio > 0.0).max_by(|a, b| a.ratio.total_cmp(&b.ratio));
        let worst = worst.map_or_else(String::new, |case| {
            format!(
                "; the largest error is {:.1} times what rounding alone must be expected to do ({})",
                case.ratio, case.name
            )
        });
        format!("Stability of {name}{same}: of {} extreme cases {verdict}{worst}.", cases.len())
    };
    names.iter().filter(|name| first(name) == **name).map(sentence).collect()
}

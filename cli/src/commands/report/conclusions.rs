//! Which method for which need, read off the results: a table of needs by lens, and sentences about each lens.

use super::findings::{PIXELS, WORTH, all_hold, fastest, is_exact, seconds, soonest, time_to};
use realistic_lab::accuracy::curve::Curve;
use realistic_lab::accuracy::ray_map::RayErrors;
use realistic_lab::accuracy::suite::Results;
use realistic_lab::methods::Family;
use realistic_lab::stability;

/// A need, and what serves it on every lens.
pub struct Answer {
    /// The need in words.
    pub need: String,
    /// One for each lens, in the report's order.
    pub by_lens: Vec<String>,
}

/// Relative errors of irradiance that a need allows.
const IRRADIANCE: [f64; 2] = [1e-2, 2e-3];
/// Errors of pictures that a need allows.
const PICTURE: [f64; 2] = [0.2, 0.1];

/// Every need with its answers.
pub fn answers(results: &Results) -> Vec<Answer> {
    let mut answers = Vec::new();
    let mut answer = |need: String, of: &dyn Fn(&str) -> String| {
        answers.push(Answer { need, by_lens: results.lenses.iter().map(|lens| of(lens)).collect() });
    };
    for pixels in PIXELS {
        answer(format!("rays in batches, 99.9 % within {pixels} pixel"), &|lens| {
            method(results, lens, |m| m.pixels.most <= pixels)
        });
    }
    for pixels in PIXELS {
        answer(format!("one ray at a time, 99.9 % within {pixels} pixel"), &|lens| {
            method(results, lens, |m| alone(m) && m.pixels.most <= pixels)
        });
    }
    answer("rays in batches to double precision (1e-12 rad)".to_owned(), &|lens| {
        method(results, lens, is_exact)
    });
    answer("one ray at a time to double precision".to_owned(), &|lens| {
        method(results, lens, |m| alone(m) && is_exact(m))
    });
    for error in IRRADIANCE {
        answer(format!("film irradiance within {} %", 100.0 * error), &|lens| {
            let curves = results.irradiance.iter().filter(|c| c.lens == lens);
            let named = |c: &Curve| (format!("{}, {}, {}", c.pupil, c.disk, c.sequence), c.errors());
            soonest_in_words(curves.map(named), error)
        });
    }
    for error in PICTURE {
        answer(format!("the picture within {} % of its mean", 100.0 * error), &|lens| {
            let curves = results.renderers.iter().filter(|c| c.lens == lens);
            soonest_in_words(curves.map(|c| (c.pupil.to_owned(), c.errors())), error)
        });
    }
    answers
}

/// Whether the method takes a ray by itself.
fn alone(m: &RayErrors) -> bool {
    !m.method.family().in_batches() && !m.method.name.starts_with("three")
}

/// The fastest method that serves and loses no ray, in words.
fn method(results: &Results, lens: &str, serves: impl Fn(&RayErrors) -> bool) -> String {
    let Some(m) = fastest(results, lens, |m| m.lost == 0 && serves(m)) else {
        return "none of these".to_owned();
    };
    let family = match m.method.family() {
        Family::Polynomial => "polynomial of ",
        Family::PolynomialBatch => "batch polynomial of ",
        Family::Kernel | Family::KernelBatch => "kernel, ",
        Family::Gaussian | Family::Walk => "",
    };
    format!("{family}{}, {}", m.method.name, seconds(m.time.median))
}

fn soonest_in_words(curves: impl Iterator<Item = (String, Vec<(f64, f64)>)>, error: f64) -> String {
    soonest(curves, error).map_or_else(
        || "none within what was measured".to_owned(),
        |(name, time)| format!("{name}: {}", seconds(time)),
    )
}

/// What the figures say of each lens, and of stability, in sentences under headings.
pub fn sentences(results: &Results) -> Vec<(&str, Vec<String>)> {
    let of_lens = |lens| {
        [kernels, polynomials, pupils, estimators].iter().filter_map(|say| say(results, lens)).collect()
    };
    let lenses = results.lenses.iter().map(|&lens| (lens, of_lens(lens)));
    lenses.chain([("stability", stability(results))]).collect()
}

/// What compiling a lens gains.
fn kernels(results: &Results, lens: &str) -> Option<String> {
    let own = |wanted: &dyn Fn(&RayErrors) -> bool| fastest(results, lens, wanted);
    let walk = own(&|m| m.method.family() == Family::Walk && is_exact(m))?;
    let one = own(&|m| m.method.name.starts_with("one") && is_exact(m))?;
    let batch = own(&|m| m.method.family() == Family::KernelBatch && is_exact(m))?;
    let single = own(&|m| m.method.family() == Family::KernelBatch && !is_exact(m))?;
    let times = |m: &RayErrors| walk.time.median / m.time.median;
    Some(format!(
        "The kernel traces one ray exactly in {}, {:.0} times faster than the walk ({}); in batches of {} it \
         takes {} per ray ({:.0} times), and in {} {} ({:.0} times), whose error at the 99.9 % quantile is {:.1e} \
         pixel.",
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

/// Up to where polynomials are worth it.
fn polynomials(results: &Results, lens: &str) -> Option<String> {
    let kernel = fastest(results, lens, |m| m.method.family() == Family::KernelBatch)?;
    let polynomials =
        results.ray_map.iter().filter(|m| m.lens == lens && m.method.family() == Family::PolynomialBatch);
    let faster = polynomials
        .filter(|m| m.time.median < WORTH * kernel.time.median)
        .min_by(|a, b| a.pixels.most.total_cmp(&b.pixels.most));
    Some(match faster {
        Some(best) => format!(
            "Of the polynomials in batches {} is the most exact that is still faster than the exact kernel: {:.1} \
             times, at {:.1e} pixel against {:.1e}.",
            best.method.name,
            kernel.time.median / best.time.median,
            best.pixels.most,
            kernel.pixels.most,
        ),
        None => "No polynomial in batches is faster than the exact kernel.".to_owned(),
    })
}

/// What the pupil's table costs and gains.
fn pupils(results: &Results, lens: &str) -> Option<String> {
    let own = |name: &str| results.pupils.iter().find(|m| m.lens == lens && m.name == name);
    let (rear, disk, warped) = (own("rear")?, own("disk")?, own("warped")?);
    let percent = |share: f64| match 100.0 * share {
        none if none < 1e-4 => "less than 0.0001 %".to_owned(),
        small if small < 0.1 => format!("{small:.4} %"),
        more => format!("{more:.1} %"),
    };
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

/// How much time a sampler saves.
fn estimators(results: &Results, lens: &str) -> Option<String> {
    let own = |pupil: &str, sequence: &str| {
        let own = |c: &&Curve| (c.pupil, c.disk, c.sequence) == (pupil, "concentric", sequence);
        results.irradiance.iter().filter(|c| c.lens == lens).find(own)
    };
    let (random, rear, warped) = (own("rear", "random")?, own("rear", "Sobol'")?, own("warped", "Sobol'")?);
    let biased = own("disk", "Sobol'")?;
    let last = random.points.last()?;
    let saved =
        |curve: &Curve| time_to(&curve.errors(), last.error).map(|time| format!("1/{:.0}", last.time / time));
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

/// One for each tracer, those that give the same bits together.
fn stability(results: &Results) -> Vec<String> {
    let tracers = stability::tracers();
    let mut names: Vec<&'static str> = Vec::new();
    for case in &results.stability {
        if !names.contains(&case.tracer) {
            names.push(case.tracer);
        }
    }
    let of = |name: &str| results.stability.iter().filter(move |c| c.tracer == name).collect::<Vec<_>>();
    let figures = |name: &str| of(name).iter().map(|c| (c.ratio, c.disagreements)).collect::<Vec<_>>();
    // The first of those that give the same bits; one whose figures differ all the same stands alone.
    let first = |name: &'static str| {
        let like = tracers.iter().find(|t| t.name == name).map_or(name, |t| t.like);
        if figures(like) == figures(name) { like } else { name }
    };
    let sentence = |&name: &&'static str| {
        let cases = of(name);
        let failed = cases.iter().filter(|c| !c.holds).count();
        let same: Vec<&str> =
            names.iter().filter(|other| **other != name && first(other) == name).copied().collect();
        let same = if same.is_empty() {
            String::new()
        } else {
            format!(" ({}: the same figures in every case)", same.join("; "))
        };
        let worst = cases.iter().filter(|c| c.ratio > 0.0).max_by(|a, b| a.ratio.total_cmp(&b.ratio));
        let worst = worst.map_or_else(String::new, |case| {
            format!("; the worst error / (condition x epsilon) is {:.1} ({})", case.ratio, case.name)
        });
        format!("Stability of {name}{same}: of {} extreme cases {}{worst}.", cases.len(), all_hold(failed))
    };
    names.iter().filter(|name| first(name) == **name).map(sentence).collect()
}

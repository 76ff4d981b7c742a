//! Which method for which need, read off the results.

use super::advice::{WORTH, seconds};
use realistic_lab::irradiance::Curve;
use realistic_lab::ray_map::{Family, Measured};
use realistic_lab::stability;
use realistic_lab::suite::Results;

/// A need, and what serves it on every lens.
pub struct Answer {
    /// The need in words.
    pub need: String,
    /// One a lens, in the report's order.
    pub by_lens: Vec<String>,
}

/// Error at the 99.9 % quantile, pixels, that a need allows.
pub const PIXELS: [f64; 3] = [1.0, 0.1, 0.01];
/// Error of a direction, rad, that counts as double precision.
pub const DOUBLE: f64 = 1e-12;
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
            fastest(results, lens, |m| m.pixels.most <= pixels)
        });
    }
    for pixels in PIXELS {
        answer(format!("one ray at a time, 99.9 % within {pixels} pixel"), &|lens| {
            fastest(results, lens, |m| alone(m) && m.pixels.most <= pixels)
        });
    }
    answer("rays in batches to double precision (1e-12 rad)".to_owned(), &|lens| {
        fastest(results, lens, |m| m.direction.worst <= DOUBLE)
    });
    answer("one ray at a time to double precision".to_owned(), &|lens| {
        fastest(results, lens, |m| alone(m) && m.direction.worst <= DOUBLE)
    });
    for error in IRRADIANCE {
        answer(format!("film irradiance within {} %", 100.0 * error), &|lens| {
            let curves = results.irradiance.iter().filter(|c| c.lens == lens).map(|c| {
                let points: Vec<_> = c.points.iter().map(|p| (p.time, p.error)).collect();
                (format!("{}, {}, {}", c.pupil, c.disk, c.sequence), points)
            });
            soonest_in_words(curves, error)
        });
    }
    for error in PICTURE {
        answer(format!("the picture within {} % of its mean", 100.0 * error), &|lens| {
            let curves = results
                .renderers
                .iter()
                .filter(|c| c.lens == lens)
                .map(|c| (c.first.to_owned(), c.points.iter().map(|p| (p.time, p.error)).collect()));
            soonest_in_words(curves, error)
        });
    }
    answers
}

/// Whether the method takes a ray by itself.
fn alone(m: &Measured) -> bool {
    !m.method.family.in_batches() && !m.method.name.starts_with("three")
}

fn fastest(results: &Results, lens: &str, serves: impl Fn(&Measured) -> bool) -> String {
    let own = results.ray_map.iter().filter(|m| m.lens == lens && m.lost == 0 && serves(m));
    own.min_by(|a, b| a.time.median.total_cmp(&b.time.median)).map_or_else(
        || "none of these".to_owned(),
        |m| {
            let kind = match m.method.family {
                Family::Polynomial => "polynomial of ",
                Family::PolynomialBatch => "batch polynomial of ",
                Family::Kernel | Family::KernelBatch => "kernel, ",
                Family::Gaussian | Family::Walk => "",
            };
            format!("{kind}{}, {}", m.method.name, seconds(m.time.median))
        },
    )
}

/// The curve that first gets and stays below an error, and when, between its points by the power law through
/// them.
pub fn soonest<T>(curves: impl Iterator<Item = (T, Vec<(f64, f64)>)>, error: f64) -> Option<(T, f64)> {
    let reached = curves.filter_map(|(name, points)| Some((name, time_to(&points, error)?)));
    reached.min_by(|a, b| a.1.total_cmp(&b.1))
}

fn soonest_in_words(curves: impl Iterator<Item = (String, Vec<(f64, f64)>)>, error: f64) -> String {
    soonest(curves, error).map_or_else(
        || "none within what was measured".to_owned(),
        |(name, time)| format!("{name}: {}", seconds(time)),
    )
}

/// When a curve of (time, error) reaches an error for good; `None` where it does not.
fn time_to(points: &[(f64, f64)], error: f64) -> Option<f64> {
    let last_above = points.iter().rposition(|(_, own)| *own > error);
    let Some(above) = last_above else {
        return points.first().map(|(time, _)| *time);
    };
    let (&(t0, e0), &(t1, e1)) = (points.get(above)?, points.get(above + 1)?);
    let share = (e0 / error).ln() / (e0 / e1).ln();
    Some(t0 * (t1 / t0).powf(share))
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
    let own = |wanted: &dyn Fn(&&Measured) -> bool| {
        let all = results.ray_map.iter().filter(|m| m.lens == lens);
        all.filter(wanted).min_by(|a, b| a.time.median.total_cmp(&b.time.median))
    };
    let exact = |m: &&Measured| m.direction.worst <= DOUBLE;
    let walk = own(&|m| m.method.family == Family::Walk && exact(m))?;
    let one = own(&|m| m.method.name.starts_with("one") && exact(m))?;
    let batch = own(&|m| m.method.family == Family::KernelBatch && exact(m))?;
    let single = own(&|m| m.method.family == Family::KernelBatch && !exact(m))?;
    let times = |m: &Measured| walk.time.median / m.time.median;
    Some(format!(
        "The kernel traces one ray exactly in {}, {:.0} times faster than the walk ({}); in batches of {} it \
         takes {} a ray ({:.0} times), and in {} {} ({:.0} times), whose error at the 99.9 % quantile is {:.1e} pixel.",
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
    let own = || results.ray_map.iter().filter(|m| m.lens == lens);
    let kernel = own()
        .filter(|m| m.method.family == Family::KernelBatch)
        .min_by(|a, b| a.time.median.total_cmp(&b.time.median))?;
    let faster = own()
        .filter(|m| m.method.family == Family::PolynomialBatch && m.time.median < WORTH * kernel.time.median)
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
    let saved = |curve: &Curve| {
        let points: Vec<_> = curve.points.iter().map(|p| (p.time, p.error)).collect();
        time_to(&points, last.error).map(|time| format!("1/{:.0}", last.time / time))
    };
    let bias = match 100.0 * biased.bias {
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
        random.slope,
        rear.slope,
        warped.slope,
    ))
}

/// One for each tracer, those that give the same bits together.
fn stability(results: &Results) -> Vec<String> {
    let kernels = stability::kernels();
    let mut names: Vec<&str> = Vec::new();
    for case in &results.stability {
        if !names.contains(&case.kernel) {
            names.push(case.kernel);
        }
    }
    let of = |name: &str| results.stability.iter().filter(move |c| c.kernel == name).collect::<Vec<_>>();
    let figures = |name: &str| of(name).iter().map(|c| (c.ratio, c.disagreements)).collect::<Vec<_>>();
    let like = |name: &str| kernels.iter().find(|k| k.name == name).map(|k| k.like);
    // What is like another and has its figures to the last digit is told with that one.
    let told = |name: &str| like(name).is_some_and(|first| first != name && figures(first) == figures(name));
    let sentence = |name: &&str| {
        let cases = of(name);
        let failed = cases.iter().filter(|c| !c.holds).count();
        let verdict = if failed == 0 { "all hold".to_owned() } else { format!("{failed} do not hold") };
        let same: Vec<&str> =
            names.iter().filter(|other| told(other) && like(other) == Some(name)).copied().collect();
        let same = if same.is_empty() {
            String::new()
        } else {
            format!(" ({}: the same figures in every case)", same.join("; "))
        };
        let worst = cases.iter().filter(|c| c.ratio > 0.0).max_by(|a, b| a.ratio.total_cmp(&b.ratio));
        let mut text = format!("Stability of {name}{same}: of {} extreme cases {verdict}", cases.len());
        if let Some(case) = worst {
            text +=
                &format!("; the worst error / (condition x epsilon) is {:.1} ({})", case.ratio, case.name);
        }
        text + "."
    };
    names.iter().filter(|name| !told(name)).map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_to_an_error_lies_on_the_power_law_between_points() {
        let points = [(1.0, 1.0), (4.0, 0.5), (16.0, 0.25)];
        assert!((time_to(&points, 0.3535533905932738).expect("reached") - 8.0).abs() < 1e-9);
        assert_eq!(time_to(&points, 2.0), Some(1.0));
        assert_eq!(time_to(&points, 0.1), None);
        // It counts where the curve stays below.
        assert!(time_to(&[(1.0, 0.1), (2.0, 1.0), (4.0, 0.1)], 0.2).expect("reached") > 2.0);
    }
}

//! Which method for which need, read off the results.

use realistic::report::ray_map::{Family, Measured};
use realistic::report::suite::Results;

/// A need, and what serves it on every lens.
pub struct Answer {
    /// The need in words.
    pub need: String,
    /// One a lens, in the report's order.
    pub by_lens: Vec<String>,
}

/// Error at the 99.9 % quantile, pixels, that a need allows.
const PIXELS: [f64; 4] = [1.0, 0.1, 0.01, 0.001];
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
        answer(format!("a ray within {pixels} pixel, 99.9 %"), &|lens| {
            fastest(results, lens, |m| m.pixels.most <= pixels)
        });
    }
    answer("a ray traced surface by surface".to_owned(), &|lens| {
        fastest(results, lens, |m| matches!(m.method.family, Family::Exact | Family::Lecture))
    });
    answer("a ray to double precision (1e-12 rad)".to_owned(), &|lens| {
        fastest(results, lens, |m| m.direction.worst <= 1e-12)
    });
    for error in IRRADIANCE {
        answer(format!("film irradiance within {} %", 100.0 * error), &|lens| {
            let curves = results.irradiance.iter().filter(|c| c.lens == lens).map(|c| {
                let points: Vec<_> = c.points.iter().map(|p| (p.time, p.error)).collect();
                (format!("{}, {}, {}", c.pupil, c.disk, c.sequence), points)
            });
            soonest(curves, error)
        });
    }
    for error in PICTURE {
        answer(format!("the picture within {} % of its mean", 100.0 * error), &|lens| {
            let curves = results
                .renderers
                .iter()
                .filter(|c| c.lens == lens)
                .map(|c| (c.first.to_owned(), c.points.iter().map(|p| (p.time, p.error)).collect()));
            soonest(curves, error)
        });
    }
    answers
}

fn fastest(results: &Results, lens: &str, serves: impl Fn(&Measured) -> bool) -> String {
    let own = results.ray_map.iter().filter(|m| m.lens == lens && m.lost == 0 && serves(m));
    own.min_by(|a, b| a.time.median.total_cmp(&b.time.median)).map_or_else(
        || "none of these".to_owned(),
        |m| {
            let kind = match m.method.family {
                Family::Polynomial => "polynomial of ",
                Family::PolynomialBatch => "batch polynomial of ",
                Family::Exact => "exact walk in ",
                Family::Lecture => "exact walk, refraction ",
                Family::Gaussian => "",
            };
            format!("{kind}{}, {}", m.method.name, seconds(m.time.median))
        },
    )
}

/// The curve that first gets and stays below an error, and when, between its points by the power law through
/// them.
fn soonest(curves: impl Iterator<Item = (String, Vec<(f64, f64)>)>, error: f64) -> String {
    let reached = curves.filter_map(|(name, points)| Some((name, time_to(&points, error)?)));
    reached.min_by(|a, b| a.1.total_cmp(&b.1)).map_or_else(
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

/// A time with a unit that keeps it readable.
pub fn seconds(time: f64) -> String {
    let (number, unit) = match time {
        t if t < 1e-6 => (t * 1e9, "ns"),
        t if t < 1e-3 => (t * 1e6, "µs"),
        t if t < 1.0 => (t * 1e3, "ms"),
        t => (t, "s"),
    };
    let digits = if number < 10.0 { 1 } else { 0 };
    format!("{number:.digits$} {unit}")
}

/// What the figures say, in sentences.
pub fn sentences(results: &Results) -> Vec<String> {
    let mut sentences = by_lens(results);
    sentences.extend(stability(results));
    sentences
}

/// One for each tracer.
fn stability(results: &Results) -> Vec<String> {
    let mut sentences: Vec<(&str, String)> = Vec::new();
    for case in &results.stability {
        if sentences.iter().any(|(kernel, _)| *kernel == case.kernel) {
            continue;
        }
        let own = || results.stability.iter().filter(|c| c.kernel == case.kernel);
        let (cases, failed) = (own().count(), own().filter(|c| !c.holds).count());
        let verdict = if failed == 0 { "all hold".to_owned() } else { format!("{failed} do not hold") };
        let ratio = own().map(|c| c.ratio).fold(0.0, f64::max);
        let text = format!(
            "Stability of {}: of {cases} extreme cases {verdict}; the worst error / (condition x epsilon) is {ratio:.1}.",
            case.kernel
        );
        sentences.push((case.kernel, text));
    }
    sentences.into_iter().map(|(_, text)| text).collect()
}

fn by_lens(results: &Results) -> Vec<String> {
    results
        .lenses
        .iter()
        .filter_map(|lens| {
            let bias = results.irradiance.iter().find(|c| c.lens == *lens && c.pupil == "disk" && c.sequence == "Sobol'")?;
            let own = |disk: &str, sequence: &str| {
                results
                    .irradiance
                    .iter()
                    .find(|c| c.lens == *lens && c.pupil == "rear" && c.disk == disk && c.sequence == sequence)
            };
            let (random, best) = (own("concentric", "random")?, own("concentric", "Sobol'")?);
            let error = random.points.last()?.error;
            let needs = |curve: &realistic::report::irradiance::Curve| {
                time_to(&curve.points.iter().map(|p| (p.time, p.error)).collect::<Vec<_>>(), error)
            };
            let bias = match 100.0 * bias.bias {
                small if small < 0.1 => "is less than 0.1 % off".to_owned(),
                percent => format!("is {percent:.1} % off whatever the number of samples"),
            };
            Some(format!(
                "{lens}: film irradiance by the thick lens's exit pupil (disk) {bias}. For the error that random numbers \
                 on the rear disk reach with {} samples ({:.2} %), Sobol' numbers need 1/{:.0} of the time; their noise \
                 falls with exponent {:.2}, random numbers' with {:.2}.",
                random.points.last()?.samples,
                100.0 * error,
                needs(random)? / needs(best)?,
                best.slope,
                random.slope,
            ))
        })
        .collect()
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

    #[test]
    fn times_are_readable() {
        assert_eq!([5.2e-9, 1.5e-7, 2.34e-4, 12.0].map(seconds), ["5.2 ns", "150 ns", "234 µs", "12 s"]);
    }
}

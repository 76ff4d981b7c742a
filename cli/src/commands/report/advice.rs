//! Which method for which need, in a few sentences about all the lenses together.

use super::conclusions::{DOUBLE, PIXELS, soonest};
use realistic_lab::ray_map::{Family, Measured};
use realistic_lab::stability;
use realistic_lab::suite::Results;

/// A model is worth naming where it takes less than this part of the exact kernel's time.
pub const WORTH: f64 = 0.9;

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

/// The advice.
pub fn advice(results: &Results) -> Vec<String> {
    [batches, single_rays, models, samplers, pictures, tracers]
        .iter()
        .filter_map(|say| say(results))
        .collect()
}

/// From the least of some times to the greatest.
fn range(times: impl Iterator<Item = f64> + Clone) -> String {
    let (low, high) = (times.clone().fold(f64::INFINITY, f64::min), times.fold(0.0, f64::max));
    format!("{} to {}", seconds(low), seconds(high))
}

/// The rows of the method that is the fastest on most lenses of those wanted.
fn usual(results: &Results, wanted: impl Fn(&Measured) -> bool) -> Option<Vec<&Measured>> {
    let fastest = |lens: &&str| {
        let own = results.ray_map.iter().filter(|m| m.lens == **lens && wanted(m));
        own.min_by(|a, b| a.time.median.total_cmp(&b.time.median)).map(|m| m.method.name)
    };
    let name = most_frequent(results.lenses.iter().filter_map(fastest))?.0;
    Some(results.ray_map.iter().filter(|m| m.method.name == name).collect())
}

/// The word that comes most often, and how often.
fn most_frequent<T: PartialEq + Clone>(words: impl Iterator<Item = T> + Clone) -> Option<(T, usize)> {
    let times = |word: &T| words.clone().filter(|other| other == word).count();
    words.clone().map(|word| (word.clone(), times(&word))).max_by_key(|(_, count)| *count)
}

fn times_of<'a>(rows: &'a [&Measured]) -> impl Iterator<Item = f64> + Clone + 'a {
    rows.iter().map(|m| m.time.median)
}

fn batches(results: &Results) -> Option<String> {
    let fast = usual(results, |m| m.method.family == Family::KernelBatch)?;
    let exact = usual(results, |m| m.method.family == Family::KernelBatch && m.direction.worst <= DOUBLE)?;
    let error = fast.iter().map(|m| m.pixels.most).fold(0.0, f64::max);
    Some(format!(
        "Many rays at once: the kernel in {}, {} a ray on these lenses, 99.9 % of the rays within {error:.1e} pixel. \
         Where double precision is wanted: {}, {}.",
        fast.first()?.method.name,
        range(times_of(&fast)),
        exact.first()?.method.name,
        range(times_of(&exact)),
    ))
}

fn single_rays(results: &Results) -> Option<String> {
    let rows = |name: &str| results.ray_map.iter().filter(|m| m.method.name == name).collect::<Vec<_>>();
    let (double, single, three) = (rows("one f64"), rows("one f32"), rows("three f64"));
    let total = |rows: &[&Measured]| times_of(rows).sum::<f64>();
    (!double.is_empty() && !single.is_empty()).then(|| {
        format!(
            "One ray at a time: the kernel in double precision, {}; single precision takes {:.0} % of that. A ray \
             with its two differentials takes {:.1} times as long as a ray alone.",
            range(times_of(&double)),
            100.0 * total(&single) / total(&double),
            3.0 * total(&three) / total(&double),
        )
    })
}

/// Where a model that leaves surfaces out is worth it.
fn models(results: &Results) -> Option<String> {
    let gain = |lens: &str, pixels: f64| {
        let own = || results.ray_map.iter().filter(|m| m.lens == lens && m.pixels.most <= pixels);
        let least = |rows: &mut dyn Iterator<Item = &Measured>| {
            rows.map(|m| m.time.median).fold(f64::INFINITY, f64::min)
        };
        let model = least(
            &mut own().filter(|m| matches!(m.method.family, Family::Gaussian | Family::PolynomialBatch)),
        );
        let kernel = least(&mut own().filter(|m| m.method.family == Family::KernelBatch));
        (model < WORTH * kernel).then_some(kernel / model)
    };
    let at = |pixels: &f64| {
        let gains: Vec<f64> = results.lenses.iter().filter_map(|lens| gain(lens, *pixels)).collect();
        let most = gains.iter().copied().fold(0.0, f64::max);
        match gains.len() {
            0 => format!("within {pixels} pixel on none of the {} lenses", results.lenses.len()),
            n => format!(
                "within {pixels} pixel on {n} of {} lenses, up to {most:.1} times",
                results.lenses.len()
            ),
        }
    };
    (!results.lenses.is_empty()).then(|| {
        let all: Vec<String> = PIXELS.iter().map(at).collect();
        format!(
            "A polynomial or the thick lens in batches is faster than the exact kernel {}.",
            all.join("; ")
        )
    })
}

/// The error of irradiance that samplers are compared at.
const IRRADIANCE: f64 = 0.01;

fn samplers(results: &Results) -> Option<String> {
    let best = |lens: &&str| {
        let curves = results.irradiance.iter().filter(|c| c.lens == **lens);
        let points =
            |c: &realistic_lab::irradiance::Curve| c.points.iter().map(|p| (p.time, p.error)).collect();
        soonest(curves.map(|c| ((c.pupil, c.sequence), points(c))), IRRADIANCE)
    };
    let bests: Vec<_> = results.lenses.iter().filter_map(best).map(|(name, _)| name).collect();
    let (pupil, wins) = most_frequent(bests.iter().map(|(pupil, _)| *pupil))?;
    let sequences: Vec<&str> = bests.iter().map(|(_, sequence)| *sequence).collect();
    let (sequence, times) = most_frequent(sequences.iter().copied())?;
    Some(format!(
        "Film irradiance within {} %: soonest by the pupil \"{pupil}\" on {wins} of {} lenses, with {sequence} \
         numbers on {times}.",
        100.0 * IRRADIANCE,
        results.lenses.len(),
    ))
}

fn pictures(results: &Results) -> Option<String> {
    let best = |lens: &&str| {
        let own = || results.renderers.iter().filter(|c| c.lens == **lens);
        // What the exact way that gets nearest reaches, with a little room.
        let least = own().filter_map(|c| c.points.last()).map(|p| p.error).fold(f64::INFINITY, f64::min);
        let points = |c: &realistic_lab::picture::Curve| c.points.iter().map(|p| (p.time, p.error)).collect();
        soonest(own().map(|c| (c.first, points(c))), 1.1 * least)
    };
    let bests: Vec<_> = results.lenses.iter().filter_map(best).map(|(name, _)| name).collect();
    let (name, wins) = most_frequent(bests.iter().copied())?;
    Some(format!(
        "Whole pictures: \"{name}\" comes soonest within a tenth of the least error that any way reaches, on {wins} \
         of {} lenses.",
        results.lenses.len(),
    ))
}

fn tracers(results: &Results) -> Option<String> {
    let failed = results.stability.iter().filter(|c| !c.holds).count();
    let worst = |wanted: &dyn Fn(&str) -> bool| {
        let own = results.stability.iter().filter(|c| wanted(c.kernel));
        own.map(|c| c.ratio).fold(0.0, f64::max)
    };
    let kernels = stability::kernels();
    let compiled = |name: &str| {
        kernels.iter().any(|k| k.name == name && k.norm == realistic_lab::condition::Norm::Surface)
    };
    (!results.stability.is_empty()).then(|| {
        format!(
            "Stability: of {} results of extreme cases {}. The worst error / (condition x epsilon) is {:.1} for the \
             compiled kernels and {:.1} for the walks.",
            results.stability.len(),
            if failed == 0 { "all hold".to_owned() } else { format!("{failed} do not hold") },
            worst(&compiled),
            worst(&|name| !compiled(name)),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_readable() {
        assert_eq!([5.2e-9, 1.5e-7, 2.34e-4, 12.0].map(seconds), ["5.2 ns", "150 ns", "234 µs", "12 s"]);
    }

    #[test]
    fn the_most_frequent_word_is_found() {
        assert_eq!(most_frequent(["a", "b", "b"].into_iter()), Some(("b", 2)));
        assert_eq!(most_frequent(std::iter::empty::<&str>()), None);
    }

    #[test]
    fn of_nothing_nothing_is_said() {
        assert_eq!(advice(&Results::default()), Vec::<String>::new());
    }
}

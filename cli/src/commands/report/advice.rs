//! Which method for which need: results in, a few sentences about all the lenses together out.

use super::findings::{PIXELS, WORTH, all_hold, fastest, is_exact, seconds, soonest};
use realistic_lab::accuracy::ray_map::RayErrors;
use realistic_lab::accuracy::suite::Results;
use realistic_lab::methods::Family;
use realistic_lab::reference::condition::Norm;
use realistic_lab::stability;

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
fn usual(results: &Results, wanted: impl Fn(&RayErrors) -> bool) -> Option<Vec<&RayErrors>> {
    let name = |lens: &&str| fastest(results, lens, &wanted).map(|m| m.method.name);
    let name = most_frequent(results.lenses.iter().filter_map(name))?.0;
    Some(results.ray_map.iter().filter(|m| m.method.name == name).collect())
}

/// The word that comes most often, and how often.
fn most_frequent<T: PartialEq + Clone>(words: impl Iterator<Item = T> + Clone) -> Option<(T, usize)> {
    let times = |word: &T| words.clone().filter(|other| other == word).count();
    words.clone().map(|word| (word.clone(), times(&word))).max_by_key(|(_, count)| *count)
}

fn times_of<'a>(rows: &'a [&RayErrors]) -> impl Iterator<Item = f64> + Clone + 'a {
    rows.iter().map(|m| m.time.median)
}

fn batches(results: &Results) -> Option<String> {
    let fast = usual(results, |m| m.method.family() == Family::KernelBatch)?;
    let exact = usual(results, |m| m.method.family() == Family::KernelBatch && is_exact(m))?;
    let error = fast.iter().map(|m| m.pixels.most).fold(0.0, f64::max);
    Some(format!(
        "Many rays at once: the kernel in {}, {} per ray on these lenses, 99.9 % of the rays within {error:.1e} pixel. \
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
    let total = |rows: &[&RayErrors]| times_of(rows).sum::<f64>();
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
        let time = |families: &[Family]| {
            let serves = |m: &RayErrors| m.pixels.most <= pixels && families.contains(&m.method.family());
            fastest(results, lens, serves).map_or(f64::INFINITY, |m| m.time.median)
        };
        let model = time(&[Family::Gaussian, Family::PolynomialBatch]);
        let kernel = time(&[Family::KernelBatch]);
        (model < WORTH * kernel).then_some(kernel / model)
    };
    let at = |pixels: &f64| {
        let gains: Vec<f64> = results.lenses.iter().filter_map(|lens| gain(lens, *pixels)).collect();
        let most = gains.iter().copied().fold(0.0, f64::max);
        let lenses = results.lenses.len();
        match gains.len() {
            0 => format!("within {pixels} pixel on none of the {lenses} lenses"),
            n => format!("within {pixels} pixel on {n} of {lenses} lenses, up to {most:.1} times"),
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
        soonest(curves.map(|c| ((c.pupil, c.sequence), c.errors())), IRRADIANCE)
    };
    let bests: Vec<_> = results.lenses.iter().filter_map(best).map(|(name, _)| name).collect();
    let (pupil, wins) = most_frequent(bests.iter().map(|(pupil, _)| *pupil))?;
    let (sequence, times) = most_frequent(bests.iter().map(|(_, sequence)| *sequence))?;
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
        soonest(own().map(|c| (c.pupil, c.errors())), 1.1 * least)
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
    let tracers = stability::tracers();
    let is_compiled = |name: &str| tracers.iter().any(|t| t.name == name && t.norm == Norm::Surface);
    let worst = |compiled: bool| {
        let own = results.stability.iter().filter(|c| is_compiled(c.tracer) == compiled);
        own.map(|c| c.ratio).fold(0.0, f64::max)
    };
    (!results.stability.is_empty()).then(|| {
        format!(
            "Stability: of {} results of extreme cases {}. The worst error / (condition x epsilon) is {:.1} for the \
             compiled kernels and {:.1} for the walks.",
            results.stability.len(),
            all_hold(failed),
            worst(true),
            worst(false),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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

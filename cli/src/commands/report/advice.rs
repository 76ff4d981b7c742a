//! Advice on the method for each need, written from the results: a paragraph, and a few sentences about all lenses. A
//! difference within the threshold of the run is called a tie and does not count.

use super::findings::{camera, range, saved, soonest};
use realistic_camera::Precision;
use realistic_camera::plan::{Entry, Tracing};
use realistic_lab::accuracy::curve::Curve;
use realistic_lab::accuracy::irradiance;
use realistic_lab::accuracy::leaving_out::{Asked, Saving, TOLERANCES};
use realistic_lab::accuracy::suite::{Results, Suite};
use realistic_lab::stability::{Extent, RAYS_EACH};
use realistic_lab::subject::STOPPED_DOWN;

/// Returns the overall result in one paragraph.
pub fn what_to_use_when(results: &Results) -> Option<String> {
    let times = |entry, precision| {
        let request = Asked::Precision(precision);
        let of = move |lens: &&'static str| camera(results, lens, false, entry, request);
        range(results.lenses.iter().filter_map(of).map(|saving| saving.left_out.median))
    };
    if results.leaving_out.is_empty() {
        return None;
    }
    let [batches, single] = [Entry::Many, Entry::One].map(|entry| gains(results, entry, TOLERANCES[0]));
    let warped = match wins(results, |c| c.pupil, |pupil| *pupil == "warped") {
        0 => {
            "leave \"pupil\" at \"warped\", which spends no samples on light that the lens blocks".to_owned()
        }
        wins => format!(
            "leave \"pupil\" at \"warped\": film irradiance settles soonest by it on {wins} of {} lenses",
            results.lenses.len()
        ),
    };
    Some(format!(
        "Ask for many rays in one call wherever the renderer can: a ray then takes {} in double precision and {} in \
         single, one by one {}. Set \"tolerance\" to the error that the picture can bear, in pixels, and let the camera \
         choose what to trace by: beside double precision, with 1 pixel that {batches} in batches, and {single} one by one. \
         It never takes what is further off. And {warped}.",
        times(Entry::Many, Precision::F64),
        times(Entry::Many, Precision::F32),
        times(Entry::One, Precision::F64),
    ))
}

/// Counts the lenses, wide open or stopped down, on which a tolerance saves more than the threshold of a tie, and
/// states how much it saves.
fn gains(results: &Results, entry: Entry, tolerance: f64) -> String {
    let own = || {
        let own = results.leaving_out.iter();
        own.filter(|saving| saving.entry == entry && saving.request == Asked::Tolerance(tolerance))
    };
    let gains: Vec<f64> = own().filter_map(|saving| saved(results, saving)).collect();
    let (low, high) = gains.iter().fold((1.0_f64, 0.0_f64), |(l, h), &x| (l.min(x), h.max(x)));
    let [low, high] = [low, high].map(|share| format!("{:.0}", 100.0 * share));
    let shares = if low == high { low } else { format!("{low} to {high}") };
    match gains.len() {
        0 => "saves nothing beyond a tie".to_owned(),
        n => format!("saves {shares} % of the time in {n} of {} cases", own().count()),
    }
}

/// Counts the lenses on which each kind of pupil, or of sequence, is the first to reach the error at which samplers
/// are compared.
fn wins<T: PartialEq>(
    results: &Results,
    of: impl Fn(&Curve) -> T,
    is_selected: impl Fn(&T) -> bool,
) -> usize {
    let tie = results.ties().irradiance;
    let first = |lens: &&&str| {
        let curves = results.irradiance.iter().filter(|c| c.lens == ***lens);
        soonest(curves, IRRADIANCE, tie).common(&of).is_some_and(|kind| is_selected(&kind))
    };
    results.lenses.iter().filter(first).count()
}

/// Relative error of irradiance at which samplers are compared.
const IRRADIANCE: f64 = irradiance::NEEDS[0];

/// Returns the advice, one need after another.
pub fn advice(results: &Results, suite: &Suite) -> Vec<String> {
    let all: [Option<String>; 5] = [
        models(results),
        vignetting(results),
        samplers(results),
        pictures(results),
        stability(results, suite),
    ];
    all.into_iter().flatten().collect()
}

/// Reports the cases in which a tolerance chose a model that leaves out surfaces, because it was then worth it.
fn models(results: &Results) -> Option<String> {
    let of = |entry: Entry, tolerance: f64| {
        let own = |saving: &&Saving| saving.entry == entry && saving.request == Asked::Tolerance(tolerance);
        let all: Vec<&Saving> = results.leaving_out.iter().filter(own).collect();
        let is_model = |saving: &&&Saving| matches!(saving.tracing, Tracing::Polynomials { .. });
        let chosen = all.iter().filter(is_model);
        let faster = chosen.clone().filter(|saving| saved(results, saving).is_some()).count();
        format!("{tolerance} pixel on {} of {} ({faster} by more than a tie)", chosen.count(), all.len())
    };
    let all = |entry| TOLERANCES.map(|tolerance| of(entry, tolerance)).join(", ");
    (!results.leaving_out.is_empty()).then(|| {
        format!(
            "Polynomials in the place of the surfaces: a tolerance chose them, over lenses wide open and at \
             f/{STOPPED_DOWN}, in batches with {}; one by one with {}.",
            all(Entry::Many),
            all(Entry::One),
        )
    })
}

/// Reports the errors that models make in vignetting.
fn vignetting(results: &Results) -> Option<String> {
    let worst = |is_selected: &dyn Fn(&str, bool) -> bool| {
        let own = results.vignetting.iter().filter(|m| is_selected(m.method.name, m.apertures));
        own.map(realistic_lab::accuracy::vignetting::Vignetting::worst).fold(0.0, f64::max)
    };
    (!results.vignetting.is_empty()).then(|| {
        format!(
            "Vignetting: where the rear element is sampled and the lens's apertures shape the light, polynomials of \
             order 11 that know the apertures are off by {} of the light on the axis at the most, without apertures by \
             {}, the thick lens by {}; the exact ways by {}.",
            percent(worst(&|name, apertures| name == "order 11, f32" && apertures)),
            percent(worst(&|name, apertures| name == "order 11, f32" && !apertures)),
            percent(worst(&|name, _| name == "thick lens")),
            percent(worst(&|name, _| !name.starts_with("order") && name != "thick lens")),
        )
    })
}

/// Formats a share with its significant digits.
pub fn percent(share: f64) -> String {
    match 100.0 * share {
        none if none < 1e-4 => "less than 0.0001 %".to_owned(),
        small if small < 0.1 => format!("{small:.4} %"),
        few if few < 10.0 => format!("{few:.1} %"),
        more => format!("{more:.0} %"),
    }
}

fn samplers(results: &Results) -> Option<String> {
    if results.irradiance.is_empty() {
        return None;
    }
    let lenses = results.lenses.len();
    let pupil = |name| wins(results, |c| c.pupil, |own| *own == name);
    let sobol = wins(results, |c| c.sequence, |own| *own == "Sobol'");
    Some(format!(
        "Film irradiance within {} %: soonest by more than a tie with the pupil \"warped\" on {} of {lenses} lenses, \
         with \"rear\" on {}, with \"disk\" on {}; with Sobol' samples alone on {sobol}.",
        100.0 * IRRADIANCE,
        pupil("warped"),
        pupil("rear"),
        pupil("disk"),
    ))
}

fn pictures(results: &Results) -> Option<String> {
    let tie = results.ties().pictures;
    let mut wins: Vec<(&str, usize)> = Vec::new();
    for lens in &results.lenses {
        let own = || results.renderers.iter().filter(|c| c.lens == *lens);
        // The lowest error that any exact renderer reaches; a small margin is added below.
        let least = own().filter_map(|c| c.points.last()).map(|p| p.error).fold(f64::INFINITY, f64::min);
        let Some(name) = soonest(own(), 1.1 * least, tie).common(|c| c.pupil) else { continue };
        match wins.iter_mut().find(|(other, _)| *other == name) {
            Some((_, count)) => *count += 1,
            None => wins.push((name, 1)),
        }
    }
    let lenses = results.lenses.len();
    let won: usize = wins.iter().map(|(_, count)| count).sum();
    let named: Vec<String> = wins.iter().map(|(name, count)| format!("\"{name}\" on {count}")).collect();
    (!results.renderers.is_empty()).then(|| {
        format!(
            "Whole pictures, soonest within a tenth of the least error that any way reaches, by more than a tie: {}; a \
             tie of several on {} of {lenses} lenses.",
            if named.is_empty() { "none".to_owned() } else { named.join(", ") },
            lenses - won,
        )
    })
}

/// Reports the number of rays through extreme and random lenses, the results that fail, and the omissions of a quick
/// run.
pub fn stability(results: &Results, suite: &Suite) -> Option<String> {
    if results.stability.is_empty() {
        return None;
    }
    let sum = |is_selected: &dyn Fn(&str, &str) -> bool| -> usize {
        let own = results.stability.iter().filter(|c| is_selected(c.tracer, c.group));
        own.map(|c| c.rays + c.undecided).sum()
    };
    let [named, random] = [false, true]
        .map(|random| sum(&|tracer, group| tracer == "walk f64" && (group == "random") == random));
    let cameras = sum(&|tracer, group| tracer.starts_with("camera") && group == "random");
    let failed: Vec<_> = results.stability.iter().filter(|c| !c.holds()).collect();
    let verdict = match failed.len() {
        0 => "none fails".to_owned(),
        1 => "1 result fails, listed below".to_owned(),
        n => format!("{n} results fail, listed below"),
    };
    Some(format!(
        "Stability: {named} rays through named extreme lenses and {random} through random ones, by each of {} tracers, and \
         {cameras} through random cameras: of {} results {verdict}.{}",
        realistic_lab::stability::tracers().len(),
        results.stability.len(),
        left_out(suite.stability),
    ))
}

/// Reports the omissions of a run that is shorter than the full one.
fn left_out(extent: Extent) -> String {
    let Extent { lenses, cameras } = Extent::FULL;
    if extent.lenses >= lenses && extent.cameras >= cameras {
        return String::new();
    }
    let rays = RAYS_EACH as u64;
    format!(
        " This run left out {} of the {lenses} random lenses of either kind and {} of the {} random camera rays of a full \
         one, and says nothing about those.",
        lenses.saturating_sub(extent.lenses),
        cameras.saturating_sub(extent.cameras) * rays,
        cameras * rays,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::host::scene::chequers;
    use realistic_lab::stability::CaseResult;

    #[test]
    fn empty_results_give_no_advice() {
        let suite = Suite::quick(chequers::radiance);
        assert_eq!(advice(&Results::default(), &suite), Vec::<String>::new());
        assert_eq!(what_to_use_when(&Results::default()), None);
    }

    #[test]
    fn the_headline_counts_rays_and_states_what_is_left_out() {
        let name = "a case".to_owned();
        let case = CaseResult { rays: 40, undecided: 2, ..CaseResult::new(name, "radius", "walk f64", 16.0) };
        let results = Results { stability: vec![case], ..Results::default() };
        let [quick, full] = [Suite::quick(chequers::radiance), Suite::full(chequers::radiance)]
            .map(|suite| stability(&results, &suite).unwrap());
        assert!(
            full.contains("42 rays through named") && full.ends_with("of 1 results none fails."),
            "{full}"
        );
        assert!(
            quick.contains("left out 9700 of the 10000 random lenses") && !quick.contains("all hold"),
            "{quick}"
        );
        assert!(quick.contains("99000000 of the 100000000 random camera rays"), "{quick}");
    }
}

//! Tools that read conclusions from the results: the method that a tolerance chose, the curve that first stays below
//! an error and the curves that tie with it, and times in words.

use realistic_camera::Precision;
use realistic_camera::plan::{Entry, Tracing};
use realistic_lab::accuracy::curve::Curve;
use realistic_lab::accuracy::leaving_out::{Asked, Saving};
use realistic_lab::accuracy::suite::{Results, Tie};

/// Formats a time with a readable unit.
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

/// Formats the range from the shortest to the longest time.
pub fn range(times: impl Iterator<Item = f64> + Clone) -> String {
    let (low, high) = (times.clone().fold(f64::INFINITY, f64::min), times.fold(0.0, f64::max));
    format!("{} to {}", seconds(low), seconds(high))
}

/// Joins words with commas, and puts "and" before the last word.
pub fn listed(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// Returns the camera of a lens that was requested with these settings.
pub fn camera<'a>(
    results: &'a Results,
    lens: &str,
    stopped_down: bool,
    entry: Entry,
    request: Asked,
) -> Option<&'a Saving> {
    results.leaving_out.iter().find(|saving| {
        saving.lens == lens
            && saving.stopped_down == stopped_down
            && saving.entry == entry
            && saving.request == request
    })
}

/// Returns the camera that traces exactly in double precision, on the same film and called in the same way.
pub fn exact<'a>(results: &'a Results, of: &Saving) -> Option<&'a Saving> {
    camera(results, &of.lens, of.stopped_down, of.entry, Asked::Precision(Precision::F64))
}

/// Returns the share of the time that a tolerance saves, compared with the camera that traces in double precision;
/// negative if the tolerance costs time, `None` for a tie.
pub fn gain(results: &Results, of: &Saving) -> Option<f64> {
    let ratio = of.left_out.median / exact(results, of)?.left_out.median;
    (ratio.max(ratio.recip()) > results.ties().times.ratio).then_some(1.0 - ratio)
}

/// Returns the result of [`gain`] if it is positive.
pub fn saved(results: &Results, of: &Saving) -> Option<f64> {
    gain(results, of).filter(|share| *share > 0.0)
}

/// Describes the tracing method.
pub fn tracing(of: Tracing) -> String {
    match of {
        Tracing::Exact(Precision::F64) => "exact, double precision".to_owned(),
        Tracing::Exact(Precision::F32) => "exact, single precision".to_owned(),
        other => other.to_string(),
    }
}

/// The first curves to reach an error.
pub struct Soonest<'a> {
    /// The first curve, then the curves that tie with it, each with its time.
    pub first: Vec<(&'a Curve, f64)>,
}

impl Soonest<'_> {
    /// Returns the property that all of the first curves have in common, if there is one: this kind then wins over
    /// the others.
    pub fn common<T: PartialEq>(&self, of: impl Fn(&Curve) -> T) -> Option<T> {
        let mut kinds = self.first.iter().map(|(curve, _)| of(curve));
        let kind = kinds.next()?;
        kinds.all(|other| other == kind).then_some(kind)
    }
}

/// Returns the curves that are the first to reach an error and stay below it, with their times, which are
/// interpolated between points by a power law.
pub fn soonest<'a>(curves: impl Iterator<Item = &'a Curve>, error: f64, tie: Tie) -> Soonest<'a> {
    let mut first: Vec<(&Curve, f64)> =
        curves.filter_map(|curve| Some((curve, curve.time_to(error)?))).collect();
    first.sort_by(|a, b| a.1.total_cmp(&b.1));
    let least = first.first().map_or(f64::NAN, |(_, time)| *time);
    first.retain(|(_, time)| *time <= tie.ratio * least);
    Soonest { first }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_lab::accuracy::curve::Estimate;

    fn curve(pupil: &'static str, sequence: &'static str, time: f64) -> Curve {
        let point =
            |number: f64| Estimate { samples: 1, time: time * number, error: 1.0 / number, noise: 0.0 };
        let points = [1.0, 2.0, 4.0].map(point).into();
        Curve { lens: "a lens".to_owned(), pupil, disk: "concentric", sequence, points }
    }

    #[test]
    fn a_win_exceeds_the_threshold_and_ties_are_listed() {
        let curves =
            [curve("rear", "random", 3.0), curve("warped", "Sobol'", 1.0), curve("warped", "random", 1.2)];
        let at = |ratio: f64| soonest(curves.iter(), 0.5, Tie { ratio, share: 0.9, pairs: 1 });
        let names = |soonest: &Soonest<'_>| soonest.first.iter().map(|(c, _)| c.sequence).collect::<Vec<_>>();
        assert_eq!(names(&at(1.1)), ["Sobol'"]);
        assert_eq!(at(1.1).common(|c| c.sequence), Some("Sobol'"));
        // In this run, a difference of a fifth is a tie: neither sequence wins, but the pupil still does.
        assert_eq!(names(&at(1.3)), ["Sobol'", "random"]);
        assert_eq!((at(1.3).common(|c| c.sequence), at(1.3).common(|c| c.pupil)), (None, Some("warped")));
        // Without repeats, nothing wins.
        assert_eq!(at(f64::INFINITY).common(|c| c.pupil), None);
        assert!(soonest(curves.iter(), 1e-3, Tie { ratio: 1.0, share: 0.9, pairs: 1 }).first.is_empty());
    }

    #[test]
    fn times_are_readable() {
        assert_eq!([5.2e-9, 1.5e-7, 2.34e-4, 12.0].map(seconds), ["5.2 ns", "150 ns", "234 µs", "12 s"]);
    }

    #[test]
    fn words_are_listed_as_people_list_them() {
        let words = |count: usize| ["a", "b", "c"][..count].iter().map(|&w| w.to_owned()).collect::<Vec<_>>();
        assert_eq!([0, 1, 2, 3].map(|count| listed(&words(count))), ["", "a", "a and b", "a, b and c"]);
    }
}

//! What the conclusions are read off the results with: the cheapest method that serves a need and what ties with it, the
//! curve that is soonest below an error, and times in words.

use realistic_lab::accuracy::ray_map::RayErrors;
use realistic_lab::methods::Family;
use realistic_lab::results::statistics::TIE;

/// Error at the 99.9 % quantile, pixels, that a need allows.
pub const PIXELS: [f64; 3] = [1.0, 0.1, 0.01];
/// Error of a direction, rad, that counts as double precision.
pub const DOUBLE: f64 = 1e-12;

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

/// Whether the method traces to double precision.
pub fn is_exact(m: &RayErrors) -> bool {
    m.direction.worst <= DOUBLE
}

/// Whether the method is a model that leaves surfaces out.
pub fn is_model(m: &RayErrors) -> bool {
    matches!(m.method.family(), Family::Gaussian | Family::Polynomial | Family::PolynomialBatch)
}

/// The fastest of the methods wanted on a lens.
pub fn fastest<'a>(
    rays: &'a [RayErrors],
    lens: &str,
    wanted: impl Fn(&RayErrors) -> bool,
) -> Option<&'a RayErrors> {
    let own = rays.iter().filter(|m| m.lens == lens && wanted(m));
    own.min_by(|a, b| a.time.median.total_cmp(&b.time.median))
}

/// The method to take for a need.
pub struct Choice<'a> {
    /// The nearest of those whose times tie with the fastest.
    pub best: &'a RayErrors,
    /// The others of them, by rising time.
    pub ties: Vec<&'a RayErrors>,
}

/// The cheapest of the methods wanted on a lens that lose no ray. All that the page says of what is cheaper goes by this,
/// and so by one threshold, [`TIE`].
pub fn cheapest<'a>(
    rays: &'a [RayErrors],
    lens: &str,
    wanted: impl Fn(&RayErrors) -> bool,
) -> Option<Choice<'a>> {
    let serves = |m: &&RayErrors| m.lens == lens && m.lost == 0 && wanted(m);
    let least = rays.iter().filter(serves).map(|m| m.time.median).fold(f64::INFINITY, f64::min);
    let mut ties: Vec<_> = rays.iter().filter(serves).filter(|m| m.time.median < TIE * least).collect();
    ties.sort_by(|a, b| a.time.median.total_cmp(&b.time.median));
    let nearest = (0..ties.len()).min_by(|&a, &b| ties[a].pixels.most.total_cmp(&ties[b].pixels.most))?;
    let best = ties.remove(nearest);
    Some(Choice { best, ties })
}

/// The curve that first gets and stays below an error, and when, between its points by the power law through
/// them.
pub fn soonest<T>(curves: impl Iterator<Item = (T, Vec<(f64, f64)>)>, error: f64) -> Option<(T, f64)> {
    let reached = curves.filter_map(|(name, points)| Some((name, time_to(&points, error)?)));
    reached.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// When a curve of (time, error) reaches an error for good; `None` where it does not.
pub fn time_to(points: &[(f64, f64)], error: f64) -> Option<f64> {
    let last_above = points.iter().rposition(|(_, own)| *own > error);
    let Some(above) = last_above else {
        return points.first().map(|(time, _)| *time);
    };
    let (&(t0, e0), &(t1, e1)) = (points.get(above)?, points.get(above + 1)?);
    let share = (e0 / error).ln() / (e0 / e1).ln();
    Some(t0 * (t1 / t0).powf(share))
}

/// Whether all results hold, in words.
pub fn all_hold(failed: usize) -> String {
    if failed == 0 { "all hold".to_owned() } else { format!("{failed} do not hold") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_lab::methods::METHODS;
    use realistic_lab::results::statistics::Spread;
    use realistic_lab::timing::Timing;

    /// A method that takes so many ns and is so many pixels off.
    fn measured(name: &str, time: f64, pixels: f64, lost: usize) -> RayErrors {
        let method = *METHODS.iter().find(|method| method.name == name).unwrap();
        let [median, low, high] = [1.0, 0.9, 1.1].map(|share| share * time * 1e-9);
        let spread = Spread { median: pixels / 2.0, most: pixels, worst: 2.0 * pixels };
        RayErrors {
            lens: "a lens".to_owned(),
            method,
            time: Timing { median, low, high },
            direction: spread,
            position: spread,
            pixels: spread,
            lost,
            on_front: false,
        }
    }

    #[test]
    fn of_a_tie_the_nearest_is_taken_and_the_others_are_named() {
        let rays = [
            measured("order 3, f32", 4.8, 0.5, 0),
            measured("f32x16", 5.0, 0.001, 0),
            measured("order 5, f32", 4.9, 0.1, 0),
            measured("f64x8", 11.0, 1e-9, 0),
            measured("thick lens", 1.0, 0.9, 3),
        ];
        let named = |pixels: f64| {
            let choice = cheapest(&rays, "a lens", |m| m.pixels.most <= pixels).unwrap();
            let ties: Vec<_> = choice.ties.iter().map(|m| m.method.name).collect();
            (choice.best.method.name, ties, is_model(choice.best))
        };
        assert_eq!(named(1.0), ("f32x16", vec!["order 3, f32", "order 5, f32"], false));
        assert_eq!(named(1e-6), ("f64x8", vec![], false));
        assert!(cheapest(&rays, "a lens", |m| m.pixels.most < 1e-12).is_none());
        // One that is faster by more than a tie is named though others are nearer.
        let rays = [measured("order 3, f32", 4.0, 0.5, 0), measured("f32x16", 5.0, 0.001, 0)];
        let choice = cheapest(&rays, "a lens", |_| true).unwrap();
        assert!(is_model(choice.best) && choice.ties.is_empty());
    }

    #[test]
    fn times_are_readable() {
        assert_eq!([5.2e-9, 1.5e-7, 2.34e-4, 12.0].map(seconds), ["5.2 ns", "150 ns", "234 µs", "12 s"]);
    }

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

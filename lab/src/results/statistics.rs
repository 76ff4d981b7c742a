//! Statistics for work-precision diagrams: quantiles, exponents of power laws and Pareto fronts.

/// Returns the value below which the share `q` in [0, 1] of the numbers lies, by linear interpolation; NaN if there are
/// none.
pub fn quantile(numbers: &[f64], q: f64) -> f64 {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let at = q * last as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (at - below as f64) * (sorted[above] - sorted[below])
}

/// Returns the median.
pub fn median(numbers: &[f64]) -> f64 {
    quantile(numbers, 0.5)
}

/// Median, 99.9 % quantile and maximum of an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Median.
    pub median: f64,
    /// 99.9 % quantile.
    pub most: f64,
    /// Maximum.
    pub worst: f64,
}

impl Spread {
    /// Computes the spread of some errors.
    pub fn of(errors: &[f64]) -> Self {
        let [median, most, worst] = [0.5, 0.999, 1.0].map(|q| quantile(errors, q));
        Self { median, most, worst }
    }
}

/// Returns the exponent s of the power law y = c x^s that best fits the logarithms of positive points; `None` for fewer
/// than two different values of x.
pub fn log_slope(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<_> =
        points.iter().filter(|(x, y)| *x > 0.0 && *y > 0.0).map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let mean = logs.iter().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / count, sy + y / count));
    let (mut product, mut square) = (0.0, 0.0);
    for (x, y) in &logs {
        product += (x - mean.0) * (y - mean.1);
        square += (x - mean.0).powi(2);
    }
    (square > 0.0).then(|| product / square)
}

/// Marks the points (cost, error) that no other point beats. A point is marked if no other point is as good in both and
/// better in one, no more accurate point costs less than `tie` times as much, and no cheaper point has an error less
/// than `tie` times as large. With a `tie` of 1 these points are the Pareto front.
pub fn pareto_front(points: &[(f64, f64)], tie: f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let ((cost_a, error_a), (cost_b, error_b)) = (points[a], points[b]);
        error_a.total_cmp(&error_b).then(cost_a.total_cmp(&cost_b))
    });
    // From the most accurate to the cheapest point, each step must save more than a tie; on the way back, each must gain
    // more accuracy than a tie.
    let cheaper = far_apart(points, order, |last, next| last.0 > tie * next.0);
    let both = far_apart(points, cheaper.into_iter().rev(), |last, next| last.1 >= tie * next.1);
    (0..points.len()).map(|number| both.contains(&number)).collect()
}

/// Returns the numbered points, in their order, that are `far` enough from the last one selected, or equal to it.
fn far_apart(
    points: &[(f64, f64)],
    numbers: impl IntoIterator<Item = usize>,
    far: impl Fn((f64, f64), (f64, f64)) -> bool,
) -> Vec<usize> {
    let mut selected: Vec<usize> = Vec::new();
    for number in numbers {
        let is_next = selected
            .last()
            .is_none_or(|&last| points[last] == points[number] || far(points[last], points[number]));
        if is_next {
            selected.push(number);
        }
    }
    selected
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_interpolate_and_do_not_care_for_order() {
        let numbers = [3.0, 1.0, 2.0, 5.0, 4.0];
        assert_eq!((quantile(&numbers, 0.0), median(&numbers), quantile(&numbers, 1.0)), (1.0, 3.0, 5.0));
        assert_eq!(quantile(&numbers, 0.125), 1.5);
        assert!(median(&[]).is_nan());
    }

    #[test]
    fn the_slope_of_a_power_law_is_its_exponent() {
        let points: Vec<_> = (1..9).map(|i| f64::from(1 << i)).map(|x| (x, 3.0 * x.powf(-0.75))).collect();
        assert!((log_slope(&points).expect("a slope") + 0.75).abs() < 1e-12);
        assert_eq!(log_slope(&points[..1]), None);
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [(1.0, 9.0), (2.0, 5.0), (2.0, 6.0), (3.0, 7.0), (4.0, 1.0), (4.0, 1.0), (9.0, 1.0)];
        assert_eq!(pareto_front(&points, 1.0), [true, true, false, false, true, true, false]);
        // An independent computation: along increasing cost, the errors of the front only decrease.
        let mut front: Vec<_> =
            points.into_iter().zip(pareto_front(&points, 1.0)).filter(|p| p.1).map(|p| p.0).collect();
        front.sort_by(|a, b| a.0.total_cmp(&b.0));
        assert!(front.windows(2).all(|pair| pair[1].1 < pair[0].1 || pair[1] == pair[0]));
    }

    #[test]
    fn what_saves_less_than_a_tie_is_not_on_the_front() {
        // The second point is more accurate than the first and costs 5 % more; each of the last three costs 9 % more
        // than the one before.
        let points = [(1.0, 9.0), (1.05, 5.0), (2.0, 3.0), (2.18, 2.0), (2.38, 1.0)];
        assert_eq!(pareto_front(&points, 1.1), [false, true, true, false, true]);
        assert_eq!(pareto_front(&points, 1.0), [true; 5]);
        // The second costs forty times as much, for a gain in accuracy of the size of rounding errors.
        assert_eq!(pareto_front(&[(12.0, 1.0e-12), (480.0, 0.95e-12)], 1.1), [true, false]);
        assert_eq!(pareto_front(&[], 1.1), Vec::<bool>::new());
    }
}

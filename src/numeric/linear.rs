//! Numbers between tabulated ones, on straight lines.

/// What y is at `x` on the broken line through `points`, pairs (x, y) of which there is at least one, with x ascending;
/// beyond its ends on the first or the last of its lines.
pub fn on_broken_line(points: &[[f64; 2]], x: f64) -> f64 {
    let next = points.partition_point(|[place, _]| *place <= x).clamp(1, points.len().max(2) - 1);
    let [from, first] = points[next - 1];
    let Some([to, second]) = points.get(next) else { return first };
    let part = if *to > from { (x - from) / (to - from) } else { 1.0 };
    first + part * (second - first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_through_the_points_and_on_beyond_them() {
        let points = [[0.0, 1.0], [2.0, 5.0], [2.0, 7.0], [3.0, 6.0]];
        for (x, y) in [(-1.0, -1.0), (0.0, 1.0), (1.0, 3.0), (2.0, 7.0), (2.5, 6.5), (3.0, 6.0), (4.0, 5.0)] {
            assert_eq!(on_broken_line(&points, x), y, "{x}");
        }
        assert_eq!(on_broken_line(&points[..1], 3.0), 1.0);
    }
}

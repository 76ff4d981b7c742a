//! Quasi-random points, spread evenly over the unit cube.

/// Returns points of the `N`-dimensional unit cube, nearly evenly spread, by the additive recurrence whose steps are
/// the powers of 1/g, where g > 1 and g^(N + 1) = g + 1 (M. Roberts, "The Unreasonable Effectiveness of Quasirandom
/// Sequences", 2018). Another `shift` gives other points.
pub fn spread<const N: usize>(shift: f64) -> impl Iterator<Item = [f64; N]> {
    let steps = steps();
    (0_u32..).map(move |number| steps.map(|step| (shift + (f64::from(number) + 0.5) * step).fract()))
}

/// Returns the powers of 1/g, the steps of the coordinates.
pub fn steps<const N: usize>() -> [f64; N] {
    // Every iteration reduces the error by more than a factor of N + 1.
    let g = (0..60).fold(1.5_f64, |g, _| (g + 1.0).powf(1.0 / (N as f64 + 1.0)));
    std::array::from_fn(|i| g.powi(-(i as i32 + 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_steps_are_powers_of_the_root_and_the_points_even() {
        let [a, b, c, d, e] = steps::<5>();
        assert!((a.powi(-6) - 1.0 / a - 1.0).abs() < 1e-13 && (a * a - b).abs() < 1e-15);
        assert!((a * b - c).abs() < 1e-15 && (a * c - d).abs() < 1e-15 && (a * d - e).abs() < 1e-15);
        let residual = |step: f64, n: i32| (step.powi(-n - 1) - 1.0 / step - 1.0).abs();
        assert!(residual(steps::<2>()[0], 2) < 1e-13 && residual(steps::<4>()[0], 4) < 1e-13);
        for i in 0..5 {
            let mean = spread::<5>(0.0).take(4096).map(|point| point[i]).sum::<f64>() / 4096.0;
            assert!((mean - 0.5).abs() < 2e-3, "{i}: {mean}");
        }
    }
}

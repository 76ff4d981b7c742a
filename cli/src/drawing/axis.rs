//! Logarithmic scales, which convert numbers to positions in pixels and have labelled ticks.

/// A map from positive numbers to pixels, by their logarithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogScale {
    /// Smallest and largest number shown.
    pub range: [f64; 2],
    /// Positions of the smallest and the largest number, pixels.
    pub pixels: [f64; 2],
}

/// A tick.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// The number.
    pub value: f64,
    /// Text of the label; `None` for a small tick.
    pub label: Option<String>,
}

impl LogScale {
    /// Makes a scale that shows all the numbers with a margin.
    pub fn around(numbers: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let numbers = numbers.filter(|number| number.is_finite() && *number > 0.0);
        let (low, high) = numbers.fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
        if low > high {
            return Self { range: [0.1, 10.0], pixels };
        }
        // A range of at least a decade keeps noise from looking like structure.
        let (low, high) = (low.log10(), high.log10());
        let room = (0.06 * (high - low)).max((1.0 - (high - low)) / 2.0).max(0.06);
        Self { range: [10_f64.powf(low - room), 10_f64.powf(high + room)], pixels }
    }

    /// Returns the position of a number, pixels; a number outside the range is placed at the nearer end.
    pub fn position(&self, number: f64) -> f64 {
        let [low, high] = self.range.map(f64::log10);
        let share = ((number.max(f64::MIN_POSITIVE).log10() - low) / (high - low)).clamp(0.0, 1.0);
        self.pixels[0] + share * (self.pixels[1] - self.pixels[0])
    }

    /// Returns ticks at 1 to 9 of every decade. Labels are at least `room` pixels apart. They are at powers of ten,
    /// and also at 2 and 5 times a power if fewer than three powers are visible.
    pub fn ticks(&self, room: f64) -> Vec<Tick> {
        let [low, high] = self.range.map(f64::log10);
        let per_decade = (self.pixels[1] - self.pixels[0]).abs() / (high - low);
        let every = (room / per_decade).ceil().max(1.0) as i32;
        let (first, last) = (low.floor() as i32, high.ceil() as i32);
        let whole = (first..=last).filter(|&e| (low..=high).contains(&f64::from(e))).count();
        let mut ticks = Vec::new();
        for decade in first..=last {
            for digit in 1..10 {
                // Parsing decimal text gives the nearest double; the product of a power of ten and a digit
                // may not.
                let value: f64 = format!("{digit}e{decade}").parse().unwrap_or(f64::NAN);
                if !(self.range[0]..=self.range[1]).contains(&value) {
                    continue;
                }
                let labelled = match digit {
                    1 => decade.rem_euclid(every) == 0,
                    2 | 5 => whole < 3 && 0.3 * per_decade >= room,
                    _ => false,
                };
                if digit == 1 || every == 1 {
                    ticks.push(Tick { value, label: labelled.then(|| text(digit, decade)) });
                }
            }
        }
        ticks
    }
}

fn text(digit: i32, decade: i32) -> String {
    match decade {
        -2..=-1 => format!("{:.*}", decade.unsigned_abs() as usize, f64::from(digit) * 10_f64.powi(decade)),
        0..=4 => format!("{}", digit * 10_i32.pow(decade as u32)),
        _ => format!("{digit}e{decade}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_linear_in_the_logarithm_and_stay_inside() {
        let scale = LogScale { range: [1.0, 100.0], pixels: [0.0, 200.0] };
        assert_eq!([1.0, 10.0, 100.0].map(|x| scale.position(x)), [0.0, 100.0, 200.0]);
        assert_eq!([0.0, -1.0, 1e9].map(|x| scale.position(x)), [0.0, 0.0, 200.0]);
        let all = [3e-5, 0.2, 7.0];
        let scale = LogScale::around(all.into_iter().chain([f64::NAN, 0.0]), [500.0, 0.0]);
        assert!(all.iter().all(|x| (10.0..490.0).contains(&scale.position(*x))));
        assert!(scale.position(3e-5) > scale.position(7.0));
        assert_eq!(LogScale::around(std::iter::empty(), [0.0, 1.0]).range, [0.1, 10.0]);
    }

    #[test]
    fn ticks_are_exact_decimals_in_range_with_room_between_labels() {
        for range in [[1e-17, 1e-2], [0.003, 2e5], [4.0, 60.0], [0.9, 11.0]] {
            let scale = LogScale { range, pixels: [0.0, 420.0] };
            let ticks = scale.ticks(30.0);
            let labelled: Vec<_> = ticks.iter().filter(|tick| tick.label.is_some()).collect();
            assert!(labelled.len() >= 2, "{range:?}");
            for tick in &labelled {
                assert_eq!(tick.label.as_deref().and_then(|label| label.parse().ok()), Some(tick.value));
                assert!((range[0]..=range[1]).contains(&tick.value));
            }
            for pair in labelled.windows(2) {
                assert!(
                    scale.position(pair[1].value) - scale.position(pair[0].value) >= 30.0,
                    "{range:?}: {pair:?}"
                );
            }
        }
    }
}

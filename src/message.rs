//! Messages for people: how serious they are, and the names and computed numbers in them, with few digits and never
//! outside the range that they state.

/// How serious a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Worth knowing.
    Info,
    /// The camera is built, and something is not as asked.
    Warning,
    /// The camera is not built.
    Error,
}

/// Receives messages.
pub type Log<'a> = &'a mut dyn FnMut(Level, &str);

/// Names to choose from, in a sentence: `"a", "b" or "c"`.
pub fn quoted(names: &[&str]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    match &names[..] {
        [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        _ => names.concat(),
    }
}

/// A number with six significant digits at most, and far from 1 with a power of ten.
pub fn short(number: f64) -> String {
    written(rounded(number))
}

/// [`short`] of a positive number rounded up: the least of a range, which a reader may give back as it stands.
pub fn short_above(number: f64) -> String {
    // Half a unit of the last digit is 5e-6 of the number at most.
    let mut nudged = (0..=6).map(|step: u8| rounded(number * (1.0 + 1e-6 * f64::from(step))));
    written(nudged.find(|rounded| *rounded >= number).unwrap_or(number))
}

fn rounded(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

fn written(number: f64) -> String {
    let is_plain = number == 0.0 || !number.is_finite() || (1e-4..1e7).contains(&number.abs());
    if is_plain { number.to_string() } else { format!("{number:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn computed_numbers_keep_six_digits_and_round_ones_stay() {
        for (number, text) in [
            (237.983_410_372_1, "237.983"),
            (-0.051_234_567, "-0.0512346"),
            (17.1, "17.1"),
            (f64::from(0.1_f32), "0.1"),
            (250.0, "250"),
            (0.0, "0"),
            (1e300, "1e300"),
            (1.234_567_89e-7, "1.23457e-7"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(short(number), text);
        }
    }

    #[test]
    fn names_are_offered_as_a_sentence_does() {
        let offers = [&["a"][..], &["a", "b"], &["a", "b", "c"]].map(quoted);
        assert_eq!(offers, ["\"a\"", "\"a\" or \"b\"", "\"a\", \"b\" or \"c\""]);
    }

    #[test]
    fn rounding_up_never_rounds_down() {
        assert_eq!(short_above(237.983_410_372_1), "237.984");
        assert_eq!(short_above(250.0), "250");
        for i in 1..2000 {
            let number = 1e-3 * f64::from(i).powf(1.7);
            let above: f64 = short_above(number).parse().expect("a number");
            assert!(above >= number && above <= number * (1.0 + 1e-5), "{number}: {above}");
        }
    }
}

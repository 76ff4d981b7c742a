//! Ranges of values: the numbers or names that a parameter accepts, and their description in words.

use std::ops::{
    Bound::{self, Excluded, Included},
    RangeBounds as _,
};

use realistic_base::message::{quoted, short};

/// The values that a parameter accepts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Every value of the parameter's kind.
    Any,
    /// Numbers in an interval.
    Numbers(Interval),
    /// One of these names.
    Names(&'static [&'static str]),
}

/// An interval of numbers. It never contains NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub from: Bound<f64>,
    /// The upper end.
    pub to: Bound<f64>,
    /// Whether numbers are used in single precision, so that the rounded number, too, must lie in the
    /// interval.
    single: bool,
    /// Meaning of the value 0, which is the lower end.
    zero: &'static str,
}

impl Interval {
    /// Positive, finite numbers.
    pub(super) const POSITIVE: Self = Self::new(Excluded(0.0), Excluded(f64::INFINITY));
    /// Every finite number.
    pub(super) const FINITE: Self = Self::new(Excluded(f64::NEG_INFINITY), Excluded(f64::INFINITY));

    pub(super) const fn new(from: Bound<f64>, to: Bound<f64>) -> Self {
        Self { from, to, single: false, zero: "" }
    }

    /// Returns the closed interval between two numbers.
    pub(super) const fn between(from: f64, to: f64) -> Self {
        Self::new(Included(from), Included(to))
    }

    /// Returns this interval for numbers used in single precision.
    pub(super) const fn single(self) -> Self {
        Self { single: true, ..self }
    }

    /// Returns this interval with a description of the meaning of 0, which is the lower end.
    pub(super) const fn where_zero_is(self, zero: &'static str) -> Self {
        Self { zero, ..self }
    }

    /// Whether the interval contains a number.
    pub fn contains(&self, number: f64) -> bool {
        let to_single = |end: Bound<f64>| end.map(|end| end as f32);
        (self.from, self.to).contains(&number)
            && (!self.single || (to_single(self.from), to_single(self.to)).contains(&(number as f32)))
    }

    /// Describes the interval in words, without the unit.
    fn words(&self) -> String {
        let zero = if self.zero.is_empty() { String::new() } else { format!(" ({})", self.zero) };
        match (self.from, self.to) {
            (Excluded(0.0), Excluded(f64::INFINITY) | Included(f64::INFINITY)) => "positive".to_owned(),
            (Excluded(0.0), Included(to)) => format!("more than 0 and at most {}", short(to)),
            (Excluded(_), _) => "a finite number".to_owned(),
            (Included(f64::NEG_INFINITY), _) => "a number".to_owned(),
            (Included(0.0), Included(f64::INFINITY)) => format!("0{zero} or more"),
            (Included(0.0), Excluded(_)) => format!("0{zero} or more and finite"),
            (Included(0.0), Included(to)) => format!("0{zero} or more, up to {}", short(to)),
            (Included(from), Included(to) | Excluded(to)) => {
                // A lower end just above 0 exists only for the arithmetic, so words say "positive".
                let positive = if from > 0.0 && from < 1e-9 { "positive, " } else { "" };
                let less_than = if matches!(self.to, Excluded(_)) { "less than " } else { "" };
                format!("{positive}from {} to {less_than}{}", short(from), short(to))
            }
            (from, to) => format!("{from:?} to {to:?}"),
        }
    }
}

impl Range {
    /// Returns the range in words, with the unit of its numbers; empty for [`Range::Any`].
    pub fn in_words(&self, unit: &str) -> String {
        let words = match self {
            Self::Any => return String::new(),
            Self::Names(names) => return quoted(names),
            Self::Numbers(interval) => interval.words(),
        };
        match words.ends_with(|last: char| last.is_ascii_digit()) {
            _ if unit.is_empty() => words,
            true => format!("{words} {unit}"),
            false => format!("{words}, in {unit}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_precision_keeps_inside_after_rounding() {
        let clip = Interval::new(Included(0.0), Excluded(f64::INFINITY)).single();
        assert!(clip.contains(0.0) && clip.contains(3.4e38) && !clip.contains(1e39));
        assert!(!clip.contains(-1e-300) && !clip.contains(f64::NAN));
        let end = Interval::new(Included(0.0), Included(f64::INFINITY)).single();
        assert!(end.contains(1e300) && end.contains(f64::INFINITY) && !end.contains(f64::NAN));
        let angle = Interval::new(Included(1e-4), Excluded(180.0)).single();
        assert!(angle.contains(1e-4) && angle.contains(179.9) && !angle.contains(180.0_f64.next_down()));
        assert!(!Interval::FINITE.single().contains(-1e39) && Interval::FINITE.contains(-1e39));
    }

    #[test]
    fn ranges_read_as_sentences() {
        let words = |interval, unit| Range::Numbers(interval).in_words(unit);
        assert_eq!(words(Interval::POSITIVE, "mm"), "positive, in mm");
        assert_eq!(words(Interval::POSITIVE, ""), "positive");
        assert_eq!(words(Interval::between(300.0, 2000.0), "nm"), "from 300 to 2000 nm");
        assert_eq!(words(Interval::between(1e-15, 1e15), ""), "positive, from 1e-15 to 1e15");
        let radius = Interval::between(0.0, 1e15).where_zero_is("a pinhole");
        assert_eq!(words(radius, "mm"), "0 (a pinhole) or more, up to 1e15 mm");
    }
}

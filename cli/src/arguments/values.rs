//! Parses numeric values of flags; an error states what to write instead.

use crate::image::LARGEST_SIDE;
use realistic_camera::Parameters;
use std::fmt::Display;
use std::str::FromStr;

/// Parses a number; `None` if it is outside the range of this parameter.
fn in_range(text: &str, parameter: &str) -> Option<f64> {
    let row = Parameters::find(parameter).expect("a parameter of the table");
    text.parse().ok().and_then(|number| row.check(number).ok())
}

/// Parses a finite number.
pub fn finite(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|number: &f32| number.is_finite());
    number.ok_or_else(|| "write a finite number".to_owned())
}

/// Parses a positive finite number.
pub fn positive(text: &str) -> Result<f64, String> {
    in_range(text, "film_distance").ok_or_else(|| "write a positive number".to_owned())
}

/// Parses a positive distance, or `inf` for infinity.
pub fn distance(text: &str) -> Result<f64, String> {
    in_range(text, "focus_distance").ok_or_else(|| "write a positive number of mm, or inf".to_owned())
}

/// Parses 0 or a positive finite number.
pub fn not_negative(text: &str) -> Result<f64, String> {
    in_range(text, "tolerance").ok_or_else(|| "write 0 or a positive number".to_owned())
}

/// Parses a whole number from `least` to `most`.
pub fn whole<T>(least: T, most: T) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: FromStr + PartialOrd + Display + Copy + Send + Sync + 'static,
{
    move |text| {
        let number = text.parse().ok().filter(|number: &T| *number >= least && *number <= most);
        number.ok_or_else(|| format!("write a whole number from {least} to {most}"))
    }
}

/// Parses a size in pixels, written as `WxH`.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| {
        let side = text.parse().ok();
        side.filter(|side| (1..=LARGEST_SIDE).contains(side))
    };
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| format!("write WIDTHxHEIGHT in pixels, each 1 to {LARGEST_SIDE}, as in 480x320"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_numbers_of_pixels() {
        assert_eq!(size("480x320"), Ok([480, 320]));
        for text in ["480", "0x3", "3x", "3x-1", "99999x3", "3x3x3"] {
            assert!(size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn lengths_are_positive_and_only_distances_infinite() {
        assert_eq!((positive("2.5"), not_negative("0")), (Ok(2.5), Ok(0.0)));
        assert_eq!(distance("inf"), Ok(f64::INFINITY));
        for text in ["-1", "nan", "far", "-inf"] {
            assert!(positive(text).is_err() && distance(text).is_err() && not_negative(text).is_err());
        }
        assert!(positive("inf").is_err() && not_negative("inf").is_err() && distance("0").is_err());
    }

    #[test]
    fn what_is_added_to_is_a_finite_number() {
        assert_eq!((finite("-1.5"), finite("0")), (Ok(-1.5), Ok(0.0)));
        for text in ["nan", "inf", "-inf", "1e39", "bright"] {
            assert_eq!(finite(text), Err("write a finite number".to_owned()), "{text}");
        }
    }

    #[test]
    fn counts_are_whole_numbers_of_a_range() {
        let samples = whole(1_u32, 64);
        assert_eq!((samples("1"), samples("64")), (Ok(1), Ok(64)));
        for text in ["0", "65", "1.5", "-4", "many", ""] {
            assert_eq!(samples(text), Err("write a whole number from 1 to 64".to_owned()), "{text}");
        }
    }
}

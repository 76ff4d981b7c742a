//! The zoom of a lens, as a user gives it: a focal length or the name of a position.

use super::{
    error::ParameterError,
    value::{Kind, Setting, Value, Written},
};
use realistic_base::message::as_given;

/// The zoom of a lens.
#[derive(Clone, Debug, PartialEq)]
pub enum Zoom {
    /// A focal length, mm, positive and finite, between the focal lengths of the lens's positions.
    FocalLength(f64),
    /// The zoom position of this name.
    Position(String),
}

/// Converts a number to a focal length, and likewise a text that reads as a finite number, with or without
/// "mm" after it; any other text is the name of a position.
impl Setting for Zoom {
    const KIND: Kind = Kind::Text;

    fn of(name: &'static str, value: Value<'_>) -> Result<Self, ParameterError> {
        let number = match value {
            Value::Text(text) => {
                let text = text.trim();
                let number = text.strip_suffix("mm").unwrap_or(text).trim_end().parse();
                match number.ok().filter(|number: &f64| number.is_finite()) {
                    Some(number) => number,
                    None => return Ok(Self::Position(text.to_owned())),
                }
            }
            Value::Float(number) => number,
            other => return Err(other.refused(name, Self::KIND)),
        };
        if number > 0.0 && number.is_finite() {
            return Ok(Self::FocalLength(number));
        }
        let range = "a positive focal length in mm, or the name of a position";
        Err(ParameterError::out_of_range(name, number, range))
    }
}

impl Written for Zoom {
    fn written(&self) -> String {
        match self {
            Self::FocalLength(number) => as_given(*number),
            Self::Position(name) => name.clone(),
        }
    }
}

impl From<f64> for Zoom {
    fn from(focal_length: f64) -> Self {
        Self::FocalLength(focal_length)
    }
}

impl From<&str> for Zoom {
    fn from(name: &str) -> Self {
        Self::Position(name.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_a_focal_length_and_anything_else_a_name() {
        let zoom = |text| Zoom::of("zoom", Value::Text(text));
        for (text, focal_length) in [("35", 35.0), ("35mm", 35.0), (" 1.5e2 mm ", 150.0), ("24.7", 24.7)] {
            assert_eq!(zoom(text), Ok(Zoom::FocalLength(focal_length)), "{text}");
        }
        for name in ["wide", "f35", "inf", "NaN", "35 mm close", ""] {
            assert_eq!(zoom(name), Ok(Zoom::Position(name.to_owned())));
        }
        for text in ["0", "-35", "-0.0mm"] {
            let refused = zoom(text).expect_err("not positive").to_string();
            assert!(refused.contains("\"zoom\"") && refused.contains("positive"), "{refused}");
        }
        for text in ["35", "0.1", "150.25", "wide"] {
            assert_eq!(zoom(text).expect("a zoom").written(), text);
        }
        assert_eq!(Zoom::of("zoom", Value::Float(35.0)), Ok(Zoom::FocalLength(35.0)));
        for number in [0.0, -35.0, f64::INFINITY] {
            assert!(Zoom::of("zoom", Value::Float(number)).is_err(), "{number}");
        }
        assert!(Zoom::of("zoom", Value::Bool(true)).is_err());
    }
}

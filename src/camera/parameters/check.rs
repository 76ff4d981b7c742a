//! The checks of a parameter's value, each with the error that names the parameter and its range.

use crate::camera::{CameraError, ParameterError};

/// The choice that a name stands for; the first of `choices` where none is given.
pub(crate) fn choice<T: Copy>(
    parameter: &'static str,
    given: Option<&str>,
    choices: &[(&str, T)],
) -> Result<T, CameraError> {
    let Some(given) = given else {
        return Ok(choices[0].1);
    };
    choices.iter().find(|(name, _)| *name == given).map(|&(_, value)| value).ok_or_else(|| {
        let names: Vec<String> = choices.iter().map(|(name, _)| format!("\"{name}\"")).collect();
        ParameterError::Range { name: parameter, value: format!("\"{given}\""), range: names.join(" or ") }
            .into()
    })
}

/// A positive, finite number; `unit` may be empty.
pub(crate) fn positive(parameter: &'static str, value: f64, unit: &str) -> Result<(), CameraError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    let range = if unit.is_empty() { "positive".to_owned() } else { format!("positive, in {unit}") };
    Err(out_of_range(parameter, value, &range))
}

/// The error of a number outside its range, which is given in words.
pub(crate) fn out_of_range(parameter: &'static str, value: f64, range: &str) -> CameraError {
    let plain = value.to_string();
    // More than the digits of a number are the zeros of one very large or very small.
    let value = if plain.len() > 24 { format!("{value:e}") } else { plain };
    ParameterError::Range { name: parameter, value, range: range.to_owned() }.into()
}

/// A number that is a finite float, which a ray may carry.
pub(crate) fn finite_float(parameter: &'static str, value: f64) -> Result<f32, CameraError> {
    let float = value as f32;
    if float.is_finite() { Ok(float) } else { Err(out_of_range(parameter, value, "a finite float")) }
}

/// Two distances along a ray as floats: the first finite and 0 or more, the second no less, or infinite.
pub(crate) fn clip_range(
    (low_name, low): (&'static str, f64),
    (high_name, high): (&'static str, f64),
) -> Result<[f32; 2], CameraError> {
    let from = finite_float(low_name, low)?;
    if high.is_nan() {
        return Err(out_of_range(high_name, high, "a finite float"));
    }
    if low < 0.0 {
        return Err(out_of_range(low_name, low, "0 or more"));
    }
    if high < low {
        return Err(out_of_range(high_name, high, &format!("at least \"{low_name}\", which is {low}")));
    }
    Ok([from, high as f32])
}

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

/// Two parameters of which the first may not exceed the second; as floats, so that what a ray carries
/// is finite, but for a far end where `open_ended`.
pub(crate) fn interval(
    (low_name, low, low_default): (&'static str, Option<f64>, f64),
    (high_name, high, high_default): (&'static str, Option<f64>, f64),
    least: Option<f64>,
    open_ended: bool,
) -> Result<[f32; 2], CameraError> {
    let low = low.unwrap_or(low_default);
    let high = high.unwrap_or(high_default);
    let is_finite = |value: f64| (value as f32).is_finite();
    if !is_finite(low) {
        return Err(out_of_range(low_name, low, "a finite float"));
    }
    if !(is_finite(high) || open_ended && !high.is_nan()) {
        return Err(out_of_range(high_name, high, "a finite float"));
    }
    if let Some(least) = least
        && low < least
    {
        return Err(out_of_range(low_name, low, &format!("{least} or more")));
    }
    if high < low {
        return Err(out_of_range(high_name, high, &format!("at least \"{low_name}\", which is {low}")));
    }
    Ok([low as f32, high as f32])
}

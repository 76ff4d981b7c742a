//! Copies parameters by name into the fields of the C options.

use super::library::PluginError;
use realistic::ffi::realistic_options;
use realistic_camera::Parameters;
use std::ffi::CString;

/// Fills in the given parameters and leaves the others unchanged. The options point at the returned strings, which
/// must outlive the options.
///
/// # Errors
/// A parameter has a text that C cannot hold.
pub fn fill(options: &mut realistic_options, given: &Parameters) -> Result<Vec<CString>, PluginError> {
    let mut strings = Vec::new();
    options.fill(given, |value| {
        let string = CString::new(value.as_str())
            .map_err(|_| PluginError::Refused(format!("{value:?} holds a zero byte, which no name may")))?;
        let start = string.as_ptr();
        strings.push(string);
        Ok(start)
    })?;
    Ok(strings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic_camera::PARAMETERS;

    #[test]
    fn every_parameter_reaches_the_options() {
        for row in PARAMETERS {
            // SAFETY: zeros are NULL pointers, no callback and plain numbers.
            let mut options: realistic_options = unsafe { std::mem::zeroed() };
            let before = format!("{options:?}");
            let mut given = Parameters::default();
            let known = ["1", "true", "1,2,3,4", row.default];
            assert!(known.iter().any(|text| given.set_from_text(row.name, text).is_ok()), "{}", row.name);
            let _strings = fill(&mut options, &given).expect("no text with a zero byte");
            assert_ne!(before, format!("{options:?}"), "{}", row.name);
        }
    }
}

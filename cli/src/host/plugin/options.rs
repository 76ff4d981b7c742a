//! Parameters by name, put into the fields of the C options.

use super::library::PluginError;
use realistic::abi::realistic_options;
use realistic::camera::Parameters;
use std::ffi::CString;

/// Fills in what is given and leaves the rest. The strings returned are those that the
/// options now point at: they must outlive them.
///
/// # Errors
/// A text that C cannot hold, or a parameter that has no field.
pub fn fill(options: &mut realistic_options, given: &Parameters) -> Result<Vec<CString>, PluginError> {
    if given.af_zones.is_some() {
        return Err(PluginError::Refused(
            "\"af_zones\" is for scene files only and changes nothing: leave it out, and give \
             \"focusdistance\" or \"filmdistance\""
                .to_owned(),
        ));
    }
    if let Some(simple) = given.simpleweighting {
        options.simpleweighting = i32::from(simple);
    }
    for (field, value) in [
        (&mut options.filmdistance, given.filmdistance),
        (&mut options.focusdistance, given.focusdistance),
        (&mut options.aperture_diameter, given.aperture_diameter),
        (&mut options.fnumber, given.fnumber),
        (&mut options.filmdiag, given.filmdiag),
        (&mut options.hither, given.hither),
        (&mut options.yon, given.yon),
        (&mut options.shutteropen, given.shutteropen),
        (&mut options.shutterclose, given.shutterclose),
        (&mut options.wavelength, given.wavelength),
        (&mut options.mmperunit, given.mmperunit),
        (&mut options.shutterramp, given.shutterramp),
        (&mut options.shutterslit, given.shutterslit),
        (&mut options.fov, given.fov),
        (&mut options.frameaspectratio, given.frameaspectratio),
        (&mut options.lensradius, given.lensradius),
        (&mut options.focaldistance, given.focaldistance),
        (&mut options.tolerance, given.tolerance),
    ] {
        if let Some(value) = value {
            *field = value;
        }
    }
    if let Some(window) = given.screenwindow {
        options.screenwindow = window;
    }
    let mut strings = Vec::new();
    for (field, value) in [
        (&mut options.model, given.model.map(|name| name.to_string())),
        (&mut options.specfile, given.specfile.clone()),
        (&mut options.weighting, given.weighting.map(|name| name.to_string())),
        (&mut options.pupil, given.pupil.map(|name| name.to_string())),
        (&mut options.disk, given.disk.map(|name| name.to_string())),
        (&mut options.refraction, given.refraction.map(|name| name.to_string())),
        (
            &mut options.precision,
            given.precision.map(|asked| asked.map_or("auto".to_owned(), |name| name.to_string())),
        ),
        (&mut options.shutter, given.shutter.map(|name| name.to_string())),
        (&mut options.lensplane, given.lensplane.map(|name| name.to_string())),
    ] {
        if let Some(value) = value {
            let string = CString::new(value.as_str()).map_err(|_| {
                PluginError::Refused(format!("{value:?} holds a zero byte, which no name may"))
            })?;
            *field = string.as_ptr();
            strings.push(string);
        }
    }
    Ok(strings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use realistic::camera::PARAMETERS;

    #[test]
    fn every_parameter_reaches_the_options() {
        for row in PARAMETERS {
            // SAFETY: zeros are NULL pointers, no callback and plain numbers.
            let mut options: realistic_options = unsafe { std::mem::zeroed() };
            let before = format!("{options:?}");
            let mut given = Parameters::default();
            let known = ["1", "true", "1,2,3,4", row.default];
            assert!(known.iter().any(|text| given.set_from_text(row.name, text).is_ok()), "{}", row.name);
            match fill(&mut options, &given) {
                Ok(_strings) => assert_ne!(before, format!("{options:?}"), "{}", row.name),
                Err(error) => assert!(error.to_string().contains(row.name), "{error}"),
            }
        }
    }
}

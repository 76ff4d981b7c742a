//! The settings that every model has: pose, clip range, shutter, the mapping of lens samples to a disk, and
//! the part of the picture that the host renders.

use crate::{
    film::Raster,
    host::{Host, Level, Log},
    model::Model,
    parameters::{CameraError, ParameterError, Parameters},
    placement::{Placement, shutter::Shutter},
    sampling::DiskMapping,
};
use realistic_base::message::as_given;

/// Returns the shutter with its share of the interval: the parameter's value if it is given, otherwise the
/// shutter's default.
pub fn shutter(given: &Parameters) -> Result<Shutter, ParameterError> {
    let share = |name, given: Option<f64>, own: f32| match given {
        Some(share) => Ok(share as f32),
        None => Parameters::row(name).check(own.into()).map(|share| share as f32),
    };
    Ok(match given.shutter() {
        Shutter::Global => Shutter::Global,
        Shutter::Leaf { ramp } => Shutter::Leaf { ramp: share("shutter_ramp", given.shutter_ramp()?, ramp)? },
        Shutter::FocalPlane { slit } => {
            Shutter::FocalPlane { slit: share("shutter_slit", given.shutter_slit()?, slit)? }
        }
    })
}

/// Returns the image's raster, which must have at least one pixel.
pub fn raster(host: &Host) -> Result<Raster, CameraError> {
    match host.raster {
        Raster { xres, yres } if xres == 0 || yres == 0 => {
            Err(CameraError::Raster { xres: xres as i32, yres: yres as i32 })
        }
        raster => Ok(raster),
    }
}

/// Returns the camera's pose and shutter interval, with the clip range `hither` to `yon`, both multiplied by
/// `clip_scale`.
pub fn placement(
    [hither, yon]: [f64; 2],
    clip_scale: f64,
    given: &Parameters,
    host: &Host,
) -> Result<Placement, CameraError> {
    if yon < hither {
        let range = format!("at least \"hither\", which is {}", as_given(hither));
        return Err(ParameterError::out_of_range("yon", yon, &range).into());
    }
    // Either order is valid, as in pbrt's stock cameras; if the shutter closes first, time runs backward.
    let shutter = [given.shutter_open()? as f32, given.shutter_close()? as f32];
    let to_world = match host.to_world.at(shutter[0]) {
        // A camera does not move during a shutter interval of length 0.
        at_once if host.leave_out && shutter[0] == shutter[1] => at_once.into_owned().into(),
        _ => host.to_world.clone(),
    };
    // The start of a ray must be finite; its end may be infinite.
    let clip = [(hither * clip_scale).min(f32::MAX.into()) as f32, (yon * clip_scale) as f32];
    Ok(Placement { to_world, clip, shutter })
}

/// Returns the mapping of lens samples to the disk; an error if the mapping needs new samples and the host
/// cannot draw them.
pub fn disk_mapping(given: &Parameters, host: &Host) -> Result<DiskMapping, ParameterError> {
    let mapping = given.disk();
    if mapping == DiskMapping::Rejection && !host.can_redraw {
        return Err(ParameterError::Range {
            name: "disk",
            value: format!("\"{mapping}\""),
            range: "\"concentric\" or \"polar\" with a host that cannot draw a lens sample again".to_owned(),
        });
    }
    Ok(mapping)
}

/// Warns of given parameters that the model or its shutter does not use.
pub fn warn_of_unused(model: Model, shutter: Shutter, given: &Parameters, log: Log<'_>) {
    let unused = given.given().filter(|row| !row.models.contains(&model));
    let names: Vec<String> = unused.map(|row| format!("\"{}\"", row.name)).collect();
    if !names.is_empty() {
        log(Level::Warning, &format!("model \"{model}\" does not use {}", names.join(", ")));
    }
    for (name, is_given, is_used, kind) in [
        ("shutter_ramp", given.shutter_ramp.is_some(), matches!(shutter, Shutter::Leaf { .. }), "leaf"),
        (
            "shutter_slit",
            given.shutter_slit.is_some(),
            matches!(shutter, Shutter::FocalPlane { .. }),
            "focal-plane",
        ),
    ] {
        if is_given && !is_used {
            log(Level::Warning, &format!("\"{name}\" is used with \"shutter\" \"{kind}\" only"));
        }
    }
}

/// A part of a picture, in pixels: columns from `from[0]` up to but excluding `to[0]`, rows from `from[1]` up
/// to but excluding `to[1]`.
///
/// A crop only concerns hosts. Film, plan, pupil and weights are those of the whole picture, and samples keep
/// the whole picture's raster coordinates, so that a ray has the same bits for every crop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// The top left pixel: column and row, from 0.
    pub from: [u32; 2],
    /// The column to the right of the last column of the part, and the row below its last row.
    pub to: [u32; 2],
}

impl Crop {
    /// Returns the requested part of the picture, or the whole raster if none is requested.
    ///
    /// # Errors
    /// The sides are not whole pixels, enclose no pixel, or lie outside the raster.
    pub fn of(given: &Parameters, Raster { xres, yres }: Raster) -> Result<Self, ParameterError> {
        let Some(sides @ [x0, y0, x1, y1]) = given.crop else {
            return Ok(Self { from: [0; 2], to: [xres, yres] });
        };
        let are_pixels = sides.iter().all(|side| side.fract() == 0.0);
        let within = |from: f64, to: f64, most: u32| 0.0 <= from && from < to && to <= f64::from(most);
        if !are_pixels || !within(x0, x1, xres) || !within(y0, y1, yres) {
            return Err(ParameterError::Range {
                name: Parameters::row("crop").name,
                value: sides.map(as_given).join(","),
                range: format!(
                    "x from, y from, x to, y to in whole pixels of the {xres} x {yres} picture, with some width and \
                     height: 0 <= x from < x to <= {xres} and 0 <= y from < y to <= {yres}"
                ),
            });
        }
        let [x0, y0, x1, y1] = sides.map(|side| side as u32);
        Ok(Self { from: [x0, y0], to: [x1, y1] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_out_of_range_is_an_error_that_states_the_range() {
        let with = |name: &str, number: &str, kind: &str| {
            let mut given = Parameters::default();
            given.set_from_text("shutter", kind)?;
            given.set_from_text(name, number)?;
            shutter(&given)
        };
        let refused = |name, number, kind| with(name, number, kind).expect_err("refused").to_string();
        assert!(refused("shutter_ramp", "0.6", "leaf").contains("at most 0.5"));
        assert!(refused("shutter_slit", "0", "focal-plane").contains("shutter_slit"));
        assert!(refused("shutter_slit", "0.5", "curtain").contains("\"focal-plane\""));
        assert_eq!(with("shutter_slit", "0.5", "focal-plane"), Ok(Shutter::FocalPlane { slit: 0.5 }));
    }

    #[test]
    fn a_shutter_without_its_share_has_the_tables() {
        for (name, listed) in Shutter::NAMES {
            let mut given = Parameters::default();
            given.set_from_text("shutter", name).expect("listed");
            assert_eq!(shutter(&given), Ok(listed));
        }
    }

    const RASTER: Raster = Raster { xres: 48, yres: 32 };

    fn crop(sides: [f64; 4]) -> Result<Crop, String> {
        let given = Parameters { crop: Some(sides), ..Parameters::default() };
        Crop::of(&given, RASTER).map_err(|error| error.to_string())
    }

    #[test]
    fn a_crop_is_whole_pixels_of_the_picture() {
        let whole = Crop { from: [0, 0], to: [48, 32] };
        assert_eq!(Crop::of(&Parameters::default(), RASTER), Ok(whole));
        assert_eq!(crop([0.0, -0.0, 48.0, 32.0]), Ok(whole));
        assert_eq!(crop([47.0, 3.0, 48.0, 4.0]), Ok(Crop { from: [47, 3], to: [48, 4] }));
        for bad in [
            [0.0, 0.0, 49.0, 32.0],
            [0.0, 0.0, 48.0, 33.0],
            [-1.0, 0.0, 48.0, 32.0],
            [0.0, -1.0, 48.0, 32.0],
            [5.0, 0.0, 5.0, 32.0],
            [0.0, 9.0, 48.0, 8.0],
            [0.5, 0.0, 48.0, 32.0],
            [0.0, 0.0, f64::INFINITY, 32.0],
            [0.0, f64::NAN, 48.0, 32.0],
            [0.0, 0.0, 1e300, 32.0],
        ] {
            let message = crop(bad).expect_err("no part of the picture");
            let given = bad.map(as_given).join(",");
            assert!(given.len() < 30, "{given}");
            for words in [&format!("\"crop\" is {given};"), "48 x 32", "y to <= 32"] {
                assert!(message.contains(words), "{bad:?}: {message}");
            }
        }
    }
}

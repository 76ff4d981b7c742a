//! What every model has: its place in the world, clip range, shutter, and the way to sample a disk.

use crate::{
    camera::{
        film::Raster,
        host::{Host, Level, Log},
        model::Model,
        parameters::{CameraError, ParameterError, Parameters},
        placement::{Placement, shutter::Shutter},
    },
    message::as_given,
    sampling::DiskMapping,
};

/// The shutter, with its share of the interval: the parameter's where it is given, else the shutter's own.
pub(crate) fn shutter(given: &Parameters) -> Result<Shutter, ParameterError> {
    let share = |name, given: Option<f64>, own: f32| match given {
        Some(share) => Ok(share as f32),
        None => Parameters::row(name).check(own.into()).map(|share| share as f32),
    };
    Ok(match given.shutter() {
        Shutter::Global => Shutter::Global,
        Shutter::Leaf { ramp } => Shutter::Leaf { ramp: share("shutterramp", given.shutterramp()?, ramp)? },
        Shutter::FocalPlane { slit } => {
            Shutter::FocalPlane { slit: share("shutterslit", given.shutterslit()?, slit)? }
        }
    })
}

/// The image's pixels, of which there must be some.
pub(crate) fn raster(host: &Host) -> Result<Raster, CameraError> {
    match host.raster {
        Raster { xres, yres } if xres == 0 || yres == 0 => {
            Err(CameraError::Raster { xres: xres as i32, yres: yres as i32 })
        }
        raster => Ok(raster),
    }
}

/// The camera's place and shutter interval, with a clip range of `hither` and `yon`.
pub(crate) fn placement(
    [hither, yon]: [f64; 2],
    given: &Parameters,
    host: &Host,
) -> Result<Placement, CameraError> {
    if yon < hither {
        let range = format!("at least \"hither\", which is {}", as_given(hither));
        return Err(ParameterError::out_of_range("yon", yon, &range).into());
    }
    // In either order, as pbrt's stock cameras take them: time then runs backward.
    let shutter = [given.shutteropen()? as f32, given.shutterclose()? as f32];
    let to_world = match host.to_world.at(shutter[0]) {
        // A moving camera seen at one moment stands still.
        at_once if host.leave_out && shutter[0] == shutter[1] => at_once.into_owned().into(),
        _ => host.to_world.clone(),
    };
    Ok(Placement { to_world, clip: [hither as f32, yon as f32], shutter })
}

/// How lens samples map to the disk, for a host that may not be able to draw again.
pub(crate) fn disk_mapping(given: &Parameters, host: &Host) -> Result<DiskMapping, ParameterError> {
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

/// Warns of what is given and the model or its shutter does not use.
pub(crate) fn warn_of_unused(model: Model, shutter: Shutter, given: &Parameters, log: Log<'_>) {
    let unused = given.given().filter(|row| !row.models.contains(&model));
    let names: Vec<String> = unused.map(|row| format!("\"{}\"", row.name)).collect();
    if !names.is_empty() {
        log(Level::Warning, &format!("model \"{model}\" does not use {}", names.join(", ")));
    }
    for (name, is_given, is_used, kind) in [
        ("shutterramp", given.shutterramp.is_some(), matches!(shutter, Shutter::Leaf { .. }), "leaf"),
        (
            "shutterslit",
            given.shutterslit.is_some(),
            matches!(shutter, Shutter::FocalPlane { .. }),
            "focal-plane",
        ),
    ] {
        if is_given && !is_used {
            log(Level::Warning, &format!("\"{name}\" is used with \"shutter\" \"{kind}\" only"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_out_of_range_is_told_with_the_range() {
        let with = |name: &str, number: &str, kind: &str| {
            let mut given = Parameters::default();
            given.set_from_text("shutter", kind)?;
            given.set_from_text(name, number)?;
            shutter(&given)
        };
        let refused = |name, number, kind| with(name, number, kind).expect_err("refused").to_string();
        assert!(refused("shutterramp", "0.6", "leaf").contains("at most 0.5"));
        assert!(refused("shutterslit", "0", "focal-plane").contains("shutterslit"));
        assert!(refused("shutterslit", "0.5", "curtain").contains("\"focal-plane\""));
        assert_eq!(with("shutterslit", "0.5", "focal-plane"), Ok(Shutter::FocalPlane { slit: 0.5 }));
    }

    #[test]
    fn a_shutter_without_its_share_has_the_tables() {
        for (name, listed) in Shutter::NAMES {
            let mut given = Parameters::default();
            given.set_from_text("shutter", name).expect("listed");
            assert_eq!(shutter(&given), Ok(listed));
        }
    }
}

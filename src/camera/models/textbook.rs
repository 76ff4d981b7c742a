//! From parameters to the cameras without a prescription: perspective, orthographic, environment.

use super::{
    projective::{Kind, LensPlane, ThinLens},
    spaces::ScreenWindow,
};
use crate::camera::{
    CameraError, EnvironmentCamera, Host, Level, Parameters, ProjectiveCamera,
    parameters::check::{choice, out_of_range},
    placement::Placement,
    setup,
};

/// The least `hither` that pbrt's stock cameras take, world units.
const LEAST_HITHER: f64 = 1e-4;
/// The largest `yon` that they take, world units.
const LARGEST_YON: f64 = 1e30;
/// A distance to the plane of focus that stands for infinity, world units.
const FOCUSED_AT_INFINITY: f64 = 1e30;

/// The least field of view, degrees.
const LEAST_FOV: f64 = 1e-4;
/// The farthest that a screen window may reach, and the largest lens: products of floats stay floats.
const LARGEST_SIDE: f64 = 1e15;

type Log<'a> = &'a mut dyn FnMut(Level, &str);

pub(crate) fn perspective(
    given: &Parameters,
    host: &Host,
    log: Log<'_>,
) -> Result<ProjectiveCamera, CameraError> {
    let fov = given.fov.unwrap_or(90.0);
    if !(fov >= LEAST_FOV && (fov as f32) < 180.0) {
        let range = format!("from {LEAST_FOV} to less than 180 degrees");
        return Err(out_of_range("fov", fov, &range));
    }
    projective(Kind::Perspective { fov: fov as f32 }, given, host, log)
}

pub(crate) fn orthographic(
    given: &Parameters,
    host: &Host,
    log: Log<'_>,
) -> Result<ProjectiveCamera, CameraError> {
    projective(Kind::Orthographic, given, host, log)
}

pub(crate) fn environment(
    given: &Parameters,
    host: &Host,
    log: Log<'_>,
) -> Result<EnvironmentCamera, CameraError> {
    Ok(EnvironmentCamera::new(host.raster, placement(given, host, log)?))
}

fn projective(
    kind: Kind,
    given: &Parameters,
    host: &Host,
    log: Log<'_>,
) -> Result<ProjectiveCamera, CameraError> {
    let placement = placement(given, host, log)?;
    let [hither, yon] = placement.clip;
    if !(hither < yon) {
        return Err(out_of_range("yon", yon.into(), &format!("more than \"hither\", which is {hither}")));
    }
    let window = window(given, host)?;
    let lens = thin_lens(given, host, hither)?;
    Ok(ProjectiveCamera::new(kind, window, host.raster, lens, placement))
}

fn placement(given: &Parameters, host: &Host, log: Log<'_>) -> Result<Placement, CameraError> {
    let mut clip = given.clone();
    if let Some(hither) = clip.hither.as_mut()
        && *hither < LEAST_HITHER
    {
        log(Level::Warning, &format!("\"hither\" {hither} is used as {LEAST_HITHER}, as pbrt does"));
        *hither = LEAST_HITHER;
    }
    clip.yon = clip.yon.map(|yon| yon.min(LARGEST_YON));
    setup::placement(&clip, host)
}

fn window(given: &Parameters, host: &Host) -> Result<ScreenWindow, CameraError> {
    if let Some(aspect) = given.frameaspectratio
        && !(LARGEST_SIDE.recip()..=LARGEST_SIDE).contains(&aspect)
    {
        return Err(out_of_range("frameaspectratio", aspect, "positive, from 1e-15 to 1e15"));
    }
    if let Some(window @ [x0, x1, y0, y1]) = given.screenwindow {
        if x0 == x1 || y0 == y1 || window.iter().any(|side| side.abs() > LARGEST_SIDE || side.is_nan()) {
            return Err(crate::camera::ParameterError::Range {
                name: "screenwindow",
                value: format!("{x0} {x1} {y0} {y1}"),
                range: "x from, x to, y from, y to, with some width and height, each at most 1e15 from 0"
                    .to_owned(),
            }
            .into());
        }
        return Ok(ScreenWindow(window.map(|side| side as f32)));
    }
    let image = host.raster.xres as f32 / host.raster.yres as f32;
    Ok(ScreenWindow::of_aspect(given.frameaspectratio.map_or(image, |aspect| aspect as f32)))
}

fn thin_lens(given: &Parameters, host: &Host, hither: f32) -> Result<Option<ThinLens>, CameraError> {
    let plane = choice("lensplane", given.lensplane.as_deref(), &LensPlane::NAMES)?;
    let radius = given.lensradius.unwrap_or(0.0);
    if !(0.0..=LARGEST_SIDE).contains(&radius) {
        return Err(out_of_range("lensradius", radius, "0 (a pinhole) or more, up to 1e15 world units"));
    }
    let focal_distance = given.focaldistance.unwrap_or(FOCUSED_AT_INFINITY).min(FOCUSED_AT_INFINITY);
    if radius > 0.0 && !(focal_distance as f32 > hither) {
        let range = format!("more than \"hither\", which is {hither}, in world units");
        return Err(out_of_range("focaldistance", focal_distance, &range));
    }
    // A radius that single precision rounds to 0 is a pinhole.
    Ok((radius as f32 > 0.0).then_some(ThinLens {
        radius: radius as f32,
        focal_distance: focal_distance as f32,
        plane,
        mapping: setup::disk_mapping(given, host)?,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Raster};

    fn build(settings: &[(&str, &str)]) -> (Result<Camera, String>, Vec<String>) {
        let mut given = Parameters::default();
        for (name, text) in settings {
            given.set_from_text(name, text).expect("the kind of value it takes");
        }
        let mut said = Vec::new();
        let host = Host::new(Raster { xres: 40, yres: 20 }, None);
        let camera = Camera::build(&given, &host, &mut |_, text| said.push(text.to_owned()));
        (camera.map_err(|error| error.to_string()), said)
    }

    #[track_caller]
    fn refused(settings: &[(&str, &str)], parts: &[&str]) {
        let message = build(settings).0.expect_err("refused");
        for part in parts {
            assert!(message.contains(part), "{message} lacks {part}");
        }
    }

    #[test]
    fn values_out_of_range_are_errors_that_name_the_range() {
        refused(&[("model", "perspective"), ("fov", "180")], &["\"fov\" is 180", "less than 180"]);
        refused(&[("model", "perspective"), ("frameaspectratio", "0")], &["frameaspectratio", "positive"]);
        refused(&[("model", "perspective"), ("screenwindow", "1,1,-1,1")], &["screenwindow", "1 1 -1 1"]);
        refused(&[("model", "orthographic"), ("lensradius", "-1")], &["lensradius", "0 (a pinhole) or more"]);
        refused(&[("model", "orthographic"), ("hither", "5"), ("yon", "5")], &["yon", "hither"]);
        refused(
            &[("model", "perspective"), ("lensradius", "1"), ("focaldistance", "2"), ("hither", "3")],
            &["focaldistance", "more than \"hither\""],
        );
        refused(&[("model", "orthographic"), ("lensplane", "middle")], &["\"eye\" or \"hither\""]);
        refused(&[("model", "camera obscura")], &["\"orthographic\"", "camera obscura"]);
    }

    #[test]
    fn clip_distances_are_kept_in_the_stock_cameras_range() {
        let (camera, said) = build(&[("model", "environment"), ("hither", "0"), ("yon", "1e35")]);
        assert_eq!(camera.expect("built").clip(), [1e-4, 1e30]);
        assert!(said.len() == 1 && said[0].contains("0.0001"), "{said:?}");
        let (camera, said) = build(&[("model", "perspective")]);
        assert_eq!(camera.expect("built").clip(), [1e-3, 1e30]);
        assert_eq!(said, [""; 0]);
    }

    #[test]
    fn what_a_model_does_not_use_is_told() {
        for (model, settings, names) in [
            ("perspective", [("filmdiag", "35"), ("wavelength", "500")], "\"filmdiag\", \"wavelength\""),
            ("orthographic", [("fov", "60"), ("lensradius", "0")], "\"fov\""),
            ("environment", [("lensradius", "0"), ("disk", "polar")], "\"lensradius\", \"disk\""),
            ("perspective", [("fov", "60"), ("af_zones", "zones.txt")], "\"af_zones\""),
            ("thick", [("refraction", "whitted"), ("filmdiag", "35")], "\"refraction\""),
            ("lens", [("lensradius", "1"), ("filmdiag", "35")], "\"lensradius\""),
        ] {
            let (camera, mut said) = build(&[("model", model), settings[0], settings[1]]);
            camera.expect("built all the same");
            said.sort();
            let found: Vec<&str> = said
                .iter()
                .filter_map(|text| text.strip_prefix(&format!("model \"{model}\" does not use ")))
                .collect();
            let sorted = |text: &str| {
                let mut names: Vec<String> = text.split(", ").map(str::to_owned).collect();
                names.sort();
                names
            };
            assert_eq!(found.len(), 1, "{model}: {said:?}");
            assert_eq!(sorted(found[0]), sorted(names), "{model}");
        }
    }

    #[test]
    fn a_shutters_number_without_that_shutter_is_told() {
        let (camera, said) = build(&[("model", "environment"), ("shutterslit", "0.5")]);
        camera.expect("built all the same");
        assert_eq!(said, ["\"shutterslit\" is used with \"shutter\" \"focal-plane\" only"]);
    }
}
